#include <stdlib.h>

#include "cohesive/fixture.h"

#include "base/random.h"
#include "cohesive/facet_rotation.h"

typedef struct Step {
    double last, step;
    bool close;
} Step;

static double kinetic(const Fixture *f)
{
    double sum = 0.0;
    for (int32_t i = 0; i < f->state.node_count; i++) {
        const ShvVec3 v = shv_load3(f->state.velocity + 3 * (int64_t)i);
        sum += 0.5 * f->state.mass[i] * shv_dot(v, v);
    }
    return sum;
}

static void momenta(const Fixture *f, ShvVec3 *linear, ShvVec3 *angular, double *scale)
{
    *linear = *angular = shv_vec3(0.0, 0.0, 0.0);
    *scale = 0.0;
    for (int32_t i = 0; i < f->state.node_count; i++) {
        const ShvVec3 p = shv_scale(shv_load3(f->state.velocity + 3 * (int64_t)i), f->state.mass[i]);
        *linear = shv_add(*linear, p);
        *angular = shv_add(*angular, shv_cross(shv_state_position(&f->state, i), p));
        *scale += shv_norm(p);
    }
}

static void zero_force(Fixture *f)
{
    memset(f->state.force, 0, 3 * (size_t)f->state.node_count * sizeof(double));
}

/* One step in which nothing but the crack acts; `external` of nodal forces is in state.force already. */
static void step_once(Fixture *f, Step s, ShvLedger *ledger)
{
    ShvState *state = &f->state;
    const double kick = 0.5 * (s.last + s.step);
    state->last_step = s.last;
    shv_cohesive_begin(&f->cohesive, state, NULL);
    for (int64_t i = 0; i < 3 * (int64_t)state->node_count; i++)
        state->velocity[i] += kick * state->force[i] / state->mass[i / 3];
    shv_cohesive_pull(&f->cohesive, state, kick, s.step);
    if (s.close) shv_cohesive_close(&f->cohesive, state, kick, s.step);
    shv_ledger_begin_step(ledger);
    shv_cohesive_book(&f->cohesive, state, s.step, ledger);
    for (int64_t i = 0; i < 3 * (int64_t)state->node_count; i++) state->displacement[i] += s.step * state->velocity[i];
}

static void insert_plane(Fixture *f)
{
    int32_t *facets = calloc((size_t)f->model.adjacency.interior_count, sizeof *facets), duplicated;
    const int32_t count = fixture_plane(f, 0.0, 1e-9, facets);
    check_ok(shv_cohesive_insert(&f->cohesive, &f->state, f->stress, facets, count, &duplicated, &f->error), f->error);
    free(facets);
}

/* Nodes of elements on the right half. */
static bool on_right(const Fixture *f, int32_t node)
{
    const int32_t element = f->state.corners[f->state.corner_start[node]] / 4;
    double x = 0.0;
    for (int k = 0; k < 4; k++)
        x += f->model.mesh.positions[3 * (int64_t)f->model.mesh.elements[4 * (int64_t)element + k]];
    return x > 0.0;
}

static void throw_apart(Fixture *f, ShvVec3 speed)
{
    for (int32_t i = 0; i < f->state.node_count; i++)
        shv_store3(f->state.velocity + 3 * (int64_t)i, shv_scale(speed, on_right(f, i) ? 0.5 : -0.5));
}

/* Two halves of a bar pulled apart at 0.05 … 10 final openings a step: the crack takes G × area. All pairs alike: one
   sweep settles it. */
