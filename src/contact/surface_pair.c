/* Nodes that may soon meet a facet. */
#include "contact/surface_candidates.h"

/* ---- a facet and a node ---- */

/* A facet that meets nodes. */
typedef struct Target {
    int32_t place;
    const ShvSurfaceFacet *facet;
    ShvFacetPlane plane;
    bool alone; /* it cannot meet its own fragment */
} Target;

/* False for one without area, which meets nothing. */
static bool make_target(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t place, Target *target)
{
    const ShvSurfaceFacet *facet = &contact->list.facets[place];
    ShvVec3 corners[3];
    target->place = place;
    target->facet = facet;
    target->alone = !contact->fragments[facet->fragment].cracked || contact->fragments[facet->fragment].rigid;
    for (int k = 0; k < 3; k++)
        corners[k] = shv_bodies_position(bodies, contact->list.nodes[facet->slots[k]].node, facet->fragment);
    return shv_facet_plane_make(corners, &target->plane);
}

static int corner_of_duplicate(const ShvState *state, int32_t element, int32_t node)
{
    for (int k = 0; k < 4; k++)
        if (state->origin[shv_state_node(state, element, k)] == state->origin[node]) return k;
    return -1;
}

/* Whether a node belongs to the tet on the other side of the facet: these two meet across it from the start. */
static bool is_across(const ShvModel *model, const ShvState *state, const ShvSurfaceFacet *facet, int32_t node)
{
    const ShvAdjacency *adjacency = &model->adjacency;
    const int64_t between = adjacency->element_facets[4 * (int64_t)facet->element + facet->face];
    if (between >= adjacency->interior_count) return false;
    const int32_t *elements = adjacency->facet_elements + 2 * between;
    return shv_state_has_node(state, elements[elements[0] == facet->element], node);
}

/* Neighbours between which a crack sees to them have nothing to do with each other. */
static bool are_held(const ShvSurfaceContact *contact, const ShvState *state, const ShvSurfaceNode *node,
                     const ShvSurfaceFacet *facet, int corner)
{
    if (corner < 0 || !node->held) return false;
    const int32_t slot = contact->list.slot[shv_state_node(state, facet->element, corner)];
    return slot >= 0 && contact->list.nodes[slot].held;
}

/* Both have been found where they stand in the grids; since then each may have gone as far as its skin, and may go as far on the
   other side of that place. */
static ShvStatus pair(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const Target *target, int32_t slot,
                      ShvError *error)
{
    const ShvSurfaceFacet *facet = target->facet;
    const ShvSurfaceNode *node = &contact->list.nodes[slot];
    if (target->alone && node->fragment == facet->fragment) return SHV_OK;
    if (shv_state_has_node(bodies->state, facet->element, node->node)) return SHV_OK;
    const int corner = corner_of_duplicate(bodies->state, facet->element, node->node);
    if (are_held(contact, bodies->state, node, facet, corner)) return SHV_OK;
    const bool fresh = contact->built_time == bodies->state->time;
    const ShvVec3 x = fresh ? node->from : shv_bodies_position(bodies, node->node, node->fragment);
    const double distance = shv_facet_plane_distance(&target->plane, x);
    if (distance > (fresh ? 1.0 : 2.0) * shv_surface_reach(contact, facet, node->speed_class)) return SHV_OK;
    const bool across = corner >= 0 && is_across(contact->model, bodies->state, facet, node->node);
    const ShvSurfaceCandidate candidate = {
        .slot = slot, .facet = target->place, .own_facet = -1, .duplicate_corner = (int8_t)(across ? -1 : corner)};
    return shv_surface_candidate_add(contact, bodies, &candidate, distance, error);
}

ShvStatus shv_surface_pair_facet(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t place,
                                 ShvError *error)
{
    Target target;
    ShvHashGrid *grid = &contact->node_grid;
    if (!make_target(contact, bodies, place, &target)) return SHV_OK;
    for (int speed_class = 0; speed_class < SHV_SURFACE_SPEED_CLASSES; speed_class++) {
        const double reach = shv_surface_reach(contact, target.facet, speed_class);
        SHV_TRY(shv_hash_grid_find(grid, speed_class, shv_box_grown(target.facet->box, reach), error));
        for (int32_t k = 0; k < grid->found_count; k++) SHV_TRY(pair(contact, bodies, &target, grid->found[k], error));
    }
    return SHV_OK;
}

