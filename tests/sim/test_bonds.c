/* A piece is what its bonds hold: fragments of whole runs against components by bonds. */
#include "sim/stage.h"

#include <stdlib.h>

#include "bonded_pieces.h"

static int32_t check_pieces(const ShvSimulation *simulation)
{
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    int32_t *fragment = malloc((size_t)mesh.element_count * sizeof *fragment);
    uint8_t *bonds = malloc(4 * (size_t)mesh.element_count);
    assert_true(fragment && bonds);
    shv_simulation_element_state(simulation, fragment, NULL);
    shv_simulation_bonds(simulation, bonds);
    const int32_t pieces = check_bonded_pieces(&mesh, fragment, bonds);
    free(fragment);
    free(bonds);
    return pieces;
}

static void fragments_are_pieces_by_bonds(void **unused)
{
    (void)unused;
    for (int engine = 0; engine < 2; engine++) {
        Stage stage;
        stage_make_breaking_bar(&stage);
        stage.scene.rigid.engine = engine ? SHV_RIGID_BULLET : SHV_RIGID_ANALYTIC;
        stage.scene.fracture.energy_bound = 0.5;
        ShvSimulation *simulation = stage_start(&stage);
        const ShvFrameView *frame = NULL;
        while (!shv_simulation_finished(simulation)) {
            frame = stage_next(simulation);
            assert_int_equal(check_pieces(simulation), frame->alive_count);
            assert_int_equal(frame->pieces[0], frame->alive_count);
            assert_true(frame->pieces[0] <= frame->pieces[1] && frame->pieces[1] <= frame->pieces[2]);
        }
        assert_true(frame->alive_count > 10 && frame->failed > 20 && frame->inserted > frame->failed);
        shv_simulation_destroy(simulation);
    }
}

/* ---- nothing is let go ---- */

/* Largest distance of a corner from the body's centre, m. */
static double reach_of(const ShvSimulation *simulation, const double centre[3])
{
    const size_t count = 4 * (size_t)shv_simulation_mesh(simulation).element_count;
    double *corners = malloc(3 * count * sizeof *corners), reach = 0.0;
    assert_non_null(corners);
    shv_simulation_corner_positions(simulation, corners);
    for (size_t i = 0; i < count; i++) {
        double square = 0.0;
        for (int k = 0; k < 3; k++) square += (corners[3 * i + k] - centre[k]) * (corners[3 * i + k] - centre[k]);
        reach = fmax(reach, sqrt(square));
    }
    free(corners);
    return reach;
}

/* A bar cracked by a stretch that cannot part it, and that spins: it goes to rest with its crack, and stays one body, in nodes
   that bars and ties lead, too. */
static void fly_with_a_held_crack(ShvRigidEngine engine)
{
    Stage stage;
    stage_make(&stage);
    ShvObjectDefinition *bar = stage_box(&stage, "bar", (const double[3]){0.1, 0.02, 0.02}, 0.0125, 0.0);
    bar->mesh.pattern = SHV_PATTERN_BRICKS;
    bar->placement.stretch_rate[0] = 8.0;
    bar->placement.angular_velocity[2] = 5.0;
    stage.material.poissons_ratio = 0.0;
    stage.material.fracture_energy = 5.0; /* far more than the stretch has */
    stage.scene.fracture.on.kind = SHV_SELECT_PLANE;
    stage.scene.fracture.on.plane_normal[0] = 1.0;
    stage.scene.fracture.on.tolerance = 1e-6;
    stage.scene.gravity[2] = 0.0;
    stage.scene.duration = 0.2;
    stage.scene.output.rate = 100.0;
    stage.scene.rigid.engine = engine;
    ShvSimulation *simulation = stage_start(&stage);
    const ShvFrameView *frame = stage_finish(simulation);
    assert_true(frame->inserted > 0 && !frame->fracture);
    check_near(reach_of(simulation, frame->fragments[0].position), sqrt(0.05 * 0.05 + 2e-4), 1e-3 * 0.05);
    assert_int_equal(frame->failed, 0);
    assert_int_equal(frame->alive_count, 1);
    assert_int_equal(check_pieces(simulation), 1);
    const double *inertia = frame->fragments[0].inertia; /* xx, yy, zz, … */
    check_near(frame->ledger.kinetic, 0.5 * inertia[2] * 25.0, 0.05 * frame->ledger.kinetic);
    check_near(frame->ledger.residual, 0.0, 1e-3 * frame->ledger.largest);
    shv_simulation_destroy(simulation);
}

static void a_held_crack_flies(void **unused)
{
    (void)unused;
    fly_with_a_held_crack(SHV_RIGID_ANALYTIC);
    fly_with_a_held_crack(SHV_RIGID_BULLET);
    fly_with_a_held_crack(SHV_RIGID_PBD);
}

/* ---- the last bond ---- */

/* Pulled apart across one plane while it turns, so that bonds fail one after another: it is two from the step in which the
   last of them does, not before and not after. */
