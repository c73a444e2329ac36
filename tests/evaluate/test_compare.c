/* Comparisons of small scenes: errors, references, refusals, files. */
#include "check.h"

#include <stdlib.h>
#include <unistd.h>

#include "base/memory.h"
#include "shiver/scene.h"
#include "shiver/study.h"
#include "xml.h"

#define HEAD                                                                                                           \
    "shiver: 1\nname: drop & bounce\n"                                                                                 \
    "materials: {m: {density: 1000, youngs_modulus: 1e6, poissons_ratio: 0.3, breakable: false}}\n"                    \
    "threads: 1\noutput: {rate: 200}\n"
/* A box that falls flat hits the floor below its centre. */
#define BOUNCE                                                                                                         \
    HEAD "objects: {box: {mesh: {box: {size: [0.1, 0.1, 0.1], edge: 0.1}}, material: m, position: [0, 0, 0.25]}}\n"    \
         "obstacles: {floor: {plane: {normal: [0, 0, 1]}, restitution: 0.5}, wall: {box: {size: [1, 1, 1]}, "          \
         "position: [9, 0, 0]}}\nduration: 0.4\n"                                                                      \
         "reference: {law: bounce, body: box, on: floor}\n"

static ShvScene *parse(const char *text, const char *const *overrides, int32_t count)
{
    ShvScene *scene = NULL;
    ShvError error;
    check_ok(shv_scene_parse(&scene, text, strlen(text), "text", NULL, overrides, count, NULL, NULL, &error), error);
    return scene;
}

static ShvCompareOptions analytic_at(double step)
{
    ShvCompareOptions options = shv_compare_default();
    options.engine_count = 1;
    options.engines[0] = SHV_RIGID_ANALYTIC;
    options.step_count = 1;
    options.steps[0] = step;
    return options;
}

static void test_bounce(void **state)
{
    (void)state;
    ShvScene *scene = parse(BOUNCE, NULL, 0);
    ShvCompareOptions options = shv_compare_default();
    options.step_count = 2;
    ShvComparison *comparison;
    ShvError error;
    check_ok(shv_compare(&comparison, shv_scene_definition(scene), &options, &error), error);
    assert_int_equal(shv_comparison_count(comparison), 8);
    assert_string_equal(shv_comparison_reference(comparison), "closed form (bounce of box on floor)");
    for (int32_t i = 0; i < 8; i++) {
        const ShvComparedRun *run = shv_comparison_run(comparison, i);
        assert_int_equal(run->engine, options.engines[i / 2]);
        assert_true(run->step == options.steps[i % 2] && run->status == SHV_OK && !run->is_reference);
        assert_true(run->seconds > 0.0 && run->seconds_per_step > 0.0 && run->seconds_per_step < run->seconds);
        /* Falls 0.2 m: impacts at 0.2019 and 0.4038 s, the second after the end. */
        assert_int_equal(run->reference_moments, 1);
        if (run->engine == SHV_RIGID_PBD || run->engine == SHV_RIGID_BULLET_PLAIN) continue;
        assert_int_equal(run->moments, 1);
        /* The floor is met within the backends' slack, which is far below 1 µm for a box of 10 cm. */
        assert_true(run->position < 1e-6 && run->velocity < 1e-5 && run->moment < 1e-6 && run->energy < 1e-5);
        assert_true(run->surface >= run->position);
    }
    shv_comparison_destroy(comparison);
    shv_scene_destroy(scene);
}

static void test_finest(void **state)
{
    (void)state;
    static const char *const none[] = {"reference={law: rest}"};
    ShvScene *scene = parse(BOUNCE, none, 1);
    ShvSceneDefinition definition = *shv_scene_definition(scene);
    definition.reference.law = SHV_REFERENCE_NONE;
    ShvCompareOptions options = shv_compare_default();
    options.step_count = 2;
    ShvComparison *comparison;
    ShvError error;
    check_ok(shv_compare(&comparison, &definition, &options, &error), error);
    assert_string_equal(shv_comparison_reference(comparison), "finest run (analytic at 0.001 s)");
    for (int32_t i = 0; i < 8; i++) {
        const ShvComparedRun *run = shv_comparison_run(comparison, i);
        assert_true(run->is_reference == (i == 7));
        assert_int_equal(run->reference_moments, 0);
        if (run->is_reference) assert_true(run->position == 0.0 && run->energy == 0.0);
    }
    shv_comparison_destroy(comparison);
    options.engine_count = 1;
    options.engines[0] = SHV_RIGID_PBD;
    check_fails(shv_compare(&comparison, &definition, &options, &error), SHV_BAD_INPUT, error, "add bullet or");
    assert_null(comparison);
    shv_scene_destroy(scene);
}

