/* Measures against values worked out by hand, and outcomes that come back as they were written. */
#include "check.h"

#include <stdlib.h>
#include <unistd.h>

#include "base/memory.h"
#include "evaluate/crack_surface.h"
#include "evaluate/figures.h"
#include "evaluate/names.h"

static void test_masses(void **state)
{
    (void)state;
    const double halves[] = {1.0, 1.0}, quarters[] = {1.0, 1.0, 1.0, 1.0}, uneven[] = {1.0, 3.0},
                 doubled[] = {2.0, 2.0};
    check_near(shv_masses_distance(halves, 2, halves, 2), 0.0, 0.0);
    check_near(shv_masses_distance(halves, 2, doubled, 2), 0.0, 0.0); /* in shares of all mass */
    /* All quarters are lighter than the halves. */
    check_near(shv_masses_distance(halves, 2, quarters, 4), 1.0, 0.0);
    /* Shares {1/4, 3/4} and {1/2, 1/2}: from 1/4 on one of two, from 1/2 on 1/2 and 1. */
    check_near(shv_masses_distance(uneven, 2, halves, 2), 0.5, 1e-15);
    check_near(shv_masses_distance(halves, 2, uneven, 2), 0.5, 1e-15);
    /* Shares {1/4, 3/4} and four quarters: from 1/4 on 1/2 and 1. */
    check_near(shv_masses_distance(uneven, 2, quarters, 4), 0.5, 1e-15);
    check_near(shv_masses_distance(NULL, 0, quarters, 4), 1.0, 0.0);
    check_near(shv_masses_distance(NULL, 0, NULL, 0), 0.0, 0.0);
}

/* ---- cracks ---- */

static ShvCrackFacet facet_at(int32_t first, double x, double z, double size)
{
    return (ShvCrackFacet){{first, first + 1, first + 2},
                           {shv_vec3(x, 0.0, z), shv_vec3(x + size, 0.0, z), shv_vec3(x, size, z)}};
}

/* A star of four arms, one of which ends at 5, in slips of facets across the plane; and a ring. */
static void test_arms(void **state)
{
    (void)state;
    enum { ARMS = 4, SLIPS = 10, RING = 100 };
    ShvVec3 star[ARMS * SLIPS][3], ring[RING][3];
    for (int arm = 0; arm < ARMS; arm++)
        for (int i = 0; i < SLIPS; i++) {
            const double angle = 0.1 + 1.5 * arm, from = arm > 0 ? i : 0.5 * i, to = arm > 0 ? i + 1.0 : 0.5 * (i + 1);
            const ShvVec3 along = shv_vec3(cos(angle), sin(angle), 0.0), up = shv_vec3(0.0, 0.0, 1.0);
            ShvVec3 *facet = star[SLIPS * arm + i];
            facet[0] = shv_scale(along, from);
            facet[1] = shv_scale(along, to);
            facet[2] = shv_add(facet[1], up);
        }
    assert_int_equal(shv_crack_arms(star[0], ARMS * SLIPS, 4.25, 0.5), 4);
    assert_int_equal(shv_crack_arms(star[0], ARMS * SLIPS, 8.5, 0.5), 3);
    assert_int_equal(shv_crack_arms(star[0], ARMS * SLIPS, 20.0, 0.5), 0);
    /* Arms are 6.4 and more apart at 4.25; the first and the last, 7.6. */
    assert_int_equal(shv_crack_arms(star[0], ARMS * SLIPS, 4.25, 6.8), 1);
    assert_int_equal(shv_crack_arms(star[0], SLIPS, 4.25, 0.5), 1);
    assert_int_equal(shv_crack_arms(NULL, 0, 1.0, 0.5), 0);
    for (int i = 0; i < RING; i++)
        for (int k = 0; k < 3; k++) {
            const double angle = 0.0628 * (i + 0.5 * k), radius = 1.0 + 0.2 * (k - 1);
            ring[i][k] = shv_vec3(radius * cos(angle), radius * sin(angle), 0.0);
        }
    assert_int_equal(shv_crack_arms(ring[0], RING, 1.05, 0.5), 0);
}

