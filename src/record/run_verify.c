/* Whether a run file is whole. */
#include <string.h>
#include <zlib.h>

#include "record/hdf5_text.h"
#include "record/record.h"
#include "record/run_file.h"
#include "record/types.h"

/* What the frame before leaves off with, and what this one says. */
typedef struct Frames {
    ShvFrameSum before, sum;
} Frames;

static bool sum_rows(const ShvRunFile *file, ShvSeriesName name, int64_t begin, int64_t end, uint32_t *sum)
{
    *sum = 0;
    return end == begin || (end > begin && file->series[name].dataset >= 0 &&
                            shv_series_sum(&file->series[name], begin, end - begin, file->info.probe_count, sum));
}

static int64_t columns_of(const ShvSeries *series, const Frames *frames)
{
    return series->width == SHV_WIDTH_FRAGMENT ? frames->sum.fragments : (int64_t)series->extent[1];
}

static bool frame_agrees(const ShvRunFile *file, int64_t frame, const Frames *frames)
{
    uint32_t sums[SHV_SERIES_SUM] = {0}, events, times, samples;
    for (int i = 0; i < SHV_SERIES_SUM; i++) {
        const ShvSeries *series = &file->series[i];
        if (series->dataset < 0) continue;
        if (!shv_series_sum(series, frame, 1, columns_of(series, frames), &sums[i])) return false;
        if (shv_series_of_cost((ShvSeriesName)i)) sums[i] = 0;
    }
    return sum_rows(file, SHV_SERIES_EVENTS, frames->before.events, frames->sum.events, &events) &&
           sum_rows(file, SHV_SERIES_PROBE_TIME, frames->before.probe_rows, frames->sum.probe_rows, &times) &&
           sum_rows(file, SHV_SERIES_PROBE_SAMPLES, frames->before.probe_rows, frames->sum.probe_rows, &samples) &&
           shv_frame_checksum(sums, events, times, samples) == frames->sum.checksum;
}

static ShvStatus fail_frame(const ShvRunFile *file, int64_t frame, ShvError *error)
{
    if (shv_memory_missed()) return shv_fail(error, SHV_NO_MEMORY, "out of memory for a frame of '%s'", file->path);
    return shv_fail(error, SHV_BAD_INPUT, "'%s' is damaged: frame %lld of %lld does not agree with its checksum",
                    file->path, (long long)frame, (long long)file->info.frame_count);
}

static ShvStatus verify_frames(const ShvRunFile *file, ShvError *error)
{
    Frames frames = {{0, 0, 0, 0}, {0, 0, 0, 0}};
    for (int64_t i = 0; i < file->info.frame_count; i++) {
        const bool told = shv_series_read(&file->series[SHV_SERIES_SUM], i, 1, 0, &frames.sum);
        if (!told || !frame_agrees(file, i, &frames)) return fail_frame(file, i, error);
        frames.before = frames.sum;
    }
    if (frames.sum.fragments == file->info.fragment_count && frames.sum.events == file->info.event_count &&
        frames.sum.probe_rows == file->info.probe_row_count)
        return SHV_OK;
    return shv_run_fail_damaged(file, "as many fragments, events and samples as its last frame has", error);
}

static ShvStatus verify_lengths(const ShvRunFile *file, ShvError *error)
{
    for (int i = 0; i < SHV_SERIES_FRAMES; i++)
        if (file->series[i].dataset >= 0 && file->series[i].extent[0] != (hsize_t)file->info.frame_count)
            return shv_fail(error, SHV_BAD_INPUT, "'%s' is damaged: %s has %lld entries for %lld frames", file->path,
                            shv_series_path((ShvSeriesName)i), (long long)file->series[i].extent[0],
                            (long long)file->info.frame_count);
    return SHV_OK;
}

static ShvStatus verify_text(const ShvRunFile *file, const char *path, const char *text, ShvError *error)
{
    int64_t sum = -1;
    const hid_t dataset = H5Dopen2(file->file, path, H5P_DEFAULT);
    const bool good = dataset >= 0 &&
                      shv_attribute_get_number(dataset, "checksum", H5T_NATIVE_INT64, H5T_INTEGER, &sum) &&
                      sum == (int64_t)crc32_z(0, (const unsigned char *)text, strlen(text) + 1);
    if (dataset >= 0) H5Dclose(dataset);
    return good ? SHV_OK : shv_run_fail_damaged(file, path, error);
}

/* Each living fragment has as many tets as the owners say. */
static ShvStatus verify_owners(const ShvRunFile *file, const ShvFragmentView *fragments, int32_t *tets,
                               const int32_t *owner, ShvError *error)
{
    for (int32_t e = 0; e < file->info.element_count; e++) tets[owner[e]]++;
    for (int32_t i = 0; i < file->info.fragment_count; i++)
        if (tets[i] != (fragments[i].mode == SHV_FRAGMENT_DEAD ? 0 : fragments[i].tets))
            return shv_run_fail_damaged(file, "/fragments/elements", error);
    return SHV_OK;
}

static ShvStatus verify_mesh(ShvRunFile *file, ShvError *error)
{
    const size_t fragments = (size_t)file->info.fragment_count, elements = (size_t)file->info.element_count;
    const size_t nodes = (size_t)file->info.node_count;
    ShvFragmentView *list = shv_allocate(file->memory, SHV_PART_RECORD, fragments, sizeof *list);
    int32_t *numbers = shv_allocate(file->memory, SHV_PART_RECORD, 5 * elements + fragments, sizeof *numbers);
    double *positions = shv_allocate(file->memory, SHV_PART_RECORD, 3 * nodes, sizeof *positions);
    ShvStatus status = list && numbers && positions
                           ? SHV_OK
                           : shv_fail_memory(error, "the mesh", 20 * elements + 24 * nodes + 300 * fragments);
    if (status == SHV_OK) status = shv_run_file_mesh(file, positions, numbers + elements, NULL, numbers, error);
    if (status == SHV_OK) status = shv_run_file_fragments(file, list, error);
    if (status == SHV_OK) status = verify_owners(file, list, numbers + 5 * elements, numbers, error);
    shv_release(list);
    shv_release(numbers);
    shv_release(positions);
    return status;
}

ShvStatus shv_run_file_checksum(ShvRunFile *file, uint32_t *checksum, ShvError *error)
{
    *checksum = 0;
    const ShvSilence silence = shv_silence_begin();
    const bool good = shv_series_sum(&file->series[SHV_SERIES_SUM], 0, file->info.frame_count, 0, checksum);
    shv_silence_end(silence);
    return good ? SHV_OK : shv_run_fail_damaged(file, "/frames", error);
}

ShvStatus shv_run_file_verify(ShvRunFile *file, ShvError *error)
{
    const ShvSilence silence = shv_silence_begin();
    ShvStatus status = verify_lengths(file, error);
    if (status == SHV_OK) status = verify_text(file, "/scene/text", file->scene_text, error);
    if (status == SHV_OK) status = verify_text(file, "/scene/overrides", file->overrides, error);
    if (status == SHV_OK) status = verify_mesh(file, error);
    ShvObstacleBody body;
    for (int32_t i = 0; status == SHV_OK && i < file->info.obstacle_count; i++)
        status = shv_run_file_obstacle(file, i, &body, error);
    if (status == SHV_OK) status = verify_frames(file, error);
    shv_silence_end(silence);
    return status;
}
