/* Which candidates are close enough to meet in the step. Each decision stands for itself, so that threads share them; the
   pairs are then put into the order of their numbers. */
#include "contact/narrow_phase.h"

#include <stdlib.h>

#include "contact/candidates.h"
#include "contact/surface_candidates.h"
#include "contact/surface_edge.h"

/* Fewer distances than this are measured before threads have woken. */
enum { WORTH_THREADS = 256 };

/* By the movers of both sides, m: how far they have come and how far they may come in the step. */
typedef struct Horizon {
    double path[SHV_SURFACE_MOVERS * SHV_SURFACE_MOVERS], reach[SHV_SURFACE_MOVERS * SHV_SURFACE_MOVERS];
} Horizon;

void shv_narrow_phase_release(ShvNarrowPhase *narrow)
{
    shv_release(narrow->due);
    shv_release(narrow->nodes);
    shv_release(narrow->facets);
    shv_release(narrow->planes);
    shv_release(narrow->drafts);
    shv_release(narrow->keys);
}

/* ---- neighbours ---- */

/* How far copies of one node of the mesh may still part until they are out of place, m; 0: they are. */
static double parting(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const int32_t nodes[2],
                      const int32_t fragments[2])
{
    const ShvVec3 own = shv_bodies_position(bodies, nodes[0], fragments[0]);
    const double apart = shv_norm(shv_sub(own, shv_bodies_position(bodies, nodes[1], fragments[1])));
    return fmax(0.5 * contact->skin[0] - apart, 0.0);
}

static double parting_of_edges(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                               const ShvSurfaceCandidate *candidate)
{
    const ShvSurfaceList *list = &contact->list;
    const int32_t half_edges[2] = {candidate->half_edge - 1, 3 * candidate->facet + candidate->edge};
    double largest = 0.0;
    for (int k = 0; k < 4; k++) {
        int32_t nodes[2];
        for (int side = 0; side < 2; side++) {
            const int32_t *slots = list->facets[half_edges[side] / 3].slots;
            nodes[side] = list->nodes[slots[(half_edges[side] + (k >> side & 1)) % 3]].node;
        }
        if (bodies->state->origin[nodes[0]] == bodies->state->origin[nodes[1]])
            largest = fmax(largest, parting(contact, bodies, nodes, candidate->fragments));
    }
    return largest;
}

/* Whether a node belongs to the tet on the other side of the facet: these two meet across it from the start. */
static bool is_across(const ShvModel *model, const ShvState *state, const ShvSurfaceCandidate *candidate)
{
    const ShvAdjacency *adjacency = &model->adjacency;
    const int64_t facet = adjacency->element_facets[4 * (int64_t)candidate->element + candidate->face];
    if (facet >= adjacency->interior_count) return false;
    const int32_t *elements = adjacency->facet_elements + 2 * facet;
    return shv_state_has_node(state, elements[elements[0] == candidate->element], candidate->node);
}

/* Whether neighbours have nothing to do with each other: as long as a crack between the two copies sees to them, and until they
   are out of place. *way: how far that is off, m. */
static bool is_left(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                    const ShvSurfaceCandidate *candidate, double *way)
{
    const ShvState *state = bodies->state;
    *way = 0.0;
    if (candidate->element < 0) return false;
    if (candidate->half_edge > 0) {
        *way = parting_of_edges(contact, bodies, candidate);
        return *way > 0.0;
    }
    if (candidate->copy_corner < 0) return false;
    const int32_t copy = shv_state_node(state, candidate->element, candidate->copy_corner);
    const int32_t slot = contact->list.slot[copy];
    if (contact->list.nodes[candidate->slot].held && slot >= 0 && contact->list.nodes[slot].held) {
        *way = (double)INFINITY;
        return true;
    }
    if (!is_across(contact->model, state, candidate))
        *way = parting(contact, bodies, (int32_t[]){candidate->node, copy}, candidate->fragments);
    return *way > 0.0;
}

/* Cosine of the angle between the normals of a node and a facet above which both look the same way; barycentric weight at which a
   point is clearly inside the edges. */
static const double same_way = 0.25, clearly = 1e-3;

/* A node comes from where its own surface looks. A facet that looks the same way, as the side of a block does for the
   corners of an equal block on top of it, is met only by what is clearly past the facet's edges. */