static void test_cracks(void **state)
{
    (void)state;
    /* Facets of area 2, 1/2, 1/2; the first two are opened in a, the first and the third in b. */
    ShvCrackFacet a_facets[] = {facet_at(0, 0.0, 0.0, 2.0), facet_at(3, 10.0, 0.0, 1.0)};
    ShvCrackFacet b_facets[] = {facet_at(0, 0.0, 0.0, 2.0), facet_at(6, 10.0, 3.0, 1.0)};
    const ShvCrackSurface a = {7, a_facets, 2}, b = {7, b_facets, 2}, none = {7, NULL, 0}, other = {8, b_facets, 2},
                          unknown = {0, NULL, 0};
    check_near(shv_crack_overlap(&a, &a), 1.0, 0.0);
    check_near(shv_crack_overlap(&a, &b), 2.0 / 3.0, 1e-15);
    check_near(shv_crack_overlap(&b, &a), 2.0 / 3.0, 1e-15);
    check_near(shv_crack_overlap(&a, &none), 0.0, 0.0);
    check_near(shv_crack_overlap(&none, &none), 1.0, 0.0);
    assert_true(isnan(shv_crack_overlap(&a, &other)));
    assert_true(isnan(shv_crack_overlap(&unknown, &unknown)));
    /* The small facets are 3 apart all over; over the area that is 3 × 1/5. */
    ShvCrackDistance distance = shv_crack_distance(&a, &b);
    check_near(distance.largest, 3.0, 1e-14);
    check_near(distance.mean, 0.6, 1e-14);
    distance = shv_crack_distance(&a, &a);
    check_near(distance.largest, 0.0, 1e-14);
    distance = shv_crack_distance(&none, &none);
    assert_true(distance.largest == 0.0 && distance.mean == 0.0);
    assert_true(isnan(shv_crack_distance(&a, &none).largest) && isnan(shv_crack_distance(&none, &a).mean));
    assert_true(isnan(shv_crack_distance(&unknown, &unknown).largest));
    /* A triangle on the ground and one lifted at a corner: y apart seen from above, y/√2 from below; the mean of y is 1/3. */
    ShvCrackFacet ground = facet_at(0, 0.0, 0.0, 1.0), lifted = ground;
    lifted.corners[2].z = 1.0;
    const ShvCrackSurface below = {7, &ground, 1}, above = {7, &lifted, 1};
    check_near(shv_crack_distance(&below, &above).largest, 1.0, 1e-14);
    check_near(shv_crack_distance(&above, &below).mean, 1.0 / 3.0, 1e-14);
}

