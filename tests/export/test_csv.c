#include "check.h"

#include <stdlib.h>
#include <unistd.h>

#include "base/memory.h"
#include "export/run.h"
#include "files.h"
#include "shiver/export.h"

enum { FRAMES = 8 };

static ShvRunFile *record_run(const char *path)
{
    ShvError error;
    ShvRunFile *file;
    ShvRecordDefinition definition = shv_record_default();
    definition.path = path;
    record_frames(&definition, FRAMES);
    check_ok(shv_run_file_open(&file, path, NULL, &error), error);
    return file;
}

static int count_lines(const char *text)
{
    int lines = 0;
    for (; *text; text++) lines += *text == '\n';
    return lines;
}

/* Every number of the table of trajectories, read back, is the one that was computed. */
static void check_trajectories(const char *path)
{
    char *table = read_bytes(path), *at = strchr(table, '\n') + 1;
    ShvSimulation *again = fake_create(&BREAKING);
    for (int i = 0; i < FRAMES; i++) {
        fake_advance(again);
        const ShvFrameView *frame = shv_simulation_frame(again);
        for (int32_t f = 0; f < frame->fragment_count; f++) {
            const ShvFragmentView *fragment = &frame->fragments[f];
            if (fragment->mode == SHV_FRAGMENT_DEAD) continue;
            assert_true(strtod(at, &at) == frame->time);
            assert_int_equal(strtol(at + 1, &at, 10), f);
            double motion[13];
            memcpy(motion, (const char *)fragment + offsetof(ShvFragmentView, position), sizeof motion);
            for (int k = 0; k < 13; k++) assert_true(strtod(at + 1, &at) == motion[k]);
            assert_int_equal(*at++, '\n');
        }
    }
    assert_int_equal(*at, '\0');
    fake_destroy(again);
    free(table);
}

/* Corners of each line about its centre, put where its fragment was at the start, are corners of its tets. */
static void check_shapes(ShvRunFile *file, const char *path)
{
    ShvError error;
    ShvFragmentView fragments[7];
    double positions[3 * 20];
    int id = -1, lines = 0, corners = 0, faces = 0;
    check_ok(shv_run_file_fragments(file, fragments, &error), error);
    check_ok(shv_run_file_mesh(file, positions, NULL, NULL, NULL, &error), error);
    char *text = read_bytes(path);
    for (const char *line = text; *line; line = strchr(line, '\n') + 1) {
        double x[3];
        lines += strncmp(line, "o line_", 7) == 0;
        faces += strncmp(line, "f ", 2) == 0;
        if (sscanf(line, "g fragment_%d", &id) == 1 || sscanf(line, "v %lf %lf %lf", &x[0], &x[1], &x[2]) != 3)
            continue;
        double nearest = 1.0;
        for (int n = 0; n < 20; n++) {
            double off = 0.0;
            for (int k = 0; k < 3; k++) off += fabs(x[k] + fragments[id].reference_centre[k] - positions[3 * n + k]);
            nearest = fmin(nearest, off);
        }
        check_near(nearest, 0.0, 3e-8); /* nine digits of numbers up to 4 */
        corners++;
    }
    assert_int_equal(lines, 4);
    assert_int_equal(faces, 24);
    assert_int_equal(corners, 20); /* its triangles share them */
    free(text);
}

static void test_five_tables(void **state)
{
    ShvError error;
    ShvRunFile *file = record_run(file_in(*state, "run.h5"));
    check_ok(shv_export_csv(file, file_in(*state, "out"), NULL, &error), error);
    assert_int_equal(files_in(*state), 7);
    check_trajectories(file_in(*state, "out_trajectories.csv"));
    check_shapes(file, file_in(*state, "out_pieces.obj"));
    char *genealogy = read_bytes(file_in(*state, "out_genealogy.csv"));
    assert_int_equal(count_lines(genealogy), 1 + 7);
    assert_non_null(strstr(genealogy, "\n0,-1,0,\"wall\",0,0.00833333333333333"));
    assert_non_null(strstr(genealogy, ",,2.5,0.5,2,3.5,0.5,0.5\n")); /* alive: no death */
    char *ledger = read_bytes(file_in(*state, "out_ledger.csv"));
    assert_int_equal(count_lines(ledger), 1 + FRAMES);
    assert_non_null(strstr(ledger, "\n7,"));
    char *events = read_bytes(file_in(*state, "out_events.csv"));
    assert_int_equal(count_lines(events), 1 + 3);
    assert_non_null(strstr(events, ",split,0,1,2,7,0,"));
    assert_non_null(strstr(events, ",longest,3,8,9,10,11,12,13,14,15,16,17"));
    char *obstacles = read_bytes(file_in(*state, "out_obstacles.csv"));
    assert_int_equal(count_lines(obstacles), 1 + 2 * FRAMES);
    assert_non_null(strstr(obstacles, ",\"floor\",plane,0,0,0,1,0,0,0,"));
    assert_non_null(strstr(obstacles, ",\"hammer\",mesh,"));
    free(genealogy);
    free(ledger);
    free(events);
    free(obstacles);
    shv_run_file_close(file);
}

