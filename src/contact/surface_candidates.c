#include "contact/surface_candidates.h"

#include "contact/surface_edge.h"

/* ---- one candidate ---- */

static ShvStatus watch(ShvSurfaceContact *contact, int32_t slot, ShvError *error)
{
    if (contact->list.nodes[slot].watch >= 0) return SHV_OK;
    SHV_GROW(contact->memory, SHV_PART_CONTACT, contact->watched, contact->watched_capacity, contact->watched_count,
             "contact", error);
    contact->list.nodes[slot].watch = contact->watched_count;
    contact->watched[contact->watched_count++] = slot;
    return SHV_OK;
}

static ShvStatus watch_facet(ShvSurfaceContact *contact, int32_t place, ShvError *error)
{
    ShvSurfaceFacet *facet = &contact->list.facets[place];
    ShvSurfacePlaces *watched = &contact->watched_facets;
    for (int k = 0; k < 3; k++) SHV_TRY(watch(contact, facet->slots[k], error));
    if (facet->watched) return SHV_OK;
    facet->watched = true;
    SHV_GROW(contact->memory, SHV_PART_CONTACT, watched->items, watched->capacity, watched->count, "contact", error);
    watched->items[watched->count++] = place;
    return SHV_OK;
}

static double side_path(const ShvSurfaceContact *contact, const ShvMotionBound *due, int side)
{
    const int32_t place = due->places[side];
    switch (due->kinds[side]) {
    case SHV_SIDE_NODE:
        return contact->list.node_path[place];
    case SHV_SIDE_FACET:
        return contact->list.facet_path[place];
    case SHV_SIDE_BODY:
        return contact->fragments[place].path;
    case SHV_SIDE_OBSTACLES:
        break;
    }
    return contact->path[SHV_SURFACE_OBSTACLES];
}

double shv_surface_candidate_path(const ShvSurfaceContact *contact, const ShvMotionBound *due)
{
    return side_path(contact, due, 0) + side_path(contact, due, 1);
}

void shv_surface_candidate_name(const ShvSurfaceList *list, ShvSurfaceCandidate *candidate)
{
    candidate->node = list->nodes[candidate->slot].node;
    if (candidate->facet < 0) return;
    const ShvSurfaceFacet *facet = &list->facets[candidate->facet];
    candidate->element = facet->element;
    for (int k = 0; k < 3; k++) candidate->corners[k] = list->nodes[facet->slots[k]].node;
}

static ShvStatus append(ShvSurfaceContact *contact, ShvSurfaceCandidates *list, const ShvSurfaceCandidate *candidate,
                        ShvError *error)
{
    int32_t room = list->capacity;
    SHV_GROW(contact->memory, SHV_PART_CONTACT, list->due, room, list->count, "contact", error);
    room = list->capacity;
    SHV_GROW(contact->memory, SHV_PART_CONTACT, list->motion_bounds, room, list->count, "contact", error);
    room = list->capacity;
    SHV_GROW(contact->memory, SHV_PART_CONTACT, list->motion_classes, room, list->count, "contact", error);
    SHV_GROW(contact->memory, SHV_PART_CONTACT, list->items, list->capacity, list->count, "contact", error);
    ShvSurfaceCandidate *added = &list->items[list->count++];
    *added = *candidate;
    added->rebuild_number = contact->rebuild_number;
    shv_surface_candidate_name(&contact->list, added);
    return SHV_OK;
}

static void set_side(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t slot, int32_t place,
                     ShvMotionBound *due, int side)
{
    const int32_t fragment = place >= 0  ? contact->list.facets[place].fragment
                             : slot >= 0 ? contact->list.nodes[slot].fragment
                                         : -1;
    const bool rigid = fragment >= 0 && shv_bodies_coupled_body(bodies, fragment);
    due->places[side] = rigid ? fragment : place >= 0 ? place : slot;
    due->kinds[side] = rigid        ? SHV_SIDE_BODY
                       : place >= 0 ? SHV_SIDE_FACET
                       : slot >= 0  ? SHV_SIDE_NODE
                                    : SHV_SIDE_OBSTACLES;
}

static ShvStatus watch_side(ShvSurfaceContact *contact, const ShvMotionBound *due, int side, ShvError *error)
{
    if (due->kinds[side] == SHV_SIDE_NODE) return watch(contact, due->places[side], error);
    return due->kinds[side] == SHV_SIDE_FACET ? watch_facet(contact, due->places[side], error) : SHV_OK;
}

