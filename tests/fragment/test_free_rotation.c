#include "check.h"

#include "fragment/free_rotation.h"
#include "rigid/world.h"

static ShvMat3 diagonal(double a, double b, double c)
{
    return (ShvMat3){{{a, 0.0, 0.0}, {0.0, b, 0.0}, {0.0, 0.0, c}}};
}

static double component(const ShvFreeRotation *rotation, ShvQuat q, ShvVec3 momentum, int axis)
{
    const ShvVec3 w = shv_rotate(shv_quat_conjugate(q), shv_free_rotation_velocity(rotation, q, momentum));
    return axis == 0 ? w.x : axis == 1 ? w.y : w.z;
}

/* A top with distinct moments flips at the zeros of an elliptic function: the middle component of its spin vanishes at
   10.917, 30.470 and 50.023 s. */
static void test_tumbling_top(void **state)
{
    (void)state;
    const ShvMat3 inertia = diagonal(1.0, 2.0, 3.0);
    const ShvFreeRotation rotation = shv_free_rotation_make(&inertia);
    ShvQuat q = shv_quat_identity();
    const ShvVec3 momentum = shv_free_rotation_momentum(&rotation, q, shv_vec3(0.01, 1.0, 0.01));
    const double energy = shv_free_rotation_energy(&rotation, q, momentum);
    const double flips[3] = {10.917, 30.470, 50.023};
    int found = 0;
    double before = 1.0;
    for (int step = 1; step <= 55000; step++) {
        q = shv_free_rotation_advance(&rotation, q, momentum, 1e-3);
        const double now = component(&rotation, q, momentum, 1);
        if (now * before < 0.0) {
            assert_true(found < 3);
            check_near((step - now / (now - before)) * 1e-3, flips[found++], 1e-3);
        }
        before = now;
        check_near(shv_free_rotation_energy(&rotation, q, momentum) / energy, 1.0, 1e-12);
        if (step % 1000 == 0) {
            const ShvVec3 spin = shv_free_rotation_velocity(&rotation, q, momentum);
            const ShvVec3 again = shv_free_rotation_momentum(&rotation, q, spin);
            check_near(shv_norm(shv_sub(again, momentum)), 0.0, 1e-14 * shv_norm(momentum));
        }
    }
    assert_int_equal(found, 3);
}

static double angle_between(ShvQuat a, ShvQuat b)
{
    const ShvQuat d = shv_quat_multiply(shv_quat_conjugate(a), b);
    return 2.0 * shv_norm(shv_vec3(d.x, d.y, d.z));
}

/* A symmetric top precesses uniformly: q(t) = exp(L t/I₁) q exp((1 − I₃/I₁) ω₃ t e₃). */
static void test_symmetric_top(void **state)
{
    (void)state;
    uint64_t index = 0;
    for (int trial = 0; trial < 50; trial++) {
        const double i1 = draw(&index, 0.5, 2.0), i3 = draw(&index, 0.1, 2.0 * i1), time = draw(&index, 0.1, 30.0);
        const ShvMat3 inertia = diagonal(i1, i1, i3);
        const ShvFreeRotation rotation = shv_free_rotation_make(&inertia);
        const ShvQuat q = draw_rotation(&index);
        const ShvVec3 spin = draw3(&index, 3.0);
        const ShvVec3 momentum = shv_free_rotation_momentum(&rotation, q, spin);
        const double own = shv_rotate(shv_quat_conjugate(q), spin).z;
        const ShvQuat precession = shv_quat_exponential(shv_scale(momentum, time / i1));
        const ShvQuat turn = shv_quat_exponential(shv_vec3(0.0, 0.0, (1.0 - i3 / i1) * own * time));
        const ShvQuat expected = shv_quat_multiply(precession, shv_quat_multiply(q, turn));
        const ShvQuat reached = shv_free_rotation_advance(&rotation, q, momentum, time);
        /* Round-off of a hundred-odd radians in some hundred substeps. */
        check_near(angle_between(reached, expected), 0.0, 1e-12);
    }
}

/* One step of any length equals many short ones: nothing depends on the step but round-off, which grows with the number
   of steps and, in a tumbling top, with the exponential growth of small differences. */
static void test_step_length_does_not_matter(void **state)
{
    (void)state;
    uint64_t index = 1000;
    for (int trial = 0; trial < 20; trial++) {
        const ShvVec3 a = draw3(&index, 1.0), b = draw3(&index, 1.0), c = draw3(&index, 1.0);
        ShvMat3 inertia = {{{0.0}}};
        const ShvVec3 points[3] = {a, b, c};
        for (int p = 0; p < 3; p++) {
            const double r[3] = {points[p].x, points[p].y, points[p].z};
            for (int i = 0; i < 3; i++)
                for (int j = 0; j < 3; j++)
                    inertia.m[i][j] += (i == j ? shv_dot(points[p], points[p]) : 0.0) - r[i] * r[j];
        }
        const ShvFreeRotation rotation = shv_free_rotation_make(&inertia);
        const ShvQuat start = draw_rotation(&index);
        const ShvVec3 momentum = shv_free_rotation_momentum(&rotation, start, draw3(&index, 2.0));
        ShvQuat steps = start;
        for (int step = 0; step < 500; step++) steps = shv_free_rotation_advance(&rotation, steps, momentum, 2e-3);
        const ShvQuat once = shv_free_rotation_advance(&rotation, start, momentum, 1.0);
        check_near(angle_between(steps, once), 0.0, 1e-11);
        const double energy = shv_free_rotation_energy(&rotation, start, momentum);
        check_near(shv_free_rotation_energy(&rotation, once, momentum), energy, 1e-13 * energy);
        const double bound = shv_free_rotation_fastest(&rotation, start, momentum);
        assert_true(shv_norm(shv_free_rotation_velocity(&rotation, once, momentum)) <= bound * (1.0 + 1e-12));
    }
}

static void test_no_inertia_no_rotation(void **state)
{
    (void)state;
    const ShvMat3 nothing = diagonal(0.0, 0.0, 0.0);
    const ShvFreeRotation rotation = shv_free_rotation_make(&nothing);
    const ShvQuat q = shv_free_rotation_advance(&rotation, shv_quat_identity(), shv_vec3(1.0, 2.0, 3.0), 1.0);
    assert_true(q.w == 1.0 && q.x == 0.0 && q.y == 0.0 && q.z == 0.0);
    assert_true(shv_free_rotation_fastest(&rotation, q, shv_vec3(1.0, 2.0, 3.0)) == 0.0);
}

/* A thin rod turns about L only; spin about its own line carries no momentum. */
static void test_rod(void **state)
{
    (void)state;
    const ShvMat3 inertia = diagonal(2.0, 0.0, 2.0);
    const ShvFreeRotation rotation = shv_free_rotation_make(&inertia);
    const ShvVec3 momentum = shv_free_rotation_momentum(&rotation, shv_quat_identity(), shv_vec3(0.3, 5.0, 0.4));
    check_near(shv_norm(shv_sub(momentum, shv_vec3(0.6, 0.0, 0.8))), 0.0, 1e-15);
    const ShvQuat q = shv_free_rotation_advance(&rotation, shv_quat_identity(), momentum, 10.0);
    check_near(angle_between(q, shv_quat_exponential(shv_vec3(3.0, 0.0, 4.0))), 0.0, 1e-13);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tumbling_top),
        cmocka_unit_test(test_symmetric_top),
        cmocka_unit_test(test_step_length_does_not_matter),
        cmocka_unit_test(test_no_inertia_no_rotation),
        cmocka_unit_test(test_rod),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
