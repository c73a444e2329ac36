#include "contact/surface_candidates.h"

#include "contact/candidates.h"

enum { STEPS_BETWEEN_LOOKS = 4, STEPS_TO_LAST = 64, MOST_REGIONS = 64 };

/* ---- whether anything can meet ---- */

static bool find_idle(const ShvSurfaceBodies *bodies)
{
    int32_t active = 0;
    for (int32_t i = 0; i < bodies->fragment_count && active < 2; i++) active += shv_bodies_active(bodies, i);
    const bool parted = bodies->cohesive && bodies->cohesive->live_count < bodies->cohesive->count;
    return active == 0 || (active == 1 && !parted);
}

static bool is_stale(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    const ShvCohesive *cohesive = bodies->cohesive;
    return contact->stale || contact->known_fragments != bodies->fragment_count ||
           contact->known_nodes != bodies->state->node_count ||
           (cohesive && contact->known_cohesive != cohesive->count) ||
           (cohesive && contact->idle && contact->known_live != cohesive->live_count);
}

/* ---- motion ---- */

static ShvVec3 node_velocity(const ShvSurfaceBodies *bodies, const ShvSurfaceNode *node)
{
    const ShvCompanion *companion = shv_bodies_companion(bodies, node->fragment);
    if (!companion) return shv_load3(bodies->state->velocity + 3 * (int64_t)node->node);
    return shv_companion_velocity(companion, shv_bodies_position(bodies, node->node, node->fragment));
}

static ShvVec3 against_frame(const ShvSurfaceContact *contact, ShvVec3 velocity)
{
    return shv_sub(velocity, contact->drift);
}

/* Of obstacles; those that stand move against the frame too. */
static double obstacle_speed(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    double largest = 0.0;
    for (int32_t k = 0; bodies->obstacles && k < bodies->obstacles->count; k++)
        largest = fmax(largest, shv_candidates_obstacle_speed(&bodies->obstacles->items[k]) + shv_norm(contact->drift));
    return largest;
}

/* No node of it is faster against the frame, m/s. */
static double companion_speed(const ShvSurfaceContact *contact, const ShvCompanion *companion)
{
    return shv_norm(against_frame(contact, companion->velocity)) +
           shv_norm(companion->angular_velocity) * companion->radius;
}

void shv_surface_candidates_look(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    double largest[SHV_SURFACE_PACES] = {0.0};
    for (int32_t k = 0; k < contact->watched_count; k++) {
        const ShvSurfaceNode *node = &contact->list.nodes[contact->watched[k]];
        const ShvVec3 v = against_frame(contact, shv_load3(bodies->state->velocity + 3 * (int64_t)node->node));
        const double squared = shv_dot(v, v);
        largest[node->pace] = squared > largest[node->pace] ? squared : largest[node->pace];
    }
    for (int pace = 0; pace < SHV_SURFACE_PACES; pace++) contact->speed[pace] = sqrt(largest[pace]);
    for (int32_t i = 0; bodies->companions && i < bodies->fragment_count; i++) {
        if (!bodies->companions[i]) continue;
        double *speed = &contact->speed[contact->motion[i].pace];
        const double own = companion_speed(contact, bodies->companions[i]);
        *speed = own > *speed ? own : *speed;
    }
    contact->speed[SHV_SURFACE_OBSTACLES] = obstacle_speed(contact, bodies);
}

/* Whether something may leave its allowance before the next look; twice the speeds are allowed for. */
static bool companions_outrun(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double ahead,
                              double gravity)
{
    for (int32_t i = 0; bodies->companions && i < bodies->fragment_count; i++) {
        if (!bodies->companions[i]) continue;
        const ShvCompanionMotion *motion = &contact->motion[i];
        const double speed = companion_speed(contact, bodies->companions[i]) + ahead * gravity;
        if (!(motion->path + ahead * speed <= contact->allowance[motion->pace])) return true;
    }
    return false;
}