static void a_plane_crack_takes_its_energy(void **state)
{
    (void)state;
    const double shares[] = {0.05, 0.3, 1.0, 3.0, 10.0};
    for (int mode = 0; mode < 2; mode++)
        for (int i = 0; i < 5; i++) {
            Fixture f;
            fixture_define(&f, 0.012, 0.006, 0.006, 0.003);
            fixture_build_cubes(&f, 4, 2, 2);
            fixture_start(&f);
            insert_plane(&f);
            throw_apart(&f, mode == 0 ? shv_vec3(12.0, 0.0, 0.0) : shv_vec3(0.0, 0.0, 12.0));
            const double final_opening = 2.0 * 8.0 / 40e6, step = shares[i] * final_opening / 12.0;
            const double area = 0.006 * 0.006, start = kinetic(&f);
            ShvVec3 p, l, spin;
            double scale;
            momenta(&f, &p, &spin, &scale);
            ShvLedger ledger = {0};
            /* closed half a step before the first */
            for (int64_t n = 0; n < 3 * (int64_t)f.state.node_count; n++)
                f.state.displacement[n] = 0.5 * step * f.state.velocity[n];
            for (int k = 0; k < 100; k++) {
                step_once(&f, (Step){step, step, false}, &ledger);
                /* all pairs alike, and later nearly so: one sweep settles it, the second finds nothing to do, nor does
                   the one after couples have been answered */
                if (k == 0) assert_true(f.cohesive.sweeps <= 3 * (int64_t)f.cohesive.cluster_count);
                zero_force(&f);
            }
            shv_cohesive_begin(&f.cohesive, &f.state, NULL);
            shv_cohesive_find_failed(&f.cohesive, &f.state, NULL, &ledger);
            const ShvCohesiveEnergy energy = shv_cohesive_energy(&f.cohesive, &f.state);
            /* in opening, slip_share takes 2/3 of itself */
            const double expected = 8.0 * area * (mode == 0 ? 1.0 - 2.0 / 3.0 * 0.005 : 1.0);
            check_near(energy.dissipated, expected, 4e-3 * expected);
            /* forces are settled to 5e-3 of the peak, work to its square */
            check_near(ledger.booked[SHV_WORK_COHESIVE], -energy.dissipated, 1e-5 * expected);
            check_near(start - kinetic(&f), energy.dissipated, 1e-5 * expected);
            assert_true(energy.failed == energy.inserted);
            check_near(energy.failed_energy, 8.0 * area, 1e-12 * 8.0 * area);
            momenta(&f, &p, &l, &scale);
            check_near(shv_norm(p), 0.0, 1e-13 * scale);
            check_near(shv_norm(shv_sub(l, spin)), 0.0, 1e-13 * scale * 0.012);
            fixture_release(&f);
        }
}

/* Nodal forces of a uniform stress sxx: −V σ ∇N of each element, and the tractions that balance them on both ends. */
static void bar_forces(Fixture *f, double sxx)
{
    zero_force(f);
    const ShvMesh *mesh = &f->model.mesh;
    for (int32_t e = 0; e < f->state.element_count; e++)
        for (int k = 0; k < 4; k++) {
            const int32_t *nodes = mesh->elements + 4 * (int64_t)e;
            const uint8_t *c = shv_face_corners[k];
            const ShvVec3 a = shv_mesh_position(mesh, nodes[c[0]]), b = shv_mesh_position(mesh, nodes[c[1]]);
            const ShvVec3 area =
                shv_scale(shv_cross(shv_sub(b, a), shv_sub(shv_mesh_position(mesh, nodes[c[2]]), a)), 0.5);
            /* ∇N_k = −area/(3V), the face opposite corner k outward */
            f->state.force[3 * (int64_t)shv_state_node(&f->state, e, k)] += sxx * area.x / 3.0;
            const bool end =
                fabs(fabs(a.x) - 0.006) < 1e-9 && fabs(b.x - a.x) < 1e-9 && fabs(area.x) > 0.9 * shv_norm(area);
            for (int i = 0; end && i < 3; i++)
                f->state.force[3 * (int64_t)shv_state_node(&f->state, e, c[i])] += sxx * area.x / 3.0;
        }
}

/* Largest acceleration of a bar under uniform tension just after its middle plane was inserted, over that of a free crack
   face. */