static ShvStatus pair_with(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t slot, int32_t place,
                           ShvError *error)
{
    const ShvSurfaceFacet *facet = &contact->list.facets[place];
    const ShvSurfaceNode *node = &contact->list.nodes[slot];
    const ShvBox box = shv_box_grown(facet->box, shv_surface_reach(contact, facet, node->speed_class));
    Target target;
    if (facet->rebuild_number == contact->rebuild_number || !shv_box_holds(&box, node->from)) return SHV_OK;
    return make_target(contact, bodies, place, &target) ? pair(contact, bodies, &target, slot, error) : SHV_OK;
}

ShvStatus shv_surface_pair_node(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t slot,
                                ShvError *error)
{
    const ShvVec3 from = contact->list.nodes[slot].from;
    const double skin = contact->skin[contact->list.nodes[slot].speed_class];
    ShvHashGrid *grid = &contact->facet_grid;
    if (contact->list.nodes[slot].inner) return SHV_OK;
    for (int speed_class = 0; speed_class < SHV_SURFACE_SPEED_CLASSES; speed_class++) {
        const double reach = contact->half[speed_class] + contact->skin[speed_class] + skin;
        SHV_TRY(shv_hash_grid_find(grid, speed_class, shv_box_grown((ShvBox){from, from}, reach), error));
        for (int32_t k = 0; k < grid->found_count; k++)
            SHV_TRY(pair_with(contact, bodies, slot, grid->found[k], error));
    }
    return SHV_OK;
}

/* ---- obstacles ---- */

static bool meets_obstacles(const ShvSurfaceBodies *bodies, int32_t fragment)
{
    return !bodies->barred || shv_bodies_coupled_body(bodies, fragment);
}

ShvStatus shv_surface_pair_node_obstacles(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t slot,
                                          ShvError *error)
{
    const ShvSurfaceNode *node = &contact->list.nodes[slot];
    if (!bodies->obstacles || !meets_obstacles(bodies, node->fragment)) return SHV_OK;
    const ShvVec3 x = shv_bodies_position(bodies, node->node, node->fragment);
    const double reach = contact->skin[node->speed_class] + contact->skin[SHV_SURFACE_OBSTACLES];
    for (int32_t k = 0; k < bodies->obstacles->count; k++) {
        const ShvSurfacePoint at = shv_obstacle_closest(&bodies->obstacles->items[k], x, reach);
        if (at.gap >= reach) continue;
        const ShvSurfaceCandidate candidate = {.slot = slot, .facet = -1 - k, .own_facet = -1, .duplicate_corner = -1};
        SHV_TRY(shv_surface_candidate_add(contact, bodies, &candidate, fmax(at.gap, 0.0), error));
    }
    return SHV_OK;
}

/* With each feature that is near. */
static ShvStatus pair_facet_obstacle(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t obstacle,
                                     int32_t place, ShvError *error)
{
    const ShvObstacle *other = &bodies->obstacles->items[obstacle];
    const ShvSurfaceFacet *facet = &contact->list.facets[place];
    const ShvFacetShape shape = shv_surface_facet_shape(bodies, &contact->list, facet);
    const double margin = contact->skin[facet->speed_class] + contact->skin[SHV_SURFACE_OBSTACLES];
    ShvFeatureRange range;
    if (!shv_features_about(other, &shape, margin, &range)) return SHV_OK;
    ShvSurfaceCandidate candidate = {
        .slot = facet->slots[0], .facet = -1 - obstacle, .own_facet = place, .duplicate_corner = -1};
    for (candidate.feature = range.first; candidate.feature < range.end; candidate.feature++)
        if (shv_feature_is_near(other, &other->features[candidate.feature], range.centre, range.reach))
            SHV_TRY(shv_surface_candidate_add(contact, bodies, &candidate, 0.0, error));
    return SHV_OK;
}

ShvStatus shv_surface_pair_facet_obstacles(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t place,
                                           ShvError *error)
{
    if (!bodies->obstacles || !meets_obstacles(bodies, contact->list.facets[place].fragment)) return SHV_OK;
    for (int32_t k = 0; k < bodies->obstacles->count; k++)
        if (bodies->obstacles->items[k].feature_count > 0)
            SHV_TRY(pair_facet_obstacle(contact, bodies, k, place, error));
    return SHV_OK;
}