static bool outrun(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step, double gravity)
{
    const double time = bodies->state->time - contact->built_time, ahead = 2.0 * STEPS_BETWEEN_LOOKS * step;
    for (int32_t k = 0; k < contact->list.node_count; k++) {
        const ShvSurfaceNode *node = &contact->list.nodes[k];
        if (shv_bodies_companion(bodies, node->fragment)) continue;
        const ShvVec3 x = shv_state_position(bodies->state, node->node);
        const ShvVec3 gone = shv_madd(shv_sub(x, node->from), -time, contact->drift);
        const ShvVec3 v = against_frame(contact, shv_load3(bodies->state->velocity + 3 * (int64_t)node->node));
        if (!(shv_norm(gone) + ahead * (shv_norm(v) + ahead * gravity) <= contact->allowance[node->pace])) return true;
    }
    return companions_outrun(contact, bodies, 2.0 * SHV_SURFACE_BEAT * step, gravity) ||
           contact->path[SHV_SURFACE_OBSTACLES] + ahead * contact->speed[SHV_SURFACE_OBSTACLES] >
               contact->allowance[SHV_SURFACE_OBSTACLES];
}

/* Counts the step that led here, once; returns whether candidates no longer hold. */
static bool count_motion(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double gravity)
{
    const ShvState *state = bodies->state;
    if (state->time == contact->seen_time) return false;
    contact->seen_time = state->time;
    shv_surface_candidates_look(contact, bodies);
    for (int k = 0; k < SHV_SURFACE_MOVERS; k++) contact->path[k] += state->last_step * contact->speed[k];
    for (int32_t i = 0; bodies->companions && i < bodies->fragment_count; i++)
        if (bodies->companions[i])
            contact->motion[i].path += state->last_step * companion_speed(contact, bodies->companions[i]);
    contact->beat = (contact->beat + 1) % SHV_SURFACE_BEAT;
    if (++contact->since < STEPS_BETWEEN_LOOKS) return false;
    contact->since = 0;
    return outrun(contact, bodies, state->last_step, gravity);
}

/* ---- paces ---- */

static double mean_size(const ShvSurfaceContact *contact)
{
    double sum = 0.0;
    for (int32_t k = 0; k < contact->list.facet_count; k++) sum += shv_box_size(&contact->list.facets[k].box);
    return contact->list.facet_count > 0 ? sum / contact->list.facet_count : 0.0;
}

static void choose_frame(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    ShvVec3 sum = {0.0, 0.0, 0.0};
    const int32_t count = contact->list.node_count;
    for (int32_t k = 0; k < count; k++) sum = shv_add(sum, node_velocity(bodies, &contact->list.nodes[k]));
    contact->drift = count > 0 ? shv_scale(sum, 1.0 / count) : sum;
}

/* Lasts for many steps, but is not so far that every node has dozens of candidates unless the motion demands it. */
static double allowance_for(const ShvSurfaceContact *contact, double way)
{
    const double far = 0.25 * contact->size, wanted = STEPS_TO_LAST * way, needed = 4.0 * STEPS_BETWEEN_LOOKS * way;
    return fmax(needed, fmin(wanted, far));
}

/* Chooses the pace; places are kept as if the frame had not moved since candidates were chosen. */
static void give_pace(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvSurfaceNode *node, double step)
{
    const ShvCompanion *companion = shv_bodies_companion(bodies, node->fragment);
    const double speed =
        companion ? companion_speed(contact, companion) : shv_norm(against_frame(contact, node_velocity(bodies, node)));
    const double wanted = companion ? 4.0 * SHV_SURFACE_BEAT * step * speed : allowance_for(contact, step * speed);
    const ShvVec3 x = shv_bodies_position(bodies, node->node, node->fragment);
    node->from = shv_madd(x, contact->built_time - bodies->state->time, contact->drift);
    node->pace = 0;
    while (node->pace < SHV_SURFACE_PACES - 1 && !(contact->allowance[node->pace] >= wanted)) node->pace++;
    if (companion) contact->motion[node->fragment] = (ShvCompanionMotion){.pace = node->pace};
}

static void give_facet_pace(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvSurfaceFacet *facet)
{
    int32_t nodes[3];
    shv_surface_corners(bodies->state, facet->element, facet->face, nodes);
    const ShvVec3 back = shv_scale(contact->drift, contact->built_time - bodies->state->time);
    facet->box = (ShvBox){shv_add(facet->box.low, back), shv_add(facet->box.high, back)};
    facet->pace = 0;
    for (int k = 0; k < 3; k++) {
        const uint8_t pace = contact->list.nodes[contact->list.slot[nodes[k]]].pace;
        facet->pace = pace > facet->pace ? pace : facet->pace;
    }
}