static bool faces_away(const ShvSurfaceContact *contact, const ShvSurfaceCandidate *candidate, const ShvFacetPair *pair)
{
    if (candidate->element < 0 || candidate->half_edge > 0) return false;
    const ShvVec3 own = contact->list.nodes[candidate->slot].normal;
    if (!(shv_dot(own, pair->normal) > same_way * shv_norm(own))) return false;
    return fmin(pair->weights[0], fmin(pair->weights[1], pair->weights[2])) < clearly;
}

/* ---- what is due ---- */

/* Twice the way both can go: other impulses of the step may speed them up. */
static void find_horizon(const ShvSurfaceContact *contact, double step, Horizon *horizon)
{
    for (int a = 0; a < SHV_SURFACE_MOVERS; a++)
        for (int b = 0; b < SHV_SURFACE_MOVERS; b++) {
            horizon->path[a * SHV_SURFACE_MOVERS + b] = contact->path[a] + contact->path[b];
            horizon->reach[a * SHV_SURFACE_MOVERS + b] = 2.0 * step * (contact->speed[a] + contact->speed[b]);
        }
}

/* What a crack kept apart is due at once where it no longer does. */
static void release_held(ShvSurfaceContact *contact)
{
    for (int kind = 0; kind < 2 && contact->list.released; kind++)
        for (int32_t k = 0; k < contact->candidates[kind].count; k++)
            if (isinf(contact->candidates[kind].due[k])) contact->candidates[kind].due[k] = 0.0;
    contact->list.released = false;
}

static ShvStatus collect(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int kind, const Horizon *horizon,
                         ShvError *error)
{
    ShvNarrowPhase *narrow = &contact->narrow;
    ShvSurfaceCandidates *list = &contact->candidates[kind];
    for (int32_t k = 0; k < list->count; k++) {
        if (list->due[k] > horizon->path[list->movers[k]] + horizon->reach[list->movers[k]]) continue;
        double way;
        const bool left = is_left(contact, bodies, &list->items[k], &way);
        if (left) {
            list->due[k] = fmax(list->due[k], horizon->path[list->movers[k]] + way);
            continue;
        }
        void *block = narrow->due;
        SHV_TRY(shv_candidates_grow(contact->memory, &block, &narrow->due_capacity, narrow->due_count,
                                    sizeof(ShvDueCandidate), error));
        narrow->due = block;
        narrow->due[narrow->due_count++] = (ShvDueCandidate){.candidate = k, .kind = (uint8_t)kind};
    }
    return SHV_OK;
}

/* ---- where they are ---- */

static ShvStatus reserve_places(ShvSurfaceContact *contact, ShvError *error)
{
    ShvNarrowPhase *narrow = &contact->narrow;
    const ShvSurfaceList *list = &contact->list;
    if (narrow->node_capacity < list->node_capacity) {
        const size_t wanted = (size_t)list->node_capacity;
        SHV_RESIZE(contact->memory, SHV_PART_CONTACT, narrow->nodes, wanted, "contact of surfaces",
                   wanted * sizeof *narrow->nodes, error);
        narrow->node_capacity = list->node_capacity;
    }
    if (narrow->facet_capacity >= list->facet_capacity) return SHV_OK;
    const size_t wanted = (size_t)list->facet_capacity;
    SHV_RESIZE(contact->memory, SHV_PART_CONTACT, narrow->facets, wanted, "contact of surfaces",
               wanted * sizeof *narrow->facets, error);
    SHV_RESIZE(contact->memory, SHV_PART_CONTACT, narrow->planes, wanted, "contact of surfaces",
               wanted * sizeof *narrow->planes, error);
    narrow->facet_capacity = list->facet_capacity;
    return SHV_OK;
}

static void want_node(ShvSurfaceContact *contact, int32_t slot)
{
    ShvSurfaceNode *node = &contact->list.nodes[slot];
    if (node->seen == contact->narrow.pass) return;
    node->seen = contact->narrow.pass;
    contact->narrow.nodes[contact->narrow.node_count++] = slot;
}

