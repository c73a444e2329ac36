#include "sim/shortage.h"

typedef struct Watched {
    Stage stage;
    ShvProbeDefinition probes[4];
} Watched;

static ShvProbeDefinition *watch(Watched *watched, const char *name, ShvProbeKind kind)
{
    ShvProbeDefinition *probe = &watched->probes[watched->stage.scene.probe_count++];
    *probe = shv_probe_default();
    probe->name = name;
    probe->kind = kind;
    watched->stage.scene.probes = watched->probes;
    return probe;
}

/* The bar that falls and breaks, with a probe of each kind. */
static void make_breaking_bar(Watched *watched)
{
    *watched = (Watched){.stage.scene.probe_count = 0};
    stage_make_breaking_bar(&watched->stage);
    watch(watched, "bar", SHV_PROBE_NODES)->object = "bar";
    watch(watched, "floor", SHV_PROBE_OBSTACLE)->obstacle = "floor";
    watch(watched, "middle", SHV_PROBE_POINT)->point[2] = 0.0512;
}

static void test_watching_changes_nothing(void **state)
{
    (void)state;
    Watched watched;
    make_breaking_bar(&watched);
    const uint64_t seen = stage_hash(&watched.stage);
    watched.stage.scene.probe_count = 0;
    assert_true(stage_hash(&watched.stage) == seen);
}

/* What one row says of the bar's mean velocity follows from the row before by the forces of both: v(n+1) − v(n) =
   dt (a(n) + a(n+1))/2, whatever cracks meanwhile. */
static void check_newton(const double *times, const ShvProbeSample *before, const ShvProbeSample *now, double mass)
{
    const double step = times[1] - times[0];
    for (int axis = 0; axis < 3; axis++) {
        const double gravity = axis == 2 ? -9.81 : 0.0;
        const double force = 0.5 * (before->contact[axis] + now->contact[axis]);
        check_near(now->velocity[axis], before->velocity[axis] + step * (force / mass + gravity), 1e-11);
    }
}

static void check_forces(ShvStabiliser stabiliser)
{
    Watched watched;
    make_breaking_bar(&watched);
    watched.stage.scene.fracture.stabiliser = stabiliser;
    watched.stage.scene.duration = 0.004;
    watched.stage.scene.output.rate = 20.0; /* one interval: steps of one length */
    watched.stage.scene.rigid.time_step = 0.1;
    ShvSimulation *simulation = stage_start(&watched.stage);
    int checked = 0, pushed = 0;
    double mass = 0.0;
    while (!shv_simulation_finished(simulation)) {
        const ShvFrameView *frame = stage_next(simulation);
        const ShvProbeSample *rows = frame->probe_samples;
        if (mass == 0.0) mass = frame->fragments[0].mass;
        for (int64_t i = 0; i < frame->probe_row_count; i++) {
            const ShvProbeSample *row = rows + 3 * i;
            for (int axis = 0; axis < 3; axis++)
                if (!isnan(row[0].contact[axis])) check_near(row[0].contact[axis], -row[1].contact[axis], 1e-9);
            pushed += row[0].contact[2] > 0.0;
            if (i == 0 || isnan(row[0].contact[2]) || isnan(row[-3].contact[2])) continue;
            check_newton(frame->probe_times + i - 1, &row[-3], &row[0], mass);
            checked++;
        }
    }
    assert_true(checked > 30);
    assert_true(pushed > 10);
    assert_true(shv_simulation_frame(simulation)->inserted > 0);
    shv_simulation_destroy(simulation);
}

static void test_forces_move_the_body(void **state)
{
    (void)state;
    check_forces(SHV_STABILISER_NONE);
}

static void test_forces_with_bars(void **state)
{
    (void)state;
    check_forces(SHV_STABILISER_BARS);
}

/* In flight there are rows at frames: a parabola, without stress and forces. */
static void test_flight(void **state)
{
    (void)state;
    Watched watched;
    make_breaking_bar(&watched);
    watched.stage.objects[0].placement.position[2] = 1.0;
    watched.probes[2].point[2] = 1.01;
    watched.stage.objects[0].placement.angular_velocity[2] = 3.0;
    watched.stage.scene.output.rate = 100.0;
    ShvSimulation *simulation = stage_start(&watched.stage);
    for (int i = 0; i < 3; i++) {
        const ShvFrameView *frame = stage_next(simulation);
        const double t = frame->time;
        assert_int_equal(frame->probe_count, 3);
        assert_int_equal(frame->probe_row_count, 1);
        assert_string_equal(frame->probes[1].name, "floor");
        assert_true(frame->probe_times[0] == t);
        for (int p = 0; p < 3; p += 2) {
            const ShvProbeSample *sample = &frame->probe_samples[p];
            check_near(sample->displacement[2], -t - 0.5 * 9.81 * t * t, 1e-12);
            check_near(sample->velocity[2], -1.0 - 9.81 * t, 1e-12);
            assert_true(isnan(sample->stress[0]) && isnan(sample->contact[0]));
        }
        assert_true(frame->probe_samples[1].displacement[2] == 0.0);
    }
    shv_simulation_destroy(simulation);
}