static void choose_paces(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step)
{
    const double least = 0.04;
    choose_frame(contact, bodies);
    contact->built_time = bodies->state->time;
    contact->since = 0;
    contact->size = mean_size(contact);
    for (int pace = 0; pace < SHV_SURFACE_PACES; pace++)
        contact->allowance[pace] = least * contact->size * (double)(1 << pace);
    contact->speed[SHV_SURFACE_OBSTACLES] = obstacle_speed(contact, bodies);
    contact->allowance[SHV_SURFACE_OBSTACLES] =
        fmax(contact->allowance[0], allowance_for(contact, step * contact->speed[SHV_SURFACE_OBSTACLES]));
    for (int32_t i = 0; i < bodies->fragment_count; i++) contact->motion[i] = (ShvCompanionMotion){0};
    for (int32_t k = 0; k < contact->list.node_count; k++) give_pace(contact, bodies, &contact->list.nodes[k], step);
    for (int32_t k = 0; k < contact->list.facet_count; k++) give_facet_pace(contact, bodies, &contact->list.facets[k]);
    for (int k = 0; k < SHV_SURFACE_MOVERS; k++) contact->path[k] = 0.0;
}

/* ---- regions ---- */

static ShvStatus reserve_fragments(ShvSurfaceContact *contact, int32_t count, ShvError *error)
{
    if (contact->fragment_capacity >= count) return SHV_OK;
    const size_t wanted = (size_t)count + (size_t)count / 2;
    ShvBox *own = shv_reallocate(contact->memory, SHV_PART_CONTACT, contact->own, wanted, sizeof(ShvBox));
    if (!own) return shv_fail_memory(error, "contact of surfaces", wanted * sizeof(ShvBox));
    contact->own = own;
    ShvBox *near = shv_reallocate(contact->memory, SHV_PART_CONTACT, contact->near, wanted, sizeof(ShvBox));
    if (!near) return shv_fail_memory(error, "contact of surfaces", wanted * sizeof(ShvBox));
    contact->near = near;
    int32_t *order = shv_reallocate(contact->memory, SHV_PART_CONTACT, contact->order, wanted, sizeof(int32_t));
    if (!order) return shv_fail_memory(error, "contact of surfaces", wanted * sizeof(int32_t));
    contact->order = order;
    ShvCompanionMotion *motion =
        shv_reallocate(contact->memory, SHV_PART_CONTACT, contact->motion, wanted, sizeof(ShvCompanionMotion));
    if (!motion) return shv_fail_memory(error, "contact of surfaces", wanted * sizeof(ShvCompanionMotion));
    contact->motion = motion;
    contact->fragment_capacity = (int32_t)wanted;
    return SHV_OK;
}

/* Binary search places each fragment: an order that does not depend on a library's sort. */
static int32_t sort_boxes(const ShvSurfaceContact *contact, int32_t count)
{
    int32_t sorted = 0;
    for (int32_t i = 0; i < count; i++) {
        if (!(contact->own[i].low.x <= contact->own[i].high.x)) continue;
        int32_t low = 0, high = sorted;
        while (low < high) {
            const int32_t middle = low + (high - low) / 2;
            if (contact->own[contact->order[middle]].low.x <= contact->own[i].low.x)
                low = middle + 1;
            else
                high = middle;
        }
        for (int32_t k = sorted++; k > low; k--) contact->order[k] = contact->order[k - 1];
        contact->order[low] = i;
    }
    return sorted;
}

static void add_common_part(ShvSurfaceContact *contact, int32_t a, int32_t b)
{
    const ShvBox *x = &contact->own[a], *y = &contact->own[b];
    if (!shv_box_meets(x, y)) return;
    const ShvVec3 low = {fmax(x->low.x, y->low.x), fmax(x->low.y, y->low.y), fmax(x->low.z, y->low.z)};
    const ShvVec3 high = {fmin(x->high.x, y->high.x), fmin(x->high.y, y->high.y), fmin(x->high.z, y->high.z)};
    shv_box_add(&contact->near[a], low);
    shv_box_add(&contact->near[a], high);
    shv_box_add(&contact->near[b], low);
    shv_box_add(&contact->near[b], high);
}

