#include "mesh/mesh.h"

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
    ShvMesh made = {memory, (int32_t)node_count, (int32_t)element_count, NULL, NULL};
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
    *mesh = (ShvMesh){0};
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
