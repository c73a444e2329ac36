/* Obstacles and cost of a run file. */
#include <string.h>

#include "record/hdf5_text.h"
#include "record/run_file.h"

/* ---- obstacles and cost ---- */

static ShvStatus read_names(ShvRunFile *file, const char *path, int32_t expected, char **names, size_t *size,
                            ShvError *error)
{
    int32_t count = 0;
    const ShvSilence silence = shv_silence_begin();
    ShvStatus status = shv_run_read_texts(file, path, 1, names, size, &count, error);
    shv_silence_end(silence);
    if (status == SHV_OK && count != expected) status = shv_run_fail_damaged(file, path, error);
    return status;
}

ShvStatus shv_run_obstacle_names(ShvRunFile *file, ShvError *error)
{
    if (file->obstacle_names) return SHV_OK;
    return read_names(file, "/obstacles/name", file->info.obstacle_count, &file->obstacle_names,
                      &file->obstacle_name_size, error);
}

static ShvStatus get_vectors(ShvRunFile *file, ShvSeriesName name, int64_t frame, double *values,
                             ShvObstacleView *obstacles, size_t offset, size_t components, ShvError *error)
{
    SHV_TRY(shv_run_get(file, name, frame, file->info.obstacle_count, values, error));
    for (int32_t i = 0; i < file->info.obstacle_count; i++)
        memcpy((char *)&obstacles[i] + offset, values + components * (size_t)i, components * sizeof *values);
    return SHV_OK;
}

ShvStatus shv_run_file_obstacles(ShvRunFile *file, int64_t frame, ShvObstacleView *obstacles, ShvError *error)
{
    SHV_TRY(shv_run_check_frame(file, frame, error));
    SHV_TRY(shv_run_obstacle_names(file, error));
    const size_t count = (size_t)file->info.obstacle_count;
    double *values = shv_allocate(file->memory, SHV_PART_RECORD, 4 * count, sizeof *values);
    if (!values) return shv_fail_memory(error, "obstacles", 4 * count * sizeof *values);
    for (size_t i = 0; i < count; i++) obstacles[i].name = file->obstacle_names + i * file->obstacle_name_size;
    ShvStatus status = get_vectors(file, SHV_SERIES_OBSTACLE_POSITION, frame, values, obstacles,
                                   offsetof(ShvObstacleView, position), 3, error);
    if (status == SHV_OK)
        status = get_vectors(file, SHV_SERIES_OBSTACLE_ORIENTATION, frame, values, obstacles,
                             offsetof(ShvObstacleView, orientation), 4, error);
    if (status == SHV_OK)
        status = get_vectors(file, SHV_SERIES_OBSTACLE_VELOCITY, frame, values, obstacles,
                             offsetof(ShvObstacleView, velocity), 3, error);
    if (status == SHV_OK)
        status = get_vectors(file, SHV_SERIES_OBSTACLE_ANGULAR_VELOCITY, frame, values, obstacles,
                             offsetof(ShvObstacleView, angular_velocity), 3, error);
    shv_release(values);
    return status;
}

static ShvStatus read_costs(ShvRunFile *file, int32_t count, double *seconds, int64_t *calls, ShvError *error)
{
    const int64_t last = file->info.frame_count - 1;
    size_t size;
    SHV_TRY(read_names(file, "/cost/name", count, &file->cost_names, &size, error));
    SHV_TRY(shv_run_get(file, SHV_SERIES_COST_SECONDS, last, count, seconds, error));
    SHV_TRY(shv_run_get(file, SHV_SERIES_COST_CALLS, last, count, calls, error));
    for (int32_t i = 0; i < count; i++)
        file->costs[i] = (ShvCostView){file->cost_names + (size_t)i * size, seconds[i], calls[i]};
    return SHV_OK;
}

static ShvStatus read_bytes(ShvRunFile *file, int32_t count, int64_t *bytes, int64_t *peak, ShvError *error)
{
    const int64_t last = file->info.frame_count - 1;
    size_t size;
    SHV_TRY(read_names(file, "/cost/bytes_name", count, &file->part_names, &size, error));
    SHV_TRY(shv_run_get(file, SHV_SERIES_BYTES, last, count, bytes, error));
    SHV_TRY(shv_run_get(file, SHV_SERIES_BYTES_PEAK, last, count, peak, error));
    for (int32_t i = 0; i < count; i++)
        file->parts[i] = (ShvBytesView){file->part_names + (size_t)i * size, (size_t)bytes[i], (size_t)peak[i]};
    return SHV_OK;
}

static void drop_cost(ShvRunFile *file)
{
    shv_release(file->costs);
    shv_release(file->parts);
    shv_release(file->cost_names);
    shv_release(file->part_names);
    file->costs = NULL;
    file->parts = NULL;
    file->cost_names = file->part_names = NULL;
}

static ShvStatus load_cost(ShvRunFile *file, int32_t costs, int32_t parts, ShvError *error)
{
    const size_t more = (size_t)(costs > parts ? costs : parts);
    file->costs = shv_allocate(file->memory, SHV_PART_RECORD, (size_t)costs, sizeof *file->costs);
    file->parts = shv_allocate(file->memory, SHV_PART_RECORD, (size_t)parts, sizeof *file->parts);
    double *seconds = shv_allocate(file->memory, SHV_PART_RECORD, more, sizeof *seconds);
    int64_t *numbers = shv_allocate(file->memory, SHV_PART_RECORD, 2 * more, sizeof *numbers);
    ShvStatus status =
        file->costs && file->parts && seconds && numbers ? SHV_OK : shv_fail_memory(error, "costs", 24 * more);
    if (status == SHV_OK) status = read_costs(file, costs, seconds, numbers, error);
    if (status == SHV_OK) status = read_bytes(file, parts, numbers, numbers + more, error);
    shv_release(seconds);
    shv_release(numbers);
    if (status != SHV_OK) drop_cost(file);
    return status;
}

ShvStatus shv_run_file_cost(ShvRunFile *file, const ShvCostView **costs, int32_t *cost_count,
                            const ShvBytesView **bytes, int32_t *bytes_count, ShvError *error)
{
    const int32_t names = (int32_t)file->series[SHV_SERIES_COST_SECONDS].extent[1];
    const int32_t parts = (int32_t)file->series[SHV_SERIES_BYTES].extent[1];
    if (!file->costs) SHV_TRY(load_cost(file, names, parts, error));
    *costs = file->costs;
    *cost_count = names;
    *bytes = file->parts;
    *bytes_count = parts;
    return SHV_OK;
}

ShvStatus shv_run_file_cost_at(ShvRunFile *file, int64_t frame, double *wall, double *seconds, ShvError *error)
{
    SHV_TRY(shv_run_check_frame(file, frame, error));
    SHV_TRY(shv_run_get(file, SHV_SERIES_WALL, frame, 0, wall, error));
    const int64_t parts = (int64_t)file->series[SHV_SERIES_COST_SECONDS].extent[1];
    return shv_run_get(file, SHV_SERIES_COST_SECONDS, frame, parts, seconds, error);
}
