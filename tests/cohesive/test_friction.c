/* Coulomb friction of cohesive facets under pressure, against closed forms of two blocks that meet on a plane. */
#include "cohesive/fixture.h"

static const double side = 0.006, coefficient = 0.6; /* m; tan φ */

/* Two blocks on x = 0, so heavy that what they do to each other in some hundred steps hardly slows them. */
static void two_blocks(Fixture *f, double energy, double cohesion, double density)
{
    fixture_define(f, 2.0 * side, side, side, 0.5 * side);
    f->material.density = density;
    f->material.fracture_energy = energy;
    f->material.cohesive_strength = 10e6;
    f->material.cohesive_strength_shear = cohesion;
    f->material.friction_angle_degrees = atan(coefficient) * 57.295779513082323;
    fixture_build_cubes(f, 4, 2, 2);
    fixture_start(f);
    int32_t *facets = calloc((size_t)f->model.adjacency.interior_count, sizeof *facets), duplicated;
    const int32_t count = fixture_plane(f, 0.0, 1e-9, facets);
    check_ok(shv_cohesive_insert(&f->cohesive, &f->state, NULL, facets, count, &duplicated, &f->error), f->error);
    free(facets);
}

/* A third of the area of the facets at every node of a face, with the sign of the way out of its block. */
static double *face_areas(const Fixture *f)
{
    double *areas = calloc((size_t)f->state.node_count, sizeof *areas);
    for (int32_t i = 0; i < f->cohesive.count; i++) {
        const ShvCohesiveSides *sides = &f->cohesive.sides[i];
        const int first_is_left = f->model.mesh.positions[3 * f->model.mesh.elements[4 * sides->elements[0]]] +
                                      f->model.mesh.positions[3 * f->model.mesh.elements[4 * sides->elements[0] + 1]] +
                                      f->model.mesh.positions[3 * f->model.mesh.elements[4 * sides->elements[0] + 2]] +
                                      f->model.mesh.positions[3 * f->model.mesh.elements[4 * sides->elements[0] + 3]] <
                                  0.0;
        for (int k = 0; k < 3; k++) {
            areas[sides->first[k]] += (first_is_left ? 1.0 : -1.0) * f->cohesive.area[i] / 3.0;
            areas[sides->second[k]] += (first_is_left ? -1.0 : 1.0) * f->cohesive.area[i] / 3.0;
        }
    }
    return areas;
}

/* One step under a pressure and a shear stress along z on both faces, Pa. Returns the force by which the left face holds the
   right one back, N. */
static double step_once(Fixture *f, const double *areas, double pressure, double shear, double step, ShvLedger *ledger)
{
    ShvState *state = &f->state;
    double held = 0.0;
    memset(state->force, 0, 3 * (size_t)state->node_count * sizeof *state->force);
    shv_cohesive_begin(&f->cohesive, state, NULL);
    for (int32_t i = 0; i < state->node_count; i++) {
        state->velocity[3 * i] += step / state->mass[i] * areas[i] * pressure;
        state->velocity[3 * i + 2] -= step / state->mass[i] * areas[i] * shear;
    }
    shv_cohesive_pull(&f->cohesive, state, step, step);
    shv_cohesive_close(&f->cohesive, state, step, step);
    shv_cohesive_pull(&f->cohesive, state, step, step);
    shv_ledger_begin_step(ledger);
    shv_cohesive_book(&f->cohesive, state, step, ledger);
    for (int32_t i = 0; i < state->node_count; i++)
        if (areas[i] < 0.0) held -= state->force[3 * i + 2];
    for (int64_t i = 0; i < 3 * (int64_t)state->node_count; i++) state->displacement[i] += step * state->velocity[i];
    state->last_step = step;
    state->time += step;
    return held;
}

/* Mean slip of the faces, m. */
static double slip_of(const Fixture *f, const double *areas)
{
    double sum = 0.0;
    for (int32_t i = 0; i < f->state.node_count; i++) sum -= areas[i] * f->state.displacement[3 * i + 2];
    return sum / (side * side);
}

