#include <float.h>

#include "base/deterministic.h"
#include "base/vector.h"

/* ---- small matrices ----------------------------------------------------------------------------------- */

/* Matrix of cofactors: inverse transposed times determinant. */
static ShvMat3 cofactors(const ShvMat3 *a)
{
    ShvMat3 c;
    for (int i = 0; i < 3; i++) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int j = 0; j < 3; j++) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            c.m[i][j] = a->m[i1][j1] * a->m[i2][j2] - a->m[i1][j2] * a->m[i2][j1];
        }
    }
    return c;
}

static double squared_norm(const ShvMat3 *a)
{
    double s = 0.0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) s += a->m[i][j] * a->m[i][j];
    return s;
}

static double largest_entry(const ShvMat3 *a)
{
    double largest = 0.0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) largest = fmax(largest, fabs(a->m[i][j]));
    return largest;
}

int shv_invert(const ShvMat3 *a, ShvMat3 *inverse)
{
    const double scale = 1.0 / shv_determinant(a);
    if (!isfinite(scale) || scale == 0.0) return 0;
    const ShvMat3 c = cofactors(a);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) inverse->m[i][j] = c.m[j][i] * scale;
    return 1;
}

/* ---- eigenvalues of symmetric matrices ---------------------------------------------------------------- */

enum { JACOBI_SWEEPS = 30 };

/* One Jacobi rotation that makes a[p][q] zero (Golub and Van Loan, Matrix Computations, 8.5). */
static void jacobi_rotate(int n, double a[4][4], double v[4][4], int p, int q)
{
    if (a[p][q] == 0.0) return;
    const double theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
    const double t = (theta < 0.0 ? -1.0 : 1.0) / (fabs(theta) + sqrt(theta * theta + 1.0));
    const double c = 1.0 / sqrt(t * t + 1.0), s = t * c, shift = t * a[p][q];
    a[p][p] -= shift;
    a[q][q] += shift;
    a[p][q] = a[q][p] = 0.0;
    for (int r = 0; r < n; r++) {
        if (r != p && r != q) {
            const double x = a[r][p], y = a[r][q];
            a[r][p] = a[p][r] = c * x - s * y;
            a[r][q] = a[q][r] = s * x + c * y;
        }
        const double x = v[r][p], y = v[r][q];
        v[r][p] = c * x - s * y;
        v[r][q] = s * x + c * y;
    }
}

/* Turns the symmetric n × n matrix into its eigenvalues on the diagonal, eigenvectors in the columns of v. */
static void jacobi(int n, double a[4][4], double v[4][4])
{
    double norm = 0.0;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++) {
            v[i][j] = i == j ? 1.0 : 0.0;
            norm = fmax(norm, fabs(a[i][j]));
        }
    for (int sweep = 0; sweep < JACOBI_SWEEPS; sweep++) {
        double off = 0.0;
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++) off = fmax(off, fabs(a[p][q]));
        /* What is left out moves no eigenvalue, and no residual A v − λ v, by as much as a rounding. Further
           rotations would only add roundings of their own to the vectors. */
        if (!(off > 1e-18 * norm)) return;
        for (int p = 0; p < n; p++)
            for (int q = p + 1; q < n; q++) jacobi_rotate(n, a, v, p, q);
    }
}

static void swap_columns(double values[3], double v[4][4], int i, int j)
{
    const double value = values[i];
    values[i] = values[j];
    values[j] = value;
    for (int r = 0; r < 3; r++) {
        const double x = v[r][i];
        v[r][i] = v[r][j];
        v[r][j] = x;
    }
}

void shv_symmetric_eigen(const ShvMat3 *a, double values[3], ShvMat3 *vectors)
{
    double work[4][4] = {{0.0}}, v[4][4] = {{0.0}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) work[i][j] = a->m[i][j];
    jacobi(3, work, v);
    for (int i = 0; i < 3; i++) values[i] = work[i][i];
    if (values[1] < values[0]) swap_columns(values, v, 0, 1);
    if (values[2] < values[1]) swap_columns(values, v, 1, 2);
    if (values[1] < values[0]) swap_columns(values, v, 0, 1);
    if (!vectors) return;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) vectors->m[i][j] = v[i][j];
    if (shv_determinant(vectors) < 0.0)
        for (int i = 0; i < 3; i++) vectors->m[i][2] = -vectors->m[i][2];
}

ShvMat3 shv_symmetric_pseudo_inverse(const ShvMat3 *a, double relative)
{
    double values[3];
    ShvMat3 v, inverse = {{{0.0}}};
    shv_symmetric_eigen(a, values, &v);
    for (int k = 0; k < 3; k++) {
        if (!(values[k] > 0.0 && values[k] >= relative * values[2])) continue;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) inverse.m[i][j] += v.m[i][k] * v.m[j][k] / values[k];
    }
    return inverse;
}

/* ---- largest principal value -------------------------------------------------------------------------- */

