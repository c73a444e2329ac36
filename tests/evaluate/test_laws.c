/* Motions along a line against numbers worked out by hand and against plain integration in small steps. */
#include "check.h"

#include "evaluate/closed_form.h"

static const double g = 9.81;

/* First impact √(2h/g), then hops of 2 eⁿ √(2h/g); apices h e²ⁿ; at rest from √(2h/g) (1 + e)/(1 − e) on. */
static void test_bounce(void **state)
{
    (void)state;
    static const double impacts[] = {0.45152, 1.17396, 1.75191, 2.21427};
    static const double apices[] = {0.64, 0.4096, 0.262144};
    const double fall = sqrt(2.0 / g);
    double time = fall;
    for (int n = 0; n < 4; n++) {
        check_near(time, impacts[n], 5e-6);
        /* Distance to the ground of a body of a few m/s, 1e-9 s before and after. */
        check_near(shv_law_bounce(1.0, 0.0, g, 0.8, time - 1e-9).position, 0.0, 1e-8);
        check_near(shv_law_bounce(1.0, 0.0, g, 0.8, time + 1e-9).position, 0.0, 1e-8);
        const double before = shv_law_bounce(1.0, 0.0, g, 0.8, time - 1e-9).velocity;
        const double after = shv_law_bounce(1.0, 0.0, g, 0.8, time + 1e-9).velocity;
        check_near(after, -0.8 * before, 1e-7);
        const double hop = 2.0 * fall * pow(0.8, n + 1);
        if (n < 3) check_near(shv_law_bounce(1.0, 0.0, g, 0.8, time + 0.5 * hop).position, apices[n], 1e-12);
        time += hop;
    }
    check_near(fall * 9.0, 4.0637, 5e-5);
    assert_true(shv_law_bounce(1.0, 0.0, g, 0.8, 9.0 * fall * 0.9999).position > 0.0);
    assert_true(shv_law_bounce(1.0, 0.0, g, 0.8, 9.0 * fall * 1.0001).position == 0.0);
    assert_true(shv_law_bounce(1.0, 0.0, g, 0.8, 1e6).velocity == 0.0);
}

static void test_bounce_extremes(void **state)
{
    (void)state;
    const ShvLineMotion dead = shv_law_bounce(1.0, 0.0, g, 0.0, 0.5);
    assert_true(dead.position == 0.0 && dead.velocity == 0.0);
    /* Restitution 1: period 2 √(2h/g); 1000 of them lose a thousand rounding errors of the time. */
    const double period = 2.0 * sqrt(2.0 / g);
    check_near(shv_law_bounce(1.0, 0.0, g, 1.0, 1000.0 * period).position, 1.0, 1e-9);
    assert_true(shv_law_bounce(0.0, 0.0, g, 0.8, 1.0).position == 0.0);
    /* Thrown up: v t − ½ g t². */
    check_near(shv_law_bounce(0.0, 2.0, g, 0.5, 0.1).position, 0.2 - 0.5 * g * 0.01, 1e-15);
}

static ShvLineMotion slide(double velocity, double pull, double friction, double time)
{
    return shv_law_roll(velocity, 0.0, pull, friction, HUGE_VAL, time).centre;
}

static void test_slide(void **state)
{
    (void)state;
    const double steep = g * 0.5, press = g * sqrt(0.75);
    check_near(slide(0.0, steep, 0.3 * press, 1.0).velocity, 2.3563, 5e-5);
    check_near(slide(0.0, steep, 0.3 * press, 2.0).position, 2.0 * 2.3563, 2e-4);
    /* tan 30° = 0.577: 0.58 holds it, in either direction, and brings it to rest when it moves. */
    assert_true(slide(0.0, steep, 0.58 * press, 5.0).position == 0.0);
    assert_true(slide(0.0, -steep, 0.58 * press, 5.0).position == 0.0);
    assert_true(slide(0.1, steep, 0.7 * press, 5.0).velocity == 0.0);
    /* 2 m/s on the level with 0.4: v²/(2 µ g). */
    check_near(slide(2.0, 0.0, 0.4 * g, 10.0).position, 0.5097, 5e-5);
    /* Uphill against the pull, then down again: v² / 2(pull + f) up, then (pull − f) for the rest of the time. */
    const double up = 2.0 / (steep + 0.3 * press), down = 1.0 - up;
    check_near(slide(-2.0, steep, 0.3 * press, 1.0).position,
               -0.5 * 2.0 * up + 0.5 * (steep - 0.3 * press) * down * down, 1e-14);
}

