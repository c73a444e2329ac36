/* Every reference of the XML leads to a data set of the stated shape, and the points are where the fragments were. */
#include "check.h"

#include <hdf5.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/vector.h"
#include "export/run.h"
#include "files.h"
#include "shiver/export.h"

enum { FRAMES = 8, ELEMENTS = 8 };

static void export_run(void *folder, bool nodes, bool animation)
{
    ShvError error;
    ShvRunFile *file;
    ShvRecordDefinition definition = shv_record_default();
    definition.path = file_in(folder, "run.h5");
    definition.nodes = nodes;
    record_frames(&definition, FRAMES);
    check_ok(shv_run_file_open(&file, file_in(folder, "run.h5"), NULL, &error), error);
    ShvExportOptions options = shv_export_default();
    options.animation = animation;
    check_ok(shv_export_xdmf(file, file_in(folder, "a&b"), &options, &error), error);
    check_fails(shv_export_xdmf(file, file_in(folder, "a&b"), &options, &error), SHV_BAD_INPUT, error, "--force");
    shv_run_file_close(file);
}

/* Follows all references; returns their number. */
static int check_references(const void *folder, const char *name)
{
    char *xml = read_bytes(file_in(folder, name));
    const hid_t file = H5Fopen(file_in(folder, "a&b_xdmf.h5"), H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    int count = 0;
    for (const char *item = strstr(xml, "<DataItem"); item; item = strstr(item + 1, "<DataItem"), count++) {
        static const char reference[] = "\">a&amp;b_xdmf.h5:";
        char path[128];
        hsize_t extent[2] = {0, 0};
        long rows = 0, columns = 0;
        const char *dimensions = strstr(item, "Dimensions=\"") + 12, *begin = strstr(item, reference);
        assert_non_null(begin);
        const int given = sscanf(dimensions, "%ld %ld", &rows, &columns);
        begin += sizeof reference - 1;
        snprintf(path, sizeof path, "%.*s", (int)strcspn(begin, "<"), begin);
        const hid_t dataset = H5Dopen2(file, path, H5P_DEFAULT), space = H5Dget_space(dataset);
        assert_int_equal(H5Sget_simple_extent_dims(space, extent, NULL), given);
        assert_int_equal(extent[0], rows);
        assert_int_equal(extent[1], columns);
        H5Sclose(space);
        H5Dclose(dataset);
    }
    H5Fclose(file);
    free(xml);
    return count;
}

static int count_text(const void *folder, const char *name, const char *text)
{
    char *xml = read_bytes(file_in(folder, name));
    int count = 0;
    for (const char *at = strstr(xml, text); at; at = strstr(at + 1, text)) count++;
    free(xml);
    return count;
}

static void read_array(const void *folder, const char *path, hid_t type, void *data)
{
    const hid_t file = H5Fopen(file_in(folder, "a&b_xdmf.h5"), H5F_ACC_RDONLY, H5P_DEFAULT);
    const hid_t dataset = H5Dopen2(file, path, H5P_DEFAULT);
    assert_true(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0);
    H5Dclose(dataset);
    H5Fclose(file);
}

static void test_references(void **state)
{
    export_run(*state, false, false);
    assert_int_equal(files_in(*state), 5);
    assert_int_equal(check_references(*state, "a&b_fragments.xmf"), FRAMES * 9);
    assert_int_equal(check_references(*state, "a&b_mesh.xmf"), FRAMES * 4);
    assert_int_equal(check_references(*state, "a&b_obstacles.xmf"), FRAMES * 3);
    assert_int_equal(count_text(*state, "a&b_mesh.xmf", "<Time Value="), FRAMES);
    assert_int_equal(count_text(*state, "a&b_fragments.xmf", "\"Matrix\""), FRAMES);
}

/* Only the living are points. */
static void test_living_fragments(void **state)
{
    export_run(*state, false, false);
    ShvSimulation *again = fake_create(&BREAKING);
    for (int i = 0; i < FRAMES; i++) {
        char path[64];
        int32_t id[7];
        double position[21];
        fake_advance(again);
        const ShvFrameView *frame = shv_simulation_frame(again);
        snprintf(path, sizeof path, "/fragments/fragment_%06d", i);
        read_array(*state, path, H5T_NATIVE_INT32, id);
        snprintf(path, sizeof path, "/fragments/position_%06d", i);
        read_array(*state, path, H5T_NATIVE_DOUBLE, position);
        for (int32_t k = 0; k < frame->alive_count; k++) {
            assert_true(frame->fragments[id[k]].mode != SHV_FRAGMENT_DEAD);
            assert_memory_equal(position + 3 * k, frame->fragments[id[k]].position, 24);
        }
    }
    fake_destroy(again);
}

/* Corner by corner: the reference corner carried by the fragment that owned the tet at that frame. */
static void check_corners(const ShvSimulation *simulation, const int32_t *cells, const int32_t *shown,
                          const double *points)
{
    int32_t owner[ELEMENTS];
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    shv_simulation_element_state(simulation, owner, NULL);
    assert_memory_equal(shown, owner, sizeof owner);
    for (int32_t c = 0; c < 4 * ELEMENTS; c++) {
        const ShvFragmentView *fragment = &shv_simulation_frame(simulation)->fragments[owner[c / 4]];
        const double *q = fragment->orientation;
        const ShvVec3 arm =
            shv_sub(shv_load3(mesh.positions + 3 * mesh.elements[c]), shv_load3(fragment->reference_centre));
        const ShvVec3 turned = shv_rotate((ShvQuat){q[0], q[1], q[2], q[3]}, arm);
        const double expected[3] = {turned.x + fragment->position[0], turned.y + fragment->position[1],
                                    turned.z + fragment->position[2]};
        /* Single precision: half a unit in the last place of numbers below 8. */
        for (int k = 0; k < 3; k++) check_near(points[3 * cells[c] + k], expected[k], 4.0 * 1.2e-7);
    }
}

static void test_mesh_moves_with_the_ancestors(void **state)
{
    export_run(*state, false, false);
    int32_t cells[4 * ELEMENTS], shown[ELEMENTS];
    double points[12 * ELEMENTS];
    read_array(*state, "/mesh/cells", H5T_NATIVE_INT32, cells);
    ShvSimulation *again = fake_create(&BREAKING);
    int last = 0;
    for (int i = 0; i < FRAMES; i++) {
        char path[64];
        fake_advance(again);
        if (shv_simulation_frame(again)->event_count > 0) last = i; /* owners are written where they change */
        snprintf(path, sizeof path, "/mesh/fragment_%06d", last);
        read_array(*state, path, H5T_NATIVE_INT32, shown);
        snprintf(path, sizeof path, "/mesh/points_%06d", i);
        read_array(*state, path, H5T_NATIVE_DOUBLE, points);
        check_corners(again, cells, shown, points);
    }
    fake_destroy(again);
}

static void test_recorded_nodes(void **state)
{
    export_run(*state, true, true);
    assert_int_equal(check_references(*state, "a&b_mesh.xmf"), FRAMES / 2 * 5);
    ShvSimulation *again = fake_create(&BREAKING);
    for (int i = 0; i < 3; i++) fake_advance(again);
    double corners[12 * ELEMENTS], points[12 * ELEMENTS], damage[ELEMENTS];
    shv_simulation_corner_positions(again, corners);
    read_array(*state, "/mesh/points_000002", H5T_NATIVE_DOUBLE, points);
    read_array(*state, "/mesh/damage_000002", H5T_NATIVE_DOUBLE, damage);
    for (int i = 0; i < 12 * ELEMENTS; i++)
        check_near(points[i], corners[i], 4.0 * 1.2e-7); /* single precision below 8 */
    for (int e = 0; e < ELEMENTS; e++) assert_true(damage[e] == 0.75);
    fake_destroy(again);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_references, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_living_fragments, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_mesh_moves_with_the_ancestors, make_folder, remove_folder),
        cmocka_unit_test_setup_teardown(test_recorded_nodes, make_folder, remove_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
