/* Nodes that may soon meet a facet. */
#include "contact/surface_candidates.h"

#include "contact/candidates.h"

/* ---- one candidate ---- */

static ShvStatus watch(ShvSurfaceContact *contact, int32_t slot, ShvError *error)
{
    if (contact->list.nodes[slot].watch >= 0) return SHV_OK;
    void *block = contact->watched;
    SHV_TRY(shv_candidates_grow(contact->memory, &block, &contact->watched_capacity, contact->watched_count,
                                sizeof(int32_t), error));
    contact->watched = block;
    contact->list.nodes[slot].watch = contact->watched_count;
    contact->watched[contact->watched_count++] = slot;
    return SHV_OK;
}

static ShvStatus reserve_candidate(ShvSurfaceContact *contact, ShvSurfaceCandidates *list, ShvError *error)
{
    if (list->count < list->capacity) return SHV_OK;
    int32_t room = list->capacity;
    void *block = list->due;
    SHV_TRY(shv_candidates_grow(contact->memory, &block, &room, list->count, sizeof(double), error));
    list->due = block;
    room = list->capacity;
    block = list->movers;
    SHV_TRY(shv_candidates_grow(contact->memory, &block, &room, list->count, sizeof(uint8_t), error));
    list->movers = block;
    block = list->items;
    SHV_TRY(
        shv_candidates_grow(contact->memory, &block, &list->capacity, list->count, sizeof(ShvSurfaceCandidate), error));
    list->items = block;
    return SHV_OK;
}

ShvStatus shv_surface_candidate_append(ShvSurfaceContact *contact, ShvSurfaceCandidates *list,
                                       const ShvSurfaceCandidate *candidate, double due, uint8_t movers,
                                       ShvError *error)
{
    SHV_TRY(reserve_candidate(contact, list, error));
    list->items[list->count] = *candidate;
    list->due[list->count] = due;
    list->movers[list->count++] = movers;
    return SHV_OK;
}

ShvStatus shv_surface_candidate_watch(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                                      const ShvSurfaceCandidate *candidate, ShvError *error)
{
    if (!shv_bodies_coupled_body(bodies, candidate->fragments[0])) {
        SHV_TRY(watch(contact, candidate->slot, error));
        const int32_t half_edge = candidate->half_edge - 1;
        if (half_edge >= 0)
            SHV_TRY(watch(contact, contact->list.facets[half_edge / 3].slots[(half_edge + 1) % 3], error));
    }
    if (candidate->element < 0 || shv_bodies_coupled_body(bodies, candidate->fragments[1])) return SHV_OK;
    const int32_t *slots = contact->list.facets[candidate->facet].slots;
    for (int k = 0; k < 3; k++) SHV_TRY(watch(contact, slots[k], error));
    return SHV_OK;
}

ShvStatus shv_surface_candidate_add(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                                    const ShvSurfaceCandidate *candidate, int own, int other, double distance,
                                    ShvError *error)
{
    const bool rigid = candidate->element >= 0 && shv_bodies_coupled_body(bodies, candidate->fragments[0]) &&
                       shv_bodies_coupled_body(bodies, candidate->fragments[1]);
    SHV_TRY(shv_surface_candidate_append(contact, &contact->candidates[rigid], candidate,
                                         contact->path[own] + contact->path[other] + distance,
                                         (uint8_t)(own * SHV_SURFACE_MOVERS + other), error));
    return shv_surface_candidate_watch(contact, bodies, candidate, error);
}

static ShvStatus add_candidate(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                               const ShvSurfaceCandidate *candidate, int other, double distance, ShvError *error)
{
    const int own = contact->list.nodes[candidate->slot].speed_class;
    return shv_surface_candidate_add(contact, bodies, candidate, own, other, distance, error);
}

/* ---- a facet and a node ---- */

/* A facet that looks for nodes. */
typedef struct Seeker {
    const ShvSurfaceFacet *facet;
    ShvFacetPlane plane;
    bool alone; /* it cannot meet its own fragment */
} Seeker;

/* False for one without area, which meets nothing. */
static bool make_seeker(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const ShvSurfaceFacet *facet,
                        Seeker *seeker)
{
    ShvVec3 corners[3];
    seeker->facet = facet;
    seeker->alone = !contact->fragments[facet->fragment].cracked || contact->fragments[facet->fragment].rigid;
    for (int k = 0; k < 3; k++)
        corners[k] = shv_bodies_position(bodies, contact->list.nodes[facet->slots[k]].node, facet->fragment);
    return shv_facet_plane_make(corners, &seeker->plane);
}

static int32_t corner_of_copy(const ShvState *state, int32_t element, int32_t node)
{
    for (int32_t k = 0; k < 4; k++)
        if (state->origin[shv_state_node(state, element, k)] == state->origin[node]) return k;
    return -1;
}