ShvStatus shv_surface_candidate_add(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                                    const ShvSurfaceCandidate *candidate, double distance, ShvError *error)
{
    const int32_t own = candidate->own_facet, other = candidate->facet;
    const bool feature = own >= 0 && other < 0; /* where the two overlap there is no bound */
    const int first =
        own >= 0 ? contact->list.facets[own].speed_class : contact->list.nodes[candidate->slot].speed_class;
    const int second = other >= 0 ? contact->list.facets[other].speed_class : SHV_SURFACE_OBSTACLES;
    ShvMotionBound due;
    set_side(contact, bodies, candidate->slot, own, &due, 0);
    set_side(contact, bodies, -1, other, &due, 1);
    due.path = feature ? -(double)INFINITY : shv_surface_candidate_path(contact, &due) + distance;
    ShvSurfaceCandidates *list = &contact->candidates[due.kinds[0] == SHV_SIDE_BODY && due.kinds[1] == SHV_SIDE_BODY];
    SHV_TRY(append(contact, list, candidate, error));
    list->motion_bounds[list->count - 1] = due;
    list->due[list->count - 1] = contact->path[first] + contact->path[second] + distance;
    list->motion_classes[list->count - 1] = (uint8_t)(first * SHV_SURFACE_MOTION_CLASSES + second);
    SHV_TRY(watch_side(contact, &due, 0, error));
    return watch_side(contact, &due, 1, error);
}

bool shv_surface_candidate_is_void(const ShvSurfaceContact *contact, const ShvSurfaceCandidate *candidate)
{
    const ShvSurfaceFacet *facets = contact->list.facets;
    return contact->list.nodes[candidate->slot].rebuild_number > candidate->rebuild_number ||
           (candidate->facet >= 0 && facets[candidate->facet].rebuild_number > candidate->rebuild_number) ||
           (candidate->own_facet >= 0 && facets[candidate->own_facet].rebuild_number > candidate->rebuild_number);
}

/* ---- whether anything can meet ---- */

static void find_idle(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    int32_t active = 0;
    for (int32_t i = 0; i < bodies->fragment_count && active < 2; i++) active += shv_bodies_active(bodies, i);
    const bool failed = bodies->cohesive && bodies->cohesive->live_count < bodies->cohesive->count;
    const bool obstacles = bodies->obstacles && bodies->obstacles->count > 0;
    contact->obstacles_only = bodies->apart || (active == 1 && !failed);
    contact->idle =
        active == 0 || (contact->obstacles_only && (!obstacles || (bodies->barred && !bodies->coupled_bodies)));
}

/* Insertions, splits, coupled bodies that woke. */
static bool has_changed(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    const ShvCohesive *cohesive = bodies->cohesive;
    return contact->woken || contact->known_fragments != bodies->fragment_count ||
           contact->known_nodes != bodies->state->node_count ||
           (cohesive && contact->known_cohesive != cohesive->count);
}

static bool is_stale(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    const ShvCohesive *cohesive = bodies->cohesive;
    const bool few = contact->idle || (contact->obstacles_only && !bodies->apart);
    return contact->stale ||
           (few && (has_changed(contact, bodies) || (cohesive && contact->known_live != cohesive->live_count)));
}

/* ---- the whole ---- */

static double mean_size(const ShvSurfaceContact *contact)
{
    double sum = 0.0;
    for (int32_t k = 0; k < contact->list.facet_count; k++) sum += shv_box_size(&contact->list.facets[k].box);
    return contact->list.facet_count > 0 ? sum / contact->list.facet_count : 0.0;
}

static ShvStatus update_list(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, bool lost, ShvError *error)
{
    ShvSurfaceList *list = &contact->list;
    if (lost)
        SHV_TRY(shv_surface_list_build(list, bodies, error));
    else if (bodies->cohesive)
        SHV_TRY(shv_surface_list_update(list, bodies, error));
    if (!lost) shv_surface_list_measure(list, bodies);
    contact->size = mean_size(contact);
    SHV_TRY(shv_surface_list_inner(list, bodies, SHV_SURFACE_INNER * contact->size, error));
    list->outdated.count = 0;
    for (int32_t k = 0; k < list->facet_count; k++) list->facets[k].watched = false;
    for (int32_t k = 0; k < list->node_count; k++) {
        list->nodes[k].watch = -1;
        list->nodes[k].outdated = false;
    }
    SHV_RESERVE(contact->memory, SHV_PART_CONTACT, contact->fragments, contact->fragment_capacity,
                bodies->fragment_count, "contact", error);
    for (int32_t i = 0; i < bodies->fragment_count; i++)
        contact->fragments[i] = (ShvSurfaceFragment){.rigid = shv_bodies_coupled_body(bodies, i)};
    shv_surface_mark_cracked(contact, bodies, 0);
    for (int32_t i = 0; i < bodies->fragment_count; i++) contact->fragments[i].opened = false;
    return SHV_OK;
}

