/* What holds of any motion, whatever the program does to make it: bodies that only meet one another keep their momentum, a scene told
   in other units is the same scene, what has a velocity moves, and what is far away and rigid is nothing to it. */
#include "base/vector.h"
#include "sim/stage.h"

/* ---- momentum ---- */

/* A plate of chalk between two cubes that break it and themselves, far from any support. */
static void make_collision(Stage *stage, double speed, double turn, double time_step)
{
    static const double plate[3] = {0.06, 0.06, 0.02}, cube[3] = {0.03, 0.03, 0.03};
    stage_make(stage);
    stage_box(stage, "plate", plate, 0.012, 0.0);
    ShvObjectDefinition *above = stage_box(stage, "above", cube, 0.015, 0.04);
    above->placement.position[0] = 0.011;
    above->placement.velocity[2] = -speed;
    above->placement.rotation_axis[0] = 1.0;
    above->placement.rotation_degrees = turn;
    ShvObjectDefinition *below = stage_box(stage, "below", cube, 0.015, -0.045);
    below->placement.position[0] = -0.02;
    below->placement.position[1] = -0.012;
    below->placement.velocity[2] = 0.6 * speed;
    below->placement.rotation_axis[1] = 1.0;
    below->placement.rotation_degrees = 2.0 * turn;
    ShvObstacleDefinition *ball = stage_free_ball(stage, "ball", 0.01, 0.02);
    ball->placement.position[1] = 0.1;
    ball->placement.velocity[1] = -2.0 * speed;
    stage->scene.rigid.time_step = time_step;
    stage->scene.duration = 0.05;
    stage->scene.output.rate = 500.0;
}

/* Of the frame alone, as a reader of the run file sums it; *size receives Σ m |v|. */
static ShvVec3 momentum_of(const ShvFrameView *frame, double ball_mass, double *mass, double *size)
{
    const ShvVec3 ball = shv_scale(shv_load3(frame->obstacles[0].velocity), ball_mass);
    ShvVec3 sum = ball;
    *mass = ball_mass;
    *size = shv_norm(ball);
    for (int32_t i = 0; i < frame->fragment_count; i++) {
        const ShvFragmentView *fragment = &frame->fragments[i];
        if (fragment->mode != SHV_FRAGMENT_FLIGHT && fragment->mode != SHV_FRAGMENT_FRACTURE) continue;
        const ShvVec3 own = shv_scale(shv_load3(fragment->velocity), fragment->mass);
        sum = shv_add(sum, own);
        *mass += fragment->mass;
        *size += shv_norm(own);
    }
    return sum;
}

static void momentum_is_that_of_a_fall(void **state)
{
    (void)state;
    static const double speeds[] = {2.0, 4.0}, turns[] = {15.0, 40.0}, steps[] = {1e-3, 3e-3};
    for (int k = 0; k < 2; k++) {
        Stage stage;
        make_collision(&stage, speeds[k], turns[k], steps[k]);
        ShvSimulation *simulation = stage_start(&stage);
        double mass, size, unused;
        const ShvVec3 start = momentum_of(stage_next(simulation), stage.obstacles[0].mass, &mass, &size);
        const ShvVec3 gravity = shv_load3(stage.scene.gravity);
        while (!shv_simulation_finished(simulation)) {
            const ShvFrameView *frame = stage_next(simulation);
            const ShvVec3 expected = shv_madd(start, mass * frame->time, gravity);
            const ShvVec3 momentum = momentum_of(frame, stage.obstacles[0].mass, &unused, &unused);
            check_near(shv_norm(shv_sub(momentum, expected)), 0.0, 1e-11 * size);
            check_near(shv_norm(shv_sub(shv_load3(frame->ledger.momentum), expected)), 0.0, 1e-11 * size);
        }
        assert_true(shv_simulation_frame(simulation)->alive_count > 100);
        shv_simulation_destroy(simulation);
    }
}

/* ---- units ---- */

/* So many of today's units of length, mass and time make one of those in which the scene is told. Powers of two change no digit, so that
   any difference is a length, a mass or a time that the program has of its own. Square roots of masses ask for powers of four. */
