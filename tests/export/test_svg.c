/* Drawings: well-formed, with the panels, colours and extents that were asked for. */
#include "check.h"

#include <locale.h>
#include <stdlib.h>

#include "base/memory.h"
#include "export/colour.h"
#include "export/run.h"
#include "files.h"
#include "shiver/export.h"
#include "xml.h"

enum { FRAMES = 8, BRICKS = 4 };

static ShvRunFile *open_run(void *folder, bool nodes)
{
    ShvError error;
    ShvRunFile *file;
    ShvRecordDefinition definition = shv_record_default();
    definition.path = file_in(folder, "run.h5");
    definition.scene_name = "glass & <stone>";
    definition.nodes = nodes;
    definition.force = true;
    record_frames(&definition, FRAMES);
    check_ok(shv_run_file_open(&file, file_in(folder, "run.h5"), NULL, &error), error);
    return file;
}

static char *draw(void *folder, ShvRunFile *file, const ShvSvgOptions *options)
{
    ShvError error;
    check_ok(shv_export_svg(file, file_in(folder, "a"), options, &error), error);
    return read_bytes(file_in(folder, "a.svg"));
}

static bool is_shadow(const char *path)
{
    return strncmp(path + 19, "\" fill-opacity", 14) == 0;
}

/* The panel's faces have colours of these fragments and no others, and each fragment is seen; faces beside tets that are not
   held across a facet (some of every brick, by the stand-in's bonds) have that of cracks where nodes were recorded. */
static void check_colours(const char *panel, const int32_t *lines, int count, bool nodes)
{
    bool seen[BRICKS] = {false}, cracked = false;
    const char *end = strstr(panel, "</svg>");
    int paths = 0;
    for (const char *at = strstr(panel, "<path fill=\"#"); at && at < end;
         at = strstr(at + 1, "<path fill=\"#"), paths++) {
        const uint32_t colour = (uint32_t)strtoul(at + 13, NULL, 16);
        if (is_shadow(at)) continue;
        bool known = false;
        for (int shade = 0; shade < SHV_SHADES; shade++)
            known = known || shv_shaded(SHV_OBSTACLE_COLOUR, shade) == colour; /* the hammer */
        for (int shade = 0; shade < SHV_SHADES; shade++)
            if (shv_shaded(SHV_CRACK_COLOUR, shade) == colour) known = cracked = true;
        for (int i = 0; i < count; i++)
            for (int shade = 0; shade < SHV_SHADES; shade++)
                if (shv_shaded(i == 0 ? (uint32_t)SHV_STONE_COLOUR : shv_line_colour(lines[i]), shade) == colour)
                    known = seen[i] = true;
        assert_true(known);
    }
    assert_true(paths > 0 && cracked == nodes);
    for (int i = 0; i < count; i++) assert_true(seen[i] || nodes);
}

static void test_panels_and_colours(void **state)
{
    const int64_t frames[2] = {0, FRAMES - 1};
    for (int nodes = 0; nodes < 2; nodes++) {
        ShvRunFile *file = open_run(*state, nodes);
        ShvSvgOptions options = shv_svg_default();
        options.frames = frames;
        options.frame_count = 2;
        options.force = true;
        char *xml = draw(*state, file, &options);
        check_well_formed(xml);
        assert_int_equal(count_text(xml, "class=\"panel\""), 2);
        assert_int_equal(count_text(xml, "<title>glass &amp; &lt;stone&gt;</title>"), 1);
        assert_int_equal(count_text(xml, ">1 fragment<"), 1);
        assert_int_equal(count_text(xml, ">4 fragments<"), 1);
        assert_int_equal(count_text(xml, ">0.02917 s<"), 1); /* 7 / 240 s */
        const char *first = strstr(xml, "class=\"panel\"");
        check_colours(first, (const int32_t[]){0}, 1, nodes);
        /* Fragment 0 became 1 and 2, 1 became 3 and 4, 2 became 5 and 6: equal masses, so the first is the
           largest and goes on in the line of 0, and 5 in that of 2. */
        check_colours(strstr(first + 1, "class=\"panel\""), (const int32_t[]){0, 4, 2, 6}, 4, nodes);
        free(xml);
        shv_run_file_close(file);
    }
}

/* A shadow or an obstacle. */
static bool is_scenery(const char *path)
{
    const uint32_t colour = (uint32_t)strtoul(path + 13, NULL, 16);
    if (is_shadow(path)) return true;
    for (int shade = 0; shade < SHV_SHADES; shade++)
        if (shv_shaded(SHV_OBSTACLE_COLOUR, shade) == colour) return true;
    return false;
}

/* Grows a box by the corners of a patch, `at` its first; returns their number. */
static int read_patch(const char *at, double low[2], double high[2])
{
    double p[2] = {0.0, 0.0};
    int corners = 0;
    for (; *at != 'z'; corners++) {
        double move[2];
        int length = 0;
        const char command = *at++;
        assert_true(command == (corners == 0 ? 'M' : 'l'));
        assert_int_equal(sscanf(at, "%lf %lf%n", &move[0], &move[1], &length), 2);
        at += length;
        for (int k = 0; k < 2; k++) {
            p[k] += move[k];
            low[k] = fmin(low[k], p[k]);
            high[k] = fmax(high[k], p[k]);
        }
    }
    return corners;
}

