/* Rotations of eight elements at once: the quaternion of the rotation nearest to F is the eigenvector of the largest
   eigenvalue of a symmetric 4 × 4 matrix (Horn, J. Opt. Soc. Am. A 4, 1987). It needs no inverse, is a proper rotation
   for every F, inverted elements too, and is exactly the identity when F is. */
#ifndef SHV_SOLID_POLAR_H
#define SHV_SOLID_POLAR_H

#include "base/simd.h"

/* Newton steps to the eigenvalue: two or three near a rotation, all of them only where the rotation is not defined. */
enum { SHV_POLAR_STEPS = 20 };

/* a d − b c */
static inline ShvWide shv_wide_minor(ShvWide a, ShvWide b, ShvWide c, ShvWide d)
{
    return shv_wide_fnma(b, c, shv_wide_mul(a, d));
}

/* a x − b y + c z */
static inline ShvWide shv_wide_alternate(ShvWide a, ShvWide x, ShvWide b, ShvWide y, ShvWide c, ShvWide z)
{
    return shv_wide_fma(c, z, shv_wide_fnma(b, y, shv_wide_mul(a, x)));
}

/* Cofactors (inverse transposed times determinant); returns the determinant. */
static inline ShvWide shv_wide_cofactors(ShvWide f[3][3], ShvWide c[3][3])
{
    for (int i = 0; i < 3; i++) {
        const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (int j = 0; j < 3; j++) {
            const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            c[i][j] = shv_wide_minor(f[i1][j1], f[i1][j2], f[i2][j1], f[i2][j2]);
        }
    }
    return shv_wide_fma(f[0][2], c[0][2], shv_wide_fma(f[0][1], c[0][1], shv_wide_mul(f[0][0], c[0][0])));
}

static inline ShvWide shv_wide_squared_norm(ShvWide f[3][3])
{
    ShvWide sum = shv_wide_mul(f[0][0], f[0][0]);
    for (int k = 1; k < 9; k++) sum = shv_wide_fma(f[k / 3][k % 3], f[k / 3][k % 3], sum);
    return sum;
}

/* The eigenvalue s₁+s₂+s₃ (singular values, the last with the sign of det F): largest root of the characteristic
   polynomial λ⁴ − 2|F|²λ² − 8 det F λ + |F|⁴ − 4|cof F|². All roots are real, so Newton steps from above, from
   √3 |F|, come down without overshoot. A lane stops for itself: its bits do not depend on the lanes beside it. */
static inline ShvWide shv_wide_rotation_eigenvalue(ShvWide f[3][3])
{
    ShvWide cofactors[3][3];
    const ShvWide norm = shv_wide_squared_norm(f), four = shv_wide_set1(4.0);
    const ShvWide linear = shv_wide_mul(shv_wide_set1(8.0), shv_wide_cofactors(f, cofactors));
    const ShvWide constant = shv_wide_fnma(four, shv_wide_squared_norm(cofactors), shv_wide_mul(norm, norm));
    const ShvWide twice_norm = shv_wide_add(norm, norm), rounding = shv_wide_set1(4e-16);
    /* The floor keeps a collapsed element (F = 0) away from 0/0. */
    ShvWide root = shv_wide_max(shv_wide_set1(1e-50), shv_wide_sqrt(shv_wide_mul(shv_wide_set1(3.0), norm)));
    for (int step = 0; step < SHV_POLAR_STEPS; step++) {
        const ShvWide square = shv_wide_mul(root, root);
        const ShvWide cubic = shv_wide_minor(shv_wide_sub(square, twice_norm), linear, shv_wide_set1(1.0), root);
        const ShvWide value = shv_wide_fma(cubic, root, constant);
        const ShvWide slope =
            shv_wide_minor(shv_wide_mul(four, shv_wide_sub(square, norm)), linear, shv_wide_set1(1.0), root);
        const ShvWide change = shv_wide_div(value, slope);
        const ShvWideMask moving = shv_wide_less(shv_wide_mul(rounding, root), change);
        if (!shv_wide_any(moving)) break;
        root = shv_wide_select(moving, shv_wide_sub(root, change), root);
    }
    return root;
}

/* q := candidate where its own component is the larger one in magnitude. */
static inline void shv_wide_take_larger(ShvWide q[4], ShvWide *largest, const ShvWide candidate[4], int own)
{
    const ShvWide size = shv_wide_max(candidate[own], shv_wide_sub(shv_wide_zero(), candidate[own]));
    const ShvWideMask larger = shv_wide_less(*largest, size);
    for (int i = 0; i < 4; i++) q[i] = shv_wide_select(larger, candidate[i], q[i]);
    *largest = shv_wide_select(larger, size, *largest);
}

/* Null vector of the symmetric matrix m of rank 3: the column of its adjugate, which is a multiple of q qᵀ, with the
   largest diagonal entry. Not normalised. */