static void the_last_bond_parts(void **unused)
{
    (void)unused;
    Stage stage;
    stage_make(&stage);
    ShvObjectDefinition *bar = stage_box(&stage, "bar", (const double[3]){0.1, 0.02, 0.02}, 0.0125, 0.0);
    bar->mesh.pattern = SHV_PATTERN_BRICKS;
    bar->placement.stretch_rate[0] = 40.0;
    stage.material.poissons_ratio = 0.0;
    stage.material.fracture_energy = 20.0;
    stage.material.weibull_modulus = 6.0;
    stage.scene.fracture.on.kind = SHV_SELECT_PLANE;
    stage.scene.fracture.on.plane_normal[0] = 1.0;
    stage.scene.fracture.on.tolerance = 1e-6;
    stage.scene.gravity[2] = 0.0;
    stage.scene.duration = 0.01;
    stage.scene.output.fracture_every = 1;
    ShvSimulation *simulation = stage_start(&stage);
    const ShvFrameView *frame = stage_next(simulation);
    int32_t partly = 0;
    while (!shv_simulation_finished(simulation) && frame->alive_count == 1) {
        partly += frame->failed > 0;
        assert_true(frame->inserted == 0 || frame->failed < frame->inserted || frame->inserted < 8);
        frame = stage_next(simulation);
    }
    assert_int_equal(frame->alive_count, 2);
    assert_int_equal(frame->failed, frame->inserted);
    assert_true(partly > 0);
    for (int32_t i = 0; i < frame->fragment_count; i++)
        if (frame->fragments[i].mode != SHV_FRAGMENT_DEAD) assert_true(frame->fragments[i].tets > 10);
    shv_simulation_destroy(simulation);
}

/* ---- cracked bodies fly ---- */

static double *damage_of(const ShvSimulation *simulation)
{
    const size_t count = 4 * (size_t)shv_simulation_mesh(simulation).element_count;
    double *damage = malloc(count * sizeof *damage);
    assert_non_null(damage);
    shv_simulation_element_state(simulation, NULL, damage);
    return damage;
}

/* Cracked by a first fall, thrown, it breaks by a second: what it had come to is as it was in flight, and goes on from there. */
static void damage_outlives_flight(void **unused)
{
    (void)unused;
    Stage stage;
    stage_make_breaking_bar(&stage);
    stage.objects[0].placement.velocity[2] = -0.26;
    stage.scene.fracture.criterion = SHV_CRITERION_TRACTION; /* disks of this coarse lattice would hold */
    stage.scene.fracture.longest = 0.02; /* so that it flies for most of the time until it is thrown */
    stage.scene.fracture.threshold = 0.9;
    stage.scene.duration = 0.2;
    ShvEventDefinition *event = stage_event(&stage, 0.1, SHV_EVENT_SET_VELOCITY, "bar");
    event->value[2] = -1.5;
    event->angular[1] = 2.0;
    ShvSimulation *simulation = stage_start(&stage);
    const size_t count = 4 * (size_t)shv_simulation_mesh(simulation).element_count;
    double *kept = NULL;
    int flights = 0;
    bool flew = false; /* since it was at rest with `kept` */
    const ShvFrameView *frame = stage_next(simulation);
    while (!shv_simulation_finished(simulation)) {
        frame = stage_next(simulation);
        check_near(frame->ledger.residual, 0.0, 1e-3 * frame->ledger.largest);
        for (int32_t i = 0; i < frame->event_count; i++) flew &= frame->events[i].kind != SHV_RUN_WAKE;
        if (frame->fracture || frame->time > 0.1 || frame->inserted == 0) continue;
        double *damage = damage_of(simulation);
        flights += flew;
        if (flew) assert_memory_equal(damage, kept, count * sizeof *damage);
        free(kept);
        kept = damage;
        flew = true;
    }
    assert_true(kept && flights > 10);
    double *damage = damage_of(simulation), before = 0.0, after = 0.0;
    for (size_t i = 0; i < count; i++) {
        assert_true(damage[i] >= kept[i]);
        before += kept[i];
        after += damage[i];
    }
    assert_true(before > 0.0 && after > 2.0 * before);
    assert_int_equal(check_pieces(simulation), frame->alive_count);
    free(damage);
    free(kept);
    shv_simulation_destroy(simulation);
}

/* ---- the other reading ---- */

/* Under `nodes` the crack of the held bar cuts, though it holds. */
static void nodes_cut_what_holds(void **unused)
{
    (void)unused;
    Stage stage;
    stage_make_breaking_bar(&stage);
    stage.scene.fracture.connectivity = SHV_CONNECTIVITY_NODES;
    stage.scene.fracture.energy_bound = 0.5;
    ShvSimulation *simulation = stage_start(&stage);
    const ShvFrameView *frame = stage_finish(simulation);
    assert_true(frame->alive_count > frame->pieces[0]);
    assert_true(frame->failed > 0 && frame->failed < frame->inserted && frame->pieces[0] > 1);
    shv_simulation_destroy(simulation);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(fragments_are_pieces_by_bonds), cmocka_unit_test(a_held_crack_flies),
        cmocka_unit_test(the_last_bond_parts),           cmocka_unit_test(damage_outlives_flight),
        cmocka_unit_test(nodes_cut_what_holds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
