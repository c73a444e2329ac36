/* Sharp edges that may soon meet one another, one of them at least of what deforms: two rigid bodies that go along are left to
   nodes and facets, and in flight to their convex pieces. */
#include "contact/surface_candidates.h"
#include "contact/surface_edge.h"
#include "shape/segment.h"

/* A facet whose sharp edges look for others. */
typedef struct Seeker {
    int32_t place;
    const ShvSurfaceFacet *facet;
    bool alone; /* it cannot meet its own fragment */
    bool
        all_lists; /* all lists are chosen anew: what deforms looks for what is rigid, and for what has a lower place */
    bool woken;    /* it was rigid until now, and looks for what it was left to then */
} Seeker;

static ShvVec3 place_of(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t slot)
{
    const ShvSurfaceNode *node = &contact->list.nodes[slot];
    return contact->built_time == bodies->state->time ? node->from
                                                      : shv_bodies_position(bodies, node->node, node->fragment);
}

/* Half-edges of facets, the first of the seeker's. What overlaps is due at once, however deep: all are looked at once. */
static ShvStatus pair_edge(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const int32_t half_edges[2],
                           double reach, ShvError *error)
{
    int32_t slots[2][2];
    ShvVec3 places[2][2];
    const ShvSurfaceFacet *facets[2];
    for (int side = 0; side < 2; side++) {
        facets[side] = &contact->list.facets[half_edges[side] / 3];
        for (int k = 0; k < 2; k++) {
            slots[side][k] = facets[side]->slots[(half_edges[side] + k) % 3];
            places[side][k] = place_of(contact, bodies, slots[side][k]);
        }
    }
    for (int k = 0; k < 4; k++)
        if (slots[0][k / 2] == slots[1][k % 2]) return SHV_OK;
    const ShvSegmentPoints at = shv_segments_closest(places[0][0], shv_sub(places[0][1], places[0][0]), places[1][0],
                                                     shv_sub(places[1][1], places[1][0]));
    if (shv_norm(at.between) > reach) return SHV_OK;
    const ShvSurfaceCandidate candidate = {.node = contact->list.nodes[slots[0][0]].node,
                                           .element = facets[1]->element,
                                           .face = facets[1]->face,
                                           .fragments = {facets[0]->fragment, facets[1]->fragment},
                                           .slot = slots[0][0],
                                           .facet = half_edges[1] / 3,
                                           .copy_corner = -1,
                                           .half_edge = half_edges[0] + 1,
                                           .edge = half_edges[1] % 3};
    return shv_surface_candidate_add(contact, bodies, &candidate, facets[0]->speed_class, facets[1]->speed_class, 0.0,
                                     error);
}

static bool is_for(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const Seeker *seeker,
                   const ShvSurfaceFacet *other, int32_t place)
{
    const bool rigid = contact->fragments[other->fragment].rigid, below = place < seeker->place;
    if (seeker->woken) return rigid && (below || shv_bodies_coupled_body(bodies, other->fragment));
    if (seeker->all_lists) return rigid || below;
    if (rigid && contact->fragments[seeker->facet->fragment].rigid) return false;
    return !(other->leaves_skin && below); /* it has found this one */
}

static ShvStatus pair_facet(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const Seeker *seeker,
                            int32_t place, double times, ShvError *error)
{
    const ShvSurfaceFacet *facet = seeker->facet, *other = &contact->list.facets[place];
    if (other->sharp == 0 || place == seeker->place || (seeker->alone && other->fragment == facet->fragment))
        return SHV_OK;
    if (!is_for(contact, bodies, seeker, other, place)) return SHV_OK;
    const double reach = times * shv_surface_reach(contact, facet, other->speed_class);
    const ShvBox box = shv_box_grown(facet->box, reach);
    if (!shv_box_meets(&box, &other->box)) return SHV_OK;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            if (facet->sharp >> k & other->sharp >> i & 1)
                SHV_TRY(pair_edge(contact, bodies, (int32_t[]){3 * seeker->place + k, 3 * place + i}, reach, error));
    return SHV_OK;
}

/* Facets of the grid, below a place. Those that have left their skin are not where it has them. */
static ShvStatus pair_grid(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const Seeker *seeker,
                           int32_t facets, double times, ShvError *error)
{
    ShvNodeGrid *grid = &contact->facet_grid;
    for (int speed_class = 0; speed_class < SHV_SURFACE_SPEED_CLASSES; speed_class++) {
        const double reach =
            contact->half[speed_class] + times * shv_surface_reach(contact, seeker->facet, speed_class);
        SHV_TRY(shv_node_grid_find(grid, speed_class, shv_box_grown(seeker->facet->box, reach), error));
        for (int32_t k = 0; k < grid->found_count; k++)
            if (grid->found[k] < facets && !contact->list.facets[grid->found[k]].out_of_skin)
                SHV_TRY(pair_facet(contact, bodies, seeker, grid->found[k], times, error));
    }
    return SHV_OK;
}

static bool make_seeker(const ShvSurfaceContact *contact, int32_t place, Seeker *seeker)
{
    const ShvSurfaceFacet *facet = &contact->list.facets[place];
    const ShvSurfaceFragment *fragment = &contact->fragments[facet->fragment];
    *seeker = (Seeker){.place = place, .facet = facet, .alone = !fragment->cracked || fragment->rigid};
    return facet->sharp != 0;
}

ShvStatus shv_surface_pair_edges(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t place,
                                 ShvError *error)
{
    Seeker seeker;
    if (!make_seeker(contact, place, &seeker) || contact->fragments[seeker.facet->fragment].rigid) return SHV_OK;
    seeker.all_lists = true;
    return pair_grid(contact, bodies, &seeker, contact->grid_facets, 1.0, error);
}

/* With those below a place, wherever they have gone since the grid was filled. */
static ShvStatus pair_late(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const Seeker *seeker,
                           int32_t facets, ShvError *error)
{
    SHV_TRY(pair_grid(contact, bodies, seeker, facets, 2.0, error));
    for (int32_t k = 0; k < contact->facets_out_of_skin.count; k++)
        if (contact->facets_out_of_skin.items[k] < facets)
            SHV_TRY(pair_facet(contact, bodies, seeker, contact->facets_out_of_skin.items[k], 2.0, error));
    for (int32_t k = contact->grid_facets; k < facets; k++) SHV_TRY(pair_facet(contact, bodies, seeker, k, 2.0, error));
    return SHV_OK;
}

ShvStatus shv_surface_pair_late_edges(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t place,
                                      int32_t facets, ShvError *error)
{
    Seeker seeker;
    return make_seeker(contact, place, &seeker) ? pair_late(contact, bodies, &seeker, facets, error) : SHV_OK;
}

ShvStatus shv_surface_pair_woken_edges(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t place,
                                       ShvError *error)
{
    Seeker seeker;
    if (!make_seeker(contact, place, &seeker)) return SHV_OK;
    seeker.woken = true;
    return pair_late(contact, bodies, &seeker, contact->list.facet_count, error);
}
