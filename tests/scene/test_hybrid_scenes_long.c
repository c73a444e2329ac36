/* Scenes of scenes/hybrid to their ends, or until what they show has happened. */
#include "check.h"

#include "shiver/scene.h"
#include "shiver/simulation.h"

typedef struct Run {
    ShvScene *scene;
    ShvSimulation *simulation;
    const ShvFrameView *frame;
    ShvError error;
} Run;

static Run start(const char *name, const char *const *overrides)
{
    char path[200];
    size_t count = 0;
    while (overrides && overrides[count]) count++;
    snprintf(path, sizeof path, "../scenes/hybrid/%s.yaml", name);
    Run run = {.error = {SHV_OK, ""}};
    check_ok(shv_scene_load(&run.scene, path, overrides, count, NULL, NULL, &run.error), run.error);
    check_ok(shv_simulation_create(&run.simulation, shv_scene_definition(run.scene), NULL, &run.error), run.error);
    return run;
}

static bool go_on(Run *run)
{
    if (run->frame && shv_simulation_finished(run->simulation)) return false;
    check_ok(shv_simulation_advance(run->simulation, &run->error), run->error);
    run->frame = shv_simulation_frame(run->simulation);
    return true;
}

static void end(Run *run)
{
    shv_simulation_destroy(run->simulation);
    shv_scene_destroy(run->scene);
}

static int32_t awake_fragments(const ShvFrameView *frame)
{
    int32_t awake = 0;
    for (int32_t i = 0; i < frame->fragment_count; i++)
        awake += isnan(frame->fragments[i].death) && frame->fragments[i].mode == SHV_FRAGMENT_FRACTURE;
    return awake;
}

static double length(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Momentum to round-off of Σ m |v| through contact, breaking and rest. */
static void two_balls_keep_their_momentum(void **state)
{
    (void)state;
    Run run = start("two_balls", NULL);
    double first[3] = {0.0}, scale = 0.0;
    while (go_on(&run)) {
        const ShvLedgerView *ledger = &run.frame->ledger;
        if (scale == 0.0) {
            memcpy(first, ledger->momentum, sizeof first);
            for (int32_t i = 0; i < run.frame->fragment_count; i++)
                scale += run.frame->fragments[i].mass * length(run.frame->fragments[i].velocity);
        }
        for (int axis = 0; axis < 3; axis++) check_near(ledger->momentum[axis], first[axis], 1e-10 * scale);
    }
    assert_true(run.frame->inserted > 100);
    assert_true(fabs(run.frame->ledger.residual) < 1e-4 * run.frame->ledger.largest);
    end(&run);
}

/* Pieces of the plate that the ledge has broken break again on the floor, a quarter of a second later. */
static void second_generation_breaks_again(void **state)
{
    (void)state;
    Run run = start("second_generation", NULL);
    while (go_on(&run)) continue;
    const double between = 0.3; /* s: after the ledge, before the floor */
    int32_t first = 0, second = 0;
    for (int32_t i = 0; i < run.frame->fragment_count; i++) {
        const ShvFragmentView *fragment = &run.frame->fragments[i];
        if (fragment->parent < 0) continue;
        const ShvFragmentView *parent = &run.frame->fragments[fragment->parent];
        assert_int_equal(parent->id, fragment->parent);
        first += fragment->birth < between;
        second += fragment->birth > between && parent->birth > 0.0 && parent->birth < between;
    }
    assert_true(first > 10);
    assert_true(second > 0);
    assert_true(fabs(run.frame->ledger.residual) < 0.01 * run.frame->ledger.largest);
    end(&run);
}

/* The pieces rattle, and in the end all are rigid bodies again. */
static void rattling_pieces_go_back(void **state)
{
    (void)state;
    static const char *const coarse[] = {"objects.tile.mesh.box.edge=12 mm", NULL};
    Run run = start("tile_on_floor", coarse);
    while (go_on(&run)) continue;
    assert_true(run.frame->inserted > 50);
    assert_int_equal(awake_fragments(run.frame), 0);
    assert_true(fabs(run.frame->ledger.residual) < 0.01 * run.frame->ledger.largest);
    end(&run);
}

/* The brick under a breaking tile stays where it stands, to a thousandth of its height. */
static void brick_does_not_sink(void **state)
{
    (void)state;
    Run run = start("tile_on_brick", NULL);
    int64_t steps = 0;
    while (go_on(&run)) {
        for (int32_t i = 0; i < run.frame->fragment_count; i++)
            if (run.frame->fragments[i].object == 1) assert_true(run.frame->fragments[i].position[2] > 0.02 - 4e-5);
        steps = run.frame->steps;
    }
    assert_true(steps > 100);
    assert_true(run.frame->inserted > 0);
    end(&run);
}

/* Half a kilogram from 2 cm: the load wakes the pane, and it breaks. */
static void pane_breaks(void **state)
{
    (void)state;
    static const char *const coarse[] = {"objects.pane.mesh.box.edge=6 mm", NULL};
    Run run = start("pane", coarse);
    while (go_on(&run) && run.frame->inserted < 100) continue;
    assert_true(run.frame->steps > 0);
    assert_true(run.frame->inserted >= 100);
    end(&run);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(two_balls_keep_their_momentum),
        cmocka_unit_test(second_generation_breaks_again),
        cmocka_unit_test(rattling_pieces_go_back),
        cmocka_unit_test(brick_does_not_sink),
        cmocka_unit_test(pane_breaks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
