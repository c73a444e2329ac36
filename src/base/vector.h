/* 3-vectors, 3×3 matrices (row major) and unit quaternions (w, x, y, z) in double precision. Plain
   products and sums in one written order: contraction is off, so every processor gives the same bits. */
#ifndef SHV_BASE_VECTOR_H
#define SHV_BASE_VECTOR_H

#include <math.h>

typedef struct ShvVec3 {
    double x, y, z;
} ShvVec3;
typedef struct ShvMat3 {
    double m[3][3];
} ShvMat3;
typedef struct ShvQuat {
    double w, x, y, z;
} ShvQuat;

static inline ShvVec3 shv_vec3(double x, double y, double z)
{
    return (ShvVec3){x, y, z};
}
static inline ShvVec3 shv_load3(const double *p)
{
    return (ShvVec3){p[0], p[1], p[2]};
}
static inline void shv_store3(double *p, ShvVec3 a)
{
    p[0] = a.x;
    p[1] = a.y;
    p[2] = a.z;
}
static inline void shv_add_to3(double *p, ShvVec3 a)
{
    p[0] += a.x;
    p[1] += a.y;
    p[2] += a.z;
}
static inline ShvVec3 shv_add(ShvVec3 a, ShvVec3 b)
{
    return (ShvVec3){a.x + b.x, a.y + b.y, a.z + b.z};
}
static inline ShvVec3 shv_sub(ShvVec3 a, ShvVec3 b)
{
    return (ShvVec3){a.x - b.x, a.y - b.y, a.z - b.z};
}
static inline ShvVec3 shv_scale(ShvVec3 a, double s)
{
    return (ShvVec3){a.x * s, a.y * s, a.z * s};
}
/* a + s b */
static inline ShvVec3 shv_madd(ShvVec3 a, double s, ShvVec3 b)
{
    return (ShvVec3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}
static inline double shv_dot(ShvVec3 a, ShvVec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline ShvVec3 shv_cross(ShvVec3 a, ShvVec3 b)
{
    return (ShvVec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline double shv_norm(ShvVec3 a)
{
    return sqrt(shv_dot(a, a));
}
/* Unit vector, or zero for a zero vector. */
static inline ShvVec3 shv_unit(ShvVec3 a)
{
    const double n = shv_norm(a);
    return n > 0.0 ? shv_scale(a, 1.0 / n) : shv_vec3(0.0, 0.0, 0.0);
}
static inline int shv_same3(ShvVec3 a, ShvVec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}
static inline int shv_finite3(ShvVec3 a)
{
    return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}

static inline ShvMat3 shv_identity(void)
{
    return (ShvMat3){{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
}
static inline ShvVec3 shv_apply(const ShvMat3 *a, ShvVec3 v)
{
    return (ShvVec3){a->m[0][0] * v.x + a->m[0][1] * v.y + a->m[0][2] * v.z,
                     a->m[1][0] * v.x + a->m[1][1] * v.y + a->m[1][2] * v.z,
                     a->m[2][0] * v.x + a->m[2][1] * v.y + a->m[2][2] * v.z};
}
static inline ShvVec3 shv_apply_transposed(const ShvMat3 *a, ShvVec3 v)
{
    return (ShvVec3){a->m[0][0] * v.x + a->m[1][0] * v.y + a->m[2][0] * v.z,
                     a->m[0][1] * v.x + a->m[1][1] * v.y + a->m[2][1] * v.z,
                     a->m[0][2] * v.x + a->m[1][2] * v.y + a->m[2][2] * v.z};
}
static inline ShvMat3 shv_multiply(const ShvMat3 *a, const ShvMat3 *b)
{
    ShvMat3 c;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            c.m[i][j] = a->m[i][0] * b->m[0][j] + a->m[i][1] * b->m[1][j] + a->m[i][2] * b->m[2][j];
    return c;
}
static inline ShvMat3 shv_transpose(const ShvMat3 *a)
{
    ShvMat3 t;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) t.m[i][j] = a->m[j][i];
    return t;
}
static inline double shv_determinant(const ShvMat3 *a)
{
    return a->m[0][0] * (a->m[1][1] * a->m[2][2] - a->m[1][2] * a->m[2][1]) -
           a->m[0][1] * (a->m[1][0] * a->m[2][2] - a->m[1][2] * a->m[2][0]) +
           a->m[0][2] * (a->m[1][0] * a->m[2][1] - a->m[1][1] * a->m[2][0]);
}

static inline int shv_same_quat(ShvQuat a, ShvQuat b)
{
    return a.w == b.w && a.x == b.x && a.y == b.y && a.z == b.z;
}
static inline ShvQuat shv_quat_identity(void)
{
    return (ShvQuat){1.0, 0.0, 0.0, 0.0};
}
static inline ShvQuat shv_quat_multiply(ShvQuat a, ShvQuat b)
{
    return (ShvQuat){a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                     a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
static inline ShvQuat shv_quat_conjugate(ShvQuat q)
{
    return (ShvQuat){q.w, -q.x, -q.y, -q.z};
}
static inline ShvQuat shv_quat_unit(ShvQuat q)
{
    const double n = sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return n > 0.0 ? (ShvQuat){q.w / n, q.x / n, q.y / n, q.z / n} : shv_quat_identity();
}
static inline ShvVec3 shv_rotate(ShvQuat q, ShvVec3 v)
{
    const ShvVec3 u = {q.x, q.y, q.z};
    const ShvVec3 t = shv_scale(shv_cross(u, v), 2.0);
    return shv_add(shv_madd(v, q.w, t), shv_cross(u, t));
}

/* Where a point of a body is: it lay at `point` when the body's centre lay at `centre`, unturned, which is at `position` now,
   turned by `orientation` (w, x, y, z). */
static inline ShvVec3 shv_pose_point(const double *position, const double *orientation, const double *centre,
                                     const double *point)
{
    const ShvQuat turn = {orientation[0], orientation[1], orientation[2], orientation[3]};
    return shv_add(shv_load3(position), shv_rotate(turn, shv_sub(shv_load3(point), shv_load3(centre))));
}

/* Of the point of a rigid body at `arm` from the one that has `velocity`. */
static inline ShvVec3 shv_velocity_at(ShvVec3 velocity, ShvVec3 angular_velocity, ShvVec3 arm)
{
    return shv_add(velocity, shv_cross(angular_velocity, arm));
}

/* Symmetric matrix from its Voigt components xx, yy, zz, yz, xz, xy. */
static inline ShvMat3 shv_from_voigt(const double voigt[6])
{
    return (ShvMat3){{{voigt[0], voigt[5], voigt[4]}, {voigt[5], voigt[1], voigt[3]}, {voigt[4], voigt[3], voigt[2]}}};
}

/* linear.c */
/* Inverse of a; returns 0 and leaves `inverse` alone when the determinant is zero or not finite. */
int shv_invert(const ShvMat3 *a, ShvMat3 *inverse);
/* Eigenvalues (ascending) and, when `vectors` is not NULL, unit eigenvectors in its columns (right handed) of a
   symmetric matrix, by cyclic Jacobi rotations. */
void shv_symmetric_eigen(const ShvMat3 *a, double values[3], ShvMat3 *vectors);
/* Largest eigenvalue of the symmetric matrix (xx, yy, zz, yz, xz, xy), closed form without library trigonometry
   of processor-dependent bits. */
double shv_largest_principal(const double voigt[6]);
/* Pseudo-inverse of a symmetric positive semidefinite matrix: eigenvalues below `relative` × largest count as zero. */
ShvMat3 shv_symmetric_pseudo_inverse(const ShvMat3 *a, double relative);
/* Rotation closest to a (polar factor; proper, determinant +1). */
ShvMat3 shv_polar_rotation(const ShvMat3 *a);
ShvQuat shv_quat_from_matrix(const ShvMat3 *rotation);
ShvMat3 shv_quat_to_matrix(ShvQuat q);
ShvQuat shv_quat_from_axis_angle(ShvVec3 axis, double angle_radians);
/* exp of a rotation vector: the rotation by |w| about w/|w|. */
ShvQuat shv_quat_exponential(ShvVec3 rotation_vector);

#endif
