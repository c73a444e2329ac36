/* Which candidates are close enough to meet in the step. Each decision stands for itself; the pairs are then put into the order of
   their numbers. */
#include <stdlib.h>

#include "base/simd.h"
#include "contact/surface_candidates.h"
#include "contact/surface_edge.h"

/* By the motion classes of both sides, m: how far they have come and how far they may come in the step. */
typedef struct Horizon {
    double path[SHV_SURFACE_MOTION_CLASSES * SHV_SURFACE_MOTION_CLASSES],
        reach[SHV_SURFACE_MOTION_CLASSES * SHV_SURFACE_MOTION_CLASSES];
} Horizon;

/* ---- neighbours ---- */

/* How far copies of one node of the mesh may still separate until they are out of place, m; 0: they are. */
static double separation_left(const ShvSurfaceContact *contact, ShvVec3 own, ShvVec3 copy)
{
    return fmax(0.5 * contact->skin[0] - shv_norm(shv_sub(own, copy)), 0.0);
}

/* A body's point, by the side of a candidate that it belongs to. */
static ShvVec3 position(const ShvSurfaceBodies *bodies, const ShvMotionBound *due, int side, int32_t node)
{
    return due->kinds[side] == SHV_SIDE_BODY ? shv_bodies_position(bodies, node, due->places[side])
                                             : shv_state_position(bodies->state, node);
}

static double separation_of_edges_left(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                                       const ShvSurfaceCandidate *candidate, const ShvMotionBound *due)
{
    const ShvSurfaceList *list = &contact->list;
    double largest = 0.0;
    for (int k = 0; k < 4; k++) {
        if (!(candidate->copies >> k & 1)) continue;
        const int32_t *slots = list->facets[candidate->own_facet].slots;
        const int32_t own = list->nodes[slots[(candidate->own_edge + (k & 1)) % 3]].node;
        const int32_t other = candidate->corners[(candidate->edge + (k >> 1)) % 3];
        largest =
            fmax(largest, separation_left(contact, position(bodies, due, 0, own), position(bodies, due, 1, other)));
    }
    return largest;
}

/* Neighbours have nothing to do with each other until they are out of place: how far that is off, m. */
static double neighbours_left(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                              const ShvSurfaceCandidate *candidate, const ShvMotionBound *due)
{
    if (candidate->copies) return separation_of_edges_left(contact, bodies, candidate, due);
    if (candidate->duplicate_corner < 0) return 0.0;
    const int32_t copy = shv_state_node(bodies->state, candidate->element, candidate->duplicate_corner);
    return separation_left(contact, position(bodies, due, 0, candidate->node), position(bodies, due, 1, copy));
}

/* How far both have to go at least until they may meet within `reach`, m, from what the candidate holds; 0: they may. */
static double distance_left(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                            const ShvSurfaceCandidate *candidate, const ShvMotionBound *due, double reach)
{
    const double left = neighbours_left(contact, bodies, candidate, due);
    ShvFacetPlane plane;
    ShvVec3 corners[3];
    if (left > 0.0) return left + reach; /* whatever is ahead */
    if (candidate->facet < 0 || candidate->own_facet >= 0) return 0.0;
    for (int k = 0; k < 3; k++) corners[k] = position(bodies, due, 1, candidate->corners[k]);
    if (!shv_facet_plane_make(corners, &plane)) return 0.0;
    const double distance = shv_facet_plane_distance(&plane, position(bodies, due, 0, candidate->node));
    return distance > reach ? distance : 0.0;
}

/* ---- what is due ---- */

/* Twice the way both can go: other impulses of the step may speed them up. */
static void find_horizon(const ShvSurfaceContact *contact, double step, Horizon *horizon)
{
    for (int a = 0; a < SHV_SURFACE_MOTION_CLASSES; a++)
        for (int b = 0; b < SHV_SURFACE_MOTION_CLASSES; b++) {
            horizon->path[a * SHV_SURFACE_MOTION_CLASSES + b] = contact->path[a] + contact->path[b];
            horizon->reach[a * SHV_SURFACE_MOTION_CLASSES + b] = 2.0 * step * (contact->speed[a] + contact->speed[b]);
        }
}

/* ---- pairs ---- */

static void name_slots(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                       const ShvSurfaceCandidate *candidate, ShvFacetPair *pair)
{
    const ShvSurfaceList *list = &contact->list;
    const bool rigid = shv_bodies_coupled_body(bodies, pair->fragments[0]), obstacle = pair->element < 0;
    const bool other_rigid = obstacle ? shv_bodies_obstacle(bodies, pair->element)->motion == SHV_OBSTACLE_FREE
                                      : shv_bodies_coupled_body(bodies, pair->fragments[1]) != NULL;
    for (int k = 0; k < 3; k++) {
        pair->slots[k] = k >= pair->node_count ? SHV_SLOT_NONE : rigid ? SHV_SLOT_RIGID : list->slot[pair->nodes[k]];
        pair->slots[3 + k] = other_rigid ? SHV_SLOT_RIGID
                             : obstacle  ? SHV_SLOT_NONE
                                         : list->facets[candidate->facet].slots[k];
    }
    pair->deforming = !rigid && (obstacle || !other_rigid);
}

