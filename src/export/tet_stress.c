#include "export/tet_stress.h"

#include <math.h>

#include "base/vector.h"

static ShvMat3 edges_of(const double corners[12])
{
    ShvMat3 edges;
    for (int row = 0; row < 3; row++)
        for (int k = 0; k < 3; k++) edges.m[row][k] = corners[3 * (k + 1) + row] - corners[row];
    return edges;
}

/* Of a matrix whose determinant is not zero: rows are cross products of columns (Cramer's rule). */
static ShvMat3 inverse_of(const ShvMat3 *a, double determinant)
{
    ShvMat3 inverse;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            const int r = (j + 1) % 3, s = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
            inverse.m[i][j] = (a->m[r][c] * a->m[s][d] - a->m[r][d] * a->m[s][c]) / determinant;
        }
    return inverse;
}

/* The trigonometric solution of the characteristic cubic. */
static double largest_eigenvalue(const ShvMat3 *a)
{
    const double mean = (a->m[0][0] + a->m[1][1] + a->m[2][2]) / 3.0;
    double squares = 0.0;
    ShvMat3 deviator = *a;
    for (int i = 0; i < 3; i++) deviator.m[i][i] -= mean;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) squares += deviator.m[i][j] * deviator.m[i][j];
    const double radius = sqrt(squares / 6.0);
    if (!(radius > 0.0)) return mean;
    const double cosine = 0.5 * shv_determinant(&deviator) / (radius * radius * radius);
    return mean + 2.0 * radius * cos(acos(fmin(1.0, fmax(-1.0, cosine))) / 3.0);
}

double shv_tet_stress(const double rest[12], const double now[12], ShvElasticity elasticity)
{
    const ShvMat3 still = edges_of(rest), moved = edges_of(now);
    const double volume = shv_determinant(&still);
    if (!(fabs(volume) > 0.0)) return (double)NAN;
    const ShvMat3 inverse = inverse_of(&still, volume), f = shv_multiply(&moved, &inverse), ft = shv_transpose(&f);
    const double ratio = shv_determinant(&f);
    if (!(ratio > 0.0)) return (double)NAN;
    const double nu = elasticity.poissons_ratio, mu = elasticity.youngs_modulus / (2.0 * (1.0 + nu));
    const double lambda = 2.0 * mu * nu / (1.0 - 2.0 * nu);
    ShvMat3 strain = shv_multiply(&ft, &f);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) strain.m[i][j] = 0.5 * (strain.m[i][j] - (i == j ? 1.0 : 0.0));
    const double trace = strain.m[0][0] + strain.m[1][1] + strain.m[2][2];
    ShvMat3 stress;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) stress.m[i][j] = 2.0 * mu * strain.m[i][j] + (i == j ? lambda * trace : 0.0);
    const ShvMat3 half = shv_multiply(&f, &stress);
    ShvMat3 cauchy = shv_multiply(&half, &ft);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) cauchy.m[i][j] /= ratio;
    return largest_eigenvalue(&cauchy);
}