typedef struct Units {
    double length, mass, time;
} Units;

static void scale_placement(ShvPlacement *placement, Units u)
{
    for (int i = 0; i < 3; i++) {
        placement->position[i] *= u.length;
        placement->velocity[i] *= u.length / u.time;
        placement->angular_velocity[i] /= u.time;
    }
}

static void tell_in(Stage *stage, Units u)
{
    const double stress = u.mass / (u.length * u.time * u.time);
    stage->material.density *= u.mass / (u.length * u.length * u.length);
    stage->material.youngs_modulus *= stress;
    stage->material.cohesive_strength *= stress;
    stage->material.fracture_energy *= u.mass / (u.time * u.time);
    for (int32_t k = 0; k < stage->scene.object_count; k++) {
        ShvObjectDefinition *object = &stage->objects[k];
        for (int i = 0; i < 3; i++) object->mesh.size[i] *= u.length;
        object->mesh.edge *= u.length;
        scale_placement(&object->placement, u);
    }
    for (int32_t k = 0; k < stage->scene.obstacle_count; k++) {
        stage->obstacles[k].radius *= u.length;
        stage->obstacles[k].mass *= u.mass;
        scale_placement(&stage->obstacles[k].placement, u);
    }
    for (int i = 0; i < 3; i++) stage->scene.gravity[i] *= u.length / (u.time * u.time);
    stage->scene.rigid.time_step *= u.time;
    stage->scene.duration *= u.time;
    stage->scene.output.rate /= u.time;
}

static void check_same(const ShvFrameView *a, const ShvFrameView *b, Units u)
{
    const double energy = u.mass * u.length * u.length / (u.time * u.time);
    assert_int_equal(a->fragment_count, b->fragment_count);
    assert_int_equal(a->alive_count, b->alive_count);
    assert_true(a->steps == b->steps);
    check_near(b->time, a->time * u.time, 0.0);
    check_near(b->ledger.kinetic, a->ledger.kinetic * energy, 0.0);
    check_near(b->ledger.strain, a->ledger.strain * energy, 0.0);
    check_near(b->ledger.fracture_dissipation, a->ledger.fracture_dissipation * energy, 0.0);
    for (int32_t i = 0; i < a->fragment_count; i++)
        for (int k = 0; k < 3; k++) {
            check_near(b->fragments[i].position[k], a->fragments[i].position[k] * u.length, 0.0);
            check_near(b->fragments[i].angular_velocity[k], a->fragments[i].angular_velocity[k] / u.time, 0.0);
        }
}

static void check_units(ShvRigidEngine engine, Units units)
{
    Stage stage, other;
    make_collision(&stage, 3.0, 30.0, 1e-3);
    make_collision(&other, 3.0, 30.0, 1e-3);
    stage.scene.rigid.engine = other.scene.rigid.engine = engine;
    stage.scene.duration = other.scene.duration = 0.03;
    tell_in(&other, units);
    ShvSimulation *as_told = stage_start(&stage), *in_others = stage_start(&other);
    while (!shv_simulation_finished(as_told)) check_same(stage_next(as_told), stage_next(in_others), units);
    assert_true(shv_simulation_finished(in_others) && shv_simulation_frame(as_told)->alive_count > 20);
    shv_simulation_destroy(as_told);
    shv_simulation_destroy(in_others);
}

static void units_do_not_matter(void **state)
{
    (void)state;
    check_units(SHV_RIGID_BULLET, (Units){1.0 / 64.0, 1.0, 1.0});
    check_units(SHV_RIGID_BULLET, (Units){1.0, 256.0, 1.0 / 16.0});
    check_units(SHV_RIGID_ANALYTIC, (Units){4.0, 1.0 / 64.0, 2.0});
}

/* ---- motion ---- */

enum { MOST_PIECES = 1000 };

/* Pieces that are fast enough to be seen and have not moved at all since the frame before. */
static void check_motion(const ShvFrameView *frame, double positions[MOST_PIECES][3], int32_t known)
{
    static const double slow = 0.02; /* m/s */
    for (int32_t i = 0; i < frame->fragment_count; i++) {
        const ShvFragmentView *fragment = &frame->fragments[i];
        const bool same = memcmp(fragment->position, positions[i], sizeof positions[i]) == 0;
        if (i < known && fragment->mode == SHV_FRAGMENT_FLIGHT && same)
            assert_true(shv_norm(shv_load3(fragment->velocity)) < slow);
        memcpy(positions[i], fragment->position, sizeof positions[i]);
    }
}