/* A cracked fragment may meet itself anywhere. */
static void mark_cracked(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    const ShvAdjacency *adjacency = &contact->model->adjacency;
    for (int32_t k = 0; k < contact->list.crack_count; k++) {
        const int64_t facet = bodies->cohesive->facet[contact->list.cracks[k].index];
        for (int side = 0; side < 2; side++) {
            const int32_t fragment = bodies->state->element_fragment[adjacency->facet_elements[2 * facet + side]];
            contact->near[fragment] = contact->own[fragment];
        }
    }
    for (int32_t k = 0; k < contact->list.facet_count; k++)
        if (contact->list.facets[k].crack)
            contact->near[contact->list.facets[k].fragment] = contact->own[contact->list.facets[k].fragment];
}

static void find_boxes(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    for (int32_t i = 0; i < bodies->fragment_count; i++) contact->own[i] = contact->near[i] = shv_box_empty();
    for (int32_t k = 0; k < contact->list.node_count; k++) {
        const ShvSurfaceNode *node = &contact->list.nodes[k];
        const double way = contact->allowance[node->pace];
        shv_box_add(&contact->own[node->fragment], shv_sub(node->from, shv_vec3(way, way, way)));
        shv_box_add(&contact->own[node->fragment], shv_add(node->from, shv_vec3(way, way, way)));
    }
}

/* Of few bodies only what is near another is looked at; where there are many, they are small, and the grid sorts them out. */
static void find_regions(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    int32_t boxes = 0;
    find_boxes(contact, bodies);
    for (int32_t i = 0; i < bodies->fragment_count; i++) boxes += contact->own[i].low.x <= contact->own[i].high.x;
    if (boxes > MOST_REGIONS) {
        for (int32_t i = 0; i < bodies->fragment_count; i++) contact->near[i] = contact->own[i];
        return;
    }
    const int32_t count = sort_boxes(contact, bodies->fragment_count);
    for (int32_t i = 0; i < count; i++)
        for (int32_t k = i + 1; k < count; k++) {
            if (contact->own[contact->order[k]].low.x > contact->own[contact->order[i]].high.x) break;
            add_common_part(contact, contact->order[i], contact->order[k]);
        }
    mark_cracked(contact, bodies);
}

/* ---- the grid ---- */

static bool node_in_region(const ShvSurfaceContact *contact, const ShvSurfaceNode *node)
{
    const ShvBox near = shv_box_grown(contact->near[node->fragment], contact->allowance[node->pace]);
    return shv_box_holds(&near, node->from);
}

static bool in_region(const ShvSurfaceContact *contact, const ShvSurfaceFacet *facet)
{
    const ShvBox box = shv_box_grown(facet->box, contact->allowance[facet->pace]);
    return shv_box_meets(&box, &contact->near[facet->fragment]);
}

static double smallest_facet(const ShvSurfaceContact *contact)
{
    double smallest = (double)INFINITY;
    for (int32_t k = 0; k < contact->list.facet_count; k++) {
        if (!in_region(contact, &contact->list.facets[k])) continue;
        const double size = shv_box_size(&contact->list.facets[k].box);
        smallest = size < smallest ? size : smallest;
    }
    return smallest;
}

/* Sizes of the facets that lie in regions. */
static uint32_t find_levels(ShvSurfaceContact *contact, ShvBox region, double smallest)
{
    uint32_t levels = 0;
    shv_node_grid_scale(&contact->grid, region, smallest);
    for (int32_t k = 0; k < contact->list.facet_count; k++)
        if (in_region(contact, &contact->list.facets[k]))
            levels |=
                (uint32_t)1 << shv_node_grid_level(&contact->grid, 0.5 * shv_box_size(&contact->list.facets[k].box));
    return levels;
}

static ShvStatus fill_grid(ShvSurfaceContact *contact, ShvError *error)
{
    ShvBox region = shv_box_empty();
    int32_t count = 0;
    contact->grid_nodes = contact->list.node_count;
    for (int32_t k = 0; k < contact->list.node_count; k++) {
        if (!node_in_region(contact, &contact->list.nodes[k])) continue;
        shv_box_add(&region, contact->list.nodes[k].from);
        count++;
    }
    const double smallest = smallest_facet(contact);
    const bool none = count == 0 || !isfinite(smallest);
    const uint32_t levels = none ? 0 : find_levels(contact, region, 0.5 * smallest);
    SHV_TRY(shv_node_grid_start(&contact->grid, region, none ? 1.0 : 0.5 * smallest, levels, none ? 0 : count, error));
    for (int32_t k = 0; k < contact->list.node_count && !none; k++)
        if (node_in_region(contact, &contact->list.nodes[k]))
            shv_node_grid_add(&contact->grid, k, contact->list.nodes[k].pace, contact->list.nodes[k].from);
    shv_node_grid_finish(&contact->grid);
    return SHV_OK;
}