/* cos(⅔ acos u) for 0 ≤ u ≤ 1. The function is analytic there (its nearest singularity is u = −1), so Chebyshev
   interpolation converges fast: degree 18 in 2u − 1, error below 3e-17. */
static double two_thirds_cosine(double u)
{
    static const double even[] = {0.76604444311897801,     -0.015509188436486424,   -0.0005041246911250438,
                                  -2.8919936440265828e-05, -2.0358689700992568e-06, -1.5954537531426307e-07,
                                  -1.334519367092948e-08,  -1.1880162409356414e-09, -9.1281742589280746e-11,
                                  -1.6089233320740645e-11};
    static const double odd[] = {0.24740906632285342,    0.0024663528150652356,  0.00011642545332376988,
                                 7.5410755286393022e-06, 5.6416444921452828e-07, 4.5826101529351644e-08,
                                 3.9822740378228916e-09, 3.0922539839713988e-10, 5.1178745156550326e-11};
    const double x = 2.0 * u - 1.0, z = x * x;
    double a = even[9], b = odd[8];
    for (int i = 8; i >= 0; i--) a = fma(a, z, even[i]);
    for (int i = 7; i >= 0; i--) b = fma(b, z, odd[i]);
    return fma(b, x, a);
}

static double square(double x)
{
    return x * x;
}

/* Discriminant (λ1−λ2)²(λ2−λ3)²(λ3−λ1)² of a deviatoric symmetric matrix b (xx, yy, zz, yz, xz, xy). It is the
   Gram determinant of I, B and B² (a product of Vandermonde matrices), hence, by Cauchy and Binet, a sum of squares
   of 3 × 3 minors: it has no cancellation left, however close two eigenvalues are. */
static double discriminant(const double b[6])
{
    const double c[6] = {b[0] * b[0] + b[5] * b[5] + b[4] * b[4],
                         b[5] * b[5] + b[1] * b[1] + b[3] * b[3],
                         b[4] * b[4] + b[3] * b[3] + b[2] * b[2],
                         b[5] * b[4] - b[0] * b[3],
                         b[5] * b[3] - b[1] * b[4],
                         b[4] * b[3] - b[2] * b[5]};
    double mixed = 0.0, shear = 0.0;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3;
        const double db = b[j] - b[i], dc = c[j] - c[i];
        for (int k = 3; k < 6; k++) mixed += square(db * c[k] - b[k] * dc);
        shear += square(b[3 + i] * c[3 + j] - b[3 + j] * c[3 + i]);
    }
    const double diagonal = (b[1] - b[0]) * (c[2] - c[0]) - (b[2] - b[0]) * (c[1] - c[0]);
    return square(diagonal) + 2.0 * mixed + 12.0 * shear;
}

/* Largest eigenvalue of a deviatoric matrix whose squares neither overflow nor vanish: 2 p cos(θ/3) with
   cos θ = det(B)/2, B = D/p, p² = |D|²/6. Near θ = π (the two largest values meet) cos θ alone would cost half of
   the digits; there cos(θ/2) comes from sin θ = √(discriminant/108). */
static double largest_of_deviator(const double d[6])
{
    const double p =
        sqrt((d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) / 6.0 + (d[3] * d[3] + d[4] * d[4] + d[5] * d[5]) / 3.0);
    const double scale = 1.0 / p;
    double b[6];
    for (int i = 0; i < 6; i++) b[i] = d[i] * scale;
    const double cosine = 0.5 * (b[0] * (b[1] * b[2] - b[3] * b[3]) - b[5] * (b[5] * b[2] - b[3] * b[4]) +
                                 b[4] * (b[5] * b[3] - b[1] * b[4]));
    const double half_cosine =
        cosine < 0.0 ? sqrt(discriminant(b) / 108.0) / sqrt(2.0 - 2.0 * cosine) : sqrt(0.5 + 0.5 * cosine);
    return 2.0 * p * two_thirds_cosine(half_cosine);
}

double shv_largest_principal(const double voigt[6])
{
    const double mean = (voigt[0] + voigt[1] + voigt[2]) / 3.0;
    double d[6] = {voigt[0] - mean, voigt[1] - mean, voigt[2] - mean, voigt[3], voigt[4], voigt[5]};
    double size = 0.0;
    for (int i = 0; i < 6; i++) size += fabs(d[i]);
    if (size == 0.0) return mean;
    if (!isfinite(size)) return (double)NAN;
    if (size > 1e-100 && size < 1e100) return mean + largest_of_deviator(d);
    int exponent;
    (void)frexp(size, &exponent);
    for (int i = 0; i < 6; i++) d[i] = ldexp(d[i], -exponent);
    return mean + ldexp(largest_of_deviator(d), exponent);
}

/* ---- rotations ---------------------------------------------------------------------------------------- */