static double jump(double overstress, double rate, double step, ShvActivation activation)
{
    Fixture f;
    fixture_define(&f, 0.012, 0.006, 0.006, 0.003);
    f.scene.fracture.activation = activation;
    f.material.fracture_energy = 800.0;
    fixture_build_cubes(&f, 4, 2, 2);
    fixture_start(&f);
    bar_forces(&f, 40e6 * overstress);
    double largest = 0.0, freed = 0.0;
    for (int32_t i = 0; i < f.state.node_count; i++) assert_true(fabs(f.state.force[3 * i]) < 1e-9);
    fixture_stress(&f, 40e6 * overstress, 0.0, 0.0, 0.0, 0.0, 0.0);
    insert_plane(&f);
    bar_forces(&f, 40e6 * overstress * (1.0 + rate * step));
    for (int32_t i = 0; i < f.state.node_count; i++) freed = fmax(freed, fabs(f.state.force[3 * i]) / f.state.mass[i]);
    ShvLedger ledger = {0};
    step_once(&f, (Step){step, step, true}, &ledger);
    for (int64_t i = 0; i < 3 * (int64_t)f.state.node_count; i++)
        largest = fmax(largest, fabs(f.state.velocity[i] / step));
    fixture_release(&f);
    return largest / freed;
}

/* Time-continuity. Under the strength a new facet holds what it carries. Over it, the plain law drops at once from what
   the facet carries to its strength: acceleration jumps by the difference whatever the step, 0.3/1.3 of that of a freed
   face. Started at its own traction it takes up what it carried, and what is left falls with the step. */
static void acceleration_is_continuous(void **state)
{
    (void)state;
    for (int k = 0; k < 2; k++)
        check_near(jump(0.9, 0.0, 1e-7, k ? SHV_ACTIVATION_STRENGTH : SHV_ACTIVATION_TRACTION), 0.0, 1e-4);
    check_near(jump(1.3, -1e4, 1e-7, SHV_ACTIVATION_TRACTION), 0.0, 1e-4);
    const double rate = 2e5; /* 1/s */
    for (double step = 4e-7; step > 2e-8; step *= 0.25) {
        check_near(jump(1.3, 0.0, step, SHV_ACTIVATION_STRENGTH), 0.3 / 1.3, 0.02);
        assert_true(jump(1.3, rate, step, SHV_ACTIVATION_TRACTION) < 1.2 * rate * step);
    }
}

typedef struct Outcome {
    uint64_t hash;
    double growth; /* largest growth of kinetic + recoverable energy in a step, share of the start's */
    double spin;   /* change of angular momentum, share of Σ m|v| × size */
    double left, dissipated;
} Outcome;

static double history_dissipated(const Fixture *f)
{
    double sum = 0.0;
    for (int32_t i = 0; i < 3 * f->cohesive.count; i++)
        sum += f->cohesive.area[i / 3] / 3.0 * f->cohesive.internal[i].history.dissipated;
    return sum;
}

