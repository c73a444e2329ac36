/* What a run file calls a fragment is a piece by the bonds that it records, in every frame. */
#include "sim/stage.h"

#include <stdio.h>
#include <unistd.h>

#include "bonded_pieces.h"
#include "shiver/run_file.h"

static void record_break(const char *path)
{
    Stage stage;
    stage_make_breaking_bar(&stage);
    stage.scene.fracture.energy_bound = 0.5;
    ShvSimulation *simulation = stage_start(&stage);
    ShvRecordDefinition definition = shv_record_default();
    definition.path = path;
    definition.nodes = true;
    ShvRecord *record;
    ShvError error;
    check_ok(shv_record_create(&record, &definition, simulation, &error), error);
    while (!shv_simulation_finished(simulation)) {
        stage_next(simulation);
        check_ok(shv_record_frame(record, simulation, &error), error);
    }
    check_ok(shv_record_close(record, SHV_OK, "", &error), error);
    shv_simulation_destroy(simulation);
}

static void check_frames(ShvRunFile *file)
{
    ShvError error;
    const ShvRunFileInfo *info = shv_run_file_info(file);
    const size_t tets = (size_t)info->element_count;
    double *positions = malloc(3 * (size_t)info->node_count * sizeof *positions);
    int32_t *elements = malloc(4 * tets * sizeof *elements), *fragment = malloc(tets * sizeof *fragment);
    uint8_t *bonds = malloc(4 * tets);
    assert_true(positions && elements && fragment && bonds);
    check_ok(shv_run_file_mesh(file, positions, elements, NULL, NULL, &error), error);
    const ShvMeshView mesh = {.element_count = info->element_count, .elements = elements};
    int32_t pieces = 0;
    for (int64_t k = 0; k < info->frame_count; k++) {
        ShvProgressView progress;
        check_ok(shv_run_file_corners(file, k, NULL, NULL, fragment, &error), error);
        check_ok(shv_run_file_bonds(file, k, bonds, &error), error);
        check_ok(shv_run_file_progress(file, k, &progress, &error), error);
        pieces = check_bonded_pieces(&mesh, fragment, bonds);
        assert_int_equal(pieces, progress.alive);
        assert_int_equal(pieces, progress.pieces[0]);
    }
    assert_true(pieces > 10);
    free(positions);
    free(elements);
    free(fragment);
    free(bonds);
}

static void run_files_hold_pieces_by_bonds(void **state)
{
    (void)state;
    char path[64];
    ShvError error;
    ShvRunFile *file;
    snprintf(path, sizeof path, "pieces-%ld.h5", (long)getpid());
    record_break(path);
    check_ok(shv_run_file_open(&file, path, NULL, &error), error);
    check_frames(file);
    shv_run_file_close(file);
    assert_int_equal(unlink(path), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(run_files_hold_pieces_by_bonds)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
