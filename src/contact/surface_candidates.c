#include "contact/surface_candidates.h"

#include <stdlib.h>

#include "contact/candidates.h"

enum { STEPS_BETWEEN_LOOKS = 8, STEPS_TO_LAST = 64 };

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
    return contact->stale || contact->known_nodes != bodies->state->node_count ||
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

static double squared_speed(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t slot)
{
    const ShvVec3 v = shv_sub(node_velocity(bodies, &contact->list.nodes[slot]), contact->drift);
    return shv_dot(v, v);
}

/* Of obstacles; those that stand move against the frame too. */
static double obstacle_speed(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    double largest = 0.0;
    for (int32_t k = 0; bodies->obstacles && k < bodies->obstacles->count; k++)
        largest = fmax(largest, shv_candidates_obstacle_speed(&bodies->obstacles->items[k]) + shv_norm(contact->drift));
    return largest;
}

double shv_surface_candidates_speed(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    double largest = 0.0;
    for (int32_t k = 0; k < contact->watched_count; k++) {
        const double squared = squared_speed(contact, bodies, contact->watched[k]);
        largest = squared > largest ? squared : largest;
    }
    return fmax(sqrt(largest), obstacle_speed(contact, bodies));
}

static void look_at_speeds(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    double largest = 0.0;
    for (int32_t k = 0; k < contact->list.node_count; k++) {
        const double squared = squared_speed(contact, bodies, k);
        largest = squared > largest ? squared : largest;
    }
    contact->largest_speed = fmax(sqrt(largest), obstacle_speed(contact, bodies));
    contact->since = 0;
}

/* Two can come closer by both their speeds; twice that, and half the skin, is kept for what they gain unseen. */
static double motion_of(const ShvSurfaceContact *contact, double step, double gravity)
{
    return 2.0 * step * (2.0 * contact->largest_speed + (STEPS_BETWEEN_LOOKS + 1) * step * gravity);
}

/* Counts the step that led here, once. */
static void count_motion(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double gravity)
{
    const ShvState *state = bodies->state;
    if (state->time == contact->seen_time) return;
    contact->seen_time = state->time;
    contact->path += 2.0 * state->last_step * shv_surface_candidates_speed(contact, bodies);
    if (++contact->since >= STEPS_BETWEEN_LOOKS) look_at_speeds(contact, bodies);
    contact->moved += motion_of(contact, state->last_step, gravity);
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
    for (int32_t k = 0; k < contact->list.uncut_count; k++) {
        const int64_t facet = bodies->cohesive->facet[contact->list.uncut[k]];
        for (int side = 0; side < 2; side++) {
            const int32_t fragment = bodies->state->element_fragment[adjacency->facet_elements[2 * facet + side]];
            contact->near[fragment] = contact->own[fragment];
        }
    }
    for (int32_t k = 0; k < contact->list.facet_count; k++)
        if (contact->list.facets[k].crack)
            contact->near[contact->list.facets[k].fragment] = contact->own[contact->list.facets[k].fragment];
}

static void find_regions(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    for (int32_t i = 0; i < bodies->fragment_count; i++) contact->own[i] = contact->near[i] = shv_box_empty();
    for (int32_t k = 0; k < contact->list.node_count; k++) {
        const ShvSurfaceNode *node = &contact->list.nodes[k];
        shv_box_add(&contact->own[node->fragment], shv_bodies_position(bodies, node->node, node->fragment));
    }
    for (int32_t i = 0; i < bodies->fragment_count; i++)
        contact->own[i] = shv_box_grown(contact->own[i], contact->skin);
    const int32_t count = sort_boxes(contact, bodies->fragment_count);
    for (int32_t i = 0; i < count; i++)
        for (int32_t k = i + 1; k < count; k++) {
            if (contact->own[contact->order[k]].low.x > contact->own[contact->order[i]].high.x) break;
            add_common_part(contact, contact->order[i], contact->order[k]);
        }
    mark_cracked(contact, bodies);
}

/* ---- candidates ---- */

static ShvStatus watch(ShvSurfaceContact *contact, int32_t slot, ShvError *error)
{
    if (contact->list.nodes[slot].watched) return SHV_OK;
    contact->list.nodes[slot].watched = true;
    void *block = contact->watched;
    SHV_TRY(shv_candidates_grow(contact->memory, &block, &contact->watched_capacity, contact->watched_count,
                                sizeof(int32_t), error));
    contact->watched = block;
    contact->watch_index[slot] = contact->watched_count;
    contact->watched[contact->watched_count++] = slot;
    return SHV_OK;
}

static ShvStatus add_candidate(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                               const ShvSurfaceCandidate *candidate, ShvError *error)
{
    void *block = contact->candidates;
    SHV_TRY(shv_candidates_grow(contact->memory, &block, &contact->candidate_capacity, contact->candidate_count,
                                sizeof *candidate, error));
    contact->candidates = block;
    contact->candidates[contact->candidate_count++] = *candidate;
    SHV_TRY(watch(contact, candidate->slot, error));
    if (candidate->element < 0) return SHV_OK;
    int32_t nodes[3];
    shv_surface_corners(bodies->state, candidate->element, candidate->face, nodes);
    for (int k = 0; k < 3; k++) SHV_TRY(watch(contact, contact->list.slot[nodes[k]], error));
    return SHV_OK;
}

