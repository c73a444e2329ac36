/* The free top against published flips, the period in closed form near the separatrix, and Euler's equations integrated in small
   steps. */
#include "check.h"

#include "base/random.h"
#include "evaluate/closed_form.h"

static ShvMat3 diagonal(double x, double y, double z)
{
    return (ShvMat3){{{x, 0.0, 0.0}, {0.0, y, 0.0}, {0.0, 0.0, z}}};
}

/* Spin about the middle axis, y, of a top with such inertia. */
static double middle_spin(ShvFreeTop top, double time)
{
    ShvQuat turned;
    ShvVec3 rate;
    shv_free_top_at(&top, time, &turned, &rate);
    return shv_rotate(shv_quat_conjugate(turned), rate).y;
}

/* Time at which the middle spin is zero, between two at which it has different signs. */
static double zero_between(const ShvFreeTop *top, double low, double high)
{
    const bool rises = middle_spin(*top, low) < 0.0;
    assert_true((middle_spin(*top, high) < 0.0) != rises);
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if ((middle_spin(*top, middle) < 0.0) == rises)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static void test_flips(void **state)
{
    (void)state;
    const ShvMat3 inertia = diagonal(1.0, 2.0, 3.0);
    const ShvFreeTop top = shv_free_top(&inertia, shv_quat_identity(), shv_vec3(0.01, 1.0, 0.01));
    /* Published to the millisecond. */
    const double first = zero_between(&top, 5.0, 15.0), second = zero_between(&top, 25.0, 35.0);
    check_near(first, 10.917, 5e-4);
    check_near(second, 30.470, 5e-4);
    check_near(zero_between(&top, 45.0, 55.0), 50.023, 5e-4);
    check_near(2.0 * (second - first), 39.1057, 5e-5);
    /* Near the separatrix a quarter of the period is K/p with K = ln(4/k′) + (ln(4/k′) − 1) k′²/4 + …, here with
       k′² = 1e-6/1.000001 and L² < 2 E I₂; from the largest spin, where it begins, it is the time to the first zero. */
    const ShvFreeTop fast = shv_free_top(&inertia, shv_quat_identity(), shv_vec3(0.01, 10.0, 0.0));
    const double complement = 1e-6 / 1.000001, log4 = log(4.0 / sqrt(complement));
    const double quarter = log4 + 0.25 * (log4 - 1.0) * complement, rate = sqrt(200.0002 / 6.0);
    check_near(zero_between(&fast, 0.5, 2.5), quarter / rate, 1e-10);
    check_near(zero_between(&fast, 3.5, 5.5), 3.0 * quarter / rate, 1e-9);
}

/* ω̇ = I⁻¹ (Iω × ω) and q̇ = ½ q ω, by Runge and Kutta's classical rule. */
typedef struct Spin {
    ShvVec3 rate;
    ShvQuat pose;
} Spin;

static Spin derivative(const ShvMat3 *inertia, const ShvMat3 *inverse, Spin at)
{
    const ShvVec3 moment = shv_cross(shv_apply(inertia, at.rate), at.rate);
    const ShvQuat turn = shv_quat_multiply(at.pose, (ShvQuat){0.0, 0.5 * at.rate.x, 0.5 * at.rate.y, 0.5 * at.rate.z});
    return (Spin){shv_apply(inverse, moment), turn};
}

static Spin plus(Spin a, double s, Spin b)
{
    return (Spin){shv_madd(a.rate, s, b.rate),
                  {a.pose.w + s * b.pose.w, a.pose.x + s * b.pose.x, a.pose.y + s * b.pose.y, a.pose.z + s * b.pose.z}};
}

static Spin integrate(const ShvMat3 *inertia, Spin at, double time, int steps)
{
    ShvMat3 inverse;
    assert_true(shv_invert(inertia, &inverse));
    const double h = time / steps;
    for (int i = 0; i < steps; i++) {
        const Spin a = derivative(inertia, &inverse, at), b = derivative(inertia, &inverse, plus(at, 0.5 * h, a));
        const Spin c = derivative(inertia, &inverse, plus(at, 0.5 * h, b));
        const Spin d = derivative(inertia, &inverse, plus(at, h, c));
        at = plus(plus(plus(plus(at, h / 6.0, a), h / 3.0, b), h / 3.0, c), h / 6.0, d);
    }
    return at;
}

static double between(uint64_t *random, double low, double high)
{
    return low + (high - low) * shv_random_uniform(7, (*random)++);
}

/* Random inertia (turned, so that its axes are not those of the body), pose and spin; 20,000 steps of 1e-4 at spins of a few
   rad/s: local errors (ωh)⁵/120 of 1e-16 each, rounding errors of the same size: 4e-12 in all. */
static void test_against_integration(void **state)
{
    (void)state;
    uint64_t random = 0;
    int thirds = 0;
    for (int n = 0; n < 12; n++) {
        const ShvMat3 moments =
            diagonal(between(&random, 1.0, 1.5), between(&random, 1.6, 2.0), between(&random, 2.1, 2.5));
        const ShvMat3 axes = shv_quat_to_matrix(
            shv_quat_exponential(shv_vec3(between(&random, -2, 2), between(&random, -2, 2), between(&random, -2, 2))));
        const ShvMat3 back = shv_transpose(&axes), half = shv_multiply(&axes, &moments);
        const ShvMat3 inertia = shv_multiply(&half, &back);
        const ShvQuat pose = shv_quat_exponential(shv_vec3(between(&random, -2, 2), between(&random, -2, 2), 0.3));
        const ShvVec3 spin = {between(&random, -3, 3), between(&random, -3, 3), between(&random, -3, 3)};
        ShvFreeTop top = shv_free_top(&inertia, pose, spin);
        const ShvVec3 w = shv_rotate(shv_quat_conjugate(pose), spin), momentum = shv_apply(&inertia, w);
        thirds += shv_dot(momentum, momentum) > moments.m[1][1] * shv_dot(momentum, w);
        const Spin end = integrate(&inertia, (Spin){shv_rotate(shv_quat_conjugate(pose), spin), pose}, 2.0, 20000);
        ShvQuat turned;
        ShvVec3 rate;
        shv_free_top_at(&top, 0.5, &turned, &rate);
        shv_free_top_at(&top, 2.0, &turned, &rate);
        const ShvVec3 expected = shv_rotate(end.pose, end.rate);
        check_near(shv_norm(shv_sub(rate, expected)), 0.0, 2e-11);
        const ShvQuat difference = shv_quat_multiply(shv_quat_conjugate(end.pose), turned);
        check_near(shv_norm(shv_vec3(difference.x, difference.y, difference.z)), 0.0, 2e-11);
    }
    assert_true(thirds > 0 && thirds < 12); /* both ways round were met */
}

static void test_steady(void **state)
{
    (void)state;
    /* A ball, any spin; a middle axis alone; no spin; a disc about one of its equal axes. */
    const struct {
        ShvMat3 inertia;
        ShvVec3 spin;
    } cases[] = {{diagonal(2, 2, 2), {1, 2, 3}},
                 {diagonal(1, 2, 3), {0, 4, 0}},
                 {diagonal(1, 2, 3), {0, 0, 0}},
                 {diagonal(1, 1, 2), {3, 1, 0}}};
    for (int i = 0; i < 4; i++) {
        ShvFreeTop top = shv_free_top(&cases[i].inertia, shv_quat_identity(), cases[i].spin);
        ShvQuat turned;
        ShvVec3 rate;
        shv_free_top_at(&top, 1.3, &turned, &rate);
        check_near(shv_norm(shv_sub(rate, cases[i].spin)), 0.0, 1e-14);
        const ShvQuat expected = shv_quat_exponential(shv_scale(cases[i].spin, 1.3));
        const ShvQuat difference = shv_quat_multiply(shv_quat_conjugate(expected), turned);
        check_near(shv_norm(shv_vec3(difference.x, difference.y, difference.z)), 0.0, 1e-14);
    }
    /* A symmetric top nods about L at L/I₁ (Landau and Lifshitz § 33), spinning about its own axis as at the start. */
    const ShvMat3 symmetric = diagonal(1, 1, 2);
    ShvFreeTop top = shv_free_top(&symmetric, shv_quat_identity(), shv_vec3(1, 0, 1));
    ShvQuat turned;
    ShvVec3 rate;
    const double turn = 2.0 * 3.14159265358979323846 / sqrt(5.0);
    shv_free_top_at(&top, turn, &turned, &rate);
    const ShvVec3 axis = shv_rotate(turned, shv_vec3(0, 0, 1));
    check_near(shv_norm(shv_sub(axis, shv_vec3(0, 0, 1))), 0.0, 1e-13);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_flips),
        cmocka_unit_test(test_against_integration),
        cmocka_unit_test(test_steady),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