/* ---- candidates ---- */

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

static ShvStatus watch_both(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                            const ShvSurfaceCandidate *candidate, ShvError *error)
{
    if (!shv_bodies_companion(bodies, candidate->fragments[0])) SHV_TRY(watch(contact, candidate->slot, error));
    if (candidate->element < 0 || shv_bodies_companion(bodies, candidate->fragments[1])) return SHV_OK;
    int32_t nodes[3];
    shv_surface_corners(bodies->state, candidate->element, candidate->face, nodes);
    for (int k = 0; k < 3; k++) SHV_TRY(watch(contact, contact->list.slot[nodes[k]], error));
    return SHV_OK;
}

static ShvStatus add_candidate(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                               const ShvSurfaceCandidate *candidate, int other, double distance, ShvError *error)
{
    const int own = contact->list.nodes[candidate->slot].pace;
    const bool rigid = candidate->element >= 0 && shv_bodies_companion(bodies, candidate->fragments[0]) &&
                       shv_bodies_companion(bodies, candidate->fragments[1]);
    ShvSurfaceCandidates *list = &contact->candidates[rigid];
    SHV_TRY(reserve_candidate(contact, list, error));
    list->items[list->count] = *candidate;
    list->due[list->count] = contact->path[own] + contact->path[other] + distance;
    list->movers[list->count++] = (uint8_t)(own * SHV_SURFACE_MOVERS + other);
    return watch_both(contact, bodies, candidate, error);
}

/* A facet that looks for nodes. */
typedef struct Seeker {
    const ShvSurfaceFacet *facet;
    ShvFacetPlane plane;
    ShvVec3 places[4];
    int32_t nodes[4], origins[4]; /* of its tet */
    int32_t across[4];            /* nodes of the tet on the other side of the facet, −1: none */
    bool alone;                   /* it cannot meet its own fragment */
} Seeker;

static void look_across(const ShvSurfaceContact *contact, const ShvState *state, Seeker *seeker)
{
    const ShvAdjacency *adjacency = &contact->model->adjacency;
    for (int k = 0; k < 4; k++) seeker->across[k] = -1;
    if (!contact->model->can_break) return;
    const int64_t facet = adjacency->element_facets[4 * (int64_t)seeker->facet->element + seeker->facet->face];
    if (facet >= adjacency->interior_count) return;
    const int32_t *elements = adjacency->facet_elements + 2 * facet;
    const int32_t other = elements[elements[0] == seeker->facet->element];
    for (int k = 0; k < 4; k++) seeker->across[k] = shv_state_node(state, other, k);
}

/* False for one without area, which meets nothing. */
static bool make_seeker(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const ShvSurfaceFacet *facet,
                        Seeker *seeker)
{
    ShvVec3 corners[3];
    seeker->facet = facet;
    seeker->alone = !facet->crack || shv_bodies_companion(bodies, facet->fragment);
    for (int k = 0; k < 4; k++) {
        seeker->nodes[k] = shv_state_node(bodies->state, facet->element, k);
        seeker->origins[k] = bodies->state->origin[seeker->nodes[k]];
        seeker->places[k] = shv_bodies_position(bodies, seeker->nodes[k], facet->fragment);
    }
    for (int k = 0; k < 3; k++) corners[k] = seeker->places[shv_face_corners[facet->face][k]];
    look_across(contact, bodies->state, seeker);
    return shv_facet_plane_make(corners, &seeker->plane);
}

/* Whether a node has anything to do with a facet's tet; `mate`: a corner that is another copy of the same node of the mesh.
   Neighbours meet across the facet between them. Those that touch at a node only have nothing to do with each other
   until they are out of place. */
