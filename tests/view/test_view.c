/* Pages of runs: what is in them is what the run file holds, and no text of a scene becomes HTML. */
#include "check.h"

#include <math.h>
#include <stdlib.h>
#include <zlib.h>

#include "base/memory.h"
#include "export/lines.h"
#include "export/run.h"
#include "files.h"
#include "shiver/view.h"

enum { FRAMES = 8, BRICKS = 4, FACES = 6 * BRICKS, OBSTACLES = 2 };
static const char PAGE[] = "<title>SHIVER_TITLE</title>SHIVER_DATA<p>end";
static const char EVIL[] = "</title><script>alert(1)</script> & \"x\"";

static ShvRunFile *open_run(void *folder, const char *name, bool nodes)
{
    ShvError error;
    ShvRunFile *file;
    ShvRecordDefinition definition = shv_record_default();
    definition.path = file_in(folder, "run.h5");
    definition.scene_name = name;
    definition.nodes = nodes;
    definition.force = true;
    record_frames(&definition, FRAMES);
    check_ok(shv_run_file_open(&file, definition.path, NULL, &error), error);
    return file;
}

static ShvViewOptions options_of(void)
{
    ShvViewOptions options = shv_view_default();
    options.page = PAGE;
    options.force = true;
    return options;
}

static int digit_of(char letter)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char *found = strchr(digits, letter);
    assert_non_null(found);
    return (int)(found - digits);
}

/* The numbers of the first run of a page, inflated; to be freed. */
static unsigned char *unpack(const char *page, size_t *size)
{
    static const char mark[] = "<script type=\"application/octet-stream\" class=\"run\">";
    const char *text = strstr(page, mark);
    assert_non_null(text);
    text += strlen(mark);
    const size_t letters = strcspn(text, "<");
    assert_int_equal(letters % 4, 0);
    unsigned char *packed = malloc(letters), *plain = malloc(1 << 20);
    size_t count = 0;
    for (size_t i = 0; i < letters; i += 4) {
        unsigned group = 0;
        int known = 0;
        for (int k = 0; k < 4; k++) {
            group = group << 6 | (text[i + (size_t)k] == '=' ? 0u : (unsigned)digit_of(text[i + (size_t)k]));
            known += text[i + (size_t)k] != '=';
        }
        for (int k = 0; k < known - 1; k++) packed[count++] = (unsigned char)(group >> (16 - 8 * k));
    }
    uLongf length = 1 << 20;
    assert_int_equal(uncompress(plain, &length, packed, count), Z_OK);
    free(packed);
    *size = length;
    return plain;
}

static char *write_run(void *folder, const ShvViewRun *run, const ShvViewOptions *options)
{
    ShvError error;
    check_ok(shv_view_write(run, 1, file_in(folder, "a.html"), options, &error), error);
    return read_bytes(file_in(folder, "a.html"));
}

static char *write_page(void *folder, ShvRunFile *file, const ShvViewOptions *options)
{
    const ShvViewRun run = {.file = file};
    return write_run(folder, &run, options);
}

static void test_scene_text_is_no_html(void **state)
{
    size_t size;
    ShvRunFile *file = open_run(*state, EVIL, false);
    const ShvViewOptions options = options_of();
    char *page = write_page(*state, file, &options);
    assert_int_equal(strncmp(page, "<title>&lt;/title&gt;&lt;script&gt;alert(1)&lt;/script&gt; &amp;", 63), 0);
    assert_null(strstr(page, "alert(1)</"));
    assert_string_equal(page + strlen(page) - 6, "<p>end");
    unsigned char *plain = unpack(page, &size);
    assert_non_null(strstr((char *)plain + 4,
                           "\"name\":\"\\u003c/title>\\u003cscript>alert(1)\\u003c/script> & \\u0022x\\u0022\""));
    free(plain);
    free(page);
    shv_run_file_close(file);
}

static int32_t int_at(const unsigned char *bytes)
{
    int32_t value;
    memcpy(&value, bytes, sizeof value);
    return value;
}

static float float_at(const unsigned char *bytes)
{
    float value;
    memcpy(&value, bytes, sizeof value);
    return value;
}

