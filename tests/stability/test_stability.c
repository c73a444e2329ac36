/* Limits and errors of steps, against closed forms. */
#include "stability/scene.h"

#include <stdlib.h>
#include <unistd.h>

#include "base/memory.h"

#define MATERIAL "{stuff: {density: 1000, youngs_modulus: 1 GPa, poissons_ratio: 0.24, breakable: false}}"

static const char single_tet[] =
    "{shiver: 1, duration: 1, materials: " MATERIAL ", objects: {tet: {material: stuff, mesh: {tetgen: {file: "
    "../scenes/extreme/meshes/single}}}}}";
static const char bar[] =
    "{shiver: 1, duration: 1, materials: " MATERIAL ", objects: {bar: {material: stuff, mesh: {jitter: 0.1, box: "
    "{size: [0.04, 0.04, 0.12], edge: 0.04}}}}}";

static ShvStability *measure(const char *text, const ShvStabilityOptions *options)
{
    ShvScene *scene = scene_parse(text);
    ShvStability *stability = NULL;
    ShvError error = {.message = ""};
    check_ok(shv_stability(&stability, shv_scene_definition(scene), options, &error), error);
    shv_scene_destroy(scene);
    return stability;
}

static ShvStabilityOptions few(int32_t stiffnesses, int32_t iterations, int32_t steps)
{
    ShvStabilityOptions options = shv_stability_default();
    options.stiffness.count = stiffnesses;
    options.iterations.count = iterations;
    options.multiples.count = 0;
    options.steps = steps;
    return options;
}

/* A single tet has its largest frequency as a mode of its own: the computed step is its limit. The search resolves 2 %, and the
   judge counts 5 % growth in 3,333 steps. The program refuses what is above; moduli change the step by their root alone. */
static void one_tet_bears_the_computed_step(void **state)
{
    (void)state;
    ShvStabilityOptions options = few(0, 0, 10000);
    options.moduli.count = 3;
    options.moduli.values[0] = 0.6;
    options.moduli.values[1] = 1e9;
    options.moduli.values[2] = 400e9;
    ShvStability *stability = measure(single_tet, &options);
    assert_int_equal(shv_stability_count(stability), 3);
    for (int32_t i = 0; i < 3; i++) {
        const ShvStabilityRow *row = shv_stability_row(stability, i);
        check_near(row->limit, 1.0, 0.02);
        assert_true(row->failed > row->limit && row->failed <= 1.02 * 1.02);
        assert_true(row->refused_above == 1.0);
        assert_true(row->monotone);
        assert_int_equal(row->iterations, 0);
        assert_true(row->far == SHV_GROWING || row->far == SHV_OVERFLOW);
        check_near(row->stable_step * sqrt(row->modulus), shv_stability_row(stability, 0)->stable_step * sqrt(0.6),
                   1e-9 * row->stable_step * sqrt(row->modulus));
    }
    shv_stability_destroy(stability);
}

/* Central difference makes a mode of frequency ω swing with sin(ω'Δt/2) = ωΔt/2, and has the static solution of any step. */
static void plain_steps_follow_central_difference(void **state)
{
    (void)state;
    ShvStabilityOptions options = few(0, 0, 1000);
    options.multiples.count = 2;
    options.multiples.values[0] = 0.5;
    options.multiples.values[1] = 1.0;
    ShvStability *stability = measure(bar, &options);
    const ShvStabilityRow *row = shv_stability_row(stability, 0);
    assert_int_equal(row->point_count, 3);
    double off[2];
    for (int i = 0; i < 2; i++) {
        const ShvStabilityPoint *point = &row->points[i];
        assert_int_equal(point->outcome, SHV_STABLE);
        check_near(point->stiffness, 1.0, 1e-4); /* what counts for settled moves by 1e-6 in a quarter of a period */
        assert_true(point->closed_form == 1.0);
        check_near(point->energy_kept, 1.0, 0.1);
        off[i] = point->frequency - 1.0;
    }
    /* x + x³/6 for small x: the shift grows with the square of the step, from that of the reference at a quarter. */
    assert_true(off[1] > 0.0 && off[1] < 0.02);
    check_near(off[1] / off[0], (1.0 - 1.0 / 16.0) / (0.25 - 1.0 / 16.0), 1.0);
    assert_true(row->points[2].multiple == row->limit);
    assert_int_equal(row->points[2].outcome, row->limit > 1.0 ? SHV_REFUSED : SHV_STABLE);
    shv_stability_destroy(stability);
}

/* Weak bars fight each other little: their stiffness is that of springs beside the solid, to the share of the stretch that is not
   uniform. It falls with the square of the step, and more sweeps and steps beyond the limit of the mesh are borne. */
