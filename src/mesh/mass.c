#include "mesh/mesh.h"

/* Σ V and Σ ∫x about `origin`. */
static void add_first_moments(const ShvMesh *mesh, ShvVec3 origin, double *volume, ShvVec3 *moment)
{
    for (int32_t e = 0; e < mesh->element_count; e++) {
        const double v = shv_mesh_element_volume(mesh, e);
        *volume += v;
        for (int i = 0; i < 4; i++) {
            const ShvVec3 x = shv_mesh_position(mesh, mesh->elements[4 * (int64_t)e + i]);
            *moment = shv_madd(*moment, 0.25 * v, shv_sub(x, origin));
        }
    }
}

/* ∫ x xᵀ over a tet with corners xᵢ is V/20 (Σ xᵢ xᵢᵀ + s sᵀ) with s = Σ xᵢ (exact for polynomials of degree two). */
static void add_second_moment(const ShvMesh *mesh, int32_t element, ShvVec3 centre, double moment[3][3])
{
    double x[5][3] = {{0.0}};
    for (int i = 0; i < 4; i++) {
        const int32_t node = mesh->elements[4 * (int64_t)element + i];
        shv_store3(x[i], shv_sub(shv_mesh_position(mesh, node), centre));
        for (int a = 0; a < 3; a++) x[4][a] += x[i][a];
    }
    const double weight = shv_mesh_element_volume(mesh, element) / 20.0;
    for (int a = 0; a < 3; a++)
        for (int b = a; b < 3; b++) {
            double sum = 0.0;
            for (int i = 0; i < 5; i++) sum += x[i][a] * x[i][b];
            moment[a][b] += weight * sum;
        }
}

ShvMassProperties shv_mesh_mass(const ShvMesh *mesh)
{
    ShvMassProperties mass = {0};
    if (mesh->element_count == 0) return mass;
    /* Moments about a node of the body first, then about the centre: no digits are lost when the body lies far from the
       origin. */
    const ShvVec3 origin = shv_mesh_position(mesh, mesh->elements[0]);
    ShvVec3 first = {0};
    add_first_moments(mesh, origin, &mass.mass, &first);
    mass.centre = shv_madd(origin, 1.0 / mass.mass, first);
    double m[3][3] = {{0.0}};
    for (int32_t e = 0; e < mesh->element_count; e++) add_second_moment(mesh, e, mass.centre, m);
    mass.inertia = (ShvMat3){{{m[1][1] + m[2][2], -m[0][1], -m[0][2]},
                              {-m[0][1], m[0][0] + m[2][2], -m[1][2]},
                              {-m[0][2], -m[1][2], m[0][0] + m[1][1]}}};
    return mass;
}
