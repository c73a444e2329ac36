#include "cohesive/topology.h"

#include <string.h>

#include "base/sorted.h"

int32_t shv_topology_find(const int32_t *corners, int32_t count, int32_t element)
{
    const int32_t place = shv_sorted_place(corners, count, 4 * element);
    return place < count && corners[place] / 4 == element ? place : -1;
}

/* Everything joined to one corner gets its label. The facets of an element that contain its corner k are those opposite
   its other corners. */
static void flood(ShvCohesive *cohesive, const int32_t *corners, int32_t count, int32_t seed, int32_t label)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    int32_t *labels = cohesive->corner_label, *queue = cohesive->corner_queue, length = 0;
    labels[seed] = label;
    queue[length++] = seed;
    for (int32_t head = 0; head < length; head++) {
        const int32_t element = corners[queue[head]] / 4, corner = corners[queue[head]] % 4;
        for (int32_t opposite = 0; opposite < 4; opposite++) {
            const int64_t facet = adjacency->element_facets[4 * (int64_t)element + opposite];
            if (opposite == corner || facet >= adjacency->interior_count || cohesive->facet_cohesive[facet] >= 0)
                continue;
            const int32_t *sides = adjacency->facet_elements + 2 * facet;
            const int32_t next = shv_topology_find(corners, count, sides[0] == element ? sides[1] : sides[0]);
            if (next < 0 || labels[next] >= 0) continue;
            labels[next] = label;
            queue[length++] = next;
        }
    }
}

int32_t shv_topology_groups(ShvCohesive *cohesive, const ShvState *state, int32_t node)
{
    const int32_t *corners = state->corners + state->corner_start[node];
    const int32_t count = state->corner_count[node];
    int32_t groups = 0;
    for (int32_t i = 0; i < count; i++) cohesive->corner_label[i] = -1;
    for (int32_t i = 0; i < count; i++)
        if (cohesive->corner_label[i] < 0) flood(cohesive, corners, count, i, groups++);
    return groups;
}

static void copy_node(ShvState *state, int32_t from, int32_t to)
{
#define COPY(type, name, components)                                                                                   \
    memcpy(state->name + (components) * (int64_t)to, state->name + (components) * (int64_t)from,                       \
           (components) * sizeof(type));
    SHV_NODE_ARRAYS(COPY)
#undef COPY
}

/* Summed afresh in corner order, as at the start: a mass never depends on the order of splits. */
static void own_corners(ShvState *state, int32_t node, int32_t start, int32_t count)
{
    double mass = 0.0;
    for (int32_t i = start; i < start + count; i++) {
        const int32_t element = state->corners[i] / 4, corner = state->corners[i] % 4;
        state->connectivity[shv_corner_slot(element, corner)] = node;
        mass += 0.25 * state->element_mass[element];
    }
    state->corner_start[node] = start;
    state->corner_count[node] = count;
    state->mass[node] = mass;
}

/* The last element's slots are repeated in the lanes that fill its batch. */
static void refresh_padding(ShvState *state)
{
    const int32_t last = state->element_count - 1;
    for (int32_t lane = state->element_count; lane < state->batch_count * SHV_LANES; lane++)
        for (int32_t corner = 0; corner < 4; corner++)
            state->connectivity[shv_corner_slot(lane, corner)] = shv_state_node(state, last, corner);
}

void shv_topology_split(ShvCohesive *cohesive, ShvState *state, int32_t node)
{
    const int32_t groups = shv_topology_groups(cohesive, state, node);
    if (groups < 2) return;
    const int32_t start = state->corner_start[node], count = state->corner_count[node];
    int32_t *corners = state->corners + start, next = start;
    memcpy(cohesive->corner_copy, corners, (size_t)count * sizeof *corners);
    for (int32_t group = 0; group < groups; group++) {
        const int32_t begin = next;
        for (int32_t i = 0; i < count; i++)
            if (cohesive->corner_label[i] == group) state->corners[next++] = cohesive->corner_copy[i];
        const int32_t own = group == 0 ? node : state->node_count++;
        if (group > 0) copy_node(state, node, own);
        own_corners(state, own, begin, next - begin);
    }
    refresh_padding(state);
}