/* What must be in view is in view, and large: it reaches at least over half of the panel in one direction. */
static void test_frame_around_the_fragments(void **state)
{
    ShvRunFile *file = open_run(*state, false);
    ShvSvgOptions options = shv_svg_default();
    char *xml = draw(*state, file, &options);
    assert_int_equal(count_text(xml, "class=\"panel\""), 4);
    int plain = 0, going_on = 0;
    double width, height, low[2] = {(double)INFINITY, (double)INFINITY},
                          high[2] = {-(double)INFINITY, -(double)INFINITY};
    assert_int_equal(
        sscanf(strstr(strstr(xml, "class=\"panel\""), "width="), "width=\"%lf\" height=\"%lf\"", &width, &height), 2);
    for (const char *path = strstr(xml, "<path fill=\"#"); path; path = strstr(path + 1, "<path fill=\"#")) {
        const char *at = strstr(path, "d=\"M");
        if (is_scenery(path)) continue;
        const char *end = strchr(at + 3, '"');
        for (at += 3; at < end; at = strchr(at, 'z') + 1) {
            const int corners = read_patch(at, low, high);
            assert_true(corners == 3 || corners == 5);
            plain += corners == 3;
            going_on += corners == 5;
        }
    }
    /* Of each brick one side is seen, two triangles: the first goes on under the second, by two corners more. */
    assert_true(plain == going_on && plain > 0);
    assert_true(low[0] >= 0.0 && low[1] >= 0.0 && high[0] <= width && high[1] <= height);
    assert_true(high[0] - low[0] > 0.5 * width || high[1] - low[1] > 0.5 * height);
    free(xml);
    shv_run_file_close(file);
}

static void test_same_bytes_in_any_locale(void **state)
{
    ShvRunFile *file = open_run(*state, false);
    ShvSvgOptions options = shv_svg_default();
    char *one = draw(*state, file, &options);
    ShvError error;
    check_fails(shv_export_svg(file, file_in(*state, "a"), &options, &error), SHV_BAD_INPUT, error, "--force");
    options.force = true;
    static const char *const commas[] = {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"};
    for (int i = 0; i < 3; i++)
        if (setlocale(LC_ALL, commas[i])) break;
    char *two = draw(*state, file, &options);
    setlocale(LC_ALL, "C");
    assert_string_equal(one, two);
    check_well_formed(one);
    assert_int_equal(count_text(one, "fill-opacity"), 4); /* the floor's shadow in each panel */
    free(one);
    free(two);
    shv_run_file_close(file);
}

static void test_refusals(void **state)
{
    ShvError error;
    const int64_t frames[25] = {0, FRAMES};
    const double times[2] = {0.0, 1.0};
    const char *path = file_in(*state, "a");
    ShvRunFile *file = open_run(*state, false);
    ShvSvgOptions options = shv_svg_default();
    options.frames = frames;
    options.frame_count = 2;
    check_fails(shv_export_svg(file, path, &options, &error), SHV_BAD_INPUT, error, "frames 0 to 7");
    options.frame_count = 25;
    check_fails(shv_export_svg(file, path, &options, &error), SHV_BAD_INPUT, error, "at most 24");
    options.times = times;
    options.time_count = 2;
    check_fails(shv_export_svg(file, path, &options, &error), SHV_BAD_INPUT, error, "either");
    options.frame_count = 0;
    check_fails(shv_export_svg(file, path, &options, &error), SHV_BAD_INPUT, error, "no time 1 s");
    options.size = 20;
    check_fails(shv_export_svg(file, path, &options, &error), SHV_BAD_INPUT, error, "pixels");
    options = shv_svg_default();
    options.cookie = 0;
    check_fails(shv_export_svg(file, path, &options, &error), SHV_BAD_INPUT, error, "shv_svg_default");
    assert_int_equal(files_in(*state), 1);
    shv_run_file_close(file);
}

/* A time that was read off a report with six digits may lie a little beyond the run's end; more is none of the run's. */
static void test_rounded_end(void **state)
{
    ShvError error;
    ShvRunFile *file = open_run(*state, false);
    const double last = shv_run_file_info(file)->last_time, rounded = last * (1.0 + 5e-6), beyond = last * (1.0 + 1e-4);
    ShvSvgOptions options = shv_svg_default();
    options.times = &rounded;
    options.time_count = 1;
    free(draw(*state, file, &options));
    options.times = &beyond;
    check_fails(shv_export_svg(file, file_in(*state, "b"), &options, &error), SHV_BAD_INPUT, error, "no time");
    assert_int_equal(shv_run_file_nearest(file, rounded), FRAMES - 1);
    assert_int_equal(shv_run_file_nearest(file, 0.4 * last), 3);
    assert_int_equal(shv_run_file_nearest(file, beyond), -1);
    assert_int_equal(shv_run_file_nearest(file, (double)NAN), -1);
    shv_run_file_close(file);
}

/* Whichever allocation fails: the status says so and no file is left. */
static void test_out_of_memory(void **state)
{
    ShvError error;
    ShvMemory *memory = shv_memory_create();
    ShvRunFile *file = open_run(*state, true);
    ShvSvgOptions options = shv_svg_default();
    options.memory = memory;
    const size_t before = shv_memory_bytes(memory, SHV_PART_COUNT);
    ShvStatus status = SHV_NO_MEMORY;
    int failures = 0;
    for (; status != SHV_OK && failures < 1000; failures++) {
        shv_memory_fail_after(memory, failures);
        status = shv_export_svg(file, file_in(*state, "a"), &options, &error);
        if (status != SHV_OK) assert_int_equal(status, SHV_NO_MEMORY);
        assert_int_equal(files_in(*state), status == SHV_OK ? 2 : 1);
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), before);
    }
    assert_true(failures > 20 && failures < 1000);
    shv_memory_fail_after(memory, -1);
    shv_run_file_close(file);
    shv_memory_destroy(memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_panels_and_colours, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_frame_around_the_fragments, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_same_bytes_in_any_locale, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_refusals, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_rounded_end, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_out_of_memory, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