/* Of facets that a node may pass in a step: it is far beyond the speed of sound by then, and has been unstable for some steps. */
static const double most_passed = 10.0;

/* Of nodes that fly off as numbers grow without bound everything would be a candidate, as far as memory goes. Measured by facets as
   they were when candidates were chosen last: these may be as large by now. */
static ShvStatus check_speeds(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step,
                              ShvError *error)
{
    const ShvState *state = bodies->state;
    for (int32_t k = 0; k < contact->list.node_count; k++) {
        const ShvSurfaceNode *node = &contact->list.nodes[k];
        if (shv_bodies_coupled_body(bodies, node->fragment)) continue;
        const double way = step * shv_norm(shv_load3(state->velocity + 3 * (int64_t)node->node));
        if (!(way > most_passed * contact->size)) continue; /* what is no number is found elsewhere */
        return shv_fail(
            error, SHV_DIVERGED,
            "at %g s a node of fragment %d would move %g m in a step of %g s: its motion has become unstable; a "
            "smaller fracture.safety may bear its strain",
            state->time, (int)node->fragment, way, step);
    }
    return SHV_OK;
}

static ShvStatus rebuild(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, bool lost, double step,
                         ShvError *error)
{
    ShvSurfaceList *list = &contact->list;
    const double last = bodies->state->last_step;
    if (!lost && contact->size > 0.0) SHV_TRY(check_speeds(contact, bodies, step, error));
    SHV_TRY(update_list(contact, bodies, lost, error));
    for (int kind = 0; kind < 2; kind++) contact->candidates[kind].count = contact->candidates[kind].held = 0;
    contact->watched_count = contact->watched_facets.count = contact->rebuilt_nodes = 0;
    contact->facets_with_neighbours = list->facet_count;
    shv_surface_speed_choose(contact, bodies, last > 0.0 ? last : step);
    SHV_TRY(shv_surface_fill_grids(contact, bodies, error));
    contact->rebuild_number++;
    for (int32_t k = 0; k < list->facet_count; k++) {
        shv_surface_edges_mark(list, bodies, k);
        if (!contact->fragments[list->facets[k].fragment].rigid)
            list->facets[k].rebuild_number = contact->rebuild_number;
    }
    for (int32_t k = 0; k < list->node_count; k++) SHV_TRY(shv_surface_pair_node_obstacles(contact, bodies, k, error));
    for (int32_t k = 0; k < list->facet_count; k++) {
        SHV_TRY(shv_surface_pair_facet_obstacles(contact, bodies, k, error));
        if (contact->obstacles_only) continue;
        SHV_TRY(shv_surface_pair_facet(contact, bodies, k, error));
        if (!contact->fragments[list->facets[k].fragment].rigid)
            SHV_TRY(shv_surface_pair_edges(contact, bodies, k, error));
    }
    contact->rebuilds++;
    return SHV_OK;
}

static ShvStatus refresh(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step, ShvError *error)
{
    bool lost = contact->stale;
    contact->stale = true; /* until it is done */
    if (!lost && has_changed(contact, bodies)) SHV_TRY(shv_surface_follow(contact, bodies, &lost, error));
    const bool outdated = !lost && shv_surface_speed_count(contact, bodies);
    if (lost || outdated) return rebuild(contact, bodies, lost, step, error);
    if (bodies->cohesive) SHV_TRY(shv_surface_list_update(&contact->list, bodies, error));
    bool many;
    SHV_TRY(shv_surface_rebuild_outdated(contact, bodies, step, &many, error));
    return many ? rebuild(contact, bodies, false, step, error) : SHV_OK;
}

ShvStatus shv_surface_candidates_refresh(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step,
                                         ShvError *error)
{
    const ShvCohesive *cohesive = bodies->cohesive;
    contact->gravity = shv_norm(bodies->gravity);
    if (is_stale(contact, bodies)) {
        const bool whole = contact->obstacles_only && !contact->idle;
        find_idle(contact, bodies);
        contact->stale |= !(whole && contact->obstacles_only);
    }
    if (!contact->idle) SHV_TRY(refresh(contact, bodies, step, error));
    contact->seen_time = bodies->state->time;
    contact->known_nodes = bodies->state->node_count;
    contact->known_fragments = bodies->fragment_count;
    contact->known_cohesive = cohesive ? cohesive->count : 0;
    contact->known_live = cohesive ? cohesive->live_count : 0;
    contact->stale = contact->woken = false;
    return SHV_OK;
}