/* Returns the number of pairs. */
static int detect(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                  const ShvSurfaceCandidate *candidate, double step, double reach, ShvFacetPair pairs[SHV_MOST_POINTS],
                  double *distance)
{
    ShvEdge own, other;
    if (candidate->facet < 0)
        return shv_obstacle_pair_detect(bodies, &contact->list, candidate, step, reach, pairs, distance);
    if (candidate->own_facet < 0)
        return shv_facet_pair_detect(bodies, &contact->list, candidate, step, reach, pairs, distance);
    *distance = 0.0;
    return shv_surface_edge(&contact->list, bodies, 3 * candidate->own_facet + candidate->own_edge, &own) &&
           shv_surface_edge(&contact->list, bodies, 3 * candidate->facet + candidate->edge, &other) &&
           shv_edge_pair_detect(bodies, &own, &other, step, reach, pairs, distance);
}

/* How many pairs a candidate may make. */
static int most_points(const ShvSurfaceCandidate *candidate)
{
    return candidate->facet < 0 ? SHV_MOST_POINTS : 1;
}

/* Whether the two have not gone so far yet that they may meet, their motion classes apart; then they are due when those have gone what is
   left. */
static bool is_early(const ShvSurfaceContact *contact, ShvSurfaceCandidates *list, int32_t k, double path, double reach)
{
    const double left = list->motion_bounds[k].path - shv_surface_candidate_path(contact, &list->motion_bounds[k]);
    if (!(left > reach)) return false;
    list->due[k] = fmax(list->due[k], path + left);
    return true;
}

/* Those that are due by their motion classes; returns how many. Memory is the bound: each costs a byte and a number. */
static ShvStatus find_due(ShvSurfaceContact *contact, ShvSurfaceCandidates *list, const Horizon *horizon,
                          int32_t *count, ShvError *error)
{
    double until[SHV_SURFACE_MOTION_CLASSES * SHV_SURFACE_MOTION_CLASSES];
    for (int k = 0; k < SHV_SURFACE_MOTION_CLASSES * SHV_SURFACE_MOTION_CLASSES; k++)
        until[k] = horizon->path[k] + horizon->reach[k];
    int32_t room = list->now_capacity;
    SHV_RESERVE(contact->memory, SHV_PART_CONTACT, list->near, room, list->count, "contact", error);
    SHV_RESERVE(contact->memory, SHV_PART_CONTACT, list->now, list->now_capacity, list->count, "contact", error);
    *count = 0;
    for (int32_t k = 0; k < list->count; k++) {
        list->now[*count] = k;
        *count += list->due[k] <= until[list->motion_classes[k]];
    }
    return SHV_OK;
}

/* So many candidates ahead of the one in hand are asked for from memory; with fewer than so many to look at threads do not pay. */
enum { PREFETCHED = 8, FEWEST_PARALLEL = 256 };

/* One search for pairs: what threads share. Each candidate is decided by itself, and writes to itself and its own places alone. */
typedef struct Search {
    ShvSurfaceContact *contact;
    const ShvSurfaceBodies *bodies;
    ShvSurfaceCandidates *list;
    Horizon horizon;
    double step; /* s: until the next search */
} Search;

static bool in_parallel(const Search *search, int32_t count)
{
    return search->contact->model->threads > 1 && count >= FEWEST_PARALLEL;
}

/* The distance that the two have now is when they are due again. */
static void postpone(const Search *search, int32_t k, double distance)
{
    ShvMotionBound *due = &search->list->motion_bounds[k];
    const double path = search->horizon.path[search->list->motion_classes[k]];
    search->list->due[k] = fmax(search->list->due[k], path + distance);
    if (due->path > -(double)INFINITY)
        due->path = fmax(due->path, shv_surface_candidate_path(search->contact, due) + distance);
}

/* Whether a candidate has to be looked at closely. */
static bool is_near(const Search *search, int32_t k)
{
    const int motion_class = search->list->motion_classes[k];
    const double path = search->horizon.path[motion_class], reach = search->horizon.reach[motion_class];
    const ShvSurfaceCandidate *candidate = &search->list->items[k];
    if (is_early(search->contact, search->list, k, path, reach)) return false;
    double distance = distance_left(search->contact, search->bodies, candidate, &search->list->motion_bounds[k], reach);
    if (!(distance > 0.0) && shv_surface_candidate_is_void(search->contact, candidate)) distance = (double)INFINITY;
    if (distance > 0.0) postpone(search, k, distance);
    return !(distance > 0.0);
}

/* Leaves those of `now` that are near; returns how many. */
static int32_t find_near(const Search *search, int32_t count)
{
    ShvSurfaceCandidates *list = search->list;
    const int32_t threads = search->contact->model->threads;
#pragma omp parallel for schedule(static) num_threads(threads) if (in_parallel(search, count))
    for (int32_t i = 0; i < count; i++) {
        if (i + PREFETCHED < count) {
            shv_prefetch(&list->motion_bounds[list->now[i + PREFETCHED]]);
            shv_prefetch(&list->items[list->now[i + PREFETCHED]]);
        }
        list->near[i].pairs = is_near(search, list->now[i]);
    }
    int32_t near = 0;
    for (int32_t i = 0; i < count; i++) {
        list->now[near] = list->now[i];
        near += list->near[i].pairs;
    }
    return near;
}