static void slide(Fixture *f, const double *areas, double speed)
{
    for (int32_t i = 0; i < f->state.node_count; i++)
        if (areas[i] != 0.0) f->state.velocity[3 * i + 2] = (areas[i] < 0.0 ? 0.5 : -0.5) * speed;
}

/* A direct shear box at four pressures: at the peak c + p tan φ, in the end p tan φ; what friction takes is force × slip, and
   cohesion takes its energy besides. */
static void shear_box(void **state)
{
    (void)state;
    const double pressures[] = {0.0, 20e6, 50e6, 100e6}, cohesion = 30e6, energy = 20.0, area = side * side;
    for (int k = 0; k < 4; k++) {
        Fixture f;
        two_blocks(&f, energy, cohesion, 2.5e9);
        double *areas = face_areas(&f);
        ShvLedger ledger = {0};
        const double last = 2.0 * energy / cohesion, step = 1e-9, speed = last / 200.0 / step;
        double peak = 0.0, residual = 0.0;
        slide(&f, areas, speed);
        for (int i = 0; i < 300; i++) {
            residual = step_once(&f, areas, pressures[k], 0.0, step, &ledger) / area;
            peak = fmax(peak, residual);
        }
        const double friction = coefficient * pressures[k], slip = slip_of(&f, areas);
        assert_true(slip > 1.4 * last);
        check_near(peak, cohesion + friction, 0.01 * (cohesion + friction));
        check_near(residual, friction, 1e-3 * friction); /* to which friction settles */
        /* the first half step is not booked, as nothing pressed before it */
        check_near(-ledger.booked[SHV_WORK_CRACK_FRICTION], friction * area * slip, 5e-3 * friction * area * slip);
        check_near(-ledger.booked[SHV_WORK_COHESIVE], energy * area, 5e-3 * energy * area);
        check_near(ledger.booked[SHV_WORK_CLOSURE], 0.0, 1e-3 * energy * area);
        free(areas);
        fixture_release(&f);
    }
}

/* Bonded faces hold c + p tan φ, failed ones p tan φ: nothing slides below it, and above it they are pulled by what is more. */
static void slips_at_the_strength_and_not_before(void **state)
{
    (void)state;
    const double pressure = 50e6, cohesion = 30e6, step = 1e-8, area = side * side;
    for (int bonded = 0; bonded < 2; bonded++)
        for (int above = 0; above < 2; above++) {
            Fixture f;
            two_blocks(&f, bonded ? 200.0 : 0.0, cohesion, 2.5e6);
            double *areas = face_areas(&f), yield = 0.0, fastest = 0.0;
            for (int32_t i = 0; i < f.state.node_count; i++)
                yield += 0.5 * areas[i] * areas[i] / f.state.mass[i]; /* of a face */
            ShvLedger ledger = {0};
            const double strength = coefficient * pressure + (bonded ? cohesion : 0.0);
            const double shear = (above ? 1.02 : 0.98) * strength;
            for (int i = 0; i < 200; i++) step_once(&f, areas, pressure, shear, step, &ledger);
            for (int32_t i = 0; i < f.state.node_count; i++) fastest = fmax(fastest, fabs(f.state.velocity[3 * i + 2]));
            const double slipped = slip_of(&f, areas), thrown = shear * yield / area * 200.0 * step;
            if (!above) {
                assert_true(slipped < 1e-5 * thrown * 200.0 * step && fastest < 1e-3 * thrown);
                check_near(ledger.booked[SHV_WORK_CRACK_FRICTION], 0.0, 1e-6 * shear * area * thrown * 200.0 * step);
            } else {
                const double way = (shear - strength) / shear * thrown * 200.0 * step; /* ½ a t² of both faces */
                assert_true(slipped > 0.98 * way && (bonded || slipped < 1.02 * way));
                assert_true(ledger.booked[SHV_WORK_CRACK_FRICTION] < 0.0);
            }
            free(areas);
            fixture_release(&f);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shear_box),
        cmocka_unit_test(slips_at_the_strength_and_not_before),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
