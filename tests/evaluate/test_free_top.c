/* Jacobi's functions against tables and their own identities; the free top against published flips, conservation, and
   Euler's equations integrated in small steps. */
#include "check.h"

#include "base/random.h"
#include "evaluate/closed_form.h"

static void test_elliptic(void **state)
{
    (void)state;
    /* Abramowitz and Stegun, tables 16 and 17: parameter 1/2. */
    const ShvElliptic half = shv_elliptic(0.5, 0.5);
    check_near(half.sn, 0.47075047365565735, 1e-15);
    check_near(half.cn, 0.88226639489044020, 1e-15);
    check_near(half.dn, 0.94297242577738570, 1e-15);
    check_near(shv_elliptic_quarter(0.5), 1.8540746773013719, 1e-15);
    /* Parameter 0: circular functions. Parameter 1: hyperbolic ones, reached to the complement itself. */
    check_near(shv_elliptic(0.7, 1.0).sn, sin(0.7), 1e-15);
    check_near(shv_elliptic(0.7, 1.0).dn, 1.0, 1e-15);
    check_near(shv_elliptic(0.7, 1e-14).sn, tanh(0.7), 1e-13);
    check_near(shv_elliptic(0.7, 1e-14).dn, 1.0 / cosh(0.7), 1e-13);
}

/* sn(F(φ)) = sin φ, cn(F(φ)) = cos φ in every quadrant; F by Simpson's rule, whose error for 2000 intervals of so smooth an
   integrand is below 1e-12 (complement 0.01: largest fourth derivative about 1e6, step 1e-3). */
static void test_elliptic_integral(void **state)
{
    (void)state;
    static const double complements[] = {1.0, 0.9, 0.5, 0.1, 0.01};
    for (int c = 0; c < 5; c++)
        for (double angle = -3.1; angle < 3.15; angle += 0.31) {
            const double u = shv_elliptic_integral(angle, complements[c]);
            const ShvElliptic value = shv_elliptic(u, complements[c]);
            check_near(value.sn, sin(angle), 1e-13);
            check_near(value.cn, cos(angle), 1e-13);
            enum { INTERVALS = 2000 };
            double sum = 0.0;
            for (int i = 0; i <= INTERVALS; i++) {
                const double s = sin(angle * i / INTERVALS);
                const double weight = i == 0 || i == INTERVALS ? 1.0 : i % 2 ? 4.0 : 2.0;
                sum += weight / sqrt(1.0 - (1.0 - complements[c]) * s * s);
            }
            check_near(u, sum * angle / (3.0 * INTERVALS), 1e-8);
        }
}

static ShvMat3 diagonal(double x, double y, double z)
{
    return (ShvMat3){{{x, 0.0, 0.0}, {0.0, y, 0.0}, {0.0, 0.0, z}}};
}

/* Time at which the middle spin is zero, between two at which it has different signs. */
static double zero_between(const ShvFreeTop *top, double low, double high)
{
    const bool rises = shv_free_top_spin(top, low).y < 0.0;
    assert_true((shv_free_top_spin(top, high).y < 0.0) != rises);
    for (int i = 0; i < 60; i++) {
        const double middle = 0.5 * (low + high);
        if ((shv_free_top_spin(top, middle).y < 0.0) == rises)
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
    assert_false(top.steady);
    /* Published to the millisecond. */
    check_near(zero_between(&top, 5.0, 15.0), 10.917, 5e-4);
    check_near(zero_between(&top, 25.0, 35.0), 30.470, 5e-4);
    check_near(zero_between(&top, 45.0, 55.0), 50.023, 5e-4);
    check_near(4.0 * shv_elliptic_quarter(top.complement) / fabs(top.rate), 39.1057, 5e-5);
    const ShvFreeTop fast = shv_free_top(&inertia, shv_quat_identity(), shv_vec3(0.01, 10.0, 0.0));
    /* Near the separatrix K = ln(4/k′) + (ln(4/k′) − 1) k′²/4 + …, here with k′² = 1e-6/1.000001 and L² < 2 E I₂. */
    const double complement = 1e-6 / 1.000001, log4 = log(4.0 / sqrt(complement));
    const double quarter = log4 + 0.25 * (log4 - 1.0) * complement, rate = sqrt(200.0002 / 6.0);
    assert_int_equal(fast.last, 0);
    check_near(4.0 * shv_elliptic_quarter(fast.complement) / fabs(fast.rate), 4.0 * quarter / rate, 1e-9);
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
        thirds += top.last == 2;
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
        cmocka_unit_test(test_elliptic), cmocka_unit_test(test_elliptic_integral),
        cmocka_unit_test(test_flips),    cmocka_unit_test(test_against_integration),
        cmocka_unit_test(test_steady),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