static void test_roll(void **state)
{
    (void)state;
    const double steep = g * 0.5, press = g * sqrt(0.75);
    check_near(shv_law_roll(0, 0, steep, 0.4 * press, 0.4, 1.0).centre.velocity, 3.5036, 5e-5);
    /* A shell has 2/3 m r²: 3/5 g sin θ. */
    check_near(shv_law_roll(0, 0, steep, 0.4 * press, 2.0 / 3.0, 1.0).centre.velocity, 0.6 * steep, 1e-14);
    /* Friction of at least 2/7 tan θ = 0.165 makes it roll, less lets it slip. */
    const ShvRollMotion rolls = shv_law_roll(0, 0, steep, 0.166 * press, 0.4, 1.0);
    check_near(rolls.centre.velocity, rolls.rim.velocity, 1e-14);
    const ShvRollMotion slips = shv_law_roll(0, 0, steep, 0.16 * press, 0.4, 1.0);
    assert_true(slips.centre.velocity > slips.rim.velocity + 0.01);
    check_near(slips.centre.velocity, steep - 0.16 * press, 1e-14);
    /* 2 m/s without spin, 0.2: rolls from 2v/(7µg) = 0.2912 s on at 5/7 v. */
    const double time = 4.0 / (7.0 * 0.2 * g);
    check_near(time, 0.2912, 5e-5);
    const ShvRollMotion before = shv_law_roll(2, 0, 0, 0.2 * g, 0.4, 0.99 * time);
    const ShvRollMotion after = shv_law_roll(2, 0, 0, 0.2 * g, 0.4, 1.01 * time);
    assert_true(before.centre.velocity > before.rim.velocity);
    check_near(after.centre.velocity, 10.0 / 7.0, 1e-14);
    check_near(after.rim.velocity, 10.0 / 7.0, 1e-14);
}

/* Back spin uphill: friction turns round twice. Against integration in steps of 1e-6 s, whose error is a few steps of
   acceleration (about 20 m/s²) × step at each change. */
static void test_roll_by_steps(void **state)
{
    (void)state;
    const double pull = 3.0, friction = 2.5, shape = 0.4, step = 1e-6;
    double x = 0.0, v = -2.0, s = 0.0, w = 6.0;
    for (int i = 0; i < 1500000; i++) {
        const double needed = pull * shape / (1.0 + shape);
        const double slip = v - w, change = step * (fabs(pull) + friction * (1.0 + 1.0 / shape));
        const double drag = fabs(slip) <= change && fabs(needed) <= friction ? needed : copysign(friction, slip);
        v += step * (pull - drag);
        w += step * drag / shape;
        x += step * v;
        s += step * w;
    }
    const ShvRollMotion motion = shv_law_roll(-2.0, 6.0, pull, friction, shape, 1.5);
    check_near(motion.centre.velocity, v, 1e-4);
    check_near(motion.rim.velocity, w, 1e-4);
    check_near(motion.centre.position, x, 1e-4);
    check_near(motion.rim.position, s, 1e-4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bounce), cmocka_unit_test(test_bounce_extremes), cmocka_unit_test(test_slide),
        cmocka_unit_test(test_roll),   cmocka_unit_test(test_roll_by_steps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
