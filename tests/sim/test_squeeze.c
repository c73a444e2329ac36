/* A body between obstacles that leave it no room is told, with the time, the body and both obstacles; one that just fits is not. */
#include "sim/stage.h"

/* A cube of 4 cm on the floor, under a ceiling at `height` that comes down at `speed`. */
static void press(Stage *stage, double height, double speed, ShvKeyframe keys[2])
{
    stage_make(stage);
    stage->material.breakable = false;
    stage_box(stage, "cube", (const double[3]){0.04, 0.04, 0.04}, 0.02, 0.02);
    stage_floor(stage);
    ShvObstacleDefinition *ceiling = &stage->obstacles[stage->scene.obstacle_count++];
    *ceiling = shv_obstacle_default();
    ceiling->name = "ceiling";
    ceiling->shape = SHV_OBSTACLE_BOX;
    for (int i = 0; i < 3; i++) ceiling->size[i] = 0.1;
    for (int i = 0; i < 2; i++) {
        keys[i] = (ShvKeyframe){.time = i, .rotation_axis = {0.0, 0.0, 1.0}};
        keys[i].position[2] = height + 0.05 - speed * i;
    }
    ceiling->keyframes = keys;
    ceiling->keyframe_count = 2;
    ceiling->motion = SHV_OBSTACLE_SCRIPTED;
}

typedef struct Told {
    int events;
    double first;   /* s */
    double missing; /* m, of the first */
    int obstacles[2];
    int fragment;
} Told;

static Told follow(const Stage *stage)
{
    Told told = {.fragment = -1};
    ShvSimulation *simulation = stage_start(stage);
    while (!shv_simulation_finished(simulation)) {
        const ShvFrameView *frame = stage_next(simulation);
        for (int32_t i = 0; i < frame->event_count; i++) {
            const ShvEventView *event = &frame->events[i];
            if (event->kind != SHV_RUN_SQUEEZE) continue;
            if (told.events == 0) {
                told.first = event->time;
                told.missing = event->value;
                told.fragment = event->fragment;
            }
            if (told.events < 2) told.obstacles[told.events] = event->obstacle;
            told.events++;
        }
    }
    shv_simulation_destroy(simulation);
    return told;
}

/* The press closes at 10 mm/s and meets the cube after 10 ms; a hundredth of the radius is missing 34.6 ms later, and the end
   of that rigid step tells it, once, for both obstacles. */
static void test_press(void **state)
{
    (void)state;
    static const ShvRigidEngine engines[] = {SHV_RIGID_ANALYTIC, SHV_RIGID_BULLET, SHV_RIGID_PBD};
    const double radius = sqrt(3.0) * 0.02, due = 0.01 + 0.01 * radius / 0.01;
    for (int i = 0; i < 3; i++) {
        ShvKeyframe keys[2];
        Stage stage;
        press(&stage, 0.0401, 0.01, keys);
        stage.scene.rigid.engine = engines[i];
        const Told told = follow(&stage);
        assert_int_equal(told.events, 2);
        assert_int_equal(told.fragment, 0);
        assert_int_equal(told.obstacles[0] + told.obstacles[1], 1);
        assert_true(told.obstacles[0] != told.obstacles[1]);
        /* A body that tilts between them lacks room earlier; nodes and bars let it be pressed flat, so that its best-fit
           shape lags by what the bars yield. */
        const double lag = engines[i] == SHV_RIGID_PBD ? 0.02 : 1.1 * stage.scene.rigid.time_step;
        if (!(told.first > 0.01 && told.first <= due + lag))
            fail_msg("engine %d tells it at %g s, not between 0.01 and %g s", i, told.first, due);
        assert_true(told.missing >= 0.01 * radius);
    }
}

/* A ceiling that leaves a tenth of a millimetre, and one that just touches. */
static void test_room_enough(void **state)
{
    (void)state;
    const double heights[] = {0.0401, 0.04};
    for (int i = 0; i < 2; i++) {
        ShvKeyframe keys[2];
        Stage stage;
        press(&stage, heights[i], 0.0, keys);
        assert_int_equal(follow(&stage).events, 0);
    }
}

/* What deforms may be pressed; told is only what no node has room for. */
static void test_awake(void **state)
{
    (void)state;
    ShvKeyframe keys[2];
    for (int i = 0; i < 2; i++) {
        Stage stage;
        press(&stage, i ? -0.002 : 0.0399, 0.0, keys);
        stage.scene.overlaps = SHV_OVERLAPS_KEEP;
        stage.objects[0].placement.stretch_rate[0] = 1e-6; /* starts awake */
        stage.scene.duration = 0.002;
        stage.scene.output.rate = 1000.0;
        assert_int_equal(follow(&stage).events, i ? 2 : 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_press),
        cmocka_unit_test(test_room_enough),
        cmocka_unit_test(test_awake),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