/* Positions, velocities and carriers of all frames, put together again, against the run file. */
static void check_frames(ShvRunFile *file, const unsigned char *ranges, const unsigned char *frames)
{
    ShvError error;
    ShvLines lines;
    uint16_t numbers[10 * BRICKS] = {0};
    int32_t carrier[BRICKS] = {0};
    double velocity[3 * 7];
    check_ok(shv_lines_create(&lines, file, NULL, NULL, &error), error);
    for (int frame = 0; frame < FRAMES; frame++, frames += 25 * BRICKS) {
        check_ok(shv_lines_move(&lines, frame, &error), error);
        check_ok(shv_run_file_frame(file, frame, NULL, NULL, NULL, NULL, NULL, velocity, NULL, &error), error);
        for (int i = 0; i < 10 * BRICKS; i++)
            numbers[i] = (uint16_t)(numbers[i] + frames[i] + (frames[10 * BRICKS + i] << 8));
        for (int line = 0; line < BRICKS; line++) {
            const ShvPose pose = shv_lines_pose(&lines, line);
            double expected[6];
            shv_store3(expected, pose.position);
            carrier[line] += int_at(frames + 20 * BRICKS + 4 * line);
            assert_int_equal(carrier[line], pose.fragment);
            for (int k = 0; k < 3; k++) expected[3 + k] = velocity[3 * pose.fragment + k];
            for (int k = 0; k < 6; k++) {
                const unsigned char *range = ranges + 8 * (6 * line + k);
                const double low = (double)float_at(range), step = (double)float_at(range + 4);
                /* Half a step, and the float that `low` is. */
                check_near(low + step * numbers[(k < 3 ? k : k + 4) * BRICKS + line], expected[k],
                           0.5001 * step + 1e-7 * fabs(expected[k]));
            }
            check_near((int16_t)numbers[6 * BRICKS + line] / 32767.0, pose.orientation.w, 0.51 / 32767.0);
        }
    }
    shv_lines_release(&lines);
}

static void test_frames_are_those_of_the_run(void **state)
{
    size_t size;
    ShvRunFile *file = open_run(*state, "wall", false);
    const ShvViewOptions options = options_of();
    char *page = write_page(*state, file, &options);
    unsigned char *plain = unpack(page, &size);
    /* From the end: frames; poses of the obstacles; a floor of 4 nodes and 2 triangles, a hammer of 4 and 4; corners and
       what is behind each face; ranges. */
    const unsigned char *frames = plain + size - (size_t)FRAMES * 25 * BRICKS;
    const unsigned char *faces = frames - FRAMES * OBSTACLES * 28 - 12 * (4 + 2 + 4 + 4) - 40 * FACES;
    check_frames(file, faces - 48 * BRICKS, frames);
    /* Each tet has three faces outside: the fourth is between the two of a brick. */
    for (int i = 0; i < FACES; i++) assert_int_equal(int_at(faces + 4 * i), -1);
    assert_int_equal(int_at(faces - 48 * BRICKS - 4), FACES);
    double time;
    memcpy(&time, plain + 4 + int_at(plain), sizeof time);
    assert_true(time == 0.0);
    free(plain);
    free(page);
    shv_run_file_close(file);
}

/* Convex pieces of a single brick, which is convex: its five corners about the centre, and six faces. */
static const unsigned char *check_brick(const unsigned char *at)
{
    assert_int_equal(int_at(at), 5);
    assert_int_equal(int_at(at + 4), 6);
    int apex = 0;
    for (int v = 0; v < 5; v++) {
        double corner[3];
        for (int c = 0; c < 3; c++) corner[c] = (double)float_at(at + 8 + 12 * v + 4 * c);
        for (int c = 0; c < 3; c++) check_near(fabs(corner[c]), 0.5, 1e-7);
        apex += corner[0] > 0.0 && corner[1] > 0.0 && corner[2] > 0.0;
    }
    assert_int_equal(apex, 1);
    for (int k = 0; k < 18; k++) assert_in_range(at[68 + k], 0, 4);
    return at + 86;
}

