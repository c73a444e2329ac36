#include "convex/fragment_tets.h"

#include "base/deterministic.h"
#include "base/disjoint_sets.h"

ShvStatus shv_fragment_tets_allocate(ShvFragmentTets *tets, int32_t node_count, int32_t tet_count, ShvMemory *memory,
                                     ShvError *error)
{
    const size_t nodes = (size_t)node_count, count = (size_t)tet_count;
    *tets = (ShvFragmentTets){.node_count = node_count, .tet_count = tet_count};
    tets->positions = shv_allocate(memory, SHV_PART_RIGID, 3 * nodes, sizeof(double));
    tets->tets = shv_allocate(memory, SHV_PART_RIGID, 4 * count, sizeof(int32_t));
    tets->centroids = shv_allocate(memory, SHV_PART_RIGID, 4 * count, sizeof(double));
    if (tets->positions && tets->tets && tets->centroids) {
        tets->volumes = tets->centroids + 3 * count;
        return SHV_OK;
    }
    shv_fragment_tets_release(tets);
    return shv_fail_memory(error, "the tets of a fragment", 24 * nodes + 48 * count);
}

void shv_fragment_tet_corners(const ShvFragmentTets *tets, int32_t tet, ShvVec3 corners[4])
{
    for (int a = 0; a < 4; a++) corners[a] = shv_load3(tets->positions + 3 * (int64_t)tets->tets[4 * (int64_t)tet + a]);
}

static void measure(ShvFragmentTets *tets, int32_t tet)
{
    ShvVec3 x[4];
    shv_fragment_tet_corners(tets, tet, x);
    const ShvVec3 sum = shv_add(shv_add(x[0], x[1]), shv_add(x[2], x[3]));
    shv_store3(tets->centroids + 3 * (int64_t)tet, shv_scale(sum, 0.25));
    const double six = shv_dot(shv_sub(x[1], x[0]), shv_cross(shv_sub(x[2], x[0]), shv_sub(x[3], x[0])));
    tets->volumes[tet] = fabs(six) / 6.0; /* what is inside out fills space as well */
    tets->volume += tets->volumes[tet];
}

void shv_fragment_tets_measure(ShvFragmentTets *tets)
{
    tets->volume = 0.0;
    for (int32_t t = 0; t < tets->tet_count; t++) measure(tets, t);
    /* a regular tet of edge h has the volume h³ / (6 √2) */
    tets->edge = shv_cube_root(6.0 * sqrt(2.0) * tets->volume / tets->tet_count);
}

/* Copies of a node that bonds hold together are one node of the shape. Returns how many there are; each node's label is its
   number. */
static int32_t number_nodes(const ShvFragments *fragments, const ShvFragment *item)
{
    const int32_t *nodes = fragments->nodes + item->node_begin, *elements = fragments->elements + item->element_begin;
    int32_t *root = fragments->root, *label = fragments->label, count = 0;
    for (int32_t i = 0; i < item->node_count; i++) root[nodes[i]] = nodes[i];
    for (int32_t i = 0; i < 4 * item->element_count && fragments->bonds; i++) {
        const int32_t element = elements[i / 4];
        if (shv_fragments_bonded_neighbour(fragments, element, i % 4) < element) continue;
        const ShvCohesive *cohesive = fragments->bonds;
        const int32_t facet = cohesive->model->adjacency.element_facets[4 * (int64_t)element + i % 4];
        const ShvCohesiveSides *sides = &cohesive->sides[cohesive->facet_cohesive[facet]];
        for (int c = 0; c < 3; c++) shv_set_join(root, sides->first[c], sides->second[c]);
    }
    for (int32_t i = 0; i < item->node_count; i++) {
        const int32_t first = shv_set_root(root, nodes[i]);
        label[nodes[i]] = first == nodes[i] ? count++ : label[first];
    }
    return count;
}

ShvStatus shv_fragment_tets_make(ShvFragmentTets *tets, const ShvFragments *fragments, const ShvState *state,
                                 int32_t fragment, ShvError *error)
{
    const ShvFragment *item = &fragments->items[fragment];
    const int32_t *nodes = fragments->nodes + item->node_begin, *elements = fragments->elements + item->element_begin;
    const int32_t count = number_nodes(fragments, item);
    SHV_TRY(shv_fragment_tets_allocate(tets, count, item->element_count, fragments->memory, error));
    for (int32_t i = 0; i < item->node_count; i++)
        if (fragments->root[nodes[i]] == nodes[i])
            shv_store3(tets->positions + 3 * (int64_t)fragments->label[nodes[i]],
                       shv_fragment_shape_position(item, state, nodes[i]));
    for (int32_t t = 0; t < item->element_count; t++)
        for (int a = 0; a < 4; a++)
            tets->tets[4 * (int64_t)t + a] = fragments->label[shv_state_node(state, elements[t], a)];
    shv_fragment_tets_measure(tets);
    return SHV_OK;
}

void shv_fragment_tets_release(ShvFragmentTets *tets)
{
    shv_release(tets->positions);
    shv_release(tets->tets);
    shv_release(tets->centroids);
    *tets = (ShvFragmentTets){0};
}
