/* Measures against values worked out by hand, and digests that come back as they were written. */
#include "check.h"

#include <stdlib.h>
#include <unistd.h>

#include "base/memory.h"
#include "evaluate/measures.h"

static void test_median(void **state)
{
    (void)state;
    double three[] = {3.0, 1.0, 2.0}, four[] = {4.0, (double)NAN, 1.0, 2.0, 10.0}, none[] = {(double)NAN};
    check_near(shv_median(three, 3), 2.0, 0.0);
    check_near(shv_median(four, 5), 3.0, 0.0);
    assert_true(isnan(shv_median(none, 1)));
    assert_true(isnan(shv_median(none, 0)));
}

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

static void test_distance_to_facet(void **state)
{
    (void)state;
    const ShvCrackFacet facet = facet_at(0, 0.0, 0.0, 1.0);
    const struct {
        ShvVec3 point;
        double distance;
    } cases[] = {{{0.25, 0.25, 0.5}, 0.5}, /* above the inside */
                 {{-3.0, -4.0, 0.0}, 5.0}, /* each corner */
                 {{4.0, -4.0, 0.0}, 5.0},  {{-4.0, 4.0, 0.0}, 5.0},
                 {{0.5, -2.0, 0.0}, 2.0}, /* each edge */
                 {{-2.0, 0.5, 0.0}, 2.0},  {{1.0, 1.0, 0.0}, 0.70710678118654752},
                 {{0.5, 0.0, 0.0}, 0.0}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        check_near(shv_distance_to_facet(cases[i].point, &facet), cases[i].distance, 1e-15);
}

static void test_cracks(void **state)
{
    (void)state;
    /* Facets of area 2, 1/2, 1/2; the first two are opened in a, the first and the third in b. */
    ShvCrackFacet a_facets[] = {facet_at(0, 0.0, 0.0, 2.0), facet_at(3, 10.0, 0.0, 1.0)};
    ShvCrackFacet b_facets[] = {facet_at(0, 0.0, 0.0, 2.0), facet_at(6, 10.0, 3.0, 1.0)};
    const ShvCrackSurface a = {7, a_facets, 2}, b = {7, b_facets, 2}, none = {7, NULL, 0}, other = {8, b_facets, 2},
                          unknown = {0, NULL, 0};
    check_near(shv_crack_surface_area(&a), 2.5, 1e-15);
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
    ShvCrackSurface surface;
    ShvError error;
    check_ok(shv_crack_surface_create(&surface, &mesh, bonds, NULL, &error), error);
    assert_int_equal(surface.count, 1);
    assert_int_equal(surface.facets[0].nodes[0], 1);
    assert_int_equal(surface.facets[0].nodes[1], 2);
    assert_int_equal(surface.facets[0].nodes[2], 3);
    check_near(shv_crack_surface_area(&surface), 0.8660254037844386, 1e-15);
    shv_crack_surface_release(&surface);
    ShvMemory *memory = shv_memory_create();
    shv_memory_fail_after(memory, 0);
    check_fails(shv_crack_surface_create(&surface, &mesh, bonds, memory, &error), SHV_NO_MEMORY, error,
                "failed facets");
    shv_memory_destroy(memory);
}

/* ---- figures of the end ---- */

static ShvDigest digest_of(double dissipated, double fragments, ShvVec3 momentum, ShvVec3 impulse)
{
    ShvDigest digest = {.memory = NULL};
    digest.numbers[SHV_DIGEST_DISSIPATED] = dissipated;
    digest.numbers[SHV_DIGEST_FRAGMENTS] = fragments;
    digest.numbers[SHV_DIGEST_MASS] = 2.0;
    digest.numbers[SHV_DIGEST_LARGEST] = 10.0;
    digest.numbers[SHV_DIGEST_BAR_SHARE] = (double)NAN;
    shv_store3(digest.numbers + SHV_DIGEST_MOMENTUM_X, momentum);
    shv_store3(digest.numbers + SHV_DIGEST_IMPULSE_X, impulse);
    return digest;
}

static void test_errors(void **state)
{
    (void)state;
    ShvDigest a = digest_of(3.0, 5.0, shv_vec3(0.0, 3.0, 4.0), shv_vec3(0.0, 0.0, 12.0));
    ShvDigest b = digest_of(4.0, 4.0, shv_vec3(0.0, 0.0, 0.0), shv_vec3(0.0, 5.0, 0.0));
    a.numbers[SHV_DIGEST_LARGEST_MASS] = 0.75;
    b.numbers[SHV_DIGEST_LARGEST_MASS] = 0.5;
    a.numbers[SHV_DIGEST_FIRST_CONTACT] = 0.25;
    b.numbers[SHV_DIGEST_FIRST_CONTACT] = 0.5;
    a.numbers[SHV_DIGEST_CONTACT_TIME] = 3.0;
    b.numbers[SHV_DIGEST_CONTACT_TIME] = 2.0;
    a.numbers[SHV_DIGEST_BARS_GIVEN] = 1.0;
    a.numbers[SHV_DIGEST_BARS_TAKEN] = 2.0;
    a.numbers[SHV_DIGEST_RESIDUAL] = 0.5;
    a.numbers[SHV_DIGEST_AUDITED] = 4.0;
    a.numbers[SHV_DIGEST_MISSED] = 1.0;
    static const struct {
        ShvMeasureKind kind;
        double value, error;
    } cases[] = {{SHV_MEASURE_DISSIPATED, 3.0, 0.25},     {SHV_MEASURE_FRAGMENTS, 5.0, 0.25},
                 {SHV_MEASURE_LARGEST_MASS, 0.75, 0.25},  {SHV_MEASURE_MOMENTUM, 5.0, 1.0}, /* |(0, 3, 4)| / 5 */
                 {SHV_MEASURE_CENTRE_VELOCITY, 2.5, 2.5},                                   /* of 2 kg */
                 {SHV_MEASURE_IMPULSE, 12.0, 13.0 / 5.0},                                   /* |(0, −5, 12)| / 5 */
                 {SHV_MEASURE_CONTACT_TIME, 3.0, 0.5},    {SHV_MEASURE_IMPACT_TIME, 0.25, 0.25},
                 {SHV_MEASURE_BARS_GIVEN, 1.0, 0.1},      {SHV_MEASURE_BARS_TAKEN, 2.0, 0.2},
                 {SHV_MEASURE_RESIDUAL, 0.5, 0.05},       {SHV_MEASURE_MISSED_FRACTURE, 1.0, 0.25}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        check_near(shv_study_measure_value(cases[i].kind, &a), cases[i].value, 1e-15);
        check_near(shv_study_measure_error(cases[i].kind, &a, &b), cases[i].error, 1e-15);
    }
    /* Where the reference is zero and the run is not, nothing can be said; where both are, there is no error. */
    assert_true(isnan(shv_study_measure_error(SHV_MEASURE_FAILED_AREA, &b, NULL)));
    check_near(shv_study_measure_error(SHV_MEASURE_FAILED_AREA, &a, &b), 0.0, 0.0);
    a.numbers[SHV_DIGEST_FAILED_AREA] = 1.0;
    assert_true(isnan(shv_study_measure_error(SHV_MEASURE_FAILED_AREA, &a, &b)));
    assert_true(isnan(shv_study_measure_error(SHV_MEASURE_POSITION, &a, &b)));
    check_near(shv_study_measure_error(SHV_MEASURE_BAR_SHARE, &a, NULL), 0.0, 0.0);
    assert_true(isnan(shv_study_measure_error(SHV_MEASURE_MISSED_FRACTURE, &b, NULL)));
}

static void test_names(void **state)
{
    (void)state;
    for (int i = 0; i < SHV_MEASURE_COUNT; i++) {
        const ShvStudyMeasure *measure = shv_study_measure_of((ShvMeasureKind)i);
        assert_true(measure->name && measure->error_unit && measure->sentence);
        assert_int_equal(shv_study_measure_find(measure->name), i);
        assert_true(!measure->track || !measure->unit);
    }
    assert_int_equal(shv_study_measure_find("fragment"), SHV_MEASURE_COUNT);
}

/* ---- files ---- */

static const char path[] = "/tmp/shiver_test_digest.run";

static void check_same(const ShvDigest *a, const ShvDigest *b)
{
    assert_true(a->key == b->key && a->status == b->status && a->shared == b->shared && a->threads == b->threads);
    assert_string_equal(a->message, b->message);
    assert_string_equal(a->processor, b->processor);
    assert_memory_equal(a->numbers, b->numbers, sizeof a->numbers);
    assert_memory_equal(a->costs, b->costs, sizeof a->costs);
    assert_int_equal(a->repeats, b->repeats);
    assert_memory_equal(a->seconds, b->seconds, (size_t)a->repeats * sizeof(double));
    assert_int_equal(a->mass_count, b->mass_count);
    assert_memory_equal(a->masses, b->masses, (size_t)a->mass_count * sizeof(double));
    assert_int_equal(a->crack.count, b->crack.count);
    assert_true(a->crack.mesh == b->crack.mesh);
    for (int32_t i = 0; i < a->crack.count; i++) {
        assert_memory_equal(a->crack.facets[i].nodes, b->crack.facets[i].nodes, 12);
        assert_memory_equal(a->crack.facets[i].corners, b->crack.facets[i].corners, 72);
    }
    assert_true(a->tracked == b->tracked && a->frame_count == b->frame_count && a->body_count == b->body_count);
    assert_memory_equal(a->times, b->times, (size_t)a->frame_count * sizeof(double));
    assert_memory_equal(a->states, b->states, (size_t)(a->frame_count * a->body_count) * sizeof(ShvBodyState));
}

static void test_files(void **state)
{
    (void)state;
    double seconds[] = {0.1, 1e-300, 3.0}, masses[] = {1.0 / 3.0}, times[] = {0.0, 0.1};
    ShvCrackFacet facets[] = {facet_at(2, 1.0 / 7.0, -1e-9, 0.1)};
    ShvBodyState states[2] = {{.position = {1.0 / 3.0, -0.0, 1e308}, .orientation = {1.0, 0.0, 0.0, 0.0}},
                              {.velocity = {5e-324, 2.0, 3.0}, .angular_velocity = {4.0, 5.0, 6.0}}};
    ShvDigest digest = {.key = UINT64_C(0xfedcba9876543210),
                        .status = SHV_DIVERGED,
                        .message = "a text\nof two lines",
                        .processor = "some processor",
                        .shared = true,
                        .threads = 3,
                        .seconds = seconds,
                        .repeats = 3,
                        .masses = masses,
                        .mass_count = 1,
                        .crack = {UINT64_C(0x8000000000000001), facets, 1},
                        .tracked = true,
                        .times = times,
                        .states = states,
                        .frame_count = 2,
                        .body_count = 1};
    ShvDigest back;
    ShvError error;
    for (int i = 0; i < SHV_DIGEST_NUMBERS; i++) digest.numbers[i] = 1.0 / (i + 3);
    digest.numbers[3] = (double)INFINITY;
    check_ok(shv_digest_save(&digest, path, &error), error);
    check_ok(shv_digest_load(&back, path, NULL, &error), error);
    strcpy(digest.message, "a text of two lines");
    check_same(&digest, &back);
    shv_digest_release(&back);
    check_near(shv_digest_seconds(&digest), 0.1, 0.0);
    /* Cut anywhere, it is not whole. */
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    static char text[1 << 14];
    const size_t length = fread(text, 1, sizeof text, file);
    fclose(file);
    for (size_t cut = 0; cut + 1 < length; cut += 1 + length / 200) {
        file = fopen(path, "w");
        assert_non_null(file);
        assert_int_equal(fwrite(text, 1, cut, file), cut);
        fclose(file);
        check_fails(shv_digest_load(&back, path, NULL, &error), SHV_BAD_INPUT, error, "not a whole run");
    }
    unlink(path);
    check_fails(shv_digest_load(&back, path, NULL, &error), SHV_FILE_ERROR, error, "cannot read");
    check_fails(shv_digest_save(&digest, "/nowhere/at/all.run", &error), SHV_FILE_ERROR, error, "/nowhere");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_median),
        cmocka_unit_test(test_masses),
        cmocka_unit_test(test_distance_to_facet),
        cmocka_unit_test(test_cracks),
        cmocka_unit_test(test_surface_of_bonds),
        cmocka_unit_test(test_errors),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_files),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
