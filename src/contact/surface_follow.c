/* Candidates go on while the mesh changes: what is split or wakes is where it was, so that what could soon meet still can, and
   nothing else. */
#include "contact/surface_candidates.h"

/* ---- bodies that crack ---- */

/* Whether a body that had no cracks, or was rigid, has some now: its own surfaces are not candidates of one another. */
static void note_crack(ShvSurfaceContact *contact, int32_t fragment)
{
    if (fragment >= contact->known_fragments) return;
    ShvSurfaceFragment *before = &contact->fragments[fragment];
    before->opened |= !before->cracked || before->rigid;
}

/* Before the list has followed. */
static void note_cracks(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies)
{
    const int32_t *fragment = bodies->state->element_fragment;
    for (int32_t k = 0; k < contact->list.facet_count && contact->known_fragments != bodies->fragment_count; k++) {
        const ShvSurfaceFacet *facet = &contact->list.facets[k];
        if (fragment[facet->element] != facet->fragment) note_crack(contact, facet->fragment);
    }
    for (int32_t i = contact->known_cohesive; i < bodies->cohesive->count; i++) {
        const int32_t *sides = contact->model->adjacency.facet_elements + 2 * (int64_t)bodies->cohesive->facet[i];
        note_crack(contact, fragment[sides[0]]);
        note_crack(contact, fragment[sides[1]]);
    }
}

/* Their nodes look for all that they may meet anew, under the fragments' names so far. */
static void open_bodies(ShvSurfaceContact *contact)
{
    bool any = false;
    for (int32_t i = 0; i < contact->known_fragments; i++) any |= contact->fragments[i].opened;
    for (int32_t k = 0; k < contact->list.node_count && any; k++)
        contact->list.nodes[k].incomplete |= contact->fragments[contact->list.nodes[k].fragment].opened;
    for (int32_t i = 0; i < contact->known_fragments && any; i++) {
        contact->fragments[i].cracked |= contact->fragments[i].opened;
        contact->fragments[i].opened = false;
    }
    contact->incomplete |= any;
}

/* ---- coupled bodies that woke ---- */

/* Both faces of an open crack belong to it: they may meet once it deforms. */
static bool opens_inside(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, const ShvSurfaceFacet *facet)
{
    const ShvAdjacency *adjacency = &contact->model->adjacency;
    if (!facet->crack) return false;
    const int32_t *sides =
        adjacency->facet_elements + 2 * adjacency->element_facets[4 * (int64_t)facet->element + facet->face];
    return bodies->state->element_fragment[sides[0]] == bodies->state->element_fragment[sides[1]];
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

/* Whether a candidate stays where it is: node_contact.h sees to obstacles now, and what deforms goes to the first list. */
static bool keeps(const ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies,
                  const ShvSurfaceCandidate *candidate, int kind)
{
    const bool woken = has_woken(contact, bodies, candidate->fragments[0]);
    if (candidate->element < 0) return !woken;
    return kind == 0 || !(woken || has_woken(contact, bodies, candidate->fragments[1]));
}

static ShvStatus wake(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvError *error)
{
    for (int kind = 1; kind >= 0; kind--) {
        ShvSurfaceCandidates *list = &contact->candidates[kind];
        int32_t kept = 0;
        for (int32_t k = 0; k < list->count; k++) {
            const ShvSurfaceCandidate candidate = list->items[k];
            if (keeps(contact, bodies, &candidate, kind)) {
                list->items[kept] = candidate;
                list->due[kept] = list->due[k];
                list->movers[kept++] = list->movers[k];
                if (kind == 0) SHV_TRY(shv_surface_candidate_watch(contact, bodies, &candidate, error));
            } else if (kind == 1) {
                SHV_TRY(shv_surface_candidate_append(contact, &contact->candidates[0], &candidate, list->due[k],
                                                     list->movers[k], error));
            }
        }
        list->count = kept;
    }
    for (int32_t k = 0; k < contact->list.facet_count; k++) {
        const ShvSurfaceFacet *facet = &contact->list.facets[k];
        if (has_woken(contact, bodies, facet->fragment) && opens_inside(contact, bodies, facet))
            contact->fragments[facet->fragment].opened = true;
    }
    for (int32_t k = 0; k < contact->list.facet_count; k++)
        if (has_woken(contact, bodies, contact->list.facets[k].fragment))
            SHV_TRY(shv_surface_pair_woken_edges(contact, bodies, k, error));
    for (int32_t i = 0; i < contact->known_fragments; i++)
        if (has_woken(contact, bodies, i)) contact->fragments[i].rigid = contact->fragments[i].cracked = false;
    return SHV_OK;
}

/* ---- insertions ---- */

/* What was split looks for all that it may meet anew. */
static ShvStatus follow_insertions(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, ShvError *error)
{
    const ShvSurfaceKnown known = {contact->known_nodes, contact->known_cohesive, contact->known_fragments};
    const bool renamed = known.fragments != bodies->fragment_count;
    SHV_TRY(shv_surface_reserve_fragments(contact, bodies->fragment_count, error));
    for (int32_t i = contact->known_fragments; i < bodies->fragment_count; i++)
        contact->fragments[i] = (ShvSurfaceFragment){.cracked = true};
    SHV_TRY(shv_surface_list_follow(&contact->list, bodies, known, error));
    contact->incomplete |= known.nodes != bodies->state->node_count;
    for (int kind = 0; kind < 2; kind++)
        for (int32_t k = 0; k < contact->candidates[kind].count && renamed; k++) {
            ShvSurfaceCandidate *candidate = &contact->candidates[kind].items[k];
            candidate->fragments[0] = contact->list.nodes[candidate->slot].fragment;
            if (candidate->facet >= 0) candidate->fragments[1] = contact->list.facets[candidate->facet].fragment;
        }
    return SHV_OK;
}

ShvStatus shv_surface_follow(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, bool *lost, ShvError *error)
{
    const bool inserted = bodies->cohesive && (contact->known_fragments != bodies->fragment_count ||
                                               contact->known_nodes != bodies->state->node_count ||
                                               contact->known_cohesive != bodies->cohesive->count);
    *lost = (!inserted && !contact->woken) || (contact->woken && any_left(contact, bodies));
    if (*lost) return SHV_OK;
    if (contact->woken) SHV_TRY(wake(contact, bodies, error));
    if (inserted) note_cracks(contact, bodies);
    open_bodies(contact);
    return inserted ? follow_insertions(contact, bodies, error) : SHV_OK;
}