/* Finds what a node has to do with a facet's tet: false when it is a corner of it; `mate`: a corner that is another copy
   of the same node of the mesh. */
static bool find_mate(const ShvState *state, int32_t node, int32_t element, int32_t *mate)
{
    *mate = -1;
    for (int32_t k = 0; k < 4; k++) {
        const int32_t corner = shv_state_node(state, element, k);
        if (corner == node) return false;
        if (state->origin[corner] == state->origin[node]) *mate = corner;
    }
    return true;
}

static ShvStatus pair_facet(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const ShvSurfaceFacet *facet,
                            ShvError *error)
{
    const ShvBox box = shv_box_grown(facet->box, contact->skin);
    if (!shv_box_meets(&box, &contact->near[facet->fragment])) return SHV_OK;
    /* Nodes stand in the grid where they were when it was filled. */
    SHV_TRY(shv_node_grid_find(&contact->grid, shv_box_grown(box, contact->path), error));
    for (int32_t k = 0; k < contact->grid.found_count; k++) {
        const int32_t slot = contact->grid.found[k];
        const ShvSurfaceNode *node = &contact->list.nodes[slot];
        if (node->fragment == facet->fragment && (!facet->crack || shv_bodies_companion(bodies, facet->fragment)))
            continue;
        const ShvVec3 x = shv_bodies_position(bodies, node->node, node->fragment);
        if (!shv_box_holds(&box, x)) continue;
        ShvSurfaceCandidate candidate = {.node = node->node,
                                         .element = facet->element,
                                         .face = facet->face,
                                         .fragments = {node->fragment, facet->fragment},
                                         .slot = slot};
        if (!find_mate(bodies->state, node->node, facet->element, &candidate.mate)) continue;
        ShvFacetPair pair;
        double distance;
        if (!shv_facet_pair_look(bodies, contact->model, &candidate, 0.0, 0.0, &pair, &distance) &&
            distance > contact->skin)
            continue;
        candidate.due = contact->path + distance;
        SHV_TRY(add_candidate(contact, bodies, &candidate, error));
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
        const ShvSurfacePoint at = shv_obstacle_closest(&bodies->obstacles->items[obstacle], x, contact->skin);
        if (at.gap >= contact->skin) continue;
        const ShvSurfaceCandidate candidate = {.node = node->node,
                                               .element = -1 - obstacle,
                                               .fragments = {node->fragment, -1 - obstacle},
                                               .slot = slot,
                                               .mate = -1,
                                               .due = fmax(at.gap, 0.0)};
        SHV_TRY(add_candidate(contact, bodies, &candidate, error));
    }
    return SHV_OK;
}

/* ---- the whole ---- */

static double mean_size(const ShvSurfaceContact *contact)
{
    double sum = 0.0;
    for (int32_t k = 0; k < contact->list.facet_count; k++) sum += shv_box_size(&contact->list.facets[k].box);
    return contact->list.facet_count > 0 ? sum / contact->list.facet_count : 0.0;
}

/* Lasts for many steps, but is not so thick that every node has dozens of candidates unless the motion demands it; what
   moves farther than its elements are large in a step is past helping. */
static void choose_skin(ShvSurfaceContact *contact, double step, double gravity)
{
    const double motion = motion_of(contact, step, gravity), size = mean_size(contact);
    const double wanted = fmin(2.0 * STEPS_TO_LAST * motion, 0.5 * size);
    contact->skin = fmax(fmax(wanted, 0.02 * size), fmin(4.0 * motion, 2.0 * size));
}

static void choose_frame(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    ShvVec3 sum = {0.0, 0.0, 0.0};
    const int32_t count = contact->list.node_count;
    for (int32_t k = 0; k < count; k++) sum = shv_add(sum, node_velocity(bodies, &contact->list.nodes[k]));
    contact->drift = count > 0 ? shv_scale(sum, 1.0 / count) : sum;
}

static bool in_region(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const ShvSurfaceNode *node)
{
    const ShvVec3 x = shv_bodies_position(bodies, node->node, node->fragment);
    return shv_box_holds(&contact->near[node->fragment], x);
}

static double smallest_box(const ShvSurfaceContact *contact)
{
    double smallest = (double)INFINITY;
    for (int32_t k = 0; k < contact->list.facet_count; k++) {
        const ShvBox box = shv_box_grown(contact->list.facets[k].box, contact->skin);
        if (shv_box_meets(&box, &contact->near[contact->list.facets[k].fragment]))
            smallest = fmin(smallest, shv_box_size(&box));
    }
    return smallest;
}

