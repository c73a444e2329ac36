/* Which frames a drawing shows. */
#include "base/memory.h"
#include "export/svg.h"

enum { PANELS = 4, MOST_PANELS = 24 };

static int64_t nearest_frame(const double *times, int64_t count, double time)
{
    int64_t best = 0;
    for (int64_t i = 1; i < count; i++)
        if (fabs(times[i] - time) < fabs(times[best] - time)) best = i;
    return best;
}

static ShvStatus take_frames(const ShvSvgOptions *options, int64_t frame_count, int64_t *frames, ShvError *error)
{
    for (int32_t i = 0; i < options->frame_count; i++) {
        frames[i] = options->frames[i];
        if (frames[i] < 0 || frames[i] >= frame_count)
            return shv_fail(error, SHV_BAD_INPUT, "there is no frame %lld: the run has frames 0 to %lld",
                            (long long)frames[i], (long long)(frame_count - 1));
    }
    return SHV_OK;
}

static ShvStatus take_times(const ShvSvgOptions *options, const ShvRunFile *file, int64_t *frames, ShvError *error)
{
    const ShvRunFileInfo *info = shv_run_file_info(file);
    for (int32_t i = 0; i < options->time_count; i++) {
        const double time = options->times[i];
        if (!(time >= info->first_time && time <= info->last_time))
            return shv_fail(error, SHV_BAD_INPUT, "there is no time %g s: the run goes from %g to %g s", time,
                            info->first_time, info->last_time);
        frames[i] = nearest_frame(shv_run_file_times(file), info->frame_count, time);
    }
    return SHV_OK;
}

/* Evenly over the time of the run, first and last included, each frame once. */
static int32_t spread(const ShvRunFile *file, int64_t *frames)
{
    const ShvRunFileInfo *info = shv_run_file_info(file);
    int32_t count = 0;
    for (int i = 0; i < PANELS; i++) {
        const double time = info->first_time + (info->last_time - info->first_time) * i / (PANELS - 1);
        const int64_t frame = nearest_frame(shv_run_file_times(file), info->frame_count, time);
        if (count == 0 || frames[count - 1] != frame) frames[count++] = frame;
    }
    return count;
}

ShvStatus shv_svg_frames(const ShvSvgOptions *options, const ShvRunFile *file, int64_t **frames, int32_t *count,
                         ShvError *error)
{
    const int64_t frame_count = shv_run_file_info(file)->frame_count;
    *frames = NULL;
    *count = options->frame_count + options->time_count;
    if (frame_count < 1) return shv_fail(error, SHV_BAD_INPUT, "the run has no frame to draw");
    if (options->frame_count < 0 || options->time_count < 0 || (options->frame_count > 0 && options->time_count > 0))
        return shv_fail(error, SHV_BAD_INPUT, "give either frames or times to draw");
    if (*count > MOST_PANELS)
        return shv_fail(error, SHV_BAD_INPUT, "a drawing shows at most %d frames; %d were given", (int)MOST_PANELS,
                        (int)*count);
    *frames = shv_allocate(options->memory, SHV_PART_RECORD, (size_t)(*count > 0 ? *count : PANELS), sizeof **frames);
    if (!*frames) return shv_fail_memory(error, "a list of frames", (size_t)*count * sizeof **frames);
    if (options->frame_count > 0) return take_frames(options, frame_count, *frames, error);
    if (options->time_count > 0) return take_times(options, file, *frames, error);
    *count = spread(file, *frames);
    return SHV_OK;
}
