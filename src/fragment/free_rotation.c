#include "fragment/free_rotation.h"

enum { TERMS = 48 };
static const double largest_angle = 0.25; /* rad of one substep */
static const double negligible =
    1e-19; /* a term that cannot change a quaternion, with margin for the sum of the rest */

ShvFreeRotation shv_free_rotation_make(const ShvMat3 *inertia)
{
    ShvFreeRotation rotation;
    shv_symmetric_eigen(inertia, rotation.moment, &rotation.axes);
    for (int i = 0; i < 3; i++) {
        const int solid = rotation.moment[i] > 1e-13 * rotation.moment[2];
        if (!solid) rotation.moment[i] = 0.0;
        rotation.inverse[i] = solid ? 1.0 / rotation.moment[i] : 0.0;
    }
    rotation.growth = 1.0;
    for (int i = 0; i < 3; i++) {
        rotation.rate[i] = (rotation.moment[(i + 1) % 3] - rotation.moment[(i + 2) % 3]) * rotation.inverse[i];
        rotation.growth = fmax(rotation.growth, fabs(rotation.rate[i]));
    }
    return rotation;
}

static ShvVec3 to_principal(const ShvFreeRotation *rotation, ShvQuat orientation, ShvVec3 world)
{
    return shv_apply_transposed(&rotation->axes, shv_rotate(shv_quat_conjugate(orientation), world));
}

static ShvVec3 from_principal(const ShvFreeRotation *rotation, ShvQuat orientation, ShvVec3 principal)
{
    return shv_rotate(orientation, shv_apply(&rotation->axes, principal));
}

static ShvVec3 times(ShvVec3 a, const double factor[3])
{
    return shv_vec3(a.x * factor[0], a.y * factor[1], a.z * factor[2]);
}

ShvVec3 shv_free_rotation_velocity(const ShvFreeRotation *rotation, ShvQuat orientation, ShvVec3 angular_momentum)
{
    return from_principal(rotation, orientation,
                          times(to_principal(rotation, orientation, angular_momentum), rotation->inverse));
}

ShvVec3 shv_free_rotation_momentum(const ShvFreeRotation *rotation, ShvQuat orientation, ShvVec3 angular_velocity)
{
    return from_principal(rotation, orientation,
                          times(to_principal(rotation, orientation, angular_velocity), rotation->moment));
}

double shv_free_rotation_energy(const ShvFreeRotation *rotation, ShvQuat orientation, ShvVec3 angular_momentum)
{
    const ShvVec3 l = to_principal(rotation, orientation, angular_momentum);
    return 0.5 * shv_dot(l, times(l, rotation->inverse));
}

double shv_free_rotation_fastest(const ShvFreeRotation *rotation, ShvQuat orientation, ShvVec3 angular_momentum)
{
    double inverse = 0.0;
    for (int i = 0; i < 3; i++) inverse = fmax(inverse, rotation->inverse[i]);
    /* |ω|² ≤ 2E/I_min and |ω| ≤ |L|/I_min, both constants of the motion */
    const double energy = shv_free_rotation_energy(rotation, orientation, angular_momentum);
    return fmin(sqrt(2.0 * energy * inverse), shv_norm(angular_momentum) * inverse);
}

ShvMat3 shv_free_rotation_world_inverse(const ShvFreeRotation *rotation, ShvQuat orientation)
{
    ShvVec3 axis[3];
    for (int k = 0; k < 3; k++)
        axis[k] =
            shv_rotate(orientation, shv_vec3(rotation->axes.m[0][k], rotation->axes.m[1][k], rotation->axes.m[2][k]));
    ShvMat3 result = {{{0.0}}};
    for (int k = 0; k < 3; k++) {
        const double a[3] = {axis[k].x, axis[k].y, axis[k].z};
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) result.m[i][j] += rotation->inverse[k] * a[i] * a[j];
    }
    return result;
}

/* Turn of the body over a substep, in principal axes, for w = ω × substep at its start. Both ω' = rate ω ω and
   q' = q ω/2 are quadratic, so the coefficients of their power series follow from each other by Cauchy products. */
static ShvQuat turn_of_substep(const ShvFreeRotation *rotation, ShvVec3 w)
{
    ShvVec3 velocity[TERMS];
    ShvQuat turn[TERMS], sum = shv_quat_identity();
    velocity[0] = w;
    turn[0] = shv_quat_identity();
    for (int k = 0; k + 1 < TERMS; k++) {
        double x = 0.0, y = 0.0, z = 0.0;
        ShvQuat t = {0.0, 0.0, 0.0, 0.0};
        for (int j = 0; j <= k; j++) {
            const ShvVec3 a = velocity[j], b = velocity[k - j];
            const ShvQuat q = turn[j];
            x += a.y * b.z;
            y += a.z * b.x;
            z += a.x * b.y;
            t.w -= q.x * b.x + q.y * b.y + q.z * b.z;
            t.x += q.w * b.x + q.y * b.z - q.z * b.y;
            t.y += q.w * b.y + q.z * b.x - q.x * b.z;
            t.z += q.w * b.z + q.x * b.y - q.y * b.x;
        }
        const double next = 1.0 / (k + 1), half = 0.5 * next;
        velocity[k + 1] =
            shv_vec3(rotation->rate[0] * x * next, rotation->rate[1] * y * next, rotation->rate[2] * z * next);
        turn[k + 1] = (ShvQuat){t.w * half, t.x * half, t.y * half, t.z * half};
        sum = (ShvQuat){sum.w + turn[k + 1].w, sum.x + turn[k + 1].x, sum.y + turn[k + 1].y, sum.z + turn[k + 1].z};
        if (fabs(t.w) + fabs(t.x) + fabs(t.y) + fabs(t.z) < negligible) break;
    }
    return sum;
}

ShvQuat shv_free_rotation_advance(const ShvFreeRotation *rotation, ShvQuat orientation, ShvVec3 angular_momentum,
                                  double step)
{
    double left = step;
    while (left > 0.0) {
        const ShvVec3 omega = times(to_principal(rotation, orientation, angular_momentum), rotation->inverse);
        const double angle = shv_norm(omega) * rotation->growth * left;
        if (!(angle > 0.0 && angle <= 2.0 * rotation->growth * SHV_LARGEST_ROTATION)) return orientation;
        const double substep = angle <= largest_angle ? left : left / ceil(angle / largest_angle);
        const ShvQuat turn = turn_of_substep(rotation, shv_scale(omega, substep));
        const ShvVec3 axis = shv_apply(&rotation->axes, shv_vec3(turn.x, turn.y, turn.z));
        orientation = shv_quat_unit(shv_quat_multiply(orientation, (ShvQuat){turn.w, axis.x, axis.y, axis.z}));
        left = angle <= largest_angle ? 0.0 : left - substep;
    }
    return orientation;
}
