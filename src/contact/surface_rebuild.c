/* Partial rebuild of the neighbour lists, for nodes whose lists are outdated: those that leave their skin, such as what was hit, and
   those of what was split. */
#include "contact/surface_candidates.h"
#include "contact/surface_edge.h"

/* Of all nodes: more at once, or more since candidates were chosen, and choosing all anew costs less. */
static const double most_at_once = 0.15, most_in_all = 1.0;
/* Of those that held when void ones were last dropped: so many more are borne before they are dropped again. */
static const double most_void = 0.5;

/* A coupled body leaves its skin as a whole, and looks for all its candidates from where it is. */
static void find_leaving_bodies(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step)
{
    for (int32_t i = 0; bodies->coupled_bodies && i < bodies->fragment_count; i++) {
        ShvSurfaceFragment *fragment = &contact->fragments[i];
        fragment->leaves_skin = bodies->coupled_bodies[i] && shv_surface_speed_leaves(contact, bodies, i, step);
        if (fragment->leaves_skin) fragment->path = 0.0;
    }
}

/* Adds the nodes that may leave their skin in the next step, and sets how many steps the others may be left for. */
static ShvStatus find_leaving(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step, ShvError *error)
{
    ShvSurfaceList *list = &contact->list;
    contact->steps_to_check = SHV_SURFACE_STEPS_BETWEEN_CHECKS;
    find_leaving_bodies(contact, bodies, step);
    for (int32_t k = 0; k < list->node_count; k++) {
        const ShvSurfaceNode *node = &list->nodes[k];
        const bool rigid = shv_bodies_coupled_body(bodies, node->fragment);
        if (node->outdated || (rigid && !contact->fragments[node->fragment].leaves_skin)) continue;
        const int32_t steps = rigid ? 0 : shv_surface_speed_steps(contact, bodies, node, step, contact->steps_to_check);
        if (steps == 0)
            SHV_TRY(shv_surface_list_mark_outdated(list, k, error));
        else
            contact->steps_to_check = steps;
    }
    return SHV_OK;
}

static ShvStatus append(ShvSurfaceContact *contact, int32_t place, ShvError *error)
{
    ShvSurfaceFacet *facet = &contact->list.facets[place];
    ShvSurfacePlaces *rebuilt = &contact->rebuilt_facets;
    if (facet->rebuild_number == contact->rebuild_number) return SHV_OK;
    facet->rebuild_number = contact->rebuild_number;
    SHV_GROW(contact->memory, SHV_PART_CONTACT, rebuilt->items, rebuilt->capacity, rebuilt->count, "contact", error);
    rebuilt->items[rebuilt->count++] = place;
    return SHV_OK;
}

/* Facets that have come, and those of the nodes. */
static ShvStatus list_facets(ShvSurfaceContact *contact, const ShvState *state, ShvError *error)
{
    const ShvSurfaceList *list = &contact->list;
    contact->rebuilt_facets.count = 0;
    for (; contact->facets_with_neighbours < list->facet_count; contact->facets_with_neighbours++)
        SHV_TRY(append(contact, contact->facets_with_neighbours, error));
    for (int32_t k = 0; k < list->outdated.count; k++) {
        const int32_t node = list->nodes[list->outdated.items[k]].node;
        for (int32_t i = 0; i < state->corner_count[node]; i++) {
            const int32_t corner = state->corners[state->corner_start[node] + i];
            for (int face = 0; face < 4; face++) {
                const int32_t place = list->place[corner / 4 * (int64_t)4 + face];
                if (face != corner % 4 && place >= 0) SHV_TRY(append(contact, place, error));
            }
        }
    }
    return SHV_OK;
}

