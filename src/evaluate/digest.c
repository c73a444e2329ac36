#include "evaluate/digest.h"

#include <stdlib.h>

void shv_digest_release(ShvDigest *digest)
{
    shv_release(digest->seconds);
    shv_release(digest->masses);
    shv_release(digest->times);
    shv_release(digest->states);
    shv_crack_surface_release(&digest->crack);
    *digest = (ShvDigest){.memory = NULL};
}

static int compare_doubles(const void *first, const void *second)
{
    const double a = *(const double *)first, b = *(const double *)second;
    return (a > b) - (a < b);
}

void shv_sort_numbers(double *values, int32_t count)
{
    if (count > 1) qsort(values, (size_t)count, sizeof *values, compare_doubles);
}

double shv_median(double *values, int32_t count)
{
    int32_t finite = 0;
    for (int32_t i = 0; i < count; i++)
        if (isfinite(values[i])) values[finite++] = values[i];
    if (finite == 0) return (double)NAN;
    shv_sort_numbers(values, finite);
    return finite % 2 ? values[finite / 2] : 0.5 * (values[finite / 2 - 1] + values[finite / 2]);
}

double shv_digest_seconds(const ShvDigest *digest)
{
    enum { MOST = 64 };
    double copy[MOST];
    const int32_t count = digest->repeats < MOST ? digest->repeats : MOST;
    for (int32_t i = 0; i < count; i++) copy[i] = digest->seconds[i];
    return shv_median(copy, count);
}

ShvStatus shv_digest_reserve(ShvDigest *digest, size_t room, size_t bodies, ShvError *error)
{
    double *times = shv_reallocate(digest->memory, SHV_PART_RECORD, digest->times, room, sizeof *times);
    if (!times) return shv_fail_memory(error, "the way of bodies", room * sizeof *times);
    digest->times = times;
    ShvBodyState *states =
        shv_reallocate(digest->memory, SHV_PART_RECORD, digest->states, room * bodies, sizeof *states);
    if (!states) return shv_fail_memory(error, "the way of bodies", room * bodies * sizeof *states);
    digest->states = states;
    digest->frame_capacity = (int32_t)room;
    return SHV_OK;
}

ShvStatus shv_digest_track(ShvDigest *digest, const ShvBodies *bodies, const ShvFrameView *frame, ShvError *error)
{
    const size_t count = (size_t)bodies->count;
    digest->body_count = bodies->count;
    if (digest->frame_count == digest->frame_capacity)
        SHV_TRY(shv_digest_reserve(digest, 2 * (size_t)digest->frame_capacity + 64, count, error));
    const size_t index = (size_t)digest->frame_count++;
    digest->times[index] = frame->time;
    for (size_t i = 0; i < count; i++) digest->states[index * count + i] = shv_body_state(&bodies->items[i], frame);
    return SHV_OK;
}