/* Two tets that share a facet: which faces have failed, and once each; the outside counts for none. */
static void test_surface_of_bonds(void **state)
{
    (void)state;
    static const double positions[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
    static const int32_t elements[] = {0, 1, 2, 3, 4, 3, 2, 1};
    const uint8_t bonds[8] = {0};
    const ShvMeshView mesh = {.node_count = 5, .element_count = 2, .positions = positions, .elements = elements};
    ShvPool pool = {.memory = NULL};
    const ShvCrackSurface surface = shv_crack_surface(&mesh, bonds, &pool);
    assert_int_equal(surface.count, 1);
    for (int i = 0; i < 3; i++) assert_true(surface.facets[0].nodes[i] == i + 1);
    shv_pool_release(&pool);
    ShvMemory *memory = shv_memory_create();
    shv_memory_fail_after(memory, 0);
    pool.memory = memory;
    assert_null(shv_crack_surface(&mesh, bonds, &pool).facets);
    assert_true(pool.failed);
    shv_memory_destroy(memory);
}

/* ---- figures of the end ---- */

static ShvOutcome outcome_of(double dissipated, double fragments, const double momentum[3], const double impulse[3])
{
    ShvOutcome outcome = {.memory = NULL};
    for (int i = 0; i < 2; i++) {
        shv_outcome_add(&outcome, "frame.time", SHV_CLOCK_FRAME, i);
        shv_outcome_add(&outcome, "ledger.fracture_dissipation", SHV_CLOCK_FRAME, i * dissipated);
        shv_outcome_add(&outcome, "ledger.largest", SHV_CLOCK_FRAME, 5.0 * (i + 1));
        shv_outcome_add(&outcome, "frame.bar_share", SHV_CLOCK_FRAME, (double)NAN);
    }
    shv_outcome_set(&outcome, "end.fragments", fragments);
    shv_outcome_set(&outcome, "end.mass", 2.0);
    shv_outcome_add_vector(&outcome, "end.momentum", SHV_CLOCK_NONE, momentum);
    shv_outcome_add_vector(&outcome, "run.impulse", SHV_CLOCK_NONE, impulse);
    return outcome;
}

static double error_of(const char *measure, const ShvOutcome *a, const ShvOutcome *b, bool value)
{
    ShvPool pool = {.memory = NULL};
    const ShvNamedRun other = {.name = "reference", .outcome = b};
    const ShvNamedRun run = {.name = "", .outcome = a, .before = &other};
    ShvNames names = {.pool = &pool, .run = &run};
    const ShvFormulaNames lookup = shv_names(&names);
    double number = (double)NAN;
    ShvError error;
    const ShvMeasure *found = shv_measure_named(measure);
    assert_non_null(found);
    (void)shv_formula_number(value ? found->value : found->error, &lookup, &number, &error);
    shv_pool_release(&pool);
    return number;
}

static void test_errors(void **state)
{
    (void)state;
    ShvOutcome a = outcome_of(3.0, 5.0, (const double[]){0.0, 3.0, 4.0}, (const double[]){0.0, 0.0, 12.0});
    ShvOutcome b = outcome_of(4.0, 4.0, (const double[]){0.0, 0.0, 0.0}, (const double[]){0.0, 5.0, 0.0});
    static const struct {
        const char *name;
        double a, b;
    } numbers[] = {{"end.largest_mass", 1.5, 1.0},
                   {"run.first_contact", 0.25, 0.5},
                   {"run.contact_time", 3.0, 2.0},
                   {"run.audited", 4.0, 0.0},
                   {"run.missed", 1.0, 0.0}};
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        shv_outcome_set(&a, numbers[i].name, numbers[i].a);
        shv_outcome_set(&b, numbers[i].name, numbers[i].b);
    }
    static const double bars[] = {0.0, -1.0, 0.0, -1.0}, residual[] = {0.1, -0.5, 0.2, (double)NAN}, none[4] = {0.0};
    shv_outcome_add_all(&a, "ledger.bars", SHV_CLOCK_FRAME, bars, 4);
    shv_outcome_add_all(&a, "ledger.residual", SHV_CLOCK_FRAME, residual, 4);
    static const struct {
        const char *measure;
        double value, error;
    } cases[] = {{"dissipated", 3.0, 0.25},     {"fragments", 5.0, 0.25},    {"largest_mass", 0.75, 0.25},
                 {"momentum", 5.0, 1.0},        /* |(0, 3, 4)| / 5 */
                 {"centre_velocity", 2.5, 2.5}, /* of 2 kg */
                 {"impulse", 12.0, 13.0 / 5.0}, /* |(0, −5, 12)| / 5 */
                 {"contact_time", 3.0, 0.5},    {"impact_time", 0.25, 0.25}, {"bars_given", 1.0, 0.1},
                 {"bars_taken", 2.0, 0.2},      {"residual", 0.5, 0.05},     {"missed_fracture", 1.0, 0.25}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        check_near(error_of(cases[i].measure, &a, &b, true), cases[i].value, 1e-15);
        check_near(error_of(cases[i].measure, &a, &b, false), cases[i].error, 1e-15);
    }
    /* Where the reference is zero and the run is not, nothing can be said; where both are, there is no error. */
    assert_true(isnan(error_of("failed_area", &b, NULL, false)));
    shv_outcome_add_all(&a, "ledger.failed_area", SHV_CLOCK_FRAME, none, 2);
    shv_outcome_add_all(&b, "ledger.failed_area", SHV_CLOCK_FRAME, none, 2);
    check_near(error_of("failed_area", &a, &b, false), 0.0, 0.0);
    shv_outcome_add(&a, "ledger.failed_area", SHV_CLOCK_FRAME, 1.0);
    assert_true(isnan(error_of("failed_area", &a, &b, false)));
    assert_true(isnan(error_of("position", &a, &b, false)) && isnan(error_of("crack_distance", &a, &b, false)));
    check_near(error_of("bar_share", &a, NULL, false), 0.0, 0.0);
    assert_true(isnan(error_of("missed_fracture", &b, NULL, false)));
    shv_outcome_release(&a);
    shv_outcome_release(&b);
}