static void want_facet(ShvSurfaceContact *contact, int32_t index)
{
    ShvSurfaceFacet *facet = &contact->list.facets[index];
    if (facet->seen == contact->narrow.pass) return;
    facet->seen = contact->narrow.pass;
    contact->narrow.facets[contact->narrow.facet_count++] = index;
    for (int k = 0; k < 3; k++) want_node(contact, facet->slots[k]);
}

/* Each node and plane once: a facet is looked at from a dozen nodes. */
static void place(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    ShvNarrowPhase *narrow = &contact->narrow;
    ShvSurfaceList *list = &contact->list;
    narrow->node_count = narrow->facet_count = 0;
    narrow->pass++;
    for (int32_t i = 0; i < narrow->due_count; i++) {
        const ShvSurfaceCandidate *candidate =
            &contact->candidates[narrow->due[i].kind].items[narrow->due[i].candidate];
        if (candidate->half_edge > 0) continue;
        want_node(contact, candidate->slot);
        if (candidate->facet >= 0) want_facet(contact, candidate->facet);
    }
#pragma omp parallel for schedule(static) num_threads(contact->model->threads) if (narrow->node_count > WORTH_THREADS)
    for (int32_t i = 0; i < narrow->node_count; i++) {
        ShvSurfaceNode *node = &list->nodes[narrow->nodes[i]];
        node->at = shv_bodies_position(bodies, node->node, node->fragment);
    }
#pragma omp parallel for schedule(static) num_threads(contact->model->threads) if (narrow->facet_count > WORTH_THREADS)
    for (int32_t i = 0; i < narrow->facet_count; i++) {
        const ShvSurfaceFacet *facet = &list->facets[narrow->facets[i]];
        ShvVec3 corners[3];
        for (int k = 0; k < 3; k++) corners[k] = list->nodes[facet->slots[k]].at;
        if (!shv_facet_plane_make(corners, &narrow->planes[narrow->facets[i]]))
            narrow->planes[narrow->facets[i]] = (ShvFacetPlane){0};
    }
}

/* ---- distances ---- */

/* How far apart they are now is when they are due again. */
static void measure_distance(ShvSurfaceContact *contact, const Horizon *horizon, ShvDueCandidate *due)
{
    ShvSurfaceCandidates *list = &contact->candidates[due->kind];
    const ShvSurfaceCandidate *candidate = &list->items[due->candidate];
    const uint8_t movers = list->movers[due->candidate];
    due->near = true;
    if (candidate->facet < 0 || candidate->half_edge > 0) return;
    const double distance =
        shv_facet_plane_distance(&contact->narrow.planes[candidate->facet], contact->list.nodes[candidate->slot].at);
    list->due[due->candidate] = horizon->path[movers] + distance;
    due->near = distance <= horizon->reach[movers];
}

static void fill(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const ShvSurfaceCandidate *candidate,
                 ShvFacetPair *pair)
{
    const bool rigid = shv_bodies_coupled_body(bodies, pair->fragments[0]);
    const bool other_rigid = pair->element < 0 || shv_bodies_coupled_body(bodies, pair->fragments[1]);
    const int32_t half_edge = candidate->half_edge - 1;
    pair->slots[0] = pair->slots[1] = rigid ? -1 : candidate->slot;
    if (half_edge >= 0 && !rigid) pair->slots[1] = contact->list.facets[half_edge / 3].slots[(half_edge + 1) % 3];
    for (int k = 0; k < 3; k++) pair->slots[2 + k] = other_rigid ? -1 : contact->list.facets[candidate->facet].slots[k];
    pair->deforming = !rigid && !other_rigid;
}

static bool detect_edges(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                         const ShvSurfaceCandidate *candidate, double step, double reach, ShvFacetPair *pair,
                         double *distance)
{
    ShvEdge own, other;
    *distance = 0.0;
    return shv_surface_edge(&contact->list, bodies, candidate->half_edge - 1, &own) &&
           shv_surface_edge(&contact->list, bodies, 3 * candidate->facet + candidate->edge, &other) &&
           shv_edge_pair_detect(bodies, &own, &other, step, reach, pair, distance);
}