static void weak_bars_are_springs_beside_the_solid(void **state)
{
    (void)state;
    ShvStabilityOptions options = few(2, 1, 1000);
    options.stiffness.values[0] = 1.0;
    options.stiffness.values[1] = 0.02;
    options.iterations.values[0] = 1;
    options.multiples.count = 2;
    options.multiples.values[0] = 0.5;
    options.multiples.values[1] = 1.0;
    ShvStability *stability = measure(bar, &options);
    assert_int_equal(shv_stability_count(stability), 3);
    const ShvStabilityRow *plain = shv_stability_row(stability, 0), *stiff = shv_stability_row(stability, 1),
                          *weak = shv_stability_row(stability, 2);
    assert_true(stiff->limit > plain->limit && stiff->over_mesh > 1.0);
    assert_true(isinf(stiff->points[0].closed_form) && stiff->points[0].stiffness > 10.0);
    for (int i = 0; i < 2; i++) {
        const double added = weak->points[i].closed_form - 1.0;
        check_near(weak->points[i].stiffness - 1.0, added, 0.15 * added);
    }
    check_near((weak->points[0].closed_form - 1.0) / (weak->points[1].closed_form - 1.0), 4.0, 1e-9);
    shv_stability_destroy(stability);
}

static void bad_options_are_refused(void **state)
{
    (void)state;
    ShvScene *scene = scene_parse(single_tet);
    const ShvSceneDefinition *definition = shv_scene_definition(scene);
    ShvStability *stability = NULL;
    ShvError error = {.message = ""};
    const struct {
        ShvStabilityOptions options;
        const char *part;
    } cases[] = {
        {{.cookie = 0}, "shv_stability_default"},
        {{.cookie = SHV_DEFINITION_COOKIE, .stiffness = {{1.5}, 1}, .steps = 100, .most = 2}, "stiffness"},
        {{.cookie = SHV_DEFINITION_COOKIE, .iterations = {{0.5}, 1}, .steps = 100, .most = 2}, "iterations"},
        {{.cookie = SHV_DEFINITION_COOKIE, .moduli = {{0.0}, 1}, .steps = 100, .most = 2}, "modulus"},
        {{.cookie = SHV_DEFINITION_COOKIE, .multiples = {{0.0}, 1}, .steps = 100, .most = 2}, "multiple"},
        {{.cookie = SHV_DEFINITION_COOKIE, .stiffness = {{0.0}, 99}, .steps = 100, .most = 2}, "at most"},
        {{.cookie = SHV_DEFINITION_COOKIE, .steps = 99, .most = 2}, "at least 100 steps"},
        {{.cookie = SHV_DEFINITION_COOKIE, .steps = 100, .most = 0.5}, "largest multiple"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        check_fails(shv_stability(&stability, definition, &cases[i].options, &error), SHV_BAD_INPUT, error,
                    cases[i].part);
        assert_null(stability);
    }
    shv_scene_destroy(scene);
}

static void files_are_written_and_kept(void **state)
{
    (void)state;
    char folder[] = "/tmp/shiver-stability-XXXXXX", path[64], prefix[64];
    static const char *const names[] = {"t.csv", "t_limit.svg", "t_stiffness.svg", "t_error.svg"};
    assert_non_null(mkdtemp(folder));
    snprintf(path, sizeof path, "%s/t.csv", folder);
    snprintf(prefix, sizeof prefix, "%s/t", folder);
    const ShvStabilityOptions options = few(1, 1, 100);
    ShvStability *stability = measure(single_tet, &options);
    ShvError error = {.message = ""};
    check_ok(shv_stability_write(stability, path, NULL, false, &error), error);
    check_ok(shv_stability_write(stability, NULL, prefix, false, &error), error);
    check_fails(shv_stability_write(stability, path, NULL, false, &error), SHV_BAD_INPUT, error, "t.csv");
    check_fails(shv_stability_check_files(NULL, prefix, false, &error), SHV_BAD_INPUT, error, "t_limit.svg");
    check_ok(shv_stability_write(stability, NULL, prefix, true, &error), error);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char file[96];
        snprintf(file, sizeof file, "%s/%s", folder, names[i]);
        FILE *stream = fopen(file, "r");
        assert_non_null(stream);
        assert_true(fgetc(stream) == (i == 0 ? 's' : '<')); /* stabiliser,… or an XML head */
        fclose(stream);
        assert_int_equal(remove(file), 0);
    }
    assert_int_equal(rmdir(folder), 0);
    shv_stability_destroy(stability);
}

/* Every allocation fails once. */
static void running_out_of_memory_is_reported(void **state)
{
    (void)state;
    ShvScene *scene = scene_parse(single_tet);
    ShvStabilityOptions options = few(1, 1, 100);
    bool done = false;
    for (int64_t count = 0; !done; count++) {
        ShvMemory *memory = shv_memory_create();
        ShvStability *stability = NULL;
        ShvError error = {.message = ""};
        options.memory = memory;
        shv_memory_fail_after(memory, count);
        const ShvStatus status = shv_stability(&stability, shv_scene_definition(scene), &options, &error);
        done = status == SHV_OK && shv_memory_requests(memory) <= count;
        if (status != SHV_OK) {
            assert_null(stability);
            assert_true(strlen(error.message) > 0);
        }
        shv_stability_destroy(stability);
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
        shv_memory_destroy(memory);
    }
    shv_scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_tet_bears_the_computed_step),
        cmocka_unit_test(plain_steps_follow_central_difference),
        cmocka_unit_test(weak_bars_are_springs_beside_the_solid),
        cmocka_unit_test(bad_options_are_refused),
        cmocka_unit_test(files_are_written_and_kept),
        cmocka_unit_test(running_out_of_memory_is_reported),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
