/* Which candidates are close enough to meet in the step. Each decision stands for itself, so that threads share them; the
   pairs are then put into the order of their numbers. */
#include "contact/surface_draw.h"

#include <stdlib.h>

#include "contact/candidates.h"
#include "contact/surface_candidates.h"

/* Fewer looks than this are done before threads have woken. */
enum { WORTH_THREADS = 256 };

/* By the movers of both sides, m: how far they have come and how far they may come in the step. */
typedef struct Horizon {
    double path[SHV_SURFACE_MOVERS * SHV_SURFACE_MOVERS], reach[SHV_SURFACE_MOVERS * SHV_SURFACE_MOVERS];
} Horizon;

void shv_surface_draw_release(ShvSurfaceDraw *draw)
{
    shv_release(draw->looks);
    shv_release(draw->nodes);
    shv_release(draw->facets);
    shv_release(draw->planes);
    shv_release(draw->drafts);
    shv_release(draw->keys);
}

/* Left to the crack between the two copies, which has not parted. */
static bool held_by_crack(const ShvSurfaceContact *contact, const ShvSurfaceCandidate *candidate)
{
    if (candidate->mate < 0 || !contact->list.nodes[candidate->slot].held) return false;
    const int32_t mate = contact->list.slot[candidate->mate];
    return mate >= 0 && contact->list.nodes[mate].held;
}

/* A node comes from where its own surface looks. A facet that looks the same way, as the side of a block does for the
   corners of an equal block on top of it, is met only by what is clearly past the facet's edges. */