/* Splinters of a bar that falls on a stone, of analytic flight, which get caught by its edges. */
static void what_has_a_velocity_moves(void **state)
{
    (void)state;
    static double positions[MOST_PIECES][3];
    Stage stage;
    stage_make(&stage);
    ShvObjectDefinition *bar = stage_box(&stage, "bar", (const double[3]){0.02, 0.02, 0.1}, 0.01, 0.09);
    /* to all digits: of sixty bars thrown at random the one of which a piece hung */
    bar->placement.position[0] = 0.00014110873687815662;
    bar->placement.velocity[2] = -2.6434957405623973;
    bar->placement.rotation_axis[1] = 1.0;
    bar->placement.rotation_degrees = 38.457662769236521;
    stage_floor(&stage)->friction = 0.3;
    ShvObstacleDefinition *stone = &stage.obstacles[stage.scene.obstacle_count++];
    *stone = shv_obstacle_default();
    stone->name = "stone";
    stone->shape = SHV_OBSTACLE_BOX;
    memcpy(stone->size, (const double[3]){0.02, 0.03, 0.024}, sizeof stone->size);
    stone->placement.position[2] = 0.012;
    stone->placement.rotation_axis[2] = 1.0;
    stone->placement.rotation_degrees = 19.059113255870347;
    stone->friction = 0.6;
    stage.scene.rigid.engine = SHV_RIGID_ANALYTIC;
    stage.scene.duration = 0.12;
    stage.scene.output.rate = 500.0;
    ShvSimulation *simulation = stage_start(&stage);
    int32_t known = 0;
    while (!shv_simulation_finished(simulation)) {
        const ShvFrameView *frame = stage_next(simulation);
        assert_true(frame->fragment_count <= MOST_PIECES);
        check_motion(frame, positions, known);
        known = frame->fragment_count;
    }
    assert_true(known > 100);
    shv_simulation_destroy(simulation);
}

/* ---- locality ---- */

/* Steps of a chalk box that falls on the floor, and where it is in the end; beside a flying one of steel, whose tets share a batch with
   its own. */
static int64_t steps_of_a_fall(bool beside, ShvVec3 *end)
{
    Stage stage;
    stage_make(&stage);
    stage_box(&stage, "box", (const double[3]){0.03, 0.03, 0.03}, 0.012, 0.02)->placement.velocity[2] = -1.0;
    stage.objects[0].mesh.pattern = SHV_PATTERN_BRICKS;
    stage_floor(&stage);
    ShvMaterialDefinition materials[2] = {stage.material, stage.material};
    materials[1].name = "steel";
    materials[1].youngs_modulus = 200e9;
    materials[1].breakable = false;
    stage.scene.materials = materials;
    stage.scene.material_count = 2;
    if (beside) stage_box(&stage, "far", (const double[3]){0.03, 0.03, 0.03}, 0.012, 500.0)->material = "steel";
    ShvSimulation *simulation = stage_start(&stage);
    const ShvFrameView *frame = stage_finish(simulation);
    const int64_t steps = frame->steps;
    *end = shv_load3(frame->fragments[0].position);
    shv_simulation_destroy(simulation);
    return steps;
}

static void a_stiff_body_in_flight_sets_no_step(void **state)
{
    (void)state;
    ShvVec3 alone, beside;
    const int64_t steps = steps_of_a_fall(false, &alone);
    assert_true(steps > 50);
    assert_true(steps_of_a_fall(true, &beside) < 2 * steps);
    check_near(shv_norm(shv_sub(alone, beside)), 0.0, 1e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(momentum_is_that_of_a_fall),
        cmocka_unit_test(units_do_not_matter),
        cmocka_unit_test(what_has_a_velocity_moves),
        cmocka_unit_test(a_stiff_body_in_flight_sets_no_step),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
