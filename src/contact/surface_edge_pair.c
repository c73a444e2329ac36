/* Sharp edges that may soon meet one another, one of them at least of what deforms: two rigid bodies that go along are left to
   nodes and facets, and in flight to their convex pieces. */
#include "contact/surface_candidates.h"
#include "contact/surface_edge.h"
#include "shape/segment.h"

/* Half-edges of facets, the first of the one that looks for others. What overlaps is due at once, however deep: all are looked at once. */
static ShvStatus pair_edge(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const int32_t places[2],
                           const int edges[2], double reach, ShvError *error)
{
    int32_t slots[2][2];
    ShvVec3 x[2][2];
    for (int side = 0; side < 2; side++)
        for (int k = 0; k < 2; k++) {
            slots[side][k] = contact->list.facets[places[side]].slots[(edges[side] + k) % 3];
            const ShvSurfaceNode *node = &contact->list.nodes[slots[side][k]];
            x[side][k] = contact->built_time == bodies->state->time
                             ? node->from
                             : shv_bodies_position(bodies, node->node, node->fragment);
        }
    const int32_t *origin = bodies->state->origin;
    uint8_t copies = 0;
    for (int k = 0; k < 4; k++) {
        const int32_t a = slots[0][k & 1], b = slots[1][k >> 1];
        if (a == b) return SHV_OK;
        if (origin[contact->list.nodes[a].node] == origin[contact->list.nodes[b].node]) copies |= (uint8_t)(1 << k);
    }
    const ShvSegmentPoints at =
        shv_segments_closest(x[0][0], shv_sub(x[0][1], x[0][0]), x[1][0], shv_sub(x[1][1], x[1][0]));
    if (shv_norm(at.between) > reach) return SHV_OK;
    const ShvSurfaceCandidate candidate = {.slot = slots[0][0],
                                           .facet = places[1],
                                           .own_facet = places[0],
                                           .own_edge = (int8_t)edges[0],
                                           .edge = (int8_t)edges[1],
                                           .copies = copies,
                                           .duplicate_corner = -1};
    return shv_surface_candidate_add(contact, bodies, &candidate, 0.0, error);
}

/* Of two that look for each other in one rebuild the one that was listed first finds the other. */
static ShvStatus pair_facets(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t place, int32_t other,
                             ShvError *error)
{
    const ShvSurfaceFacet *own = &contact->list.facets[place], *facet = &contact->list.facets[other];
    const ShvSurfaceFragment *fragment = &contact->fragments[own->fragment];
    if (facet->sharp == 0 || other == place || (facet->rebuild_number == contact->rebuild_number && other < place))
        return SHV_OK;
    if (facet->fragment == own->fragment && (!fragment->cracked || fragment->rigid)) return SHV_OK;
    if (fragment->rigid && contact->fragments[facet->fragment].rigid) return SHV_OK;
    const double reach = shv_surface_reach(contact, own, facet->speed_class);
    const double farthest = contact->built_time == bodies->state->time ? reach : 2.0 * reach;
    const ShvBox box = shv_box_grown(own->box, reach);
    if (!shv_box_meets(&box, &facet->box)) return SHV_OK;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            if (own->sharp >> k & facet->sharp >> i & 1)
                SHV_TRY(pair_edge(contact, bodies, (int32_t[]){place, other}, (int[]){k, i}, farthest, error));
    return SHV_OK;
}

ShvStatus shv_surface_pair_edges(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t place,
                                 ShvError *error)
{
    const ShvSurfaceFacet *facet = &contact->list.facets[place];
    ShvHashGrid *grid = &contact->facet_grid;
    if (facet->sharp == 0) return SHV_OK;
    for (int speed_class = 0; speed_class < SHV_SURFACE_SPEED_CLASSES; speed_class++) {
        const double reach = contact->half[speed_class] + shv_surface_reach(contact, facet, speed_class);
        SHV_TRY(shv_hash_grid_find(grid, speed_class, shv_box_grown(facet->box, reach), error));
        for (int32_t k = 0; k < grid->found_count; k++)
            SHV_TRY(pair_facets(contact, bodies, place, grid->found[k], error));
    }
    return SHV_OK;
}
