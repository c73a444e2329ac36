/* glTF, USD and VTK, read back: bodies are where the run file says, at every frame, to the precision of a float. */
#include "check.h"

#include <stdlib.h>

#include "base/memory.h"
#include "export/lines.h"
#include "export/run.h"
#include "files.h"
#include "shiver/export.h"

enum { FRAMES = 8, BRICKS = 4 };
/* Numbers up to 5 as floats, and a rotation by rounded numbers. */
static const double NEAR = 5.0 * 1.2e-7;

typedef ShvStatus (*Export)(ShvRunFile *file, const char *prefix, const ShvExportOptions *options, ShvError *error);

static ShvRunFile *open_run(void *folder, const char *name, bool nodes)
{
    ShvError error;
    ShvRunFile *file;
    ShvRecordDefinition definition = shv_record_default();
    definition.path = file_in(folder, name);
    definition.scene_name = "a \"b\" <c>";
    definition.nodes = nodes;
    record_frames(&definition, FRAMES);
    check_ok(shv_run_file_open(&file, definition.path, NULL, &error), error);
    return file;
}

/* Reference centre of the fragment that a line named by its first fragment ends with. */
static ShvPose pose_of(ShvRunFile *file, int32_t lineage, int64_t frame)
{
    ShvError error;
    ShvLines lines;
    ShvPose pose = {.lives = false};
    check_ok(shv_lines_create(&lines, file, NULL, NULL, &error), error);
    check_ok(shv_lines_move(&lines, frame, &error), error);
    for (int32_t line = 0; line < lines.count; line++)
        if (lines.pieces.lineage[lines.leaf[line]] == lineage) pose = shv_lines_pose(&lines, line);
    shv_lines_release(&lines);
    assert_true(pose.lives);
    return pose;
}

static void check_place(const double seen[3], ShvVec3 expected)
{
    check_near(seen[0], expected.x, NEAR);
    check_near(seen[1], expected.y, NEAR);
    check_near(seen[2], expected.z, NEAR);
}

/* ---- glTF ---- */

static uint32_t word_at(const char *bytes)
{
    uint32_t value;
    memcpy(&value, bytes, sizeof value);
    return value;
}

/* The number behind `key` in the object number `index` of a list without lists in it. */
static long number_in(const char *json, const char *list, int index, const char *key)
{
    const char *at = strstr(json, list);
    assert_non_null(at);
    for (int i = 0; i <= index; i++) at = strchr(at + 1, '{');
    const char *found = strstr(at, key), *end = strchr(at, '}');
    assert_true(found && found < end);
    return strtol(found + strlen(key), NULL, 10);
}

/* The floats that the channel `path` of a node goes through. */
static const char *track_of(const char *json, const char *numbers, int node, const char *path)
{
    char target[64];
    snprintf(target, sizeof target, "\"node\":%d,\"path\":\"%s\"", node, path);
    const char *channel = strstr(json, target);
    assert_non_null(channel);
    while (strncmp(channel, "\"sampler\":", 10) != 0) channel--;
    const int sampler = (int)strtol(channel + 10, NULL, 10);
    const int accessor = (int)number_in(json, "\"samplers\":[", sampler, "\"output\":");
    assert_int_equal(number_in(json, "\"accessors\":[", accessor, "\"count\":"), FRAMES);
    const int view = (int)number_in(json, "\"accessors\":[", accessor, "\"bufferView\":");
    return numbers + number_in(json, "\"bufferViews\":[", view, "\"byteOffset\":");
}

static void read_floats(const char *bytes, int count, double *values)
{
    for (int i = 0; i < count; i++) {
        float value;
        memcpy(&value, bytes + 4 * i, sizeof value);
        values[i] = (double)value;
    }
}