/* One more table where there are probes: known samples alone, an unknown number is an empty field. */
static void test_table_of_probes(void **state)
{
    ShvError error;
    ShvRunFile *file;
    const FakeSetup setup = {.bricks = 1, .most = 1, .probes = 2};
    ShvRecordDefinition definition = shv_record_default();
    definition.path = file_in(*state, "run.h5");
    record_setup(&definition, &setup, 3);
    check_ok(shv_run_file_open(&file, definition.path, NULL, &error), error);
    check_ok(shv_export_csv(file, file_in(*state, "out"), NULL, &error), error);
    shv_run_file_close(file);
    assert_int_equal(files_in(*state), 8);
    char *table = read_bytes(file_in(*state, "out_probes.csv"));
    assert_int_equal(count_lines(table), 1 + 4); /* three rows of two; of two the second is unknown */
    assert_non_null(strstr(table, "time [s],probe,displacement.x [m],"));
    assert_non_null(strstr(table, "\n1,tip,1000,1001,1002,1003,"));
    assert_non_null(strstr(table, "\n2.01,floor_below,2120,2121,"));
    assert_non_null(strstr(table, ",2136,2137\n"));
    free(table);
}

static void test_columns_fit_their_names(void **state)
{
    static const char *const names[] = {"out_trajectories.csv", "out_genealogy.csv", "out_ledger.csv", "out_events.csv",
                                        "out_obstacles.csv"};
    ShvError error;
    ShvRunFile *file = record_run(file_in(*state, "run.h5"));
    check_ok(shv_export_csv(file, file_in(*state, "out"), NULL, &error), error);
    for (int i = 0; i < 5; i++) {
        char *table = read_bytes(file_in(*state, names[i]));
        int commas = 0, in_line = 0;
        for (const char *c = table; *c; c++) {
            in_line += *c == ',';
            if (*c != '\n') continue;
            if (commas == 0) commas = in_line;
            assert_int_equal(in_line, commas);
            in_line = 0;
        }
        free(table);
    }
    shv_run_file_close(file);
}

static void test_existing_tables_are_kept(void **state)
{
    ShvError error;
    ShvExportOptions options = shv_export_default();
    ShvRunFile *file = record_run(file_in(*state, "run.h5"));
    write_file(file_in(*state, "out_events.csv"), "precious", 8);
    check_fails(shv_export_csv(file, file_in(*state, "out"), &options, &error), SHV_BAD_INPUT, error, "--force");
    assert_int_equal(files_in(*state), 2);
    options.force = true;
    check_ok(shv_export_csv(file, file_in(*state, "out"), &options, &error), error);
    assert_int_equal(files_in(*state), 7);
    assert_true(file_size(file_in(*state, "out_events.csv")) > 8);
    check_fails(shv_export_csv(file, file_in(*state, "missing/out"), &options, &error), SHV_FILE_ERROR, error,
                "missing/out");
    options.cookie = 0;
    check_fails(shv_export_csv(file, file_in(*state, "out"), &options, &error), SHV_BAD_INPUT, error,
                "shv_export_default");
    shv_run_file_close(file);
}

static void test_animation_frames_only(void **state)
{
    ShvError error;
    ShvExportOptions options = shv_export_default();
    options.animation = true;
    ShvRunFile *file = record_run(file_in(*state, "run.h5"));
    check_ok(shv_export_csv(file, file_in(*state, "out"), &options, &error), error);
    char *ledger = read_bytes(file_in(*state, "out_ledger.csv"));
    assert_int_equal(count_lines(ledger), 1 + FRAMES / 2);
    assert_null(strstr(ledger, "\n1,"));
    free(ledger);
    shv_run_file_close(file);
}

/* Every third frame, and the last. */
static void test_thinned(void **state)
{
    ShvError error;
    ShvExportOptions options = shv_export_default();
    options.every = 3;
    ShvRunFile *file = record_run(file_in(*state, "run.h5"));
    check_ok(shv_export_csv(file, file_in(*state, "out"), &options, &error), error);
    char *ledger = read_bytes(file_in(*state, "out_ledger.csv"));
    int lines = 1;
    for (int frame = 0; frame < FRAMES; frame++) {
        char start[16];
        snprintf(start, sizeof start, "\n%d,", frame);
        const bool taken = frame % 3 == 0 || frame == FRAMES - 1;
        assert_int_equal(strstr(ledger, start) != NULL, taken);
        lines += taken;
    }
    assert_int_equal(count_lines(ledger), lines);
    free(ledger);
    options.every = 0;
    check_fails(shv_export_csv(file, file_in(*state, "none"), &options, &error), SHV_BAD_INPUT, error, "0 was given");
    shv_run_file_close(file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_five_tables, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_table_of_probes, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_columns_fit_their_names, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_existing_tables_are_kept, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_animation_frames_only, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_thinned, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
