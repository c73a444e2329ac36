#include "mesh/tet.h"

#include <stdbool.h>

/* Outward, as long as the area. */
static ShvVec3 face_normal(ShvVec3 a, ShvVec3 b, ShvVec3 c)
{
    return shv_scale(shv_cross(shv_sub(b, a), shv_sub(c, a)), 0.5);
}

double shv_tet_face_area(const ShvMesh *mesh, const int32_t nodes[4], int face)
{
    ShvVec3 x[3];
    for (int i = 0; i < 3; i++) x[i] = shv_mesh_position(mesh, nodes[shv_face_corners[face][i]]);
    return shv_norm(face_normal(x[0], x[1], x[2]));
}

ShvTet shv_tet_of_nodes(const ShvMesh *mesh, const int32_t nodes[4])
{
    ShvTet tet;
    for (int i = 0; i < 4; i++) tet.corners[i] = shv_mesh_position(mesh, nodes[i]);
    for (int k = 0; k < 4; k++) {
        const uint8_t *corner = shv_face_corners[k];
        tet.normals[k] = face_normal(tet.corners[corner[0]], tet.corners[corner[1]], tet.corners[corner[2]]);
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
