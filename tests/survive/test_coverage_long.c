/* Over 200 populations: intervals hold the truth as often as they say, and are hardly wider than those of a staircase that knew
   median and spread from the start. Of as many shots each. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "survive/populations.h"

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median_of(double *values, int count)
{
    qsort(values, (size_t)count, sizeof *values, ascending);
    return values[count / 2];
}

/* An ideal staircase: it starts at the true median and its step is the true standard deviation, in ln height. */
static double staircase_width(const Population *population, int32_t count)
{
    ShvShot shots[MOST];
    ShvSpecimen specimens[MOST];
    double height = population->median, low, high;
    for (int32_t i = 0; i < count; i++) {
        shots[i] = shoot(population, (uint64_t)i, height);
        height *= exp(shots[i].broken ? -population->scale : population->scale);
    }
    const ShvFragilityData data = {shots, specimens, shv_specimens(shots, count, specimens)};
    shv_fragility_interval(SHV_FRAGILITY_LOGNORMAL, &data, 0.5, &low, &high);
    return log(high / low);
}

static void cover(bool weibull, double scale)
{
    enum { POPULATIONS = 200 };
    static double widths[POPULATIONS], ideal[POPULATIONS];
    int covered50 = 0, covered10 = 0;
    for (int k = 0; k < POPULATIONS; k++) {
        const Population population = {.median = 0.05 * pow(400.0, shv_random_uniform(77, (uint64_t)k)),
                                       .scale = scale,
                                       .seed = 1000 + (uint64_t)k,
                                       .weibull = weibull};
        const ShvFragilityLaw law = weibull ? SHV_FRAGILITY_WEIBULL : SHV_FRAGILITY_LOGNORMAL;
        ShvShot shots[MOST];
        ShvSpecimen specimens[MOST];
        const int32_t count = follow(&population, &wide, shots);
        const ShvFragilityData data = {shots, specimens, shv_specimens(shots, count, specimens)};
        double low, high;
        shv_fragility_interval(law, &data, 0.5, &low, &high);
        covered50 += low <= population.median && population.median <= high;
        widths[k] = log(high / low);
        const double z10 = weibull ? log(-log(0.9)) - log(-log(0.5)) : -1.2815515655;
        const double h10 = population.median * exp(population.scale * z10);
        shv_fragility_interval(law, &data, 0.1, &low, &high);
        covered10 += low <= h10 && h10 <= high;
        ideal[k] = staircase_width(&population, count);
    }
    const double ratio = median_of(widths, POPULATIONS) / median_of(ideal, POPULATIONS);
    print_message("scale %.2f%s: h50 covered in %.1f %%, h10 in %.1f %%; width %.3f of an ideal staircase's\n", scale,
                  weibull ? " (Weibull)" : "", covered50 / 2.0, covered10 / 2.0, ratio);
    assert_in_range(covered50, 180, 198);
    assert_in_range(covered10, 180, 200);
    assert_true(ratio <= 1.3);
}

static void test_coverage(void **state)
{
    (void)state;
    cover(false, 0.1);
    cover(false, 0.3);
    cover(false, 0.6);
    cover(true, 0.2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_coverage)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
