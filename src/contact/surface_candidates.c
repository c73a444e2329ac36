#include "contact/surface_candidates.h"

#include "contact/surface_edge.h"

/* ---- whether anything can meet ---- */

static bool find_idle(const ShvSurfaceBodies *bodies)
{
    int32_t active = 0;
    for (int32_t i = 0; i < bodies->fragment_count && active < 2; i++) active += shv_bodies_active(bodies, i);
    const bool parted = bodies->cohesive && bodies->cohesive->live_count < bodies->cohesive->count;
    return active == 0 || (active == 1 && !parted);
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
    return contact->stale || (contact->idle && (has_changed(contact, bodies) ||
                                                (cohesive && contact->known_live != cohesive->live_count)));
}

/* ---- the whole ---- */

ShvStatus shv_surface_reserve_fragments(ShvSurfaceContact *contact, int32_t count, ShvError *error)
{
    if (contact->fragment_capacity >= count) return SHV_OK;
    const size_t wanted = (size_t)count + (size_t)count / 2;
    SHV_RESIZE(contact->memory, SHV_PART_CONTACT, contact->fragments, wanted, "contact of surfaces",
               wanted * sizeof *contact->fragments, error);
    contact->fragment_capacity = (int32_t)wanted;
    return SHV_OK;
}

static void mark_fragments(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    const ShvSurfaceList *list = &contact->list;
    for (int32_t i = 0; i < bodies->fragment_count; i++)
        contact->fragments[i] = (ShvSurfaceFragment){.rigid = shv_bodies_coupled_body(bodies, i)};
    for (int32_t k = 0; k < list->crack_count; k++) {
        const int64_t facet = bodies->cohesive->facet[list->cracks[k].index];
        for (int side = 0; side < 2; side++) {
            const int32_t element = contact->model->adjacency.facet_elements[2 * facet + side];
            contact->fragments[bodies->state->element_fragment[element]].cracked = true;
        }
    }
    for (int32_t k = 0; k < list->facet_count; k++)
        if (list->facets[k].crack) contact->fragments[list->facets[k].fragment].cracked = true;
}

static ShvStatus rebuild(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, bool changed, double step,
                         ShvError *error)
{
    const ShvState *state = bodies->state;
    contact->candidates[0].count = contact->candidates[1].count = contact->watched_count = 0;
    contact->nodes_out_of_skin.count = contact->facets_out_of_skin.count = 0;
    SHV_TRY(shv_surface_reserve_fragments(contact, bodies->fragment_count, error));
    for (int32_t k = 0; k < contact->list.node_count; k++) {
        contact->list.nodes[k].watch = -1;
        contact->list.nodes[k].out_of_skin = contact->list.nodes[k].incomplete = false;
    }
    contact->incomplete = false;
    if (changed)
        SHV_TRY(shv_surface_list_build(&contact->list, bodies, error));
    else {
        SHV_TRY(shv_surface_list_part(&contact->list, bodies, error));
        shv_surface_list_measure(&contact->list, bodies);
    }
    mark_fragments(contact, bodies);
    shv_surface_speed_choose(contact, bodies, state->last_step > 0.0 ? state->last_step : step);
    SHV_TRY(shv_surface_fill_grids(contact, bodies, error));
    for (int32_t k = 0; k < contact->list.facet_count; k++)
        SHV_TRY(shv_surface_pair_facet(contact, bodies, &contact->list.facets[k], error));
    for (int32_t k = 0; k < contact->list.facet_count; k++) shv_surface_edges_mark(&contact->list, bodies, k);
    for (int32_t k = 0; k < contact->list.facet_count; k++) SHV_TRY(shv_surface_pair_edges(contact, bodies, k, error));
    for (int32_t k = 0; bodies->obstacles && k < bodies->obstacles->count; k++)
        SHV_TRY(shv_surface_pair_obstacle(contact, bodies, k, error));
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
    for (int32_t k = nodes; k < list->node_count; k++) shv_surface_speed_node(contact, bodies, &list->nodes[k], step);
    for (int32_t k = facets; k < list->facet_count; k++) shv_surface_speed_facet(contact, bodies, &list->facets[k]);
    for (int32_t k = nodes; k < list->node_count; k++)
        SHV_TRY(shv_surface_pair_late_node(contact, bodies, k, facets, error));
    for (int32_t k = facets; k < list->facet_count; k++) {
        SHV_TRY(shv_surface_pair_late_facet(contact, bodies, &list->facets[k], error));
        shv_surface_edges_mark(list, bodies, k);
        SHV_TRY(shv_surface_pair_late_edges(contact, bodies, k, k, error));
    }
    return SHV_OK;
}

static ShvStatus refresh(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step, double gravity,
                         ShvError *error)
{
    bool lost = contact->stale;
    contact->stale = true; /* until it is done */
    if (!lost && has_changed(contact, bodies)) SHV_TRY(shv_surface_follow(contact, bodies, &lost, error));
    const bool outdated = !lost && shv_surface_speed_count(contact, bodies, gravity);
    if (lost || outdated) return rebuild(contact, bodies, lost, step, error);
    SHV_TRY(add_late(contact, bodies, step, error));
    if (contact->rest > 0 && !contact->incomplete) return SHV_OK;
    bool many;
    SHV_TRY(shv_surface_renew_out_of_skin(contact, bodies, step, gravity, &many, error));
    return many ? rebuild(contact, bodies, false, step, error) : SHV_OK;
}

ShvStatus shv_surface_candidates_refresh(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step,
                                         double gravity, ShvError *error)
{
    const ShvCohesive *cohesive = bodies->cohesive;
    if (is_stale(contact, bodies)) {
        contact->stale = true;
        contact->idle = find_idle(bodies);
    }
    if (!contact->idle) SHV_TRY(refresh(contact, bodies, step, gravity, error));
    contact->seen_time = bodies->state->time;
    contact->known_nodes = bodies->state->node_count;
    contact->known_fragments = bodies->fragment_count;
    contact->known_cohesive = cohesive ? cohesive->count : 0;
    contact->known_live = cohesive ? cohesive->live_count : 0;
    contact->stale = contact->woken = false;
    return SHV_OK;
}