/* Every facet of a box of tets is cohesive, every node copy has a random velocity. */
static Outcome explode(int32_t threads, ShvCohesiveLaw law)
{
    Fixture f;
    fixture_define(&f, 0.02, 0.015, 0.015, 0.004);
    f.scene.threads = threads;
    f.material.law = law;
    f.material.friction_angle_degrees = 11.3;
    fixture_build(&f);
    const int32_t count = f.model.adjacency.interior_count;
    int32_t *facets = calloc((size_t)count, sizeof *facets), duplicated;
    for (int32_t i = 0; i < count; i++) facets[i] = i;
    check_ok(shv_cohesive_insert(&f.cohesive, &f.state, NULL, facets, count, &duplicated, &f.error), f.error);
    free(facets);
    for (int64_t i = 0; i < 3 * (int64_t)f.state.node_count; i++)
        f.state.velocity[i] = 30.0 * (shv_random_uniform(9, (uint64_t)i) - 0.5);
    ShvVec3 p0, l0, p, l;
    double scale;
    momenta(&f, &p0, &l0, &scale);
    ShvLedger ledger = {0};
    const double step = 1e-7, start = kinetic(&f);
    double last = start, history = 0.0;
    Outcome outcome = {.growth = -1.0};
    for (int k = 0; k < 60; k++) {
        step_once(&f, (Step){k == 0 ? 0.0 : step, step, true}, &ledger);
        zero_force(&f);
        const ShvCohesiveEnergy energy = shv_cohesive_energy(&f.cohesive, &f.state);
        outcome.growth = fmax(outcome.growth, (kinetic(&f) + energy.recoverable - last) / start);
        last = kinetic(&f) + energy.recoverable;
        const double lost = history_dissipated(&f);
        assert_true(lost >= history);
        history = lost;
        outcome.dissipated = energy.dissipated;
    }
    momenta(&f, &p, &l, &scale);
    check_near(shv_norm(shv_sub(p, p0)), 0.0, 1e-12 * scale);
    outcome.spin = shv_norm(shv_sub(l, l0)) / (scale * 0.02);
    outcome.left = kinetic(&f);
    outcome.hash = shv_state_hash(&f.state);
    assert_true(outcome.left + last - kinetic(&f) + outcome.dissipated <= start);
    shv_cohesive_find_failed(&f.cohesive, &f.state, NULL, &ledger);
    assert_in_range(shv_cohesive_energy(&f.cohesive, &f.state).failed, count / 10, count);
    fixture_release(&f);
    return outcome;
}

/* Momentum and angular momentum are kept to round-off; energy does not grow beyond the square of the
   sweeps' tolerance; the number of threads changes no bit. */
static void everything_breaks_without_gaining_energy(void **state)
{
    (void)state;
    for (int law = 0; law < 2; law++) {
        const Outcome one = explode(1, law ? SHV_CAMACHO_ORTIZ : SHV_PPR),
                      three = explode(3, law ? SHV_CAMACHO_ORTIZ : SHV_PPR);
        assert_true(one.hash == three.hash);
        assert_true(one.growth < 1e-6);
        assert_true(one.spin < 1e-12);
    }
}

/* Facets opened to 0.6 of their law, whose nodes tremble a thousandth as far: what is left of each bond stays left. */
static void trembling_wears_nothing(void **state)
{
    (void)state;
    Fixture f;
    fixture_define(&f, 0.02, 0.015, 0.015, 0.004);
    fixture_build(&f);
    const int32_t count = f.model.adjacency.interior_count;
    int32_t *facets = calloc((size_t)count, sizeof *facets), duplicated;
    for (int32_t i = 0; i < count; i++) facets[i] = i;
    check_ok(shv_cohesive_insert(&f.cohesive, &f.state, NULL, facets, count, &duplicated, &f.error), f.error);
    free(facets);
    const double opening = 0.6 * f.cohesive.law[0].final_opening[SHV_NORMAL], step = 1e-7;
    for (int32_t i = 0; i < 3 * count; i++) {
        const ShvLaw *law = &f.cohesive.law[i / 3];
        f.cohesive.internal[i].history = shv_law_grow(law, f.cohesive.internal[i].history, opening, 0.0);
        f.cohesive.internal[i].peak = shv_law_peak(law, f.cohesive.internal[i].history);
    }
    const double residual = shv_cohesive_residual(&f.cohesive, 0);
    assert_true(residual > 0.1 && residual < 0.9);
    for (int64_t i = 0; i < 3 * (int64_t)f.state.node_count; i++)
        f.state.velocity[i] = 1e-3 * opening / step / 100.0 * (shv_random_uniform(9, (uint64_t)i) - 0.5);
    ShvLedger ledger = {0};
    for (int k = 0; k < 300; k++) {
        step_once(&f, (Step){k == 0 ? 0.0 : step, step, true}, &ledger);
        zero_force(&f);
    }
    for (int32_t i = 0; i < count; i++) assert_true(shv_cohesive_residual(&f.cohesive, i) > 0.99 * residual);
    fixture_release(&f);
}