/* Places for the pairs of those that are near. */
static ShvStatus reserve(const Search *search, int32_t near, ShvError *error)
{
    ShvSurfaceContact *contact = search->contact;
    int32_t place = contact->found_count;
    for (int32_t i = 0; i < near; i++) {
        search->list->near[i].place = place;
        place += most_points(&search->list->items[search->list->now[i]]);
    }
    int32_t room = contact->found_capacity;
    SHV_RESERVE(contact->memory, SHV_PART_CONTACT, contact->found, room, place, "contact", error);
    SHV_RESERVE(contact->memory, SHV_PART_CONTACT, contact->keys, contact->found_capacity, place, "contact", error);
    contact->found_count = place;
    contact->distance_checks += near;
    return SHV_OK;
}

static void look(const Search *search, int32_t i)
{
    const int32_t k = search->list->now[i];
    const ShvSurfaceCandidate *candidate = &search->list->items[k];
    ShvNearCandidate *near = &search->list->near[i];
    ShvFacetPair *pairs = &search->contact->found[near->place];
    double distance = 0.0;
    near->pairs = detect(search->contact, search->bodies, candidate, search->step,
                         search->horizon.reach[search->list->motion_classes[k]], pairs, &distance);
    for (int point = 0; point < near->pairs; point++)
        name_slots(search->contact, search->bodies, candidate, &pairs[point]);
    postpone(search, k, distance);
}

static void note_keys(ShvSurfaceContact *contact, const ShvNearCandidate *near)
{
    for (int i = 0; i < near->pairs; i++) {
        const ShvFacetPair *pair = &contact->found[near->place + i];
        contact->keys[contact->pair_count++] = (ShvPairKey){pair->nodes[0], pair->node_count > 1 ? pair->nodes[1] : -1,
                                                            pair->element,  pair->face,
                                                            pair->edge,     pair->feature,
                                                            near->place + i};
    }
}

static ShvStatus find_pairs(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int kind, double step,
                            ShvError *error)
{
    Search search = {.contact = contact, .bodies = bodies, .list = &contact->candidates[kind], .step = step};
    const int32_t threads = contact->model->threads;
    int32_t count;
    find_horizon(contact, step, &search.horizon);
    SHV_TRY(find_due(contact, search.list, &search.horizon, &count, error));
    const int32_t near = find_near(&search, count);
    SHV_TRY(reserve(&search, near, error));
#pragma omp parallel for schedule(static) num_threads(threads) if (in_parallel(&search, near))
    for (int32_t i = 0; i < near; i++) look(&search, i);
    for (int32_t i = 0; i < near; i++) note_keys(contact, &search.list->near[i]);
    return SHV_OK;
}

static int by_number(const void *a, const void *b)
{
    const ShvPairKey *x = a, *y = b;
    if (x->node != y->node) return x->node < y->node ? -1 : 1;
    if (x->end != y->end) return x->end < y->end ? -1 : 1;
    if (x->element != y->element) return x->element < y->element ? -1 : 1;
    if (x->face != y->face) return x->face < y->face ? -1 : 1;
    if (x->edge != y->edge) return x->edge < y->edge ? -1 : 1;
    if (x->feature != y->feature) return x->feature < y->feature ? -1 : 1;
    return (x->found > y->found) - (x->found < y->found); /* points of one facet and one feature */
}

/* By numbers of steps, which the observer does not count: it may look at a time before or after lists were made anew. */
static bool detection_is_due(ShvSurfaceContact *contact, const ShvState *state)
{
    const int64_t steps = state->step - contact->detected_step;
    if (!contact->detect_now && steps > 0 && steps < contact->detection_interval) return false;
    contact->detect_now = false;
    contact->detected_step = state->step;
    contact->detection_interval = shv_surface_detection_interval(contact, state->last_step);
    return true;
}

ShvStatus shv_narrow_phase(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step, ShvError *error)
{
    contact->pair_count = contact->found_count = 0;
    shv_surface_measure_speeds(contact, bodies);
    SHV_TRY(find_pairs(contact, bodies, 0, step, error));
    if (detection_is_due(contact, bodies->state) && contact->candidates[1].count > 0)
        SHV_TRY(find_pairs(contact, bodies, 1, contact->detection_interval * step, error));
    SHV_RESERVE(contact->memory, SHV_PART_CONTACT, contact->pairs, contact->pair_capacity, contact->pair_count,
                "contact", error);
    if (contact->pair_count > 0) qsort(contact->keys, (size_t)contact->pair_count, sizeof *contact->keys, by_number);
    for (int32_t k = 0; k < contact->pair_count; k++) contact->pairs[k] = contact->found[contact->keys[k].found];
    return SHV_OK;
}