static void test_gltf(void **state)
{
    static const int32_t lineages[BRICKS] = {0, 2, 4, 6}; /* as in the test of drawings */
    ShvError error;
    ShvRunFile *file = open_run(*state, "run.h5", false);
    const char *path = file_in(*state, "a.glb");
    check_ok(shv_export_gltf(file, file_in(*state, "a"), NULL, &error), error);
    char *bytes = read_bytes(path);
    const long size = file_size(path);
    assert_int_equal(word_at(bytes), 0x46546c67);
    assert_int_equal(word_at(bytes + 8), size);
    const uint32_t length = word_at(bytes + 12);
    char *json = calloc(length + 1, 1);
    memcpy(json, bytes + 20, length);
    const char *numbers = bytes + 20 + length + 8;
    assert_int_equal(number_in(json, "\"buffers\":[", 0, "\"byteLength\":"), size - 20 - (long)length - 8);
    for (int i = 0; i < BRICKS; i++) {
        char name[64];
        int node = 0;
        snprintf(name, sizeof name, "\"name\":\"line_%d\"", (int)lineages[i]);
        const char *end = strstr(json, name);
        assert_non_null(end);
        for (const char *at = strstr(json, "\"name\":\"z_up\""); at < end; at = strstr(at + 1, "\"name\":\"")) node++;
        const char *places = track_of(json, numbers, node, "translation"),
                   *turns = track_of(json, numbers, node, "rotation");
        for (int64_t frame = 0; frame < FRAMES; frame++) {
            double place[3], turn[4];
            const ShvPose pose = pose_of(file, lineages[i], frame);
            read_floats(places + 12 * frame, 3, place);
            read_floats(turns + 16 * frame, 4, turn);
            check_place(place, pose.position);
            const double same = turn[0] * pose.orientation.x + turn[1] * pose.orientation.y +
                                turn[2] * pose.orientation.z + turn[3] * pose.orientation.w;
            check_near(fabs(same), 1.0, 5e-7);
        }
    }
    assert_non_null(strstr(json, "\"obstacle\":\"hammer\""));
    free(json);
    free(bytes);
    shv_run_file_close(file);
}

/* ---- USD ---- */

static void test_usd(void **state)
{
    ShvError error;
    ShvRunFile *file = open_run(*state, "run.h5", false);
    check_ok(shv_export_usd(file, file_in(*state, "a"), NULL, &error), error);
    char *text = read_bytes(file_in(*state, "a.usda"));
    assert_int_equal(strncmp(text, "#usda 1.0\n", 10), 0);
    assert_non_null(strstr(text, "doc = \"a \\\"b\\\" <c>\""));
    assert_non_null(strstr(text, "upAxis = \"Z\""));
    assert_non_null(strstr(text, "timeCodesPerSecond = 120\n")); /* every other frame of 240 a second is on the grid */
    const char *line = strstr(text, "def Xform \"line_2\"");
    const char *at = strchr(strstr(line, "xformOp:translate.timeSamples"), '\n');
    for (int64_t frame = 0; frame < FRAMES; frame++, at = strchr(at + 1, '\n')) {
        double code, place[3];
        assert_int_equal(sscanf(at, " %lf: (%lf, %lf, %lf)", &code, &place[0], &place[1], &place[2]), 4);
        check_near(code, 0.5 * (double)frame, 1e-12);
        check_place(place, pose_of(file, 2, frame).position);
    }
    at = strchr(strstr(line, "xformOp:orient.timeSamples"), '\n');
    double code, w;
    assert_int_equal(sscanf(at, " %lf: (%lf,", &code, &w), 2);
    check_near(w, pose_of(file, 2, 0).orientation.w, NEAR);
    free(text);
    shv_run_file_close(file);
}

/* ---- VTK ---- */

static void check_grid(ShvRunFile *file, const char *path, int64_t frame, bool nodes)
{
    ShvError error;
    ShvPieces pieces;
    char *bytes = read_bytes(path);
    assert_non_null(strstr(bytes, "NumberOfPoints=\"20\" NumberOfCells=\"8\""));
    assert_int_equal(strstr(bytes, "Name=\"damage\"") != NULL, nodes);
    const char *raw = strstr(bytes, "<AppendedData encoding=\"raw\">\n_") + 31;
    const char *vertices = raw + 8 + 20 * 3 * 4; /* the two tets of a brick share three of their corners */
    assert_int_equal(word_at(raw), 20 * 3 * 4);
    assert_int_equal(word_at(vertices), 32 * 4);
    check_ok(shv_pieces_create(&pieces, file, NULL, &error), error);
    check_ok(shv_pieces_move(&pieces, frame, &error), error);
    for (int i = 0; i < 32; i++) {
        double point[3];
        const ShvVec3 rest = shv_load3(pieces.reference + 3 * pieces.elements[i]);
        const double time = shv_run_file_times(file)[frame]; /* recorded corners: the reference, moved by the time */
        read_floats(raw + 8 + 12 * word_at(vertices + 8 + 4 * i), 3, point);
        check_place(point, nodes ? shv_add(rest, shv_vec3(time, time, time))
                                 : shv_pieces_point(&pieces, pieces.owner[i / 4], pieces.elements[i]));
    }
    shv_pieces_release(&pieces);
    free(bytes);
}