/* Of opening, seen by one who turns with the facet. */
static ShvVec3 rate_of(const Fixture *f, const ShvCohesivePoint *point)
{
    const ShvVec3 rotation = shv_facet_rotation_rate(&f->cohesive.rotations[point->rotation], &f->state);
    const ShvVec3 rate = shv_sub(shv_load3(f->state.velocity + 3 * (int64_t)point->second),
                                 shv_load3(f->state.velocity + 3 * (int64_t)point->first));
    return shv_sub(rate, shv_cross(rotation, point->opening));
}

/* What a cluster stores, and what the tractions do if nodes keep their velocities, J. */
static double cluster_budget(const Fixture *f, int32_t cluster, double step, double *size)
{
    double sum = 0.0;
    *size = 0.0;
    for (int32_t i = f->cohesive.cluster[cluster]; i < f->cohesive.cluster[cluster + 1]; i++) {
        const ShvCohesivePoint *point = &f->cohesive.points[i];
        const ShvVec3 to = shv_madd(point->opening, 0.5 * step, rate_of(f, point));
        const double work = shv_dot(point->pull, shv_sub(to, point->from));
        sum += point->stored + work;
        *size += point->stored + fabs(work);
    }
    return sum;
}

/* What all clusters owe; never more than a thousandth of their work of separation. */
static double check_energy_debt(const Fixture *f)
{
    double energy_debt = 0.0, work = 0.0;
    for (int32_t k = 0; k < 3 * f->cohesive.count; k++) {
        assert_true(f->cohesive.internal[k].energy_debt >= 0.0);
        energy_debt += f->cohesive.internal[k].energy_debt;
        work += f->cohesive.area[k / 3] / 3.0 * f->cohesive.law[k / 3].energy[SHV_NORMAL];
    }
    assert_true(energy_debt <= 1e-3 * work * (1.0 + 1e-9));
    return energy_debt;
}

static void disturb(Fixture *f, double speed, uint64_t stream)
{
    for (int64_t i = 0; i < 3 * (int64_t)f->state.node_count; i++)
        f->state.velocity[i] += speed * (shv_random_uniform(stream, (uint64_t)i) - 0.5);
}

/* Clusters that cannot settle: copies of unlike masses thrown about at random in every step, before either pull and, in
   every second step, after both, as a support does. After the pulls each cluster's tractions give no more than it stores.
   After the step it stores no more than it had and was given at the openings that really came, but for what it owes and the turn
   of the frames: in a step a facet of 5 mm turns by less than 100 m/s × 0.1 µs / 5 mm = 2e-3. */