static void refused(const char *override, const char *part)
{
    const char *const overrides[] = {override, "overlaps=keep"};
    ShvScene *scene = parse(BOUNCE, overrides, 2);
    ShvComparison *comparison;
    ShvError error;
    const ShvCompareOptions options = analytic_at(1e-2);
    check_fails(shv_compare(&comparison, shv_scene_definition(scene), &options, &error), SHV_BAD_INPUT, error, part);
    assert_null(comparison);
    shv_scene_destroy(scene);
}

static void test_refusals(void **state)
{
    (void)state;
    refused("materials.m={density: 1000, youngs_modulus: 1e6, poissons_ratio: 0.3, fracture_energy: 1, "
            "cohesive_strength: 1e3}",
            "can break");
    refused("events=[{at: 0.1, gravity: [0, 0, -5]}]", "gravity changes");
    refused("events=[{at: 0.1, impulse: {target: box, impulse: [1, 0, 0]}}]", "no events");
    refused("gravity=[1, 0, -9]", "straight on to");
    refused("objects.box.velocity=[1, 0, 0]", "is straight");
    refused("objects.box.angular_velocity=[1, 0, 0]", "no spin");
    refused("objects.box.position=[0, 0, 0]", "above");
    refused("objects.box.rotation={axis: [0, 1, 0], angle: 30}", "begin to turn");
    refused("reference={law: slide, body: box, on: floor}", "the gap is 0.2 m");
    refused("reference={law: roll, body: box, on: floor}", "not round enough");
    /* Material that could break, but fracture is off. */
    static const char *const off[] = {"materials.m={density: 1000, youngs_modulus: 1e6, poissons_ratio: 0.3, "
                                      "fracture_energy: 1, cohesive_strength: 1e3}",
                                      "fracture.enabled=false"};
    ShvScene *scene = parse(BOUNCE, off, 2);
    ShvComparison *comparison;
    ShvError error;
    const ShvCompareOptions options = analytic_at(1e-2);
    check_ok(shv_compare(&comparison, shv_scene_definition(scene), &options, &error), error);
    assert_true(shv_comparison_run(comparison, 0)->position < 1e-6);
    shv_comparison_destroy(comparison);
    shv_scene_destroy(scene);
}

static void test_bad_options(void **state)
{
    (void)state;
    ShvScene *scene = parse(BOUNCE, NULL, 0);
    const ShvSceneDefinition *definition = shv_scene_definition(scene);
    ShvComparison *comparison;
    ShvError error;
    ShvCompareOptions options = analytic_at(1e-2);
    options.cookie = 0;
    check_fails(shv_compare(&comparison, definition, &options, &error), SHV_BAD_INPUT, error, "shv_compare_default");
    static const double steps[] = {0.0, -1.0, 2.0};
    for (int i = 0; i < 3; i++) {
        options = analytic_at(steps[i]);
        check_fails(shv_compare(&comparison, definition, &options, &error), SHV_BAD_INPUT, error, "time step");
    }
    options = analytic_at((double)NAN);
    check_fails(shv_compare(&comparison, definition, &options, &error), SHV_BAD_INPUT, error, "time step");
    options = analytic_at(1e-2);
    options.step_count = 2;
    options.steps[1] = 1e-2;
    check_fails(shv_compare(&comparison, definition, &options, &error), SHV_BAD_INPUT, error, "twice");
    options.step_count = 0;
    check_fails(shv_compare(&comparison, definition, &options, &error), SHV_BAD_INPUT, error, "1 to 16");
    options = analytic_at(1e-2);
    options.engine_count = 2;
    options.engines[1] = SHV_RIGID_ANALYTIC;
    check_fails(shv_compare(&comparison, definition, &options, &error), SHV_BAD_INPUT, error, "twice");
    options.engine_count = 0;
    check_fails(shv_compare(&comparison, definition, &options, &error), SHV_BAD_INPUT, error, "engines");
    shv_scene_destroy(scene);
}

/* A spin that no step can follow fails in its run; the others are shown. */
static void test_failed_run(void **state)
{
    (void)state;
    static const char *const fast[] = {"objects.box.angular_velocity=[1, 2e6, 3]", "reference={law: flight, body: box}",
                                       "duration=0.1", "gravity=[0, 0, 0]", "obstacles={}"};
    ShvScene *scene = parse(BOUNCE, fast, 5);
    ShvComparison *comparison;
    ShvError error;
    ShvCompareOptions options = analytic_at(1e-1);
    options.step_count = 2;
    options.steps[1] = 1e-2;
    check_ok(shv_compare(&comparison, shv_scene_definition(scene), &options, &error), error);
    const ShvComparedRun *run = shv_comparison_run(comparison, 0);
    assert_int_equal(run->status, SHV_DIVERGED);
    assert_non_null(strstr(run->message, "smaller rigid.time_step"));
    assert_int_equal(shv_comparison_run(comparison, 1)->status, SHV_OK);
    shv_comparison_destroy(comparison);
    options.step_count = 1;
    check_fails(shv_compare(&comparison, shv_scene_definition(scene), &options, &error), SHV_DIVERGED, error,
                "every run failed");
    shv_scene_destroy(scene);
}