/* Every fragment has its pieces, which lie before the frames; without them nothing of them is there. */
static void test_convex_pieces(void **state)
{
    size_t with, without;
    ShvRunFile *file = open_run(*state, "wall", false);
    const ShvViewOptions options = options_of();
    const ShvViewRun run = {.file = file, .convex = true};
    char *page = write_run(*state, &run, &options), *bare = write_page(*state, file, &options);
    unsigned char *plain = unpack(page, &with), *unadorned = unpack(bare, &without);
    assert_non_null(strstr((char *)plain + 4, "\"hulls\":7,"));
    assert_non_null(strstr((char *)unadorned + 4, "\"hulls\":0,"));
    const unsigned char *at = plain + without - (size_t)FRAMES * 25 * BRICKS;
    const unsigned char *end = plain + with - (size_t)FRAMES * 25 * BRICKS;
    int bricks = 0;
    while (at < end) {
        const int fragment = int_at(at), count = int_at(at + 4);
        assert_in_range(fragment, 0, 6);
        assert_in_range(count, 1, BRICKS);
        at += 8;
        for (int i = 0; i < count; i++) {
            bricks += count == 1 && int_at(at) == 5;
            at = int_at(at) == 5 ? check_brick(at) : at + 8 + 12 * int_at(at) + 3 * int_at(at + 4);
        }
    }
    assert_true(at == end && bricks == BRICKS);
    free(plain);
    free(unadorned);
    free(page);
    free(bare);
    shv_run_file_close(file);
}

static void test_same_bytes_and_thinned(void **state)
{
    size_t all, few;
    ShvRunFile *file = open_run(*state, "wall", true);
    ShvViewOptions options = options_of();
    char *one = write_page(*state, file, &options), *two = write_page(*state, file, &options);
    assert_string_equal(one, two);
    unsigned char *plain = unpack(one, &all);
    options.every = 3;
    char *thin = write_page(*state, file, &options);
    unsigned char *thinned = unpack(thin, &few);
    assert_non_null(strstr((char *)plain + 4, "\"frames\":8,\"allFrames\":8,"));
    assert_non_null(strstr((char *)thinned + 4, "\"frames\":4,\"allFrames\":8,")); /* 0, 3, 6 and the last */
    assert_true(few < all);
    free(plain);
    free(thinned);
    free(one);
    free(two);
    free(thin);
    shv_run_file_close(file);
}

static void test_refusals(void **state)
{
    ShvError error;
    const char *path = file_in(*state, "a.html");
    ShvRunFile *file = open_run(*state, "wall", false);
    const ShvViewRun runs[3] = {{.file = file}, {.file = file}, {.file = file}};
    ShvViewOptions options = options_of();
    check_fails(shv_view_write(runs, 3, path, &options, &error), SHV_BAD_INPUT, error, "one or two");
    options.every = 0;
    check_fails(shv_view_write(runs, 1, path, &options, &error), SHV_BAD_INPUT, error, "every");
    options = options_of();
    options.page = "<title>";
    check_fails(shv_view_write(runs, 1, path, &options, &error), SHV_BAD_INPUT, error, "SHIVER_TITLE");
    options.cookie = 0;
    check_fails(shv_view_write(runs, 1, path, &options, &error), SHV_BAD_INPUT, error, "shv_view_default");
    options = options_of();
    options.force = false;
    check_ok(shv_view_write(runs, 2, path, &options, &error), error);
    check_fails(shv_view_write(runs, 1, path, &options, &error), SHV_BAD_INPUT, error, "--force");
    if (!shv_view_is_built())
        check_fails(shv_view_write(runs, 1, file_in(*state, "b.html"), NULL, &error), SHV_UNSUPPORTED, error,
                    "./bootstrap view");
    assert_int_equal(files_in(*state), 2);
    shv_run_file_close(file);
}

/* Whichever allocation fails: the status says so and no file is left. */
static void test_out_of_memory(void **state)
{
    ShvError error;
    ShvRunFile *file = open_run(*state, "wall", true);
    const ShvElasticity elasticity = {70e9, 0.2};
    const ShvViewRun run = {.file = file, .elasticity = &elasticity, .convex = true};
    ShvStatus status = SHV_NO_MEMORY;
    int failures = 0;
    for (; status != SHV_OK && failures < 1000; failures++) {
        ShvViewOptions options = options_of();
        options.memory = shv_memory_create();
        shv_memory_fail_after(options.memory, failures);
        status = shv_view_write(&run, 1, file_in(*state, "a.html"), &options, &error);
        if (status != SHV_OK) assert_int_equal(status, SHV_NO_MEMORY);
        assert_int_equal(files_in(*state), status == SHV_OK ? 2 : 1);
        assert_int_equal(shv_memory_bytes(options.memory, SHV_PART_COUNT), 0);
        shv_memory_destroy(options.memory);
    }
    assert_true(failures > 20 && failures < 1000);
    shv_run_file_close(file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_scene_text_is_no_html, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_frames_are_those_of_the_run, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_convex_pieces, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_same_bytes_and_thinned, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_refusals, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_out_of_memory, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
