/* The way of bodies beside a closed form or another run: errors, and scenes that are refused. */
#include "check.h"

#include "base/memory.h"

#include "evaluate/trajectory.h"
#include "shiver/scene.h"

#define HEAD                                                                                                           \
    "shiver: 1\nname: drop & bounce\n"                                                                                 \
    "materials: {m: {density: 1000, youngs_modulus: 1e6, poissons_ratio: 0.3, breakable: false}}\n"                    \
    "threads: 1\noutput: {rate: 200}\n"
/* A box that falls flat hits the floor below its centre. */
#define BOUNCE                                                                                                         \
    HEAD "objects: {box: {mesh: {box: {size: [0.1, 0.1, 0.1], edge: 0.1}}, material: m, position: [0, 0, 0.25]}}\n"    \
         "obstacles: {floor: {plane: {normal: [0, 0, 1]}, restitution: 0.5}, wall: {box: {size: [1, 1, 1]}, "          \
         "position: [9, 0, 0]}}\nduration: 0.4\n"                                                                      \
         "reference: {law: bounce, body: box, on: floor}\n"

static ShvScene *parse(const char *text, const char *const *overrides, int32_t count)
{
    ShvScene *scene = NULL;
    ShvError error;
    check_ok(shv_scene_parse(&scene, text, strlen(text), "text", NULL, overrides, count, NULL, NULL, &error), error);
    return scene;
}

/* A run with its way, and that of the closed form. */
static ShvOutcome run(const ShvScene *scene, ShvMemory *memory, ShvStatus *status, ShvError *error)
{
    ShvOutcome outcome;
    const ShvRunOrder order = {
        .scene = shv_scene_definition(scene), .memory = memory, .multiple = (double)NAN, .repeats = 1};
    *status = shv_run_scene(&outcome, &order, error);
    return outcome;
}

/* Adds to the upward velocity of the only body from a frame on. */
static void push(const ShvOutcome *outcome, int64_t frame, double speed)
{
    enum { UPWARD = offsetof(ShvBodyState, velocity.z) / sizeof(double) };
    const ShvOutcomeList *track = shv_outcome_find(outcome, "track");
    for (int64_t i = frame * SHV_STATE_NUMBERS + UPWARD; i < track->count; i += SHV_STATE_NUMBERS)
        track->values[i] += speed;
}

static void test_bounce(void **state)
{
    (void)state;
    static const char *const engines[] = {"rigid.engine=analytic", "rigid.engine=bullet"};
    for (int i = 0; i < 2; i++) {
        ShvScene *scene = parse(BOUNCE, &engines[i], 1);
        ShvStatus status;
        ShvError error;
        double errors[SHV_TRAJECTORY_MEASURES];
        ShvOutcome outcome = run(scene, NULL, &status, &error);
        check_ok(status, error);
        check_ok(shv_trajectory_errors(&outcome, NULL, errors, &error), error);
        /* Falls 0.2 m: impacts at 0.2019 and 0.4038 s, the second after the end. The floor is met within the backends' slack,
           which is far below 1 um for a box of 10 cm. */
        assert_true(errors[SHV_TRAJECTORY_EVENT_COUNT] == 0.0);
        assert_true(errors[SHV_TRAJECTORY_POSITION] < 1e-6 && errors[SHV_TRAJECTORY_VELOCITY] < 1e-5);
        assert_true(errors[SHV_TRAJECTORY_EVENT_TIME] < 1e-6 && errors[SHV_TRAJECTORY_ENERGY] < 1e-5);
        assert_true(errors[SHV_TRAJECTORY_SURFACE] >= errors[SHV_TRAJECTORY_POSITION]);
        assert_int_equal(shv_outcome_find(&outcome, "exact")->count, 81 * SHV_STATE_NUMBERS);
        /* Beside itself there is no error, and no moments without a law. */
        check_ok(shv_trajectory_errors(&outcome, &outcome, errors, &error), error);
        assert_true(errors[SHV_TRAJECTORY_POSITION] == 0.0 && errors[SHV_TRAJECTORY_ENERGY] == 0.0);
        assert_true(isnan(errors[SHV_TRAJECTORY_EVENT_TIME]) && errors[SHV_TRAJECTORY_ENERGY_GAIN] < 1e-9);
        /* A push is a rise of the energy. */
        push(&outcome, 4, 3.0);
        check_ok(shv_trajectory_errors(&outcome, &outcome, errors, &error), error);
        assert_true(errors[SHV_TRAJECTORY_ENERGY_GAIN] > 0.1);
        shv_outcome_release(&outcome);
        shv_scene_destroy(scene);
    }
}

