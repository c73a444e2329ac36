/* Candidates go on while the mesh changes: what is split or wakes is where it was, so that what could soon meet still can, and
   nothing else. */
#include "contact/surface_candidates.h"

void shv_surface_mark_cracked(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t first)
{
    for (int32_t i = first; bodies->cohesive && i < bodies->cohesive->count; i++) {
        const int32_t *sides = contact->model->adjacency.facet_elements + 2 * (int64_t)bodies->cohesive->facet[i];
        const int32_t fragment = bodies->state->element_fragment[sides[0]];
        if (fragment != bodies->state->element_fragment[sides[1]] || contact->fragments[fragment].cracked) continue;
        contact->fragments[fragment].cracked = true;
        contact->fragments[fragment].opened = fragment < contact->known_fragments;
    }
}

/* The surfaces of a body without a crack were not candidates of one another: what leaves it looks for them. */
static ShvStatus split_whole_bodies(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvError *error)
{
    for (int32_t k = 0; k < contact->list.facet_count; k++) {
        const ShvSurfaceFacet *facet = &contact->list.facets[k];
        if (bodies->state->element_fragment[facet->element] == facet->fragment ||
            contact->fragments[facet->fragment].cracked)
            continue;
        for (int i = 0; i < 3; i++) SHV_TRY(shv_surface_list_mark_outdated(&contact->list, facet->slots[i], error));
    }
    return SHV_OK;
}

static bool has_woken(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, int32_t fragment)
{
    return contact->fragments[fragment].rigid && !shv_bodies_coupled_body(bodies, fragment);
}

/* Coupled bodies that have gone to sleep elsewhere. */
static bool any_left(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    for (int32_t i = 0; i < contact->known_fragments; i++)
        if (has_woken(contact, bodies, i) && !bodies->awake[i]) return true;
    return false;
}

/* What deforms now has other candidates than a rigid body. */
static void wake(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    for (int32_t i = 0; i < contact->known_fragments; i++)
        if (has_woken(contact, bodies, i)) contact->fragments[i] = (ShvSurfaceFragment){.opened = true};
}

/* Bodies that have woken, or have their first crack, look for all that they may meet anew. */
static ShvStatus open_bodies(ShvSurfaceContact *contact, ShvError *error)
{
    bool any = false;
    for (int32_t i = 0; i < contact->known_fragments; i++) any |= contact->fragments[i].opened;
    for (int32_t k = 0; k < contact->list.node_count && any; k++)
        if (contact->fragments[contact->list.nodes[k].fragment].opened)
            SHV_TRY(shv_surface_list_mark_outdated(&contact->list, k, error));
    for (int32_t i = 0; i < contact->known_fragments && any; i++) contact->fragments[i].opened = false;
    return SHV_OK;
}

ShvStatus shv_surface_follow(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, bool *lost, ShvError *error)
{
    const ShvSurfaceKnown known = {contact->known_nodes, contact->known_cohesive, contact->known_fragments};
    const bool renamed = known.fragments != bodies->fragment_count;
    const bool inserted = bodies->cohesive && (renamed || known.nodes != bodies->state->node_count ||
                                               known.cohesive != bodies->cohesive->count);
    *lost = (!inserted && !contact->woken) || (contact->woken && any_left(contact, bodies));
    if (*lost) return SHV_OK;
    if (renamed) SHV_TRY(split_whole_bodies(contact, bodies, error));
    if (inserted) SHV_TRY(shv_surface_list_follow(&contact->list, bodies, known, error));
    SHV_RESERVE(contact->memory, SHV_PART_CONTACT, contact->fragments, contact->fragment_capacity,
                bodies->fragment_count, "contact", error);
    for (int32_t i = known.fragments; i < bodies->fragment_count; i++) contact->fragments[i] = (ShvSurfaceFragment){0};
    if (contact->woken) {
        wake(contact, bodies);
        SHV_TRY(shv_surface_list_inner(&contact->list, bodies, SHV_SURFACE_INNER * contact->size, error));
    }
    shv_surface_mark_cracked(contact, bodies, renamed || contact->woken ? 0 : known.cohesive);
    return open_bodies(contact, error);
}