/* Sizes of the facets that lie in regions. */
static uint32_t find_levels(ShvSurfaceContact *contact, ShvBox region, double smallest)
{
    uint32_t levels = 0;
    shv_node_grid_scale(&contact->grid, region, smallest);
    for (int32_t k = 0; k < contact->list.facet_count; k++) {
        const ShvSurfaceFacet *facet = &contact->list.facets[k];
        const ShvBox box = shv_box_grown(facet->box, contact->skin);
        if (shv_box_meets(&box, &contact->near[facet->fragment]))
            levels |= (uint32_t)1 << shv_node_grid_level(&contact->grid, shv_box_size(&box));
    }
    return levels;
}

static ShvStatus fill_grid(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvError *error)
{
    ShvBox region = shv_box_empty();
    int32_t count = 0;
    for (int32_t k = 0; k < contact->list.node_count; k++) {
        const ShvSurfaceNode *node = &contact->list.nodes[k];
        if (!in_region(contact, bodies, node)) continue;
        shv_box_add(&region, shv_bodies_position(bodies, node->node, node->fragment));
        count++;
    }
    const double smallest = smallest_box(contact);
    if (count == 0 || !isfinite(smallest)) return shv_node_grid_start(&contact->grid, region, 1.0, 0, 0, error);
    const uint32_t levels = find_levels(contact, region, smallest);
    SHV_TRY(shv_node_grid_start(&contact->grid, region, smallest, levels, count, error));
    for (int32_t k = 0; k < contact->list.node_count; k++)
        if (in_region(contact, bodies, &contact->list.nodes[k]))
            shv_node_grid_add(
                &contact->grid, k,
                shv_bodies_position(bodies, contact->list.nodes[k].node, contact->list.nodes[k].fragment));
    return SHV_OK;
}

static ShvStatus reserve_watch(ShvSurfaceContact *contact, ShvError *error)
{
    if (contact->watch_capacity >= contact->list.node_capacity) return SHV_OK;
    const size_t wanted = (size_t)contact->list.node_capacity;
    int32_t *grown = shv_reallocate(contact->memory, SHV_PART_CONTACT, contact->watch_index, wanted, sizeof(int32_t));
    if (!grown) return shv_fail_memory(error, "contact of surfaces", wanted * sizeof(int32_t));
    contact->watch_index = grown;
    contact->watch_capacity = contact->list.node_capacity;
    return SHV_OK;
}

static ShvStatus rebuild(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, bool changed, double step,
                         double gravity, ShvError *error)
{
    const ShvState *state = bodies->state;
    contact->candidate_count = contact->watched_count = 0;
    SHV_TRY(reserve_fragments(contact, bodies->fragment_count, error));
    for (int32_t k = 0; k < contact->list.node_count; k++) contact->list.nodes[k].watched = false;
    if (changed)
        SHV_TRY(shv_surface_list_gather(&contact->list, bodies, error));
    else {
        SHV_TRY(shv_surface_list_part(&contact->list, bodies, error));
        shv_surface_list_measure(&contact->list, bodies);
    }
    SHV_TRY(reserve_watch(contact, error));
    choose_frame(contact, bodies);
    look_at_speeds(contact, bodies);
    const double length = state->last_step > 0.0 ? state->last_step : step;
    choose_skin(contact, length, gravity);
    find_regions(contact, bodies);
    contact->path = 0.0;
    contact->moved = motion_of(contact, length, gravity);
    SHV_TRY(fill_grid(contact, bodies, error));
    for (int32_t k = 0; k < contact->list.facet_count; k++)
        SHV_TRY(pair_facet(contact, bodies, &contact->list.facets[k], error));
    for (int32_t k = 0; bodies->obstacles && k < bodies->obstacles->count; k++)
        SHV_TRY(pair_obstacle(contact, bodies, k, error));
    contact->rebuilds++;
    return SHV_OK;
}

/* Cracks that have parted since: their facets look for nodes, all of which are in the grid. */
static ShvStatus add_parted(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvError *error)
{
    if (!bodies->cohesive || contact->known_live == bodies->cohesive->live_count) return SHV_OK;
    const int32_t first = contact->list.facet_count;
    SHV_TRY(shv_surface_list_part(&contact->list, bodies, error));
    SHV_TRY(reserve_watch(contact, error));
    for (int32_t k = first; k < contact->list.facet_count; k++)
        SHV_TRY(pair_facet(contact, bodies, &contact->list.facets[k], error));
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
        if (!changed) count_motion(contact, bodies, gravity);
        contact->stale = true;
        if (changed || contact->moved > 0.5 * contact->skin)
            SHV_TRY(rebuild(contact, bodies, changed, step, gravity, error));
        else
            SHV_TRY(add_parted(contact, bodies, error));
    }
    contact->seen_time = bodies->state->time;
    contact->known_nodes = bodies->state->node_count;
    contact->known_cohesive = cohesive ? cohesive->count : 0;
    contact->known_live = cohesive ? cohesive->live_count : 0;
    contact->stale = false;
    return SHV_OK;
}
