#include "mesh/freedom.h"

#include "mesh/adjacency.h"

static bool is_same(ShvVec3 a, ShvVec3 b, double same)
{
    return shv_norm(shv_sub(a, b)) < same;
}

/* Takes in the plane of one more facet at a node. Opposite normals fix it: they meet at the front of a notch, which must
   not move, and have no line in common. */
static void restrict_node(ShvFreedom *freedom, int32_t node, ShvVec3 normal, double same)
{
    double *known = freedom->normals + 6 * (int64_t)node;
    const int planes = freedom->kind[node];
    for (int p = 0; p < planes && p < 2; p++)
        if (is_same(shv_load3(known + 3 * p), normal, same)) return;
    if (planes == 1 && is_same(shv_load3(known), shv_scale(normal, -1.0), same)) freedom->kind[node] = SHV_FIXED;
    if (planes < 2) shv_store3(known + 3 * planes, normal);
    if (freedom->kind[node] < SHV_FIXED) freedom->kind[node]++;
}

/* Twice the area along the normal. */
static ShvVec3 area_of(const ShvMesh *mesh, const int32_t nodes[3])
{
    const ShvVec3 a = shv_mesh_position(mesh, nodes[0]);
    return shv_cross(shv_sub(shv_mesh_position(mesh, nodes[1]), a), shv_sub(shv_mesh_position(mesh, nodes[2]), a));
}

static void add_areas(const ShvFreedom *freedom, const int32_t nodes[3], ShvVec3 area, double same, double *sums)
{
    const ShvVec3 normal = shv_unit(area);
    for (int i = 0; i < 3; i++)
        for (int p = 0; p < 2 && p < freedom->kind[nodes[i]]; p++) {
            const int64_t at = 6 * (int64_t)nodes[i] + 3 * p;
            if (!is_same(shv_load3(freedom->normals + at), normal, same)) continue;
            shv_store3(sums + at, shv_add(shv_load3(sums + at), area));
            break;
        }
}

/* For each plane the mean over its facets in place of the first one's normal. */
static ShvStatus average(ShvFreedom *freedom, const ShvMesh *mesh, const int32_t *triangles, int32_t count, double same,
                         ShvError *error)
{
    const size_t planes = 2 * (size_t)mesh->node_count;
    double *sums = shv_allocate(mesh->memory, SHV_PART_GENERAL, 3 * planes, sizeof *sums);
    if (!sums) return shv_fail_memory(error, "planes of a surface", 24 * planes);
    for (int32_t t = 0; t < count; t++) {
        const int32_t *n = triangles + 3 * (int64_t)t;
        add_areas(freedom, n, area_of(mesh, n), same, sums);
    }
    for (size_t i = 0; i < planes; i++) shv_store3(freedom->normals + 3 * i, shv_unit(shv_load3(sums + 3 * i)));
    shv_release(sums);
    return SHV_OK;
}

ShvStatus shv_freedom_find(ShvFreedom *freedom, const ShvMesh *mesh, double same, bool mean, ShvError *error)
{
    const size_t nodes = (size_t)mesh->node_count;
    int32_t *triangles = NULL, count = 0;
    *freedom = (ShvFreedom){
        .kind = shv_allocate(mesh->memory, SHV_PART_GENERAL, nodes, sizeof *freedom->kind),
        .normals = shv_allocate(mesh->memory, SHV_PART_GENERAL, 6 * nodes, sizeof *freedom->normals),
    };
    if (!freedom->kind || !freedom->normals) return shv_fail_memory(error, "planes of a surface", 49 * nodes);
    SHV_TRY(shv_mesh_boundary(mesh, SHV_PART_GENERAL, &triangles, &count, error));
    for (int32_t t = 0; t < count; t++) {
        const int32_t *n = triangles + 3 * (int64_t)t;
        const ShvVec3 normal = shv_unit(area_of(mesh, n));
        for (int i = 0; i < 3; i++) restrict_node(freedom, n[i], normal, same);
    }
    const ShvStatus status = mean ? average(freedom, mesh, triangles, count, same, error) : SHV_OK;
    shv_release(triangles);
    return status;
}

void shv_freedom_release(ShvFreedom *freedom)
{
    shv_release(freedom->kind);
    shv_release(freedom->normals);
    *freedom = (ShvFreedom){0};
}

ShvVec3 shv_freedom_shift(const ShvFreedom *freedom, int32_t node, ShvVec3 shift)
{
    const ShvVec3 first = shv_load3(freedom->normals + 6 * (int64_t)node);
    const ShvVec3 second = shv_load3(freedom->normals + 6 * (int64_t)node + 3);
    switch ((ShvFreedomKind)freedom->kind[node]) {
    case SHV_FREE:
        return shift;
    case SHV_IN_PLANE:
        return shv_madd(shift, -shv_dot(shift, first), first);
    case SHV_ON_LINE: {
        const ShvVec3 line = shv_unit(shv_cross(first, second));
        return shv_scale(line, shv_dot(shift, line));
    }
    case SHV_FIXED:
        break;
    }
    return shv_vec3(0.0, 0.0, 0.0);
}