static bool concerns(const ShvSurfaceContact *contact, const ShvState *state, const Seeker *seeker, int32_t node,
                     ShvVec3 x, int32_t *mate)
{
    *mate = -1;
    for (int k = 0; k < 4; k++) {
        if (seeker->nodes[k] == node) return false;
        if (seeker->origins[k] != state->origin[node]) continue;
        const ShvVec3 apart = shv_sub(x, seeker->places[k]);
        bool in_place = shv_dot(apart, apart) < 0.25 * contact->allowance[0] * contact->allowance[0];
        for (int i = 0; i < 4; i++) in_place = in_place && seeker->across[i] != node;
        if (in_place) return false;
        *mate = seeker->nodes[k];
    }
    return true;
}

static ShvStatus pair_node(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const Seeker *seeker,
                           int32_t slot, double reach, ShvError *error)
{
    const ShvSurfaceFacet *facet = seeker->facet;
    const ShvSurfaceNode *node = &contact->list.nodes[slot];
    if (seeker->alone && node->fragment == facet->fragment) return SHV_OK;
    const ShvVec3 x = contact->built_time == bodies->state->time
                          ? node->from
                          : shv_bodies_position(bodies, node->node, node->fragment);
    int32_t mate;
    if (!concerns(contact, bodies->state, seeker, node->node, x, &mate)) return SHV_OK;
    const double distance = shv_facet_plane_distance(&seeker->plane, x);
    if (distance > reach) return SHV_OK;
    const ShvSurfaceCandidate candidate = {.node = node->node,
                                           .element = facet->element,
                                           .face = facet->face,
                                           .fragments = {node->fragment, facet->fragment},
                                           .slot = slot,
                                           .facet = (int32_t)(facet - contact->list.facets),
                                           .mate = mate};
    return add_candidate(contact, bodies, &candidate, facet->pace, distance, error);
}

static ShvStatus pair_facet(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const ShvSurfaceFacet *facet,
                            ShvError *error)
{
    Seeker seeker;
    const double size = 0.5 * shv_box_size(&facet->box);
    if (!in_region(contact, facet) || !make_seeker(contact, bodies, facet, &seeker)) return SHV_OK;
    for (int pace = 0; pace < SHV_SURFACE_PACES; pace++) {
        const double reach = contact->allowance[facet->pace] + contact->allowance[pace];
        SHV_TRY(shv_node_grid_find(&contact->grid, pace, size, shv_box_grown(facet->box, reach), error));
        for (int32_t k = 0; k < contact->grid.found_count; k++)
            SHV_TRY(pair_node(contact, bodies, &seeker, contact->grid.found[k], reach, error));
    }
    return SHV_OK;
}

/* A facet that has come later. Nodes stand in the grid where they were when it was filled, and may go as far again, on the
   other side of that; later ones are not in it. */
static ShvStatus pair_late_facet(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                                 const ShvSurfaceFacet *facet, ShvError *error)
{
    Seeker seeker;
    const double size = 0.5 * shv_box_size(&facet->box);
    if (!make_seeker(contact, bodies, facet, &seeker)) return SHV_OK;
    const double own = contact->allowance[facet->pace];
    for (int pace = 0; pace < SHV_SURFACE_PACES; pace++) {
        const double reach = 2.0 * (own + contact->allowance[pace]);
        SHV_TRY(shv_node_grid_find(&contact->grid, pace, size, shv_box_grown(facet->box, reach), error));
        for (int32_t k = 0; k < contact->grid.found_count; k++)
            SHV_TRY(pair_node(contact, bodies, &seeker, contact->grid.found[k], reach, error));
    }
    for (int32_t slot = contact->grid_nodes; slot < contact->list.node_count; slot++)
        SHV_TRY(pair_node(contact, bodies, &seeker, slot,
                          2.0 * (own + contact->allowance[contact->list.nodes[slot].pace]), error));
    return SHV_OK;
}

/* A node that has come later, with the facets that were there. */
static ShvStatus pair_late_node(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t slot,
                                int32_t facets, ShvError *error)
{
    const ShvSurfaceNode *node = &contact->list.nodes[slot];
    for (int32_t k = 0; k < facets; k++) {
        const ShvSurfaceFacet *facet = &contact->list.facets[k];
        const double reach = 2.0 * (contact->allowance[facet->pace] + contact->allowance[node->pace]);
        const ShvBox box = shv_box_grown(facet->box, reach);
        Seeker seeker;
        if (shv_box_holds(&box, node->from) && make_seeker(contact, bodies, facet, &seeker))
            SHV_TRY(pair_node(contact, bodies, &seeker, slot, reach, error));
    }
    return SHV_OK;
}