static bool looks_away(const ShvSurfaceContact *contact, const ShvSurfaceCandidate *candidate, const ShvFacetPair *pair)
{
    const double clearly = 1e-3;
    if (candidate->element < 0) return false;
    const ShvVec3 own = contact->list.nodes[candidate->slot].normal;
    if (!(shv_dot(own, pair->normal) > 0.25 * shv_norm(own))) return false;
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

static ShvStatus collect(ShvSurfaceContact *contact, int kind, const Horizon *horizon, ShvError *error)
{
    ShvSurfaceDraw *draw = &contact->draw;
    const ShvSurfaceCandidates *list = &contact->candidates[kind];
    for (int32_t k = 0; k < list->count; k++) {
        if (list->due[k] > horizon->path[list->movers[k]] + horizon->reach[list->movers[k]]) continue;
        if (held_by_crack(contact, &list->items[k])) continue;
        void *block = draw->looks;
        SHV_TRY(shv_candidates_grow(contact->memory, &block, &draw->look_capacity, draw->look_count,
                                    sizeof(ShvSurfaceLook), error));
        draw->looks = block;
        draw->looks[draw->look_count++] = (ShvSurfaceLook){.candidate = k, .kind = (uint8_t)kind};
    }
    return SHV_OK;
}

/* ---- where they are ---- */

static ShvStatus reserve_places(ShvSurfaceContact *contact, ShvError *error)
{
    ShvSurfaceDraw *draw = &contact->draw;
    const ShvSurfaceList *list = &contact->list;
    if (draw->node_capacity < list->node_capacity) {
        const size_t wanted = (size_t)list->node_capacity;
        SHV_RESIZE(contact->memory, SHV_PART_CONTACT, draw->nodes, wanted, "contact of surfaces",
                   wanted * sizeof *draw->nodes, error);
        draw->node_capacity = list->node_capacity;
    }
    if (draw->facet_capacity >= list->facet_capacity) return SHV_OK;
    const size_t wanted = (size_t)list->facet_capacity;
    SHV_RESIZE(contact->memory, SHV_PART_CONTACT, draw->facets, wanted, "contact of surfaces",
               wanted * sizeof *draw->facets, error);
    SHV_RESIZE(contact->memory, SHV_PART_CONTACT, draw->planes, wanted, "contact of surfaces",
               wanted * sizeof *draw->planes, error);
    draw->facet_capacity = list->facet_capacity;
    return SHV_OK;
}

static void want_node(ShvSurfaceContact *contact, int32_t slot)
{
    ShvSurfaceNode *node = &contact->list.nodes[slot];
    if (node->seen == contact->draw.turn) return;
    node->seen = contact->draw.turn;
    contact->draw.nodes[contact->draw.node_count++] = slot;
}

static void want_facet(ShvSurfaceContact *contact, int32_t index)
{
    ShvSurfaceFacet *facet = &contact->list.facets[index];
    if (facet->seen == contact->draw.turn) return;
    facet->seen = contact->draw.turn;
    contact->draw.facets[contact->draw.facet_count++] = index;
    for (int k = 0; k < 3; k++) want_node(contact, facet->slots[k]);
}

/* Each node and plane once: a facet is looked at from a dozen nodes. */
static void place(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    ShvSurfaceDraw *draw = &contact->draw;
    ShvSurfaceList *list = &contact->list;
    draw->node_count = draw->facet_count = 0;
    draw->turn++;
    for (int32_t i = 0; i < draw->look_count; i++) {
        const ShvSurfaceCandidate *candidate =
            &contact->candidates[draw->looks[i].kind].items[draw->looks[i].candidate];
        want_node(contact, candidate->slot);
        if (candidate->facet >= 0) want_facet(contact, candidate->facet);
    }
#pragma omp parallel for schedule(static) num_threads(contact->model->threads) if (draw->node_count > WORTH_THREADS)
    for (int32_t i = 0; i < draw->node_count; i++) {
        ShvSurfaceNode *node = &list->nodes[draw->nodes[i]];
        node->at = shv_bodies_position(bodies, node->node, node->fragment);
    }
#pragma omp parallel for schedule(static) num_threads(contact->model->threads) if (draw->facet_count > WORTH_THREADS)
    for (int32_t i = 0; i < draw->facet_count; i++) {
        const ShvSurfaceFacet *facet = &list->facets[draw->facets[i]];
        ShvVec3 corners[3];
        for (int k = 0; k < 3; k++) corners[k] = list->nodes[facet->slots[k]].at;
        if (!shv_facet_plane_make(corners, &draw->planes[draw->facets[i]]))
            draw->planes[draw->facets[i]] = (ShvFacetPlane){0};
    }
}

/* ---- looks ---- */

/* How far apart they are now is when they are due again. */
static void glance(ShvSurfaceContact *contact, const Horizon *horizon, ShvSurfaceLook *look)
{
    ShvSurfaceCandidates *list = &contact->candidates[look->kind];
    const ShvSurfaceCandidate *candidate = &list->items[look->candidate];
    const uint8_t movers = list->movers[look->candidate];
    look->near = true;
    if (candidate->facet < 0) return;
    const double distance =
        shv_facet_plane_distance(&contact->draw.planes[candidate->facet], contact->list.nodes[candidate->slot].at);
    list->due[look->candidate] = horizon->path[movers] + distance;
    look->near = distance <= horizon->reach[movers];
}

static void fill(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const ShvSurfaceCandidate *candidate,
                 ShvFacetPair *pair)
{
    const bool rigid = shv_bodies_companion(bodies, pair->fragments[0]);
    const bool other_rigid = pair->element < 0 || shv_bodies_companion(bodies, pair->fragments[1]);
    pair->slots[0] = rigid ? -1 : candidate->slot;
    for (int k = 0; k < 3; k++) pair->slots[1 + k] = other_rigid ? -1 : contact->list.facets[candidate->facet].slots[k];
    pair->deforming = !rigid && !other_rigid;
}

/* One that is near becomes a draft, which is taken or not. */
static void look_closely(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const Horizon *horizon,
                         double step, ShvSurfaceLook *look, ShvFacetPair *draft)
{
    ShvSurfaceCandidates *list = &contact->candidates[look->kind];
    const ShvSurfaceCandidate *candidate = &list->items[look->candidate];
    const uint8_t movers = list->movers[look->candidate];
    double distance;
    look->near = shv_facet_pair_look(bodies, contact->model, candidate, step, horizon->reach[movers], draft, &distance);
    list->due[look->candidate] = horizon->path[movers] + distance;
    look->near = look->near && !looks_away(contact, candidate, draft);
    if (look->near) fill(contact, bodies, candidate, draft);
}

static ShvStatus reserve_drafts(ShvSurfaceContact *contact, ShvError *error)
{
    ShvSurfaceDraw *draw = &contact->draw;
    if (draw->capacity >= draw->look_count) return SHV_OK;
    const size_t wanted = (size_t)draw->look_count + (size_t)draw->look_count / 2;
    SHV_RESIZE(contact->memory, SHV_PART_CONTACT, draw->drafts, wanted, "contact of surfaces",
               wanted * sizeof *draw->drafts, error);
    SHV_RESIZE(contact->memory, SHV_PART_CONTACT, draw->keys, wanted, "contact of surfaces",
               wanted * sizeof *draw->keys, error);
    draw->capacity = (int32_t)wanted;
    return SHV_OK;
}

/* Looks at what is due of one kind; those that are near stay in draw->looks. */
static ShvStatus glance_at_all(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const Horizon *horizon,
                               ShvError *error)
{
    ShvSurfaceDraw *draw = &contact->draw;
    SHV_TRY(reserve_places(contact, error));
    place(contact, bodies);
    contact->looks += draw->look_count;
#pragma omp parallel for schedule(static) num_threads(contact->model->threads) if (draw->look_count > WORTH_THREADS)
    for (int32_t i = 0; i < draw->look_count; i++) glance(contact, horizon, &draw->looks[i]);
    int32_t kept = 0;
    for (int32_t i = 0; i < draw->look_count; i++)
        if (draw->looks[i].near) draw->looks[kept++] = draw->looks[i];
    draw->look_count = kept;
    return SHV_OK;
}

static ShvStatus draw_kind(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int kind, double step,
                           ShvError *error)
{
    ShvSurfaceDraw *draw = &contact->draw;
    Horizon horizon;
    draw->look_count = 0;
    find_horizon(contact, step, &horizon);
    SHV_TRY(collect(contact, kind, &horizon, error));
    SHV_TRY(glance_at_all(contact, bodies, &horizon, error));
    const int32_t first = draw->count;
    draw->look_count += first;
    SHV_TRY(reserve_drafts(contact, error));
    draw->look_count -= first;
#pragma omp parallel for schedule(static) num_threads(contact->model->threads) if (draw->look_count > WORTH_THREADS)
    for (int32_t i = 0; i < draw->look_count; i++)
        look_closely(contact, bodies, &horizon, step, &draw->looks[i], &draw->drafts[first + i]);
    for (int32_t i = 0; i < draw->look_count; i++) {
        const ShvFacetPair *draft = &draw->drafts[first + i];
        if (!draw->looks[i].near) continue;
        draw->keys[draw->key_count++] =
            (ShvPairKey){draft->node, draft->element, draft->face, draft->feature, first + i};
    }
    draw->count += draw->look_count;
    return SHV_OK;
}

static int by_number(const void *a, const void *b)
{
    const ShvPairKey *x = a, *y = b;
    if (x->node != y->node) return x->node < y->node ? -1 : 1;
    if (x->element != y->element) return x->element < y->element ? -1 : 1;
    if (x->face != y->face) return x->face < y->face ? -1 : 1;
    return (x->feature > y->feature) - (x->feature < y->feature);
}

ShvStatus shv_surface_draw(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step, ShvError *error)
{
    ShvSurfaceDraw *draw = &contact->draw;
    draw->count = draw->key_count = 0;
    shv_surface_candidates_look(contact, bodies);
    SHV_TRY(draw_kind(contact, bodies, 0, step, error));
    if (contact->beat <= 0 && contact->candidates[1].count > 0)
        SHV_TRY(draw_kind(contact, bodies, 1, contact->beats * step, error));
    if (draw->key_count > 0) qsort(draw->keys, (size_t)draw->key_count, sizeof *draw->keys, by_number);
    return SHV_OK;
}