/* From where they are now. */
static ShvStatus move(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step, ShvError *error)
{
    ShvSurfaceList *list = &contact->list;
    for (int32_t k = 0; k < list->outdated.count; k++) {
        ShvSurfaceNode *node = &list->nodes[list->outdated.items[k]];
        node->rebuild_number = contact->rebuild_number;
        shv_surface_speed_node(contact, bodies, node, step);
        SHV_TRY(shv_surface_put_node(contact, bodies, list->outdated.items[k], error));
        if (!shv_bodies_coupled_body(bodies, node->fragment))
            contact->steps_to_check = shv_surface_speed_steps(contact, bodies, node, step, contact->steps_to_check);
    }
    if (contact->steps_to_check == 0) contact->steps_to_check = 1;
    for (int32_t k = 0; k < contact->rebuilt_facets.count; k++) {
        const int32_t place = contact->rebuilt_facets.items[k];
        shv_surface_facet_measure(bodies, &list->facets[place]);
        shv_surface_speed_facet(contact, bodies, &list->facets[place]);
        SHV_TRY(shv_surface_put_facet(contact, place, error));
    }
    return SHV_OK;
}

static void drop_void(ShvSurfaceContact *contact, ShvSurfaceCandidates *list)
{
    if (list->count <= (1.0 + most_void) * list->held) return;
    list->held = 0;
    for (int32_t k = 0; k < list->count; k++) {
        if (shv_surface_candidate_is_void(contact, &list->items[k])) continue;
        list->items[list->held] = list->items[k];
        list->due[list->held] = list->due[k];
        list->motion_bounds[list->held] = list->motion_bounds[k];
        list->motion_classes[list->held++] = list->motion_classes[k];
    }
    list->count = list->held;
}

/* A facet looks for all nodes and edges, a node for all other facets. */
static ShvStatus pair_anew(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvError *error)
{
    for (int32_t k = 0; k < contact->rebuilt_facets.count; k++)
        shv_surface_edges_mark(&contact->list, bodies, contact->rebuilt_facets.items[k]);
    for (int32_t k = 0; k < contact->rebuilt_facets.count; k++) {
        SHV_TRY(shv_surface_pair_facet_obstacles(contact, bodies, contact->rebuilt_facets.items[k], error));
        if (contact->obstacles_only) continue;
        SHV_TRY(shv_surface_pair_facet(contact, bodies, contact->rebuilt_facets.items[k], error));
        SHV_TRY(shv_surface_pair_edges(contact, bodies, contact->rebuilt_facets.items[k], error));
    }
    for (int32_t k = 0; k < contact->list.outdated.count; k++) {
        SHV_TRY(shv_surface_pair_node_obstacles(contact, bodies, contact->list.outdated.items[k], error));
        if (!contact->obstacles_only)
            SHV_TRY(shv_surface_pair_node(contact, bodies, contact->list.outdated.items[k], error));
    }
    return SHV_OK;
}

ShvStatus shv_surface_rebuild_outdated(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step,
                                       bool *many, ShvError *error)
{
    ShvSurfaceList *list = &contact->list;
    const double last = bodies->state->last_step > 0.0 ? bodies->state->last_step : step;
    if (contact->steps_to_check <= 0) SHV_TRY(find_leaving(contact, bodies, last, error));
    const int32_t count = list->outdated.count;
    *many = count > most_at_once * list->node_count || contact->rebuilt_nodes + count > most_in_all * list->node_count;
    if (*many || (count == 0 && contact->facets_with_neighbours == list->facet_count)) return SHV_OK;
    contact->rebuild_number++;
    contact->rebuilt_nodes += count;
    SHV_TRY(list_facets(contact, bodies->state, error));
    SHV_TRY(move(contact, bodies, last, error));
    for (int kind = 0; kind < 2; kind++) drop_void(contact, &contact->candidates[kind]);
    SHV_TRY(pair_anew(contact, bodies, error));
    for (int32_t k = 0; k < count; k++) list->nodes[list->outdated.items[k]].outdated = false;
    list->outdated.count = 0;
    return SHV_OK;
}