static void unsettled_clusters_never_give_energy(void **state)
{
    (void)state;
    for (int kind = 0; kind < 6; kind++) {
        Fixture f;
        fixture_define(&f, 0.02, 0.015, 0.015, 0.005);
        f.material.law = kind % 2 ? SHV_CAMACHO_ORTIZ : SHV_PPR;
        fixture_build(&f);
        const int32_t count = f.model.adjacency.interior_count;
        int32_t *facets = calloc((size_t)count, sizeof *facets), duplicated;
        for (int32_t i = 0; i < count; i++) facets[i] = i;
        check_ok(shv_cohesive_insert(&f.cohesive, &f.state, NULL, facets, count, &duplicated, &f.error), f.error);
        free(facets);
        const double step = 1e-7, speeds[] = {0.1, 1.0, 10.0}, speed = speeds[kind / 2];
        for (int32_t i = 0; i < f.state.node_count; i++) f.state.mass[i] *= 1e-3 + shv_random_uniform(3, (uint64_t)i);
        f.state.last_step = step;
        ShvLedger ledger = {0};
        double allowed = 0.0, spared = 0.0, size;
        for (uint64_t k = 0; k < 40; k++) {
            const double energy_debt = check_energy_debt(&f);
            f.state.time += step;
            shv_cohesive_begin(&f.cohesive, &f.state, NULL);
            double stored = 0.0;
            for (int32_t i = 0; i < f.cohesive.point_count; i++) stored += f.cohesive.points[i].stored;
            if (k > 0) assert_true(stored <= allowed * (1.0 + 2e-3) + spared + check_energy_debt(&f) - energy_debt);
            for (uint64_t pull = 0; pull < 2; pull++) {
                disturb(&f, speed, 10 + 3 * k + pull);
                shv_cohesive_pull(&f.cohesive, &f.state, step, step);
                for (int32_t c = 0; c < f.cohesive.cluster_count; c++)
                    assert_true(cluster_budget(&f, c, step, &size) >= -1e-12 * size);
            }
            if (k % 2) disturb(&f, speed, 12 + 3 * k);
            allowed = spared = 0.0;
            for (int32_t c = 0; c < f.cohesive.cluster_count; c++) {
                allowed += fmax(cluster_budget(&f, c, step, &size), 0.0);
                spared += 1e-9 * size; /* what a cluster may keep that has given all (force.c) */
            }
            shv_cohesive_book(&f.cohesive, &f.state, step, &ledger);
            for (int64_t i = 0; i < 3 * (int64_t)f.state.node_count; i++)
                f.state.displacement[i] += step * f.state.velocity[i];
            zero_force(&f);
        }
        fixture_release(&f);
    }
}

/* A crack held shut: in every step nodes are thrown about as round-off throws them, after the pull too, as supports and contact
   do. No opening comes near the one with which the law starts (1e-8 of the final one), so that no corner may wear: what its
   tractions exchange is noise, whose sign says nothing. */
static void corners_held_shut_do_not_wear(void **state)
{
    (void)state;
    enum { STEPS = 50 };
    const double step = 1e-7, speed = 1e-12, start = 1e-8 * 2.0 * 8.0 / 40e6;
    assert_true(2.0 * STEPS * speed * step < 0.01 * start);
    for (int law = 0; law < 2; law++) {
        Fixture f;
        fixture_define(&f, 0.012, 0.006, 0.006, 0.003);
        f.material.law = law ? SHV_CAMACHO_ORTIZ : SHV_PPR;
        fixture_build_cubes(&f, 4, 2, 2);
        fixture_start(&f);
        insert_plane(&f);
        f.state.last_step = step;
        ShvLedger ledger = {0};
        for (uint64_t k = 0; k < STEPS; k++) {
            shv_cohesive_begin(&f.cohesive, &f.state, NULL);
            disturb(&f, speed, 2 * k);
            shv_cohesive_pull(&f.cohesive, &f.state, step, step);
            disturb(&f, speed, 2 * k + 1);
            shv_cohesive_book(&f.cohesive, &f.state, step, &ledger);
            for (int64_t i = 0; i < 3 * (int64_t)f.state.node_count; i++)
                f.state.displacement[i] += step * f.state.velocity[i];
            zero_force(&f);
        }
        shv_cohesive_begin(&f.cohesive, &f.state, NULL);
        for (int32_t i = 0; i < 3 * f.cohesive.count; i++) {
            const double strength = f.cohesive.law[i / 3].strength[SHV_NORMAL];
            check_near(f.cohesive.internal[i].peak, strength, 1e-7 * strength);
        }
        assert_int_equal(f.cohesive.point_count, f.cohesive.pair_count);
        assert_true(shv_cohesive_energy(&f.cohesive, &f.state).dissipated < 1e-7 * 8.0 * 0.006 * 0.006);
        fixture_release(&f);
    }
}

