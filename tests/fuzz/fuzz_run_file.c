/* Opens a run file and reads all of it. */
#include "fuzz.h"

#include "shiver/run_file.h"

static void read_frame(ShvRunFile *file, int64_t frame)
{
    ShvError error;
    const ShvRunFileInfo *info = shv_run_file_info(file);
    const size_t fragments = (size_t)info->fragment_count, elements = (size_t)info->element_count;
    double *values = calloc(3 * fragments + 12 * elements + 1, sizeof *values);
    uint8_t *bytes = calloc(fragments + 4 * elements + 1, 1);
    ShvLedgerView ledger;
    ShvProgressView progress;
    if (values && bytes) {
        (void)shv_run_file_frame(file, frame, NULL, NULL, bytes, values, NULL, NULL, NULL, &error);
        (void)shv_run_file_corners(file, frame, values, NULL, NULL, &error);
        (void)shv_run_file_bonds(file, frame, bytes, &error);
    }
    (void)shv_run_file_ledger(file, frame, &ledger, &error);
    (void)shv_run_file_progress(file, frame, &progress, &error);
    free(values);
    free(bytes);
}

static void read_rest(ShvRunFile *file)
{
    ShvError error;
    ShvEventView event;
    uint32_t checksum;
    const ShvRunFileInfo *info = shv_run_file_info(file);
    if (info->event_count > 0) (void)shv_run_file_event(file, info->event_count - 1, &event, &error);
    if (info->fragment_count > 0 && info->fragment_count < 1 << 20) {
        ShvFragmentView *fragments = calloc((size_t)info->fragment_count, sizeof *fragments);
        if (fragments) (void)shv_run_file_fragments(file, fragments, &error);
        free(fragments);
    }
    for (int32_t i = 0; i < info->obstacle_count && i < 4; i++) {
        ShvObstacleBody body;
        (void)shv_run_file_obstacle(file, i, &body, &error);
    }
    (void)shv_run_file_checksum(file, &checksum, &error);
    (void)shv_run_file_verify(file, &error);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    ShvRunFile *file;
    ShvError error = {SHV_OK, ""};
    const char *path = fuzz_path(".h5");
    fuzz_write(path, data, size);
    const ShvStatus status = shv_run_file_open(&file, path, NULL, &error);
    fuzz_judge(status, &error);
    if (status == SHV_OK) {
        const int64_t count = shv_run_file_info(file)->frame_count;
        for (int64_t i = 0; i < count && i < 3; i++) read_frame(file, i);
        read_rest(file);
        shv_run_file_close(file);
    }
    unlink(path);
    return 0;
}
