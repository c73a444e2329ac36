/* Nodes that leave the way that candidates were chosen for, where the rest does not, such as what was hit; and those of bodies
   that crack. */
#include "contact/candidates.h"
#include "contact/surface_candidates.h"

/* Of all nodes: more at once, or more since candidates were chosen, and choosing all anew costs less. */
static const double most_at_once = 0.06, most_in_all = 0.25;

/* Marks the nodes that leave their skin just now; their number. */
static int32_t mark_nodes(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step, double gravity)
{
    int32_t count = 0;
    for (int32_t k = 0; k < contact->list.node_count; k++) {
        ShvSurfaceNode *node = &contact->list.nodes[k];
        node->leaves_skin = node->incomplete || (!shv_bodies_coupled_body(bodies, node->fragment) &&
                                                 shv_surface_speed_steps(contact, bodies, node, step, gravity, 1) == 0);
        node->incomplete = false;
        count += node->leaves_skin;
    }
    contact->incomplete = false;
    return count;
}

static ShvStatus append(ShvSurfaceContact *contact, ShvSurfacePlaces *places, int32_t place, ShvError *error)
{
    void *block = places->items;
    SHV_TRY(shv_candidates_grow(contact->memory, &block, &places->capacity, places->count, sizeof(int32_t), error));
    places->items = block;
    places->items[places->count++] = place;
    return SHV_OK;
}

/* From where they are now. */
static ShvStatus move_nodes(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step, ShvError *error)
{
    for (int32_t k = 0; k < contact->list.node_count; k++) {
        ShvSurfaceNode *node = &contact->list.nodes[k];
        if (!node->leaves_skin) continue;
        shv_surface_speed_node(contact, bodies, node, step);
        if (!node->out_of_skin && k < contact->grid_nodes)
            SHV_TRY(append(contact, &contact->nodes_out_of_skin, k, error));
        node->out_of_skin = true;
    }
    return SHV_OK;
}

static ShvStatus move_facets(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvError *error)
{
    const ShvSurfaceNode *nodes = contact->list.nodes;
    for (int32_t k = 0; k < contact->list.facet_count; k++) {
        ShvSurfaceFacet *facet = &contact->list.facets[k];
        facet->leaves_skin = nodes[facet->slots[0]].leaves_skin || nodes[facet->slots[1]].leaves_skin ||
                             nodes[facet->slots[2]].leaves_skin;
        if (!facet->leaves_skin) continue;
        shv_surface_facet_measure(bodies, facet);
        shv_surface_speed_facet(contact, bodies, facet);
        if (!facet->out_of_skin && k < contact->grid_facets)
            SHV_TRY(append(contact, &contact->facets_out_of_skin, k, error));
        facet->out_of_skin = true;
    }
    return SHV_OK;
}

static void drop_candidates(ShvSurfaceContact *contact)
{
    ShvSurfaceCandidates *list = &contact->candidates[0];
    int32_t kept = 0;
    for (int32_t k = 0; k < list->count; k++) {
        const ShvSurfaceCandidate *candidate = &list->items[k];
        if (contact->list.nodes[candidate->slot].leaves_skin ||
            (candidate->half_edge > 0 && contact->list.facets[(candidate->half_edge - 1) / 3].leaves_skin) ||
            (candidate->facet >= 0 && contact->list.facets[candidate->facet].leaves_skin))
            continue;
        list->items[kept] = *candidate;
        list->due[kept] = list->due[k];
        list->movers[kept++] = list->movers[k];
    }
    list->count = kept;
}

/* A facet that leaves its skin looks for all nodes and edges, a node that leaves its skin for all other facets. */
static ShvStatus pair_anew(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvError *error)
{
    ShvSurfaceList *list = &contact->list;
    for (int32_t k = 0; k < list->facet_count; k++) {
        if (!list->facets[k].leaves_skin) continue;
        SHV_TRY(shv_surface_pair_late_facet(contact, bodies, &list->facets[k], error));
        SHV_TRY(shv_surface_pair_late_edges(contact, bodies, k, list->facet_count, error));
    }
    for (int32_t k = 0; k < list->node_count; k++)
        if (list->nodes[k].leaves_skin)
            SHV_TRY(shv_surface_pair_late_node(contact, bodies, k, list->facet_count, error));
    for (int32_t k = 0; k < list->facet_count; k++) list->facets[k].leaves_skin = false;
    return SHV_OK;
}

ShvStatus shv_surface_renew_out_of_skin(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step,
                                        double gravity, bool *many, ShvError *error)
{
    const double last = bodies->state->last_step > 0.0 ? bodies->state->last_step : step;
    const int32_t count = mark_nodes(contact, bodies, last, gravity), all = contact->list.node_count;
    const int32_t out = contact->nodes_out_of_skin.count + all - contact->grid_nodes;
    *many = count > most_at_once * all || count + out > most_in_all * all;
    if (*many) return SHV_OK;
    SHV_TRY(move_nodes(contact, bodies, last, error));
    SHV_TRY(move_facets(contact, bodies, error));
    drop_candidates(contact);
    SHV_TRY(pair_anew(contact, bodies, error));
    contact->rest = 1;
    return SHV_OK;
}
