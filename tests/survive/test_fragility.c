/* Fits, intervals and the choice of heights, on populations whose truth is known. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "survive/populations.h"

/* ---- fits against closed forms ---- */

/* With every specimen dropped from the same three heights often enough, the shares at two of them give both parameters. */
static void test_fit_meets_shares(void **state)
{
    (void)state;
    ShvShot shots[MOST];
    ShvSpecimen specimens[MOST];
    int32_t count = 0;
    /* Of 40 specimens a height: 8 break at 1 m, 20 at 2 m; the third height is so high that all do. */
    for (int32_t i = 0; i < 40; i++) shots[count++] = (ShvShot){.specimen = 2 * i, .height = 1.0, .broken = i < 8};
    for (int32_t i = 0; i < 40; i++) shots[count++] = (ShvShot){.specimen = 2 * i + 1, .height = 2.0, .broken = i < 20};
    const ShvFragilityData data = {shots, specimens, shv_specimens(shots, count, specimens)};
    assert_int_equal(data.specimen_count, 80);
    for (int law = 0; law < SHV_FRAGILITY_LAWS; law++) {
        const ShvFragilityFit fit = shv_fragility_fit(law, &data);
        assert_close(shv_fragility_share(law, &fit, 1.0), 0.2, 1e-3);
        assert_close(shv_fragility_share(law, &fit, 2.0), 0.5, 1e-3);
        assert_close(shv_fragility_height(law, &fit, 0.5), 2.0, 2e-3);
    }
    /* ln 2 / z(0.8): the normal quantile 0.8416. */
    assert_close(shv_fragility_fit(SHV_FRAGILITY_LOGNORMAL, &data).scale, log(2.0) / 0.841621, 2e-3);
}

static void test_isotonic(void **state)
{
    (void)state;
    const double heights[] = {1.0, 4.0, 2.0, 3.0, 5.0, 3.0};
    const bool broken[] = {false, true, true, false, true, true};
    ShvShot shots[6];
    int32_t order[6];
    double shares[6];
    for (int i = 0; i < 6; i++) shots[i] = (ShvShot){.height = heights[i], .broken = broken[i]};
    shv_fragility_isotonic(shots, 6, order, shares);
    const double expected[] = {0.0, 2.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0, 1.0, 1.0};
    for (int i = 0; i < 6; i++) assert_close(shares[i], expected[i], 1e-12);
}

/* Dixon and Mood's worked example of 60 shots (J. Am. Stat. Assoc. 43 (1948) 109-126) has the levels in log units; here a small
   one by hand: levels 1, 2, 1, 2, 3, 2 m, broken where it goes down. */
static void test_staircase(void **state)
{
    (void)state;
    const double heights[] = {1.0, 2.0, 1.0, 2.0, 3.0, 2.0};
    const bool broken[] = {false, true, false, false, true, false};
    ShvShot shots[6];
    for (int i = 0; i < 6; i++) shots[i] = (ShvShot){.height = heights[i], .broken = broken[i]};
    double mean, deviation;
    shv_staircase_mean(shots, 6, 1.0, &mean, &deviation);
    /* Two broke, at 2 and 3 m: 2 + (1/2 − 1/2) m. */
    assert_close(mean, 2.0, 1e-12);
    assert_close(deviation, 1.62 * (0.25 + 0.029), 1e-12);
    const ShvDesign design = {.first = 1.0, .lowest = 0.5, .highest = 9.0, .most_shots = 7, .every = 1};
    assert_close(shv_staircase_next(&design, 1.0, shots, 6).height, 3.0, 1e-12);
    assert_close(shv_staircase_next(&design, 1.0, shots, 5).height, 2.0, 1e-12);
    shv_staircase_mean(shots, 1, 1.0, &mean, &deviation);
    assert_true(isnan(mean));
}

/* ---- the design ---- */

/* What is there decides alone: every beginning of a table goes on to the same table. */
static void test_goes_on(void **state)
{
    (void)state;
    const Population population = {.median = 3.0, .scale = 0.3, .seed = 5};
    ShvShot shots[MOST];
    ShvSpecimen specimens[MOST];
    const int32_t count = follow(&population, &wide, shots);
    assert_int_equal(count, 40);
    for (int32_t k = 0; k < count; k++) {
        const ShvNextShot next = shv_design_next(&wide, shots, k, specimens);
        assert_false(next.done);
        assert_true(next.specimen == shots[k].specimen && next.height == shots[k].height);
    }
}

static void test_never_and_always(void **state)
{
    (void)state;
    ShvShot shots[MOST];
    ShvDesign design = wide;
    design.lowest = 0.1;
    design.highest = 10.0;
    const Population steel = {.median = 1e6, .scale = 0.1, .seed = 1}, foam = {.median = 1e-6, .scale = 0.1, .seed = 1};
    int32_t count = follow(&steel, &design, shots);
    for (int32_t i = 0; i < count; i++) assert_true(!shots[i].broken && shots[i].height <= 10.0);
    assert_true(count == 40 && shots[count - 1].height == 10.0 && shots[count - 1].specimen > 20);
    count = follow(&foam, &design, shots);
    for (int32_t i = 0; i < count; i++) assert_true(shots[i].broken && shots[i].height >= 0.1);
    assert_true(count == 40 && shots[count - 1].height == 0.1 && shots[count - 1].specimen > 20);
}

static void test_until(void **state)
{
    (void)state;
    const Population population = {.median = 0.7, .scale = 0.15, .seed = 9};
    ShvShot shots[MOST];
    ShvSpecimen specimens[MOST];
    ShvDesign design = wide;
    design.most_shots = MOST;
    design.until = 1.3;
    const int32_t count = follow(&population, &design, shots);
    assert_true(count < MOST / 2);
    const ShvFragilityData data = {shots, specimens, shv_specimens(shots, count, specimens)};
    double low, high;
    shv_fragility_interval(SHV_FRAGILITY_LOGNORMAL, &data, 0.5, &low, &high);
    assert_true(high / low <= 1.3);
}

/* A specimen that breaks at random does not stop anything, and is counted. */
static void test_chaos(void **state)
{
    (void)state;
    ShvShot shots[MOST];
    ShvSpecimen specimens[MOST];
    ShvDesign design = wide;
    int32_t count = 0, contradictory = 0;
    design.most_shots = 160;
    for (;; count++) {
        const ShvNextShot next = shv_design_next(&design, shots, count, specimens);
        if (next.done) break;
        const double share = 1.0 / (1.0 + pow(next.height, -2.0));
        shots[count] = (ShvShot){
            .specimen = next.specimen, .height = next.height, .broken = shv_random_uniform(3, (uint64_t)count) < share};
    }
    const ShvFragilityData data = {shots, specimens, shv_specimens(shots, count, specimens)};
    for (int32_t i = 0; i < data.specimen_count; i++) contradictory += specimens[i].contradictory;
    assert_true(contradictory > 0);
    const ShvFragilityFit fit = shv_fragility_fit(SHV_FRAGILITY_LOGNORMAL, &data);
    assert_true(shv_fragility_height(SHV_FRAGILITY_LOGNORMAL, &fit, 0.5) > 0.4);
    assert_true(shv_fragility_height(SHV_FRAGILITY_LOGNORMAL, &fit, 0.5) < 2.5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fit_meets_shares),
        cmocka_unit_test(test_isotonic),
        cmocka_unit_test(test_staircase),
        cmocka_unit_test(test_goes_on),
        cmocka_unit_test(test_never_and_always),
        cmocka_unit_test(test_until),
        cmocka_unit_test(test_chaos),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
