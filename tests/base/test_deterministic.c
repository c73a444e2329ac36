#include "check.h"

#include <float.h>

#include "base/deterministic.h"
#include "base/random.h"

/* The promise of the header; the references are the long double functions of the C library, good to about 1e-19. */
static const double promised = 4e-15;

static void check_relative(const char *what, double x, double a, double got, long double expected)
{
    const long double error = fabsl((long double)got - expected);
    if (!(error <= (long double)promised * fabsl(expected)))
        fail_msg("%s(%.17g, %.17g) = %.17g, relative error %Lg", what, x, a, got, error / fabsl(expected));
}

/* Uniform in (low, high), the same in every run. */
static double draw(double low, double high, int64_t i)
{
    return low + (high - low) * shv_random_uniform(11, (uint64_t)i);
}

enum { DRAWS = 60000 };

static void exponential_over_its_whole_range(void **state)
{
    (void)state;
    for (int64_t i = 0; i < DRAWS; i++) {
        const double x = draw(-708.0, 709.7, i), y = draw(-1.0, 1.0, i), z = y * exp2(-60.0 * fabs(y));
        check_relative("exp", x, 0.0, shv_exp(x), expl((long double)x));
        check_relative("exp", y, 0.0, shv_exp(y), expl((long double)y));
        check_relative("exp", z, 0.0, shv_exp(z), expl((long double)z));
    }
    /* The last finite result, and subnormal ones to their own last place. */
    check_relative("exp", 709.78, 0.0, shv_exp(709.78), expl((long double)709.78));
    for (double x = -745.0; x < -708.4; x += 0.37) check_near(shv_exp(x), (double)expl((long double)x), 0x1p-1074);
}

static void exponential_of_special_values(void **state)
{
    (void)state;
    check_near(shv_exp(0.0), 1.0, 0.0);
    assert_true(isinf(shv_exp(709.79)) && isinf(shv_exp(1e300)) && isinf(shv_exp((double)INFINITY)));
    check_near(shv_exp(-746.0), 0.0, 0.0);
    check_near(shv_exp(-(double)INFINITY), 0.0, 0.0);
    assert_true(isnan(shv_exp((double)NAN)));
}

static void logarithm_over_its_whole_range(void **state)
{
    (void)state;
    for (int64_t i = 0; i < DRAWS; i++) {
        const double x = exp2(draw(-1022.0, 1023.9, i)), y = draw(0.5, 2.0, i), z = 1.0 + draw(-1e-6, 1e-6, i);
        check_relative("log", x, 0.0, shv_log(x), logl((long double)x));
        check_relative("log", y, 0.0, shv_log(y), logl((long double)y));
        check_relative("log", z, 0.0, shv_log(z), logl((long double)z));
    }
    check_relative("log", DBL_MAX, 0.0, shv_log(DBL_MAX), logl((long double)DBL_MAX));
    check_relative("log", 0x1p-1074, 0.0, shv_log(0x1p-1074), logl(0x1p-1074L));
    check_relative("log", 1.0 - 0x1p-53, 0.0, shv_log(1.0 - 0x1p-53), logl(1.0L - 0x1p-53L));
}

static void logarithm_of_special_values(void **state)
{
    (void)state;
    check_near(shv_log(1.0), 0.0, 0.0);
    assert_true(isinf(shv_log(0.0)) && shv_log(0.0) < 0.0);
    assert_true(isinf(shv_log((double)INFINITY)));
    assert_true(isnan(shv_log(-1.0)) && isnan(shv_log((double)NAN)) && isnan(shv_log(-(double)INFINITY)));
}

static void powers_over_the_plane(void **state)
{
    (void)state;
    for (int64_t i = 0; i < DRAWS; i++) {
        const double x = exp2(draw(-1000.0, 1000.0, 2 * i)), y = draw(0.0, 3.0, 2 * i),
                     a = draw(-20.0, 20.0, 2 * i + 1);
        const long double far = powl((long double)x, (long double)a);
        if (far > (long double)DBL_MIN && far < (long double)DBL_MAX)
            check_relative("power", x, a, shv_power(x, a), far);
        check_relative("power", y, a, shv_power(y, a), powl((long double)y, (long double)a));
        /* A base near 1 and a huge exponent: every digit of the logarithm counts. */
        const double b = 1.0 + 1e-3 * (y - 1.5), c = 2e4 * a;
        check_relative("power", b, c, shv_power(b, c), powl((long double)b, (long double)c));
    }
    for (int64_t i = 0; i < 2000; i++)
        for (int twice = -20; twice <= 20; twice++) {
            const double x = draw(0.01, 100.0, i), a = 0.5 * twice;
            check_relative("power", x, a, shv_power(x, a), powl((long double)x, (long double)a));
        }
}

static void cube_roots_know_no_unit(void **state)
{
    (void)state;
    check_near(shv_cube_root(0.0), 0.0, 0.0);
    for (int64_t i = 0; i < 20000; i++) {
        const double x = exp2(draw(-1000.0, 1000.0, i));
        const double root = shv_cube_root(x);
        check_relative("cube root", x, 0.0, root, cbrtl((long double)x));
        check_near(shv_cube_root(x / 8.0), 0.5 * root, 0.0);
        check_near(shv_cube_root(64.0 * x), 4.0 * root, 0.0);
    }
}