/* One that is near becomes a draft, which is taken or not. */
static void make_pair(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const Horizon *horizon, double step,
                      ShvDueCandidate *due, ShvFacetPair *draft)
{
    ShvSurfaceCandidates *list = &contact->candidates[due->kind];
    const ShvSurfaceCandidate *candidate = &list->items[due->candidate];
    const uint8_t movers = list->movers[due->candidate];
    const double reach = horizon->reach[movers];
    double distance;
    due->near = candidate->half_edge > 0
                    ? detect_edges(contact, bodies, candidate, step, reach, draft, &distance)
                    : shv_facet_pair_detect(bodies, contact->model, candidate, step, reach, draft, &distance);
    list->due[due->candidate] = horizon->path[movers] + distance;
    due->near = due->near && !faces_away(contact, candidate, draft);
    if (due->near) fill(contact, bodies, candidate, draft);
}

static ShvStatus reserve_drafts(ShvSurfaceContact *contact, ShvError *error)
{
    ShvNarrowPhase *narrow = &contact->narrow;
    if (narrow->capacity >= narrow->due_count) return SHV_OK;
    const size_t wanted = (size_t)narrow->due_count + (size_t)narrow->due_count / 2;
    SHV_RESIZE(contact->memory, SHV_PART_CONTACT, narrow->drafts, wanted, "contact of surfaces",
               wanted * sizeof *narrow->drafts, error);
    SHV_RESIZE(contact->memory, SHV_PART_CONTACT, narrow->keys, wanted, "contact of surfaces",
               wanted * sizeof *narrow->keys, error);
    narrow->capacity = (int32_t)wanted;
    return SHV_OK;
}

/* Measures what is due of one kind; those that are near stay in narrow->due. */
static ShvStatus measure_distances(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const Horizon *horizon,
                                   ShvError *error)
{
    ShvNarrowPhase *narrow = &contact->narrow;
    SHV_TRY(reserve_places(contact, error));
    place(contact, bodies);
    contact->distance_checks += narrow->due_count;
#pragma omp parallel for schedule(static) num_threads(contact->model->threads) if (narrow->due_count > WORTH_THREADS)
    for (int32_t i = 0; i < narrow->due_count; i++) measure_distance(contact, horizon, &narrow->due[i]);
    int32_t kept = 0;
    for (int32_t i = 0; i < narrow->due_count; i++)
        if (narrow->due[i].near) narrow->due[kept++] = narrow->due[i];
    narrow->due_count = kept;
    return SHV_OK;
}

static ShvStatus find_pairs_of_kind(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int kind, double step,
                                    ShvError *error)
{
    ShvNarrowPhase *narrow = &contact->narrow;
    Horizon horizon;
    narrow->due_count = 0;
    find_horizon(contact, step, &horizon);
    SHV_TRY(collect(contact, bodies, kind, &horizon, error));
    SHV_TRY(measure_distances(contact, bodies, &horizon, error));
    const int32_t first = narrow->count;
    narrow->due_count += first;
    SHV_TRY(reserve_drafts(contact, error));
    narrow->due_count -= first;
#pragma omp parallel for schedule(static) num_threads(contact->model->threads) if (narrow->due_count > WORTH_THREADS)
    for (int32_t i = 0; i < narrow->due_count; i++)
        make_pair(contact, bodies, &horizon, step, &narrow->due[i], &narrow->drafts[first + i]);
    for (int32_t i = 0; i < narrow->due_count; i++) {
        const ShvFacetPair *draft = &narrow->drafts[first + i];
        if (!narrow->due[i].near) continue;
        narrow->keys[narrow->key_count++] =
            (ShvPairKey){draft->node, draft->end, draft->element, draft->face, draft->edge, draft->feature, first + i};
    }
    narrow->count += narrow->due_count;
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
    return (x->feature > y->feature) - (x->feature < y->feature);
}

ShvStatus shv_narrow_phase(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step, ShvError *error)
{
    ShvNarrowPhase *narrow = &contact->narrow;
    narrow->count = narrow->key_count = 0;
    shv_surface_candidates_advance(contact, bodies);
    release_held(contact);
    SHV_TRY(find_pairs_of_kind(contact, bodies, 0, step, error));
    if (contact->steps_since_detection <= 0 && contact->candidates[1].count > 0)
        SHV_TRY(find_pairs_of_kind(contact, bodies, 1, contact->detection_interval * step, error));
    if (narrow->key_count > 0) qsort(narrow->keys, (size_t)narrow->key_count, sizeof *narrow->keys, by_number);
    return SHV_OK;
}
