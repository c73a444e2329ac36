#include "mesh/tet.h"

#include <stdbool.h>

ShvTet shv_tet_of_nodes(const ShvMesh *mesh, const int32_t nodes[4])
{
    ShvTet tet;
    for (int i = 0; i < 4; i++) tet.corners[i] = shv_mesh_position(mesh, nodes[i]);
    for (int k = 0; k < 4; k++) {
        const ShvVec3 a = tet.corners[shv_face_corners[k][0]];
        const ShvVec3 b = shv_sub(tet.corners[shv_face_corners[k][1]], a);
        const ShvVec3 c = shv_sub(tet.corners[shv_face_corners[k][2]], a);
        tet.normals[k] = shv_scale(shv_cross(b, c), 0.5);
        tet.areas[k] = shv_norm(tet.normals[k]);
    }
    tet.volume = shv_dot(tet.normals[0], shv_sub(tet.corners[1], tet.corners[0])) / 3.0;
    return tet;
}

static double edge(const ShvTet *tet, int i, int j)
{
    return shv_norm(shv_sub(tet->corners[i], tet->corners[j]));
}

/* r = 3 V / ΣA, R = √((p+q+s)(p+q−s)(p−q+s)(q+s−p)) / (24 V) with p, q, s the products of opposite edges (Crelle). */
double shv_tet_aspect(const ShvTet *tet)
{
    const double p = edge(tet, 0, 1) * edge(tet, 2, 3), q = edge(tet, 0, 2) * edge(tet, 1, 3);
    const double s = edge(tet, 0, 3) * edge(tet, 1, 2);
    const double product = (p + q + s) * (p + q - s) * (p - q + s) * (q + s - p);
    const double area = tet->areas[0] + tet->areas[1] + tet->areas[2] + tet->areas[3];
    return product > 0.0 ? 216.0 * tet->volume * fabs(tet->volume) / (area * sqrt(product)) : 0.0;
}

void shv_tet_write(ShvMesh *mesh, int64_t element, const int32_t nodes[4])
{
    const bool right_handed = shv_tet_of_nodes(mesh, nodes).volume > 0.0;
    int32_t *n = mesh->elements + 4 * element;
    n[0] = nodes[0];
    n[1] = nodes[1];
    n[2] = nodes[right_handed ? 2 : 3];
    n[3] = nodes[right_handed ? 3 : 2];
}