static void powers_of_special_values(void **state)
{
    (void)state;
    const double inf = (double)INFINITY;
    check_near(shv_power(0.0, 0.0), 1.0, 0.0);
    check_near(shv_power(-3.0, 0.0), 1.0, 0.0);
    check_near(shv_power(1.0, inf), 1.0, 0.0);
    check_near(shv_power(0.0, 2.5), 0.0, 0.0);
    check_near(shv_power(0.0, 0.3), 0.0, 0.0);
    check_near(shv_power(inf, -1.0), 0.0, 0.0);
    check_near(shv_power(0.5, inf), 0.0, 0.0);
    check_near(shv_power(2.0, -inf), 0.0, 0.0);
    check_near(shv_power(1e-300, 2.3), 0.0, 0.0);
    assert_true(isinf(shv_power(0.0, -1.0)) && isinf(shv_power(inf, 0.5)) && isinf(shv_power(2.0, inf)));
    assert_true(isinf(shv_power(0.5, -inf)) && isinf(shv_power(1e300, 2.3)) && isinf(shv_power(1e300, 2.0)));
    assert_true(isnan(shv_power(-1.0, 2.0)) && isnan(shv_power((double)NAN, 1.0)) &&
                isnan(shv_power(2.0, (double)NAN)));
    check_near(shv_power(3.0, 4.0), 81.0, 0.0);
    check_near(shv_power(9.0, 1.5), 27.0, 0.0);
}

static void sine_and_cosine_over_wide_ranges(void **state)
{
    (void)state;
    static const double ranges[] = {1e-8, 1.0, 10.0, 1e3, 1e6, 1e9, 1e12};
    for (size_t k = 0; k < sizeof ranges / sizeof *ranges; k++)
        for (int64_t i = 0; i < DRAWS / 4; i++) {
            const double x = draw(-ranges[k], ranges[k], i);
            check_relative("sin", x, 0.0, shv_sin(x), sinl((long double)x));
            check_relative("cos", x, 0.0, shv_cos(x), cosl((long double)x));
        }
}

/* The doubles next to multiples of π/2, where the result is tiny and the reduction decides its digits. */
static void sine_and_cosine_near_their_zeros(void **state)
{
    (void)state;
    const long double half_pi = 1.57079632679489661923132169163975144L;
    for (int64_t n = 1; n < 20000; n++) {
        const double x = (double)((long double)(n * n) * half_pi);
        check_relative("sin", x, 0.0, shv_sin(x), sinl((long double)x));
        check_relative("cos", x, 0.0, shv_cos(x), cosl((long double)x));
    }
}

static void sine_and_cosine_of_special_values(void **state)
{
    (void)state;
    check_near(shv_cos(0.0), 1.0, 0.0);
    assert_true(shv_sin(0.0) == 0.0 && !signbit(shv_sin(0.0)) && signbit(shv_sin(-0.0)));
    assert_true(isnan(shv_sin((double)INFINITY)) && isnan(shv_cos((double)NAN)) && isnan(shv_cos(2e12)) &&
                isnan(shv_sin(-2e12)));
    check_relative("sin", 0x1p-1060, 0.0, shv_sin(0x1p-1060), 0x1p-1060L);
    for (int64_t i = 0; i < 1000; i++) {
        const double x = draw(0.0, 100.0, i);
        check_near(shv_sin(-x), -shv_sin(x), 0.0);
        check_near(shv_cos(-x), shv_cos(x), 0.0);
    }
}

static void arc_cosine_over_its_range(void **state)
{
    (void)state;
    for (int64_t i = 0; i < DRAWS; i++) {
        const double x = draw(-1.0, 1.0, i), y = 1.0 - exp2(-52.0 * fabs(x)), z = x * exp2(-60.0 * fabs(x));
        check_relative("acos", x, 0.0, shv_acos(x), acosl((long double)x));
        check_relative("acos", y, 0.0, shv_acos(y), acosl((long double)y));
        check_relative("acos", -y, 0.0, shv_acos(-y), acosl(-(long double)y));
        check_relative("acos", z, 0.0, shv_acos(z), acosl((long double)z));
    }
    check_near(shv_acos(1.0), 0.0, 0.0);
    check_relative("acos", -1.0, 0.0, shv_acos(-1.0), acosl(-1.0L));
    check_relative("acos", 0.5, 0.0, shv_acos(0.5), acosl(0.5L));
    assert_true(isnan(shv_acos(1.0 + 0x1p-52)) && isnan(shv_acos(-2.0)) && isnan(shv_acos((double)NAN)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exponential_over_its_whole_range),
        cmocka_unit_test(exponential_of_special_values),
        cmocka_unit_test(logarithm_over_its_whole_range),
        cmocka_unit_test(logarithm_of_special_values),
        cmocka_unit_test(powers_over_the_plane),
        cmocka_unit_test(cube_roots_know_no_unit),
        cmocka_unit_test(powers_of_special_values),
        cmocka_unit_test(sine_and_cosine_over_wide_ranges),
        cmocka_unit_test(sine_and_cosine_near_their_zeros),
        cmocka_unit_test(sine_and_cosine_of_special_values),
        cmocka_unit_test(arc_cosine_over_its_range),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
