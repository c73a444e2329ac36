/* Checksums of frames, and what of a file they tell. */
#include <zlib.h>

#include "record/record.h"

int64_t shv_frame_checksum(const uint32_t sums[SHV_SERIES_SUM], uint32_t events, uint32_t probe_times,
                           uint32_t probe_samples)
{
    uint32_t all[SHV_SERIES_SUM + 3];
    for (int i = 0; i < SHV_SERIES_SUM; i++) all[i] = sums[i];
    all[SHV_SERIES_SUM] = events;
    all[SHV_SERIES_SUM + 1] = probe_times;
    all[SHV_SERIES_SUM + 2] = probe_samples;
    unsigned char bytes[sizeof all];
    for (size_t i = 0; i < sizeof bytes; i++) bytes[i] = (unsigned char)(all[i / 4] >> 8 * (i % 4));
    return (int64_t)crc32_z(0, bytes, sizeof bytes);
}