static void refused(const char *override, const char *part)
{
    const char *const overrides[] = {override, "overlaps=keep"};
    ShvScene *scene = parse(BOUNCE, overrides, 2);
    ShvStatus status;
    ShvError error;
    double errors[SHV_TRAJECTORY_MEASURES];
    ShvOutcome outcome = run(scene, NULL, &status, &error);
    check_ok(status, error);
    check_fails(shv_trajectory_errors(&outcome, NULL, errors, &error), SHV_BAD_INPUT, error, part);
    shv_outcome_release(&outcome);
    shv_scene_destroy(scene);
}

static void test_refusals(void **state)
{
    (void)state;
    refused("events=[{at: 0.1, impulse: {target: box, impulse: [1, 0, 0]}}]", "no events");
    refused("gravity=[1, 0, -9]", "straight on to");
    refused("objects.box.velocity=[1, 0, 0]", "is straight");
    refused("objects.box.angular_velocity=[1, 0, 0]", "no spin");
    refused("objects.box.position=[0, 0, 0]", "above");
    refused("objects.box.rotation={axis: [0, 1, 0], angle: 30}", "begin to turn");
    refused("reference={law: slide, body: box, on: floor}", "the gap is 0.2 m");
    refused("reference={law: roll, body: box, on: floor}", "not round enough");
}

/* Frames at other times, and other bodies, cannot be compared. */
static void test_unlike_runs(void **state)
{
    (void)state;
    static const char
        *const other[] = {"output.rate=150"},
               *const fewer[] = {
                   "objects.twin={material: m, position: [5, 5, 5], mesh: {box: {size: [0.1, 0.1, 0.1], edge: 0.1}}}"};
    ShvScene *scenes[] = {parse(BOUNCE, NULL, 0), parse(BOUNCE, other, 1), parse(BOUNCE, fewer, 1)};
    static const char *const parts[] = {"same times", "same bodies"};
    ShvOutcome outcomes[3];
    ShvStatus status;
    ShvError error;
    double errors[SHV_TRAJECTORY_MEASURES];
    for (int i = 0; i < 3; i++) outcomes[i] = run(scenes[i], NULL, &status, &error);
    check_fails(shv_trajectory_errors(&outcomes[0], &outcomes[1], errors, &error), SHV_BAD_INPUT, error, parts[0]);
    check_fails(shv_trajectory_errors(&outcomes[2], &outcomes[0], errors, &error), SHV_BAD_INPUT, error, parts[1]);
    for (int i = 0; i < 3; i++) {
        shv_outcome_release(&outcomes[i]);
        shv_scene_destroy(scenes[i]);
    }
}

/* A spin that no step can follow fails in its run. */
static void test_failed_run(void **state)
{
    (void)state;
    static const char *const fast[] = {"objects.box.angular_velocity=[1, 2e6, 3]",
                                       "rigid.time_step=0.1",
                                       "rigid.engine=analytic",
                                       "duration=0.1",
                                       "obstacles={}",
                                       "output.rate=10",
                                       "reference={law: rest}"};
    ShvScene *scene = parse(BOUNCE, fast, 7);
    ShvStatus status;
    ShvError error;
    ShvOutcome outcome = run(scene, NULL, &status, &error);
    check_ok(status, error);
    assert_int_equal(outcome.status, SHV_DIVERGED);
    assert_non_null(strstr(outcome.message, "smaller rigid.time_step"));
    shv_outcome_release(&outcome);
    shv_scene_destroy(scene);
}

/* Whichever allocation fails, the status says so and nothing is left behind. */
static void test_no_memory(void **state)
{
    (void)state;
    static const char *const brief[] = {"duration=0.02", "reference={law: flight}"};
    ShvScene *scene = parse(BOUNCE, brief, 2);
    ShvMemory *memory = shv_memory_create();
    ShvStatus status = SHV_NO_MEMORY;
    int64_t count = 0;
    for (; status != SHV_OK && count < 3000; count++) {
        ShvError error;
        double errors[SHV_TRAJECTORY_MEASURES];
        shv_memory_fail_after(memory, count);
        ShvOutcome outcome = run(scene, memory, &status, &error);
        if (status == SHV_OK) status = shv_trajectory_errors(&outcome, NULL, errors, &error);
        if (status != SHV_OK) assert_int_equal(status, SHV_NO_MEMORY);
        shv_outcome_release(&outcome);
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
    }
    assert_true(count > 20 && count < 3000);
    shv_memory_fail_after(memory, -1);
    shv_memory_destroy(memory);
    shv_scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bounce),     cmocka_unit_test(test_refusals),  cmocka_unit_test(test_unlike_runs),
        cmocka_unit_test(test_failed_run), cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
