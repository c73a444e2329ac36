#include "shape/rotation.h"

#include <stdint.h>

#include "base/deterministic.h"

/* Energy ½ L_k²/I_k alone generates a rotation about axis k at the constant rate L_k/I_k: exact, and it keeps |L|. */
static void turn_about(int axis, const double moments[3], double step, double momentum[3], ShvQuat *orientation)
{
    const double angle = momentum[axis] / moments[axis] * step;
    const double half_sine = shv_sin(0.5 * angle), half_cosine = shv_cos(0.5 * angle);
    ShvQuat turn = {half_cosine, 0.0, 0.0, 0.0};
    *(axis == 0 ? &turn.x : axis == 1 ? &turn.y : &turn.z) = half_sine;
    *orientation = shv_quat_multiply(*orientation, turn);
    const ShvVec3 turned = shv_rotate(shv_quat_conjugate(turn), shv_load3(momentum));
    shv_store3(momentum, turned);
}

static int32_t parts_of(double turn)
{
    const double wanted = ceil(32.0 * turn);
    return wanted >= 4096.0 ? 4096 : wanted < 1.0 ? 1 : (int32_t)wanted;
}

void shv_rotate_free(ShvVec3 moments, ShvQuat axes, ShvQuat *orientation, ShvVec3 *angular_velocity, double step)
{
    const double inertia[3] = {moments.x, moments.y, moments.z};
    ShvQuat frame = shv_quat_multiply(*orientation, axes); /* principal → world */
    const ShvVec3 local = shv_rotate(shv_quat_conjugate(frame), *angular_velocity);
    double momentum[3] = {inertia[0] * local.x, inertia[1] * local.y, inertia[2] * local.z};
    const int32_t parts = parts_of(shv_norm(local) * fabs(step));
    const double h = step / parts;
    for (int32_t i = 0; i < parts; i++) {
        turn_about(0, inertia, 0.5 * h, momentum, &frame);
        turn_about(1, inertia, 0.5 * h, momentum, &frame);
        turn_about(2, inertia, h, momentum, &frame);
        turn_about(1, inertia, 0.5 * h, momentum, &frame);
        turn_about(0, inertia, 0.5 * h, momentum, &frame);
    }
    frame = shv_quat_unit(frame);
    *orientation = shv_quat_unit(shv_quat_multiply(frame, shv_quat_conjugate(axes)));
    *angular_velocity =
        shv_rotate(frame, shv_vec3(momentum[0] / inertia[0], momentum[1] / inertia[1], momentum[2] / inertia[2]));
}

ShvVec3 shv_rotation_between(ShvQuat from, ShvQuat to)
{
    ShvQuat turn = shv_quat_multiply(to, shv_quat_conjugate(from));
    if (turn.w < 0.0) turn = (ShvQuat){-turn.w, -turn.x, -turn.y, -turn.z};
    const ShvVec3 vector = {turn.x, turn.y, turn.z};
    const double sine = shv_norm(vector);
    if (sine < 1e-8) return shv_scale(vector, 2.0); /* sin(a/2) = a/2 to all digits */
    /* From the sine where it is small: the cosine of a small angle has lost its digits. */
    const double angle = sine < 0.7 ? 2.0 * (0.5 * SHV_PI - shv_acos(sine)) : 2.0 * shv_acos(fmin(turn.w, 1.0));
    return shv_scale(vector, angle / sine);
}