static void test_names(void **state)
{
    (void)state;
    for (int32_t i = 0; i < shv_measure_count(); i++) {
        const ShvMeasure *measure = shv_measure_at(i);
        assert_true(measure->name && measure->error_unit && measure->sentence && measure->error);
        assert_ptr_equal(shv_measure_named(measure->name), measure);
        assert_true(!measure->unit == !measure->value);
        assert_true(!shv_measure_tracks(measure) || (!measure->unit && !shv_measure_is_own(measure)));
    }
    assert_null(shv_measure_named("fragment"));
}

/* ---- files ---- */

static const char path[] = "/tmp/shiver_test_outcome.run";

static void check_same(const ShvOutcome *a, const ShvOutcome *b)
{
    assert_true(a->key == b->key && a->status == b->status && a->shared == b->shared);
    assert_string_equal(a->message, b->message);
    assert_string_equal(a->processor, b->processor);
    assert_int_equal(a->list_count, b->list_count);
    for (int32_t i = 0; i < a->list_count; i++) {
        assert_string_equal(a->lists[i].name, b->lists[i].name);
        assert_int_equal(a->lists[i].clock, b->lists[i].clock);
        assert_int_equal(a->lists[i].count, b->lists[i].count);
        if (a->lists[i].count > 0)
            assert_memory_equal(a->lists[i].values, b->lists[i].values, (size_t)a->lists[i].count * sizeof(double));
    }
}

static void test_files(void **state)
{
    (void)state;
    static const double values[] = {0.1, 1e-300, 1.0 / 3.0, -0.0, 1e308, 5e-324, (double)INFINITY};
    ShvOutcome outcome = {.key = UINT64_C(0xfedcba9876543210),
                          .status = SHV_DIVERGED,
                          .message = "a text\nof two lines",
                          .processor = "some processor",
                          .shared = true};
    ShvOutcome back;
    ShvError error;
    shv_outcome_add_all(&outcome, "frame.time", SHV_CLOCK_FRAME, values, 7);
    shv_outcome_add_all(&outcome, "empty", SHV_CLOCK_PROBE, NULL, 0);
    shv_outcome_add_all(&outcome, "pieces.mass", SHV_CLOCK_NONE, values, 3);
    check_ok(shv_outcome_save(&outcome, path, &error), error);
    check_ok(shv_outcome_load(&back, path, NULL, &error), error);
    check_same(&outcome, &back);
    shv_outcome_release(&back);
    /* Cut anywhere, it is not whole. */
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    static char text[1 << 14];
    const size_t length = fread(text, 1, sizeof text, file);
    fclose(file);
    for (size_t cut = 0; cut + 1 < length; cut++) {
        file = fopen(path, "w");
        assert_non_null(file);
        assert_int_equal(fwrite(text, 1, cut, file), cut);
        fclose(file);
        check_fails(shv_outcome_load(&back, path, NULL, &error), SHV_BAD_INPUT, error, "not a whole run");
    }
    unlink(path);
    check_fails(shv_outcome_load(&back, path, NULL, &error), SHV_FILE_ERROR, error, "cannot read");
    check_fails(shv_outcome_save(&outcome, "/nowhere/at/all.run", &error), SHV_FILE_ERROR, error, "/nowhere");
    shv_outcome_release(&outcome);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_masses), cmocka_unit_test(test_arms),
        cmocka_unit_test(test_cracks), cmocka_unit_test(test_surface_of_bonds),
        cmocka_unit_test(test_errors), cmocka_unit_test(test_names),
        cmocka_unit_test(test_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