static ShvStatus pair_obstacle(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t obstacle,
                               ShvError *error)
{
    for (int32_t slot = 0; slot < contact->list.node_count; slot++) {
        const ShvSurfaceNode *node = &contact->list.nodes[slot];
        if (!shv_bodies_companion(bodies, node->fragment)) continue;
        const ShvVec3 x = shv_bodies_position(bodies, node->node, node->fragment);
        const double reach = contact->allowance[node->pace] + contact->allowance[SHV_SURFACE_OBSTACLES];
        const ShvSurfacePoint at = shv_obstacle_closest(&bodies->obstacles->items[obstacle], x, reach);
        if (at.gap >= reach) continue;
        const ShvSurfaceCandidate candidate = {.node = node->node,
                                               .element = -1 - obstacle,
                                               .fragments = {node->fragment, -1 - obstacle},
                                               .slot = slot,
                                               .facet = -1,
                                               .mate = -1};
        SHV_TRY(add_candidate(contact, bodies, &candidate, SHV_SURFACE_OBSTACLES, fmax(at.gap, 0.0), error));
    }
    return SHV_OK;
}

/* ---- the whole ---- */

static ShvStatus rebuild(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, bool changed, double step,
                         ShvError *error)
{
    const ShvState *state = bodies->state;
    contact->candidates[0].count = contact->candidates[1].count = contact->watched_count = 0;
    SHV_TRY(reserve_fragments(contact, bodies->fragment_count, error));
    for (int32_t k = 0; k < contact->list.node_count; k++) contact->list.nodes[k].watch = -1;
    if (changed)
        SHV_TRY(shv_surface_list_gather(&contact->list, bodies, error));
    else {
        SHV_TRY(shv_surface_list_part(&contact->list, bodies, error));
        shv_surface_list_measure(&contact->list, bodies);
    }
    choose_paces(contact, bodies, state->last_step > 0.0 ? state->last_step : step);
    find_regions(contact, bodies);
    SHV_TRY(fill_grid(contact, error));
    for (int32_t k = 0; k < contact->list.facet_count; k++)
        SHV_TRY(pair_facet(contact, bodies, &contact->list.facets[k], error));
    for (int32_t k = 0; bodies->obstacles && k < bodies->obstacles->count; k++)
        SHV_TRY(pair_obstacle(contact, bodies, k, error));
    contact->rebuilds++;
    return SHV_OK;
}

/* Of cracks that have failed or parted since. */
static ShvStatus add_late(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step, ShvError *error)
{
    if (!bodies->cohesive) return SHV_OK;
    ShvSurfaceList *list = &contact->list;
    const int32_t facets = list->facet_count, nodes = list->node_count;
    SHV_TRY(shv_surface_list_part(list, bodies, error));
    for (int32_t k = nodes; k < list->node_count; k++) give_pace(contact, bodies, &list->nodes[k], step);
    for (int32_t k = facets; k < list->facet_count; k++) give_facet_pace(contact, bodies, &list->facets[k]);
    for (int32_t k = nodes; k < list->node_count; k++) SHV_TRY(pair_late_node(contact, bodies, k, facets, error));
    for (int32_t k = facets; k < list->facet_count; k++)
        SHV_TRY(pair_late_facet(contact, bodies, &list->facets[k], error));
    return SHV_OK;
}

ShvStatus shv_surface_candidates_refresh(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step,
                                         double gravity, ShvError *error)
{
    const ShvCohesive *cohesive = bodies->cohesive;
    if (is_stale(contact, bodies)) {
        contact->stale = true; /* until it is done */
        contact->idle = find_idle(bodies);
    }
    if (!contact->idle) {
        const bool changed = contact->stale;
        const bool outdated = !changed && count_motion(contact, bodies, gravity);
        contact->stale = true;
        if (changed || outdated)
            SHV_TRY(rebuild(contact, bodies, changed, step, error));
        else
            SHV_TRY(add_late(contact, bodies, step, error));
    }
    contact->seen_time = bodies->state->time;
    contact->known_nodes = bodies->state->node_count;
    contact->known_fragments = bodies->fragment_count;
    contact->known_cohesive = cohesive ? cohesive->count : 0;
    contact->known_live = cohesive ? cohesive->live_count : 0;
    contact->stale = false;
    return SHV_OK;
}