/* Polar factor by scaled Newton steps X ← (g X + X⁻ᵀ/g)/2 (Higham, SIAM J. Sci. Stat. Comput. 7, 1986); quadratic,
   so a step below 1e-8 is the last. */
static ShvMat3 newton_rotation(ShvMat3 x)
{
    for (int step = 0; step < 50; step++) {
        ShvMat3 y = cofactors(&x);
        const double over_det = 1.0 / shv_determinant(&x);
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) y.m[i][j] *= over_det;
        const double g = sqrt(sqrt(squared_norm(&y) / squared_norm(&x)));
        double change = 0.0;
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) {
                const double next = 0.5 * (g * x.m[i][j] + y.m[i][j] / g);
                change = fmax(change, fabs(next - x.m[i][j]));
                x.m[i][j] = next;
            }
        if (!(change > 1e-8)) break;
    }
    return x;
}

/* Rotation that maximises trace(Rᵀ F), proper for every F: the eigenvector of the largest eigenvalue of a symmetric
   4 × 4 matrix is its quaternion (Horn, J. Opt. Soc. Am. A 4, 1987). */
static ShvMat3 quaternion_rotation(const ShvMat3 *f)
{
    const double xx = f->m[0][0], yy = f->m[1][1], zz = f->m[2][2];
    const double rx = f->m[2][1] - f->m[1][2], ry = f->m[0][2] - f->m[2][0], rz = f->m[1][0] - f->m[0][1];
    const double xy = f->m[0][1] + f->m[1][0], xz = f->m[0][2] + f->m[2][0], yz = f->m[1][2] + f->m[2][1];
    double n[4][4] = {
        {xx + yy + zz, rx, ry, rz}, {rx, xx - yy - zz, xy, xz}, {ry, xy, yy - xx - zz, yz}, {rz, xz, yz, zz - xx - yy}};
    double v[4][4];
    jacobi(4, n, v);
    int best = 0;
    for (int i = 1; i < 4; i++)
        if (n[i][i] > n[best][best]) best = i;
    return shv_quat_to_matrix(shv_quat_unit((ShvQuat){v[0][best], v[1][best], v[2][best], v[3][best]}));
}

ShvMat3 shv_polar_rotation(const ShvMat3 *a)
{
    const double largest = largest_entry(a);
    if (!(largest > 0.0)) return shv_identity();
    ShvMat3 f;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) f.m[i][j] = a->m[i][j] / largest;
    /* Nearly flat or inverted matrices go the slower way, which needs no inverse. */
    return shv_determinant(&f) > 1e-6 ? newton_rotation(f) : quaternion_rotation(&f);
}

/* From the largest of the four components, so that nothing small is divided by (Shepperd 1978). */
ShvQuat shv_quat_from_matrix(const ShvMat3 *rotation)
{
    const double(*m)[3] = rotation->m;
    const double trace = m[0][0] + m[1][1] + m[2][2];
    if (trace >= m[0][0] && trace >= m[1][1] && trace >= m[2][2])
        return shv_quat_unit((ShvQuat){1.0 + trace, m[2][1] - m[1][2], m[0][2] - m[2][0], m[1][0] - m[0][1]});
    int i = m[1][1] > m[0][0] ? 1 : 0;
    if (m[2][2] > m[i][i]) i = 2;
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    double v[3];
    v[i] = 1.0 + m[i][i] - m[j][j] - m[k][k];
    v[j] = m[i][j] + m[j][i];
    v[k] = m[i][k] + m[k][i];
    return shv_quat_unit((ShvQuat){m[k][j] - m[j][k], v[0], v[1], v[2]});
}

ShvMat3 shv_quat_to_matrix(ShvQuat q)
{
    const double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
    const double xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
    const double wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
    return (ShvMat3){{{1.0 - 2.0 * (yy + zz), 2.0 * (xy - wz), 2.0 * (xz + wy)},
                      {2.0 * (xy + wz), 1.0 - 2.0 * (xx + zz), 2.0 * (yz - wx)},
                      {2.0 * (xz - wy), 2.0 * (yz + wx), 1.0 - 2.0 * (xx + yy)}}};
}

ShvQuat shv_quat_from_axis_angle(ShvVec3 axis, double angle_radians)
{
    const ShvVec3 u = shv_unit(axis);
    if (shv_dot(u, u) == 0.0) return shv_quat_identity();
    const double s = shv_sin(0.5 * angle_radians);
    return (ShvQuat){shv_cos(0.5 * angle_radians), s * u.x, s * u.y, s * u.z};
}

ShvQuat shv_quat_exponential(ShvVec3 rotation_vector)
{
    const double angle = shv_norm(rotation_vector);
    /* A tiny vector, whose square may vanish: exp(w/2) = 1 + w/2 to all digits. */
    const double s = angle > 1e-100 ? shv_sin(0.5 * angle) / angle : 0.5;
    return (ShvQuat){shv_cos(0.5 * angle), s * rotation_vector.x, s * rotation_vector.y, s * rotation_vector.z};
}