/* Two blocks in fracture mode, one thrown at the other and aslant, so that they rub: at every time the force on one is that
   on the other the other way round, and what the first loses is the impulse of those forces. */
static void test_bodies_push_each_other(void **state)
{
    (void)state;
    Watched watched = {.stage.scene.probe_count = 0};
    stage_make(&watched.stage);
    const char *const names[] = {"thrown", "struck"};
    for (int i = 0; i < 2; i++) {
        stage_box(&watched.stage, names[i], (const double[3]){0.02, 0.02, 0.02}, 0.01, 0.0)->placement.position[0] =
            0.0203 * i;
        stage_support(&watched.stage, i ? "pull" : "push", names[i])->kind =
            SHV_CONDITION_TRACTION; /* of 0 Pa: awake */
        watch(&watched, names[i], SHV_PROBE_NODES)->object = names[i];
    }
    watched.stage.objects[0].placement.velocity[0] = 1.0;
    watched.stage.objects[0].placement.velocity[2] = 0.3;
    watched.stage.material.breakable = false;
    watched.stage.scene.gravity[2] = 0.0;
    watched.stage.scene.duration = 0.002;
    watched.stage.scene.output.rate = 20.0; /* one interval: steps of one length */
    ShvSimulation *simulation = stage_start(&watched.stage);
    const double mass = 0.02 * 0.02 * 0.02 * watched.stage.material.density;
    double pushed = 0.0, rubbed = 0.0;
    int checked = 0;
    while (!shv_simulation_finished(simulation)) {
        const ShvFrameView *frame = stage_next(simulation);
        for (int64_t i = 0; i < frame->probe_row_count; i++) {
            const ShvProbeSample *row = frame->probe_samples + 2 * i;
            if (i == 0 || isnan(row[0].contact[0]) || isnan(row[-2].contact[0])) continue;
            pushed = fmin(pushed, row[0].contact[0]);
            rubbed = fmin(rubbed, row[0].contact[2]);
            for (int axis = 0; axis < 3; axis++) {
                const double force = 0.5 * (row[-2].contact[axis] + row[0].contact[axis]);
                const double step = frame->probe_times[i] - frame->probe_times[i - 1];
                check_near(row[1].contact[axis], -row[0].contact[axis], 1e-9);
                check_near(row[0].velocity[axis], row[-2].velocity[axis] + step * force / mass, 1e-11);
            }
            checked++;
        }
    }
    assert_true(checked > 30);
    assert_true(pushed < -1.0);
    assert_true(rubbed < -0.1);
    shv_simulation_destroy(simulation);
}

/* A point at a corner of an unbroken block moves as the node that is there, and a point between nodes as their line. */
static void test_point_is_interpolated(void **state)
{
    (void)state;
    Watched watched = {.stage.scene.probe_count = 0};
    stage_make(&watched.stage);
    ShvObjectDefinition *block = stage_box(&watched.stage, "block", (const double[3]){0.02, 0.02, 0.02}, 0.02, 0.0101);
    stage_floor(&watched.stage);
    block->placement.velocity[2] = -1.0;
    watched.stage.material.breakable = false;
    stage_support(&watched.stage, "awake", "block")->kind = SHV_CONDITION_TRACTION; /* of 0 Pa */
    watched.stage.scene.duration = 0.001;
    const double tip[3] = {0.01, 0.01, 0.0201};
    memcpy(watch(&watched, "corner", SHV_PROBE_POINT)->point, tip, sizeof tip);
    ShvProbeDefinition *node = watch(&watched, "node", SHV_PROBE_NODES);
    node->object = "block";
    node->selection.kind = SHV_SELECT_BOX;
    node->selection.tolerance = 1e-9;
    memcpy(node->selection.box_min, tip, sizeof tip);
    memcpy(node->selection.box_max, tip, sizeof tip);
    ShvSimulation *simulation = stage_start(&watched.stage);
    const ShvFrameView *frame = NULL;
    int64_t rows = 0;
    double largest = 0.0;
    while (!shv_simulation_finished(simulation)) {
        frame = stage_next(simulation);
        for (int64_t i = 0; i < frame->probe_row_count; i++, rows++)
            for (int axis = 0; axis < 3; axis++) {
                const ShvProbeSample *row = frame->probe_samples + 2 * i;
                check_near(row[0].displacement[axis], row[1].displacement[axis], 1e-15);
                check_near(row[0].velocity[axis], row[1].velocity[axis], 1e-12);
                largest = fmax(largest, fabs(row[0].stress[2]));
            }
    }
    assert_true(rows > 5);
    assert_true(largest > 1e3);
    shv_simulation_destroy(simulation);
}