static inline void shv_wide_null_vector(ShvWide m[4][4], ShvWide q[4])
{
    const ShvWide s0 = shv_wide_minor(m[0][0], m[0][1], m[0][1], m[1][1]);
    const ShvWide s1 = shv_wide_minor(m[0][0], m[0][1], m[0][2], m[1][2]);
    const ShvWide s2 = shv_wide_minor(m[0][0], m[0][1], m[0][3], m[1][3]);
    const ShvWide s3 = shv_wide_minor(m[0][1], m[0][2], m[1][1], m[1][2]);
    const ShvWide s4 = shv_wide_minor(m[0][1], m[1][1], m[0][3], m[1][3]);
    const ShvWide s5 = shv_wide_minor(m[0][2], m[1][2], m[0][3], m[1][3]);
    const ShvWide c1 = shv_wide_minor(m[0][2], m[2][2], m[0][3], m[2][3]);
    const ShvWide c2 = shv_wide_minor(m[0][2], m[2][3], m[0][3], m[3][3]);
    const ShvWide c3 = shv_wide_minor(m[1][2], m[2][2], m[1][3], m[2][3]);
    const ShvWide c4 = shv_wide_minor(m[1][2], m[2][3], m[1][3], m[3][3]);
    const ShvWide c5 = shv_wide_minor(m[2][2], m[2][3], m[2][3], m[3][3]);
    const ShvWide a01 = shv_wide_sub(shv_wide_zero(), shv_wide_alternate(m[0][1], c5, m[0][2], c4, m[0][3], c3));
    const ShvWide a02 = shv_wide_alternate(m[1][3], s5, m[2][3], s4, m[3][3], s3);
    const ShvWide a03 = shv_wide_sub(shv_wide_zero(), shv_wide_alternate(m[1][2], s5, m[2][2], s4, m[2][3], s3));
    const ShvWide a12 = shv_wide_sub(shv_wide_zero(), shv_wide_alternate(m[0][3], s5, m[2][3], s2, m[3][3], s1));
    const ShvWide a13 = shv_wide_alternate(m[0][2], s5, m[2][2], s2, m[2][3], s1);
    const ShvWide a23 = shv_wide_sub(shv_wide_zero(), shv_wide_alternate(m[0][2], s4, m[1][2], s2, m[2][3], s0));
    const ShvWide column[4][4] = {{shv_wide_alternate(m[1][1], c5, m[1][2], c4, m[1][3], c3), a01, a02, a03},
                                  {a01, shv_wide_alternate(m[0][0], c5, m[0][2], c2, m[0][3], c1), a12, a13},
                                  {a02, a12, shv_wide_alternate(m[0][3], s4, m[1][3], s2, m[3][3], s0), a23},
                                  {a03, a13, a23, shv_wide_alternate(m[0][2], s3, m[1][2], s1, m[2][2], s0)}};
    ShvWide largest = shv_wide_zero();
    for (int i = 0; i < 4; i++) q[i] = shv_wide_zero();
    for (int i = 0; i < 4; i++) shv_wide_take_larger(q, &largest, column[i], i);
}

/* Rotation minus identity from a quaternion of any length; a zero quaternion, left where no rotation is nearest, counts
   as the identity. */
static inline void shv_wide_turn(const ShvWide q[4], ShvWide k[3][3])
{
    const ShvWide ww = shv_wide_mul(q[0], q[0]), xx = shv_wide_mul(q[1], q[1]);
    const ShvWide yy = shv_wide_mul(q[2], q[2]), zz = shv_wide_mul(q[3], q[3]);
    const ShvWide norm = shv_wide_add(shv_wide_add(ww, xx), shv_wide_add(yy, zz));
    const ShvWide scale = shv_wide_div(shv_wide_set1(2.0), shv_wide_max(shv_wide_set1(1e-300), norm));
    const ShvWide diagonal[3] = {shv_wide_add(yy, zz), shv_wide_add(xx, zz), shv_wide_add(xx, yy)};
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        const ShvWide wl = shv_wide_mul(q[0], q[1 + l]), ij = shv_wide_mul(q[1 + i], q[1 + j]);
        k[i][i] = shv_wide_fnma(scale, diagonal[i], shv_wide_zero());
        k[i][j] = shv_wide_mul(scale, shv_wide_sub(ij, wl));
        k[j][i] = shv_wide_mul(scale, shv_wide_add(ij, wl));
    }
}

/* R − I of the rotation nearest to F = I + H. */
static inline void shv_wide_polar_turn(ShvWide h[3][3], ShvWide turn[3][3])
{
    ShvWide f[3][3], q[4];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) f[i][j] = i == j ? shv_wide_add(h[i][j], shv_wide_set1(1.0)) : h[i][j];
    const ShvWide root = shv_wide_rotation_eigenvalue(f);
    ShvWide m[4][4];
    m[0][0] = shv_wide_sub(shv_wide_add(f[0][0], shv_wide_add(f[1][1], f[2][2])), root);
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        m[0][1 + i] = shv_wide_sub(f[l][j], f[j][l]);
        m[1 + i][1 + i] = shv_wide_sub(shv_wide_sub(f[i][i], shv_wide_add(f[j][j], f[l][l])), root);
        m[1 + i][1 + j] = m[1 + j][1 + i] = shv_wide_add(f[i][j], f[j][i]);
    }
    shv_wide_null_vector(m, q);
    shv_wide_turn(q, turn);
}

#endif