static ShvStatus pair_node(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const Seeker *seeker,
                           int32_t slot, double reach, ShvError *error)
{
    const ShvSurfaceFacet *facet = seeker->facet;
    const ShvSurfaceNode *node = &contact->list.nodes[slot];
    if (seeker->alone && node->fragment == facet->fragment) return SHV_OK;
    if (shv_state_has_node(bodies->state, facet->element, node->node)) return SHV_OK;
    const ShvVec3 x = contact->built_time == bodies->state->time
                          ? node->from
                          : shv_bodies_position(bodies, node->node, node->fragment);
    const double distance = shv_facet_plane_distance(&seeker->plane, x);
    if (distance > reach) return SHV_OK;
    const ShvSurfaceCandidate candidate = {.node = node->node,
                                           .element = facet->element,
                                           .face = facet->face,
                                           .fragments = {node->fragment, facet->fragment},
                                           .slot = slot,
                                           .facet = (int32_t)(facet - contact->list.facets),
                                           .copy_corner = corner_of_copy(bodies->state, facet->element, node->node)};
    return add_candidate(contact, bodies, &candidate, facet->speed_class, distance, error);
}

/* Nodes of the grid that are so many times the reach of both sides away. Those that have left their skin are not where it has them. */
static ShvStatus pair_nodes(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const Seeker *seeker,
                            double times, ShvError *error)
{
    const ShvSurfaceFacet *facet = seeker->facet;
    ShvNodeGrid *grid = &contact->grid;
    for (int speed_class = 0; speed_class < SHV_SURFACE_SPEED_CLASSES; speed_class++) {
        const double reach = times * shv_surface_reach(contact, facet, speed_class);
        SHV_TRY(shv_node_grid_find(grid, speed_class, shv_box_grown(facet->box, reach), error));
        for (int32_t k = 0; k < grid->found_count; k++)
            if (!contact->list.nodes[grid->found[k]].out_of_skin)
                SHV_TRY(pair_node(contact, bodies, seeker, grid->found[k], reach, error));
    }
    return SHV_OK;
}

ShvStatus shv_surface_pair_facet(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                                 const ShvSurfaceFacet *facet, ShvError *error)
{
    Seeker seeker;
    if (!make_seeker(contact, bodies, facet, &seeker)) return SHV_OK;
    return pair_nodes(contact, bodies, &seeker, 1.0, error);
}

/* Where nodes of each speed class must be to be candidates of a facet that is not in the grid's order. */
static void find_reaches(const ShvSurfaceContact *contact, const ShvSurfaceFacet *facet,
                         double reaches[SHV_SURFACE_SPEED_CLASSES], ShvBox boxes[SHV_SURFACE_SPEED_CLASSES])
{
    for (int speed_class = 0; speed_class < SHV_SURFACE_SPEED_CLASSES; speed_class++) {
        reaches[speed_class] = 2.0 * shv_surface_reach(contact, facet, speed_class);
        boxes[speed_class] = shv_box_grown(facet->box, reaches[speed_class]);
    }
}

/* Nodes stand in the grid where they were when it was filled, and may go as far again, on the other side of that; later ones
   are not in it. */
ShvStatus shv_surface_pair_late_facet(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                                      const ShvSurfaceFacet *facet, ShvError *error)
{
    Seeker seeker;
    double reaches[SHV_SURFACE_SPEED_CLASSES];
    ShvBox boxes[SHV_SURFACE_SPEED_CLASSES];
    if (!make_seeker(contact, bodies, facet, &seeker)) return SHV_OK;
    SHV_TRY(pair_nodes(contact, bodies, &seeker, 2.0, error));
    find_reaches(contact, facet, reaches, boxes);
    const int32_t late = contact->list.node_count - contact->grid_nodes;
    for (int32_t k = 0; k < contact->nodes_out_of_skin.count + late; k++) {
        const int32_t slot = k < contact->nodes_out_of_skin.count
                                 ? contact->nodes_out_of_skin.items[k]
                                 : contact->grid_nodes + k - contact->nodes_out_of_skin.count;
        const ShvSurfaceNode *node = &contact->list.nodes[slot];
        if (shv_box_holds(&boxes[node->speed_class], node->from))
            SHV_TRY(pair_node(contact, bodies, &seeker, slot, reaches[node->speed_class], error));
    }
    return SHV_OK;
}

