#include "mesh/hilbert.h"
#include "mesh/mesh.h"

#include <stdbool.h>
#include <string.h>

typedef struct Ranked {
    uint64_t key;
    int32_t element;
} Ranked;

enum { BITS = SHV_HILBERT_BITS, DIGIT = 12 /* bits sorted at a time: 5 passes of 60 */ };

/* Lower corner of the bounding box and cells per metre, the same along every axis so that the curve keeps its shape. */
static double curve_scale(const ShvMesh *mesh, ShvVec3 *low)
{
    ShvVec3 high = *low = shv_mesh_position(mesh, 0);
    for (int32_t n = 1; n < mesh->node_count; n++) {
        const ShvVec3 x = shv_mesh_position(mesh, n);
        *low = shv_vec3(fmin(low->x, x.x), fmin(low->y, x.y), fmin(low->z, x.z));
        high = shv_vec3(fmax(high.x, x.x), fmax(high.y, x.y), fmax(high.z, x.z));
    }
    const ShvVec3 size = shv_sub(high, *low);
    const double longest = fmax(size.x, fmax(size.y, size.z));
    return longest > 0.0 ? (double)((1u << BITS) - 1) / longest : 0.0;
}

static void rank_elements(const ShvMesh *mesh, Ranked *ranked)
{
    ShvVec3 low;
    const double scale = curve_scale(mesh, &low);
    for (int32_t e = 0; e < mesh->element_count; e++) {
        ShvVec3 sum = {0};
        for (int i = 0; i < 4; i++)
            sum = shv_add(sum, shv_sub(shv_mesh_position(mesh, mesh->elements[4 * (int64_t)e + i]), low));
        const ShvVec3 cell = shv_scale(sum, 0.25 * scale);
        ranked[e] = (Ranked){shv_hilbert_place((uint32_t[3]){(uint32_t)cell.x, (uint32_t)cell.y, (uint32_t)cell.z}), e};
    }
}

/* Stable counting sorts by digits, lowest first; the result lies in `from` when the number of passes is even and is
   copied there when it is odd. */
static void sort_by_key(Ranked *from, Ranked *to, int32_t count)
{
    Ranked *const result = from;
    for (int shift = 0; shift < 3 * BITS; shift += DIGIT) {
        int32_t start[(1 << DIGIT) + 1] = {0};
        for (int32_t i = 0; i < count; i++) start[(from[i].key >> shift & ((1u << DIGIT) - 1)) + 1]++;
        for (int d = 0; d < 1 << DIGIT; d++) start[d + 1] += start[d];
        for (int32_t i = 0; i < count; i++) to[start[from[i].key >> shift & ((1u << DIGIT) - 1)]++] = from[i];
        Ranked *const swap = from;
        from = to;
        to = swap;
    }
    if (from != result) memcpy(result, from, (size_t)count * sizeof *result);
}

/* Writes the mesh in its new order into `elements` and `positions`. new_of[old node] starts at zero. */
static void reorder(const ShvMesh *mesh, const Ranked *ranked, int32_t *new_of, ShvMesh *made, int32_t *old_nodes)
{
    int32_t used = 0;
    for (int32_t e = 0; e < mesh->element_count; e++)
        for (int i = 0; i < 4; i++) {
            const int32_t old = mesh->elements[4 * (int64_t)ranked[e].element + i];
            if (!new_of[old]) {
                shv_store3(made->positions + 3 * (int64_t)used, shv_mesh_position(mesh, old));
                if (old_nodes) old_nodes[used] = old;
                new_of[old] = ++used;
            }
            made->elements[4 * (int64_t)e + i] = new_of[old] - 1;
        }
}

ShvStatus shv_mesh_renumber(ShvMesh *mesh, int32_t *old_elements, int32_t *old_nodes, ShvError *error)
{
    const size_t elements = (size_t)mesh->element_count, nodes = (size_t)mesh->node_count;
    ShvMesh made;
    SHV_TRY(shv_mesh_allocate(&made, mesh->memory, mesh->node_count, mesh->element_count, error));
    Ranked *ranked = shv_allocate(mesh->memory, SHV_PART_GENERAL, 2 * elements, sizeof *ranked);
    int32_t *new_of = shv_allocate(mesh->memory, SHV_PART_GENERAL, nodes, sizeof *new_of);
    const bool complete = ranked && new_of && (!mesh->element_groups || shv_mesh_add_groups(&made, error) == SHV_OK);
    if (complete && mesh->element_count > 0) {
        rank_elements(mesh, ranked);
        sort_by_key(ranked, ranked + elements, mesh->element_count);
        reorder(mesh, ranked, new_of, &made, old_nodes);
        for (size_t e = 0; old_elements && e < elements; e++) old_elements[e] = ranked[e].element;
        for (size_t e = 0; made.element_groups && e < elements; e++)
            made.element_groups[e] = mesh->element_groups[ranked[e].element];
        made.groups = mesh->groups;
        made.group_count = mesh->group_count;
        mesh->groups = NULL;
        const ShvMesh old = *mesh;
        *mesh = made;
        made = old;
    }
    shv_mesh_release(&made);
    shv_release(ranked);
    shv_release(new_of);
    return complete ? SHV_OK
                    : shv_fail_memory(error, "the renumbering of a mesh", 2 * elements * sizeof *ranked + 4 * nodes);
}