/* The same opening, body and all turned by 90° about z. */
static void turned_bodies_open_alike(void **state)
{
    (void)state;
    double dissipated[2], slowed[2];
    for (int rotation = 0; rotation < 2; rotation++) {
        Fixture f;
        fixture_define(&f, 0.012, 0.006, 0.006, 0.003);
        fixture_build_cubes(&f, 4, 2, 2);
        fixture_start(&f);
        insert_plane(&f);
        throw_apart(&f, rotation ? shv_vec3(-4.0, 9.0, 3.0) : shv_vec3(9.0, 4.0, 3.0));
        for (int32_t i = 0; rotation && i < f.state.node_count; i++) {
            const double *x = f.state.reference + 3 * i;
            shv_store3(f.state.displacement + 3 * i, shv_vec3(-x[1] - x[0], x[0] - x[1], 0.0));
        }
        ShvLedger ledger = {0};
        for (int k = 0; k < 5; k++) {
            step_once(&f, (Step){k == 0 ? 0.0 : 4e-9, 4e-9, true}, &ledger);
            zero_force(&f);
        }
        dissipated[rotation] = shv_cohesive_energy(&f.cohesive, &f.state).dissipated;
        slowed[rotation] = kinetic(&f);
        fixture_release(&f);
    }
    assert_true(dissipated[0] > 0.1 * 8.0 * 0.006 * 0.006);
    /* openings of 1e-7 m are differences of displacements of 1e-2 m: 1e-18/1e-7 of round-off, times a few steps */
    check_near(dissipated[1], dissipated[0], 1e-8 * dissipated[0]);
    check_near(slowed[1], slowed[0], 1e-8 * slowed[0]);
}

/* A facet that has gone through 0.7 of its law counts as softened until it has dissipated half of what that takes. */
static void softening_without_dissipation_is_counted(void **state)
{
    (void)state;
    Fixture f;
    fixture_define(&f, 0.012, 0.006, 0.006, 0.003);
    fixture_build_cubes(&f, 4, 2, 2);
    fixture_start(&f);
    insert_plane(&f);
    assert_int_equal(shv_cohesive_energy(&f.cohesive, &f.state).softened, 0);
    for (int i = 0; i < 3; i++)
        f.cohesive.internal[i].history.normal = 0.7 * f.cohesive.law[0].final_opening[SHV_NORMAL];
    assert_int_equal(shv_cohesive_energy(&f.cohesive, &f.state).softened, 1);
    for (int i = 0; i < 3; i++) f.cohesive.internal[i].history.dissipated = 0.7 * 8.0;
    assert_int_equal(shv_cohesive_energy(&f.cohesive, &f.state).softened, 0);
    for (int i = 0; i < 3; i++) f.cohesive.internal[i].history = (ShvHistory){.normal = 1.0};
    assert_int_equal(shv_cohesive_energy(&f.cohesive, &f.state).softened, 0);
    fixture_release(&f);
}

static void resolution_step_is_a_tenth_of_what_is_left(void **state)
{
    (void)state;
    Fixture f;
    fixture_define(&f, 0.012, 0.006, 0.006, 0.003);
    fixture_build_cubes(&f, 4, 2, 2);
    fixture_start(&f);
    shv_cohesive_begin(&f.cohesive, &f.state, NULL);
    assert_true(isinf(shv_cohesive_resolution_step(&f.cohesive, &f.state)));
    insert_plane(&f);
    throw_apart(&f, shv_vec3(6.0, 0.0, 0.0));
    shv_cohesive_begin(&f.cohesive, &f.state, NULL);
    check_near(shv_cohesive_resolution_step(&f.cohesive, &f.state), 0.1 * 4e-7 / 6.0, 1e-6 * 4e-8 / 6.0);
    fixture_release(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plane_crack_takes_its_energy),
        cmocka_unit_test(acceleration_is_continuous),
        cmocka_unit_test(everything_breaks_without_gaining_energy),
        cmocka_unit_test(trembling_wears_nothing),
        cmocka_unit_test(unsettled_clusters_never_give_energy),
        cmocka_unit_test(corners_held_shut_do_not_wear),
        cmocka_unit_test(turned_bodies_open_alike),
        cmocka_unit_test(softening_without_dissipation_is_counted),
        cmocka_unit_test(resolution_step_is_a_tenth_of_what_is_left),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