static void test_vtk(void **state)
{
    for (int nodes = 0; nodes < 2; nodes++) {
        ShvError error;
        ShvRunFile *file = open_run(*state, nodes ? "deformed.h5" : "run.h5", nodes);
        ShvExportOptions options = shv_export_default();
        const ShvElasticity elasticity = {70e9, 0.2};
        options.force = true;
        options.elasticity = &elasticity;
        check_ok(shv_export_vtk(file, file_in(*state, "a"), &options, &error), error);
        check_grid(file, file_in(*state, "a_000000.vtu"), 0, nodes);
        check_grid(file, file_in(*state, "a_000003.vtu"), 3, nodes);
        check_grid(file, file_in(*state, "a_000007.vtu"), 7, nodes);
        char *collection = read_bytes(file_in(*state, "a.pvd"));
        assert_non_null(strstr(collection, "timestep=\"0.029166666666666667\" part=\"0\" file=\"a_000007.vtu\""));
        assert_non_null(strstr(collection, "part=\"1\" file=\"a_obstacles_000007.vtu\""));
        free(collection);
        shv_run_file_close(file);
    }
}

/* ---- all ---- */

static void test_same_bytes_and_kept_files(void **state)
{
    static const Export exports[] = {shv_export_gltf, shv_export_usd, shv_export_vtk};
    static const char *const names[] = {"a.glb", "a.usda", "a_000004.vtu"};
    ShvError error;
    ShvRunFile *file = open_run(*state, "run.h5", true);
    for (int i = 0; i < 3; i++) {
        ShvExportOptions options = shv_export_default();
        check_ok(exports[i](file, file_in(*state, "a"), &options, &error), error);
        const long size = file_size(file_in(*state, names[i]));
        char *one = read_bytes(file_in(*state, names[i]));
        check_fails(exports[i](file, file_in(*state, "a"), &options, &error), SHV_BAD_INPUT, error, "--force");
        options.force = true;
        check_ok(exports[i](file, file_in(*state, "a"), &options, &error), error);
        char *two = read_bytes(file_in(*state, names[i]));
        assert_int_equal(file_size(file_in(*state, names[i])), size);
        assert_memory_equal(one, two, (size_t)size);
        free(one);
        free(two);
    }
    shv_run_file_close(file);
}

/* Whichever allocation fails, the status says so, all memory is given back, and nothing of the export is left. */
static void test_every_allocation_may_fail(void **state)
{
    static const Export exports[] = {shv_export_csv, shv_export_xdmf, shv_export_vtk, shv_export_gltf, shv_export_usd};
    ShvError error;
    ShvRunFile *file = open_run(*state, "run.h5", true);
    for (int i = 0; i < 5; i++) {
        ShvStatus status = SHV_NO_MEMORY;
        const int before = files_in(*state);
        for (int64_t count = 0; status != SHV_OK; count++) {
            ShvExportOptions options = shv_export_default();
            options.memory = shv_memory_create();
            options.force = true;
            shv_memory_fail_after(options.memory, count);
            status = exports[i](file, file_in(*state, "out"), &options, &error);
            assert_true(status == SHV_OK ? count > 8 : status == SHV_NO_MEMORY && files_in(*state) == before);
            assert_int_equal(shv_memory_bytes(options.memory, SHV_PART_COUNT), 0);
            shv_memory_destroy(options.memory);
        }
    }
    /* The run; six tables, four files for XDMF, the grids and their collection, one, one. */
    assert_int_equal(files_in(*state), 1 + 6 + 4 + 2 * FRAMES + 1 + 1 + 1);
    shv_run_file_close(file);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_gltf, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_usd, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_vtk, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_same_bytes_and_kept_files, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_every_allocation_may_fail, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
