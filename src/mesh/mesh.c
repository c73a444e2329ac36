#include "mesh/mesh.h"

#include <string.h>

#include "mesh/scan.h"

const uint8_t shv_face_corners[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

ShvStatus shv_mesh_allocate(ShvMesh *mesh, ShvMemory *memory, int64_t node_count, int64_t element_count,
                            ShvError *error)
{
    *mesh = (ShvMesh){0};
    if (node_count < 0 || element_count < 0 || node_count > SHV_MESH_LARGEST || element_count > SHV_MESH_LARGEST)
        return shv_fail(error, SHV_BAD_INPUT,
                        "a mesh of %lld nodes and %lld elements is too large: at most %lld of each are possible; use "
                        "longer edges",
                        (long long)node_count, (long long)element_count, (long long)SHV_MESH_LARGEST);
    ShvMesh made = {.memory = memory, .node_count = (int32_t)node_count, .element_count = (int32_t)element_count};
    made.positions = shv_allocate(memory, SHV_PART_MESH, 3 * (size_t)node_count, sizeof *made.positions);
    made.elements = shv_allocate(memory, SHV_PART_MESH, 4 * (size_t)element_count, sizeof *made.elements);
    if (!made.positions || !made.elements) {
        shv_mesh_release(&made);
        return shv_fail_memory(error, "a mesh",
                               3 * (size_t)node_count * sizeof(double) + 4 * (size_t)element_count * sizeof(int32_t));
    }
    *mesh = made;
    return SHV_OK;
}

void shv_mesh_release(ShvMesh *mesh)
{
    shv_release(mesh->positions);
    shv_release(mesh->elements);
    shv_release(mesh->element_groups);
    shv_release(mesh->groups);
    *mesh = (ShvMesh){0};
}

ShvStatus shv_mesh_add_groups(ShvMesh *mesh, ShvError *error)
{
    const size_t count = (size_t)mesh->element_count, size = sizeof *mesh->element_groups;
    mesh->element_groups = shv_allocate(mesh->memory, SHV_PART_MESH, count, size);
    return mesh->element_groups ? SHV_OK : shv_fail_memory(error, "the groups of a mesh", count * size);
}

int32_t shv_mesh_find_group(const ShvMesh *mesh, const char *name)
{
    for (int32_t i = 0; i < mesh->group_count; i++)
        if (strcmp(mesh->groups[i].name, name) == 0) return mesh->groups[i].tag;
    int64_t tag = 0;
    if (!shv_word_whole((ShvWord){name, name + strlen(name)}, &tag)) return 0;
    for (int32_t e = 0; mesh->element_groups && e < mesh->element_count; e++)
        if (mesh->element_groups[e] == tag) return (int32_t)tag;
    return 0;
}

double shv_mesh_element_volume(const ShvMesh *mesh, int32_t element)
{
    const int32_t *n = mesh->elements + 4 * (int64_t)element;
    const ShvVec3 origin = shv_mesh_position(mesh, n[0]);
    const ShvVec3 a = shv_sub(shv_mesh_position(mesh, n[1]), origin);
    const ShvVec3 b = shv_sub(shv_mesh_position(mesh, n[2]), origin);
    const ShvVec3 c = shv_sub(shv_mesh_position(mesh, n[3]), origin);
    return shv_dot(shv_cross(a, b), c) / 6.0;
}
