/* Impacts, apices and flips read from tracks that were made from exact motions. */
#include "check.h"

#include "evaluate/closed_form.h"

static const ShvVec3 up = {0.0, 0.0, 1.0};
static const ShvVec3 gravity = {0.0, 0.0, -9.81};

enum { MOST_ROWS = 6000 };
static ShvBodyState rows[MOST_ROWS], others[MOST_ROWS];
static double times_of_rows[MOST_ROWS];

static void add(ShvTrack *track, double time, ShvBodyState state)
{
    assert_true(track->count < MOST_ROWS);
    times_of_rows[track->count] = time;
    (track->states == rows ? rows : others)[track->count++] = state;
}

static void test_impacts(void **state)
{
    (void)state;
    enum { FRAMES = 241, MOST = 8 };
    ShvTrack track = {times_of_rows, rows, 1, 0}, other_track = {times_of_rows, others, 1, 0};
    /* One bounces with 0.8; the other with 0.5 and lies still at the end. */
    for (int i = 0; i < FRAMES; i++) {
        const ShvLineMotion own = shv_law_bounce(1.0, 0.0, 9.81, 0.8, 0.01 * i);
        const ShvLineMotion other = shv_law_bounce(1.0, 0.0, 9.81, 0.5, 0.01 * i);
        add(&track, 0.01 * i,
            (ShvBodyState){.position = {3.0, 0.0, 2.0 + own.position}, .velocity = {0, 0, own.velocity}});
        add(&other_track, 0.01 * i,
            (ShvBodyState){.position = {0, 0, other.position}, .velocity = {0, 0, other.velocity}});
    }
    double times[MOST], heights[MOST], fall = sqrt(2.0 / 9.81), time = fall;
    assert_int_equal(shv_track_impacts(&track, up, gravity, times, heights, MOST), 4);
    /* Rounding errors of positions of a few metres over speeds of a few m/s. */
    for (int n = 0; n < 4; n++, time += 2.0 * fall * pow(0.8, n)) check_near(times[n], time, 1e-14);
    assert_int_equal(shv_track_impacts(&track, up, gravity, times, heights, 2), 2);
    for (int n = 0; n < 3; n++) check_near(heights[n], pow(0.8, 2 * n + 2), 1e-14);
    /* Hops with 0.5 last 0.4515 s × 0.5ⁿ⁻¹; those of less than thrice gravity's share of a frame are no impacts. */
    const int count = shv_track_impacts(&other_track, up, gravity, times, heights, MOST);
    assert_in_range(count, 4, 7);
    check_near(times[1], 2.0 * fall, 1e-14);
}

/* What falls freely, slides down or rests hits nothing. */
static void test_no_impact(void **state)
{
    (void)state;
    double times[4];
    for (int kind = 0; kind < 3; kind++) {
        ShvTrack track = {times_of_rows, rows, 1, 0};
        const double a = kind == 0 ? -9.81 : kind == 1 ? -2.0 : 0.0;
        for (int i = 0; i < 100; i++) {
            const double t = 0.01 * i;
            add(&track, t, (ShvBodyState){.position = {0, 0, 0.5 * a * t * t}, .velocity = {0, 0, a * t}});
        }
        assert_int_equal(shv_track_impacts(&track, up, gravity, times, times, 4), 0);
    }
}

static void test_flips(void **state)
{
    (void)state;
    const ShvMat3 inertia = {{{1, 0, 0}, {0, 2, 0}, {0, 0, 3}}};
    ShvFreeTop top = shv_free_top(&inertia, shv_quat_identity(), shv_vec3(0.01, 1.0, 0.01));
    ShvTrack track = {times_of_rows, rows, 1, 0};
    for (int i = 0; i <= 5500; i++) {
        ShvBodyState at = {.position = {0, 0, 0}};
        shv_free_top_at(&top, 0.01 * i, &at.orientation, &at.angular_velocity);
        add(&track, 0.01 * i, at);
    }
    static const double published[] = {10.917, 30.470, 50.023};
    double times[8];
    assert_int_equal(shv_track_flips(&track, &inertia, times, 8), 3);
    for (int n = 0; n < 3; n++) check_near(times[n], published[n], 5e-4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_impacts),
        cmocka_unit_test(test_no_impact),
        cmocka_unit_test(test_flips),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