/* A block held everywhere weighs on its support. */
static void test_reaction_is_the_weight(void **state)
{
    (void)state;
    Watched watched = {.stage.scene.probe_count = 0};
    stage_make(&watched.stage);
    stage_box(&watched.stage, "held", (const double[3]){0.02, 0.02, 0.04}, 0.01, 0.5);
    stage_support(&watched.stage, "hold", "held");
    watched.stage.scene.duration = 0.001;
    watched.stage.scene.output.probe_every = 3;
    watch(&watched, "held", SHV_PROBE_NODES)->object = "held";
    ShvSimulation *simulation = stage_start(&watched.stage);
    const double weight = 0.02 * 0.02 * 0.04 * watched.stage.material.density * 9.81;
    int64_t rows = 0;
    const ShvFrameView *frame = stage_next(simulation);
    assert_int_equal(frame->probe_row_count, 0);
    while (!shv_simulation_finished(simulation)) {
        frame = stage_next(simulation);
        for (int64_t i = 0; i < frame->probe_row_count; i++, rows++) {
            check_near(frame->probe_samples[i].reaction[2], weight, 1e-9 * weight);
            check_near(frame->probe_samples[i].stress[2], 0.0, 0.0);
        }
    }
    assert_int_equal(rows, (frame->steps + 2) / 3);
    shv_simulation_destroy(simulation);
}

/* One row for each multiple of the interval, at the first step from it on. */
static void test_interval(void **state)
{
    (void)state;
    Watched watched = {.stage.scene.probe_count = 0};
    stage_make(&watched.stage);
    stage_box(&watched.stage, "held", (const double[3]){0.02, 0.02, 0.04}, 0.01, 0.5);
    stage_support(&watched.stage, "hold", "held");
    watched.stage.scene.duration = 0.01;
    watched.stage.scene.output.probe_interval = 1e-4;
    watch(&watched, "held", SHV_PROBE_NODES)->object = "held";
    ShvSimulation *simulation = stage_start(&watched.stage);
    int64_t rows = 0;
    while (!shv_simulation_finished(simulation)) {
        const ShvFrameView *frame = stage_next(simulation);
        for (int64_t i = 0; i < frame->probe_row_count; i++, rows++) {
            const double due = (double)rows * 1e-4;
            assert_true(frame->probe_times[i] >= due - 1e-12);
            assert_true(frame->probe_times[i] < due + frame->step + 1e-12);
        }
    }
    assert_int_equal(rows, 100);
    shv_simulation_destroy(simulation);
}

static void refuse(const Watched *watched, const char *part)
{
    ShvSimulation *simulation;
    ShvError error = {SHV_OK, ""};
    check_fails(shv_simulation_create(&simulation, &watched->stage.scene, NULL, &error), SHV_BAD_INPUT, error, part);
    assert_null(simulation);
}

static void test_bad_probes(void **state)
{
    (void)state;
    Watched watched;
    make_breaking_bar(&watched);
    watched.probes[2].point[0] = 1.0;
    refuse(&watched, "probe middle: the point (1, 0, 0.0512) m lies in no tet of any object");
    watched.probes[2].object = "bar";
    refuse(&watched, "lies in no tet of object bar at the start; move it inside");
    watched.probes[2].point[0] = (double)NAN;
    refuse(&watched, "probe middle: its point is not finite");
    watched.probes[2].object = "beam";
    watched.probes[2].point[0] = 0.0;
    refuse(&watched, "probe middle: there is no object named 'beam'");
    watched.probes[1].obstacle = "wall";
    refuse(&watched, "probe floor: there is no obstacle named 'wall'");
    watched.probes[0].selection.kind = SHV_SELECT_PLANE;
    watched.probes[0].selection.plane_normal[0] = 1.0;
    watched.probes[0].selection.plane_offset = 7.0;
    refuse(&watched, "probe bar: its selection contains no node of object bar");
    watched.probes[0].object = NULL;
    refuse(&watched, "probe bar: there is no object named ''");
    watched.probes[0].name = NULL;
    refuse(&watched, "probe without a name: it has no name");
    watched.probes[0].cookie = 0;
    refuse(&watched, "shv_probe_default()");
    watched.stage.scene.output.probe_every = 0;
    refuse(&watched, "output.probe_every must be a finite number of at least 1");
}

static void has_rows(const ShvFrameView *frame)
{
    assert_true(frame->probe_row_count > 0);
}

static void test_no_memory(void **state)
{
    (void)state;
    Watched watched;
    make_breaking_bar(&watched);
    watched.stage.objects[0].mesh.edge = 0.02;
    watched.stage.scene.duration = 0.0012;
    fail_everywhere(&watched.stage, has_rows);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_watching_changes_nothing),
                                       cmocka_unit_test(test_forces_move_the_body),
                                       cmocka_unit_test(test_forces_with_bars),
                                       cmocka_unit_test(test_flight),
                                       cmocka_unit_test(test_bodies_push_each_other),
                                       cmocka_unit_test(test_point_is_interpolated),
                                       cmocka_unit_test(test_reaction_is_the_weight),
                                       cmocka_unit_test(test_interval),
                                       cmocka_unit_test(test_bad_probes),
                                       cmocka_unit_test(test_no_memory)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