static ShvStatus pair_with(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t slot, int32_t place,
                           ShvError *error)
{
    const ShvSurfaceFacet *facet = &contact->list.facets[place];
    const ShvSurfaceNode *node = &contact->list.nodes[slot];
    const double reach = 2.0 * shv_surface_reach(contact, facet, node->speed_class);
    const ShvBox box = shv_box_grown(facet->box, reach);
    Seeker seeker;
    if (facet->leaves_skin || !shv_box_holds(&box, node->from) || !make_seeker(contact, bodies, facet, &seeker))
        return SHV_OK;
    return pair_node(contact, bodies, &seeker, slot, reach, error);
}

ShvStatus shv_surface_pair_late_node(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t slot,
                                     int32_t facets, ShvError *error)
{
    const ShvSurfaceNode *node = &contact->list.nodes[slot];
    ShvNodeGrid *grid = &contact->facet_grid;
    for (int speed_class = 0; speed_class < SHV_SURFACE_SPEED_CLASSES; speed_class++) {
        const double reach =
            contact->half[speed_class] + 2.0 * (contact->skin[speed_class] + contact->skin[node->speed_class]);
        SHV_TRY(
            shv_node_grid_find(grid, speed_class, shv_box_grown((ShvBox){node->from, node->from}, reach), error));
        for (int32_t k = 0; k < grid->found_count; k++)
            if (!contact->list.facets[grid->found[k]].out_of_skin)
                SHV_TRY(pair_with(contact, bodies, slot, grid->found[k], error));
    }
    for (int32_t k = 0; k < contact->facets_out_of_skin.count; k++)
        SHV_TRY(pair_with(contact, bodies, slot, contact->facets_out_of_skin.items[k], error));
    for (int32_t place = contact->grid_facets; place < facets; place++)
        SHV_TRY(pair_with(contact, bodies, slot, place, error));
    return SHV_OK;
}

static ShvStatus pair_coupled_body_node(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t obstacle,
                                        int32_t slot, ShvError *error)
{
    const ShvSurfaceNode *node = &contact->list.nodes[slot];
    if (!shv_bodies_coupled_body(bodies, node->fragment)) return SHV_OK;
    const ShvVec3 x = shv_bodies_position(bodies, node->node, node->fragment);
    const double reach = contact->skin[node->speed_class] + contact->skin[SHV_SURFACE_OBSTACLES];
    const ShvSurfacePoint at = shv_obstacle_closest(&bodies->obstacles->items[obstacle], x, reach);
    if (at.gap >= reach) return SHV_OK;
    const ShvSurfaceCandidate candidate = {.node = node->node,
                                           .element = -1 - obstacle,
                                           .fragments = {node->fragment, -1 - obstacle},
                                           .slot = slot,
                                           .facet = -1,
                                           .copy_corner = -1};
    return add_candidate(contact, bodies, &candidate, SHV_SURFACE_OBSTACLES, fmax(at.gap, 0.0), error);
}

/* With each feature that is near. */
static ShvStatus pair_coupled_body_facet(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t obstacle,
                                         const ShvSurfaceFacet *facet, ShvError *error)
{
    const ShvObstacle *other = &bodies->obstacles->items[obstacle];
    if (!shv_bodies_coupled_body(bodies, facet->fragment)) return SHV_OK;
    const ShvFacetShape shape = shv_surface_facet_shape(bodies, facet->element, facet->face, facet->fragment);
    const double margin = contact->skin[facet->speed_class] + contact->skin[SHV_SURFACE_OBSTACLES];
    ShvFeatureRange range;
    if (!shv_features_about(other, &shape, margin, &range)) return SHV_OK;
    ShvSurfaceCandidate candidate = {.node = contact->list.nodes[facet->slots[0]].node,
                                     .element = -1 - obstacle,
                                     .face = 4 * facet->element + facet->face,
                                     .fragments = {facet->fragment, -1 - obstacle},
                                     .slot = facet->slots[0],
                                     .facet = -1,
                                     .copy_corner = -1};
    for (int32_t k = range.first; k < range.end; k++) {
        candidate.feature = k + 1;
        if (shv_feature_is_near(other, &other->features[k], range.centre, range.reach))
            SHV_TRY(add_candidate(contact, bodies, &candidate, SHV_SURFACE_OBSTACLES, 0.0, error));
    }
    return SHV_OK;
}

ShvStatus shv_surface_pair_obstacle(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t obstacle,
                                    ShvError *error)
{
    for (int32_t slot = 0; slot < contact->list.node_count; slot++)
        SHV_TRY(pair_coupled_body_node(contact, bodies, obstacle, slot, error));
    if (bodies->obstacles->items[obstacle].feature_count == 0) return SHV_OK;
    for (int32_t k = 0; k < contact->list.facet_count; k++)
        SHV_TRY(pair_coupled_body_facet(contact, bodies, obstacle, &contact->list.facets[k], error));
    return SHV_OK;
}