static char *read_text(const char *path)
{
    enum { MOST = 1 << 20 };
    char *text = malloc(MOST);
    FILE *file = fopen(path, "r");
    assert_true(text && file);
    text[fread(text, 1, MOST - 1, file)] = '\0';
    fclose(file);
    return text;
}

static void test_files(void **state)
{
    (void)state;
    char folder[] = "/tmp/shiver-study-XXXXXX", prefix[64], csv[80], svg[80];
    assert_non_null(mkdtemp(folder));
    snprintf(prefix, sizeof prefix, "%s/a", folder);
    snprintf(csv, sizeof csv, "%s_compare.csv", prefix);
    snprintf(svg, sizeof svg, "%s_compare.svg", prefix);
    ShvScene *scene = parse(BOUNCE, NULL, 0);
    ShvComparison *comparison;
    ShvError error;
    ShvCompareOptions options = shv_compare_default();
    options.step_count = 2;
    check_ok(shv_compare(&comparison, shv_scene_definition(scene), &options, &error), error);
    check_ok(shv_comparison_check_files(prefix, false, &error), error);
    check_ok(shv_comparison_write(comparison, prefix, false, &error), error);
    check_fails(shv_comparison_check_files(prefix, false, &error), SHV_BAD_INPUT, error, "--force");
    check_fails(shv_comparison_write(comparison, prefix, false, &error), SHV_BAD_INPUT, error, "--force");
    check_ok(shv_comparison_write(comparison, prefix, true, &error), error);
    char *table = read_text(csv), *drawing = read_text(svg);
    /* 0.4 s at 100 frames/s (the longest step is 10 ms) is 41 frames, of eight runs. */
    int lines = 0, commas = 0, columns = 0;
    for (const char *c = table; *c; c++) {
        commas += *c == ',';
        if (*c != '\n') continue;
        if (lines++ == 0) columns = commas;
        assert_int_equal(commas, columns);
        commas = 0;
    }
    assert_int_equal(lines, 1 + 8 * 41);
    assert_int_equal(columns, 41);
    assert_non_null(strstr(table, "\npbd,0.001,0.4,"));
    check_well_formed(drawing);
    assert_int_equal(count_text(drawing, "<title>drop &amp; bounce</title>"), 1);
    assert_int_equal(count_text(drawing, ">0.01 s<"), 4);
    assert_int_equal(count_text(drawing, "<polyline"), 4);
    free(table);
    free(drawing);
    unlink(csv);
    unlink(svg);
    assert_int_equal(rmdir(folder), 0);
    shv_comparison_destroy(comparison);
    shv_scene_destroy(scene);
}

/* Whichever allocation fails, the status says so and nothing is left behind. */
static void test_no_memory(void **state)
{
    (void)state;
    static const char *const brief[] = {"duration=0.02", "reference={law: flight}"};
    ShvScene *scene = parse(BOUNCE, brief, 2);
    ShvMemory *memory = shv_memory_create();
    for (int finest = 0; finest < 2; finest++) {
        ShvSceneDefinition definition = *shv_scene_definition(scene);
        if (finest) definition.reference.law = SHV_REFERENCE_NONE;
        ShvStatus status = SHV_NO_MEMORY;
        int64_t count = 0;
        for (; status != SHV_OK && count < 2000; count++) {
            ShvComparison *comparison;
            ShvError error;
            ShvCompareOptions options = analytic_at(1e-2);
            options.memory = memory;
            shv_memory_fail_after(memory, count);
            status = shv_compare(&comparison, &definition, &options, &error);
            if (status != SHV_OK) assert_int_equal(status, SHV_NO_MEMORY);
            shv_comparison_destroy(comparison);
            assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
        }
        assert_true(count > 20 && count < 2000);
    }
    shv_memory_fail_after(memory, -1);
    shv_memory_destroy(memory);
    shv_scene_destroy(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_bounce),      cmocka_unit_test(test_finest),     cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_bad_options), cmocka_unit_test(test_failed_run), cmocka_unit_test(test_files),
        cmocka_unit_test(test_no_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
