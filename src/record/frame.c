/* One frame of a record. */
#include <math.h>
#include <string.h>

#include "base/timer.h"
#include "record/hdf5_array.h"
#include "record/record.h"
#include "record/types.h"

/* ---- room ---- */

static ShvStatus make_values(ShvRecord *record, size_t count, ShvError *error)
{
    if (count <= record->value_capacity) return SHV_OK;
    double *grown = shv_reallocate(record->memory, SHV_PART_RECORD, record->values, count, sizeof *grown);
    if (!grown) return shv_fail_memory(error, "a frame of the run file", count * sizeof *grown);
    record->values = grown;
    record->value_capacity = count;
    return SHV_OK;
}

static size_t most(size_t a, size_t b)
{
    return a > b ? a : b;
}

static ShvStatus make_room(ShvRecord *record, const ShvFrameView *frame, ShvError *error)
{
    size_t values = 4 * most((size_t)frame->fragment_count, (size_t)frame->obstacle_count);
    values = most(values, most((size_t)frame->cost_count, (size_t)frame->bytes_count));
    if (record->nodes) values = most(values, 4 * (size_t)record->element_count);
    SHV_TRY(make_values(record, values, error));
    if (frame->fragment_count <= record->fragment_capacity) return SHV_OK;
    const size_t capacity = 2 * (size_t)frame->fragment_count;
    ShvFragmentView *grown =
        shv_reallocate(record->memory, SHV_PART_RECORD, record->fragments, capacity, sizeof *grown);
    if (!grown) return shv_fail_memory(error, "fragments of the run file", capacity * sizeof *grown);
    record->fragments = grown;
    int32_t **const lists[] = {&record->lines.lineage, &record->lines.first_element, &record->lines.heir};
    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++) {
        int32_t *list = shv_reallocate(record->memory, SHV_PART_RECORD, *lists[i], capacity, sizeof *list);
        if (!list) return shv_fail_memory(error, "fragments of the run file", capacity * sizeof *list);
        *lists[i] = list;
    }
    record->fragment_capacity = (int32_t)capacity;
    return SHV_OK;
}

/* ---- series ---- */

static bool put(ShvRecord *record, ShvSeriesName name, int64_t columns, const void *data)
{
    uint32_t *sum = shv_series_of_cost(name) ? NULL : &record->sums[name];
    return shv_series_write(&record->series[name], record->frames, 1, columns, data, sum);
}

/* One vector of every fragment: NaN for the dead. */
static bool put_fragments(ShvRecord *record, const ShvFrameView *frame, ShvSeriesName name, size_t offset,
                          int components)
{
    double *values = record->values;
    for (int32_t i = 0; i < frame->fragment_count; i++) {
        const ShvFragmentView *fragment = &frame->fragments[i];
        double *value = values + components * (int64_t)i;
        if (fragment->mode == SHV_FRAGMENT_DEAD)
            for (int k = 0; k < components; k++) value[k] = (double)NAN;
        else
            memcpy(value, (const char *)fragment + offset, (size_t)components * sizeof *value);
    }
    return put(record, name, frame->fragment_count, values);
}

static bool put_alive(ShvRecord *record, const ShvFrameView *frame)
{
    uint8_t *alive = (uint8_t *)record->values;
    for (int32_t i = 0; i < frame->fragment_count; i++) alive[i] = frame->fragments[i].mode != SHV_FRAGMENT_DEAD;
    return put(record, SHV_SERIES_ALIVE, frame->fragment_count, alive);
}

static bool put_obstacles(ShvRecord *record, const ShvFrameView *frame, ShvSeriesName name, size_t offset,
                          int components)
{
    for (int32_t i = 0; i < frame->obstacle_count; i++)
        memcpy(record->values + components * (int64_t)i, (const char *)&frame->obstacles[i] + offset,
               (size_t)components * sizeof(double));
    return put(record, name, frame->obstacle_count, record->values);
}

static bool put_motion(ShvRecord *record, const ShvFrameView *frame)
{
    return put_fragments(record, frame, SHV_SERIES_POSITION, offsetof(ShvFragmentView, position), 3) &&
           put_fragments(record, frame, SHV_SERIES_ORIENTATION, offsetof(ShvFragmentView, orientation), 4) &&
           put_fragments(record, frame, SHV_SERIES_VELOCITY, offsetof(ShvFragmentView, velocity), 3) &&
           put_fragments(record, frame, SHV_SERIES_ANGULAR_VELOCITY, offsetof(ShvFragmentView, angular_velocity), 3) &&
           put_alive(record, frame) &&
           put_obstacles(record, frame, SHV_SERIES_OBSTACLE_POSITION, offsetof(ShvObstacleView, position), 3) &&
           put_obstacles(record, frame, SHV_SERIES_OBSTACLE_ORIENTATION, offsetof(ShvObstacleView, orientation), 4) &&
           put_obstacles(record, frame, SHV_SERIES_OBSTACLE_VELOCITY, offsetof(ShvObstacleView, velocity), 3) &&
           put_obstacles(record, frame, SHV_SERIES_OBSTACLE_ANGULAR_VELOCITY,
                         offsetof(ShvObstacleView, angular_velocity), 3);
}

static bool put_cost(ShvRecord *record, const ShvFrameView *frame)
{
    const double wall = shv_now() - record->start;
    double *seconds = record->values;
    for (int32_t i = 0; i < frame->cost_count; i++) seconds[i] = frame->costs[i].seconds;
    bool good =
        put(record, SHV_SERIES_WALL, 0, &wall) && put(record, SHV_SERIES_COST_SECONDS, frame->cost_count, seconds);
    int64_t *numbers = (int64_t *)record->values;
    for (int32_t i = 0; i < frame->cost_count; i++) numbers[i] = frame->costs[i].calls;
    good = good && put(record, SHV_SERIES_COST_CALLS, frame->cost_count, numbers);
    for (int32_t i = 0; i < frame->bytes_count; i++) numbers[i] = (int64_t)frame->bytes[i].bytes;
    good = good && put(record, SHV_SERIES_BYTES, frame->bytes_count, numbers);
    for (int32_t i = 0; i < frame->bytes_count; i++) numbers[i] = (int64_t)frame->bytes[i].peak;
    return good && put(record, SHV_SERIES_BYTES_PEAK, frame->bytes_count, numbers);
}

static bool put_moment(ShvRecord *record, const ShvFrameView *frame)
{
    const uint8_t mode = frame->fracture, animation = frame->animation;
    const ShvProgressView progress = {
        frame->steps,       frame->step,     frame->courant, frame->worst_overshoot,
        frame->alive_count, frame->inserted, frame->failed,  {frame->pieces[0], frame->pieces[1], frame->pieces[2]}};
    return put(record, SHV_SERIES_TIME, 0, &frame->time) && put(record, SHV_SERIES_MODE, 0, &mode) &&
           put(record, SHV_SERIES_ANIMATION, 0, &animation) && put(record, SHV_SERIES_LEDGER, 0, &frame->ledger) &&
           put(record, SHV_SERIES_PROGRESS, 0, &progress);
}

static bool put_bonds(ShvRecord *record, const ShvSimulation *simulation)
{
    uint8_t *bonds = (uint8_t *)record->values;
    shv_simulation_bonds(simulation, bonds);
    return put(record, SHV_SERIES_BOND, record->element_count, bonds);
}

static bool put_nodes(ShvRecord *record, const ShvSimulation *simulation)
{
    shv_simulation_corner_positions(simulation, record->corners);
    shv_within_blank(record, shv_simulation_frame(simulation)->time);
    shv_simulation_element_state(simulation, record->element_fragment, record->values);
    return put(record, SHV_SERIES_CORNERS, record->element_count, record->corners) &&
           put(record, SHV_SERIES_DAMAGE, record->element_count, record->values) && put_bonds(record, simulation) &&
           put(record, SHV_SERIES_NODE_FRAGMENT, record->element_count, record->element_fragment);
}

/* ---- genealogy and events ---- */

/* Everything but mode, pose and velocities. Bytes between the members may differ: then a row is written once more. */
static bool same_constants(const ShvFragmentView *a, const ShvFragmentView *b)
{
    const size_t mode = offsetof(ShvFragmentView, mode), tets = offsetof(ShvFragmentView, tets);
    return memcmp(a, b, mode) == 0 && memcmp(&a->tets, &b->tets, offsetof(ShvFragmentView, position) - tets) == 0;
}

/* Writes the rows from the first to the last that changed. */
static bool put_genealogy(ShvRecord *record, const ShvFrameView *frame)
{
    int32_t first = 0, last = frame->fragment_count;
    const int32_t known = record->fragment_count;
    while (first < known && same_constants(&record->fragments[first], &frame->fragments[first])) first++;
    while (last > first && last <= known && same_constants(&record->fragments[last - 1], &frame->fragments[last - 1]))
        last--;
    if (!shv_series_write(&record->series[SHV_SERIES_FRAGMENTS], first, last - first, 0, frame->fragments + first,
                          NULL))
        return false;
    memcpy(record->fragments + first, frame->fragments + first, (size_t)(last - first) * sizeof *record->fragments);
    record->fragment_count = frame->fragment_count;
    return true;
}

/* Owners and lines change only where fragments start. */
static bool put_births(ShvRecord *record, const ShvSimulation *simulation, const ShvFrameView *frame)
{
    const int32_t known = record->frames == 0 ? 0 : record->fragment_count, count = frame->fragment_count;
    if (count == known && record->frames > 0 && !record->resumed) return true;
    shv_simulation_element_state(simulation, record->element_fragment, NULL);
    shv_lineage_extend(&record->lines, frame->fragments, known, count, record->element_fragment, record->element_count);
    if (!shv_series_write(&record->series[SHV_SERIES_LINEAGE], known, count - known, 0, record->lines.lineage + known,
                          NULL))
        return false;
    return record->element_count == 0 ||
           H5Dwrite(record->owners, H5T_NATIVE_INT32, H5S_ALL, H5S_ALL, H5P_DEFAULT, record->element_fragment) >= 0;
}

/* Rows that belong to the frame, and the checksums of their bytes. */
typedef struct RowSums {
    uint32_t events, times, samples;
} RowSums;

static bool put_probes(ShvRecord *record, const ShvFrameView *frame, RowSums *sums)
{
    const int64_t begin = record->probe_rows, count = frame->probe_row_count;
    if (frame->probe_count == 0) return true;
    if (!shv_series_write(&record->series[SHV_SERIES_PROBE_TIME], begin, count, 0, frame->probe_times, &sums->times) ||
        !shv_series_write(&record->series[SHV_SERIES_PROBE_SAMPLES], begin, count, frame->probe_count,
                          frame->probe_samples, &sums->samples))
        return false;
    record->probe_rows += count;
    return true;
}

static bool put_events(ShvRecord *record, const ShvFrameView *frame, RowSums *sums)
{
    if (!shv_series_write(&record->series[SHV_SERIES_EVENTS], record->events, frame->event_count, 0, frame->events,
                          &sums->events))
        return false;
    record->events += frame->event_count;
    return true;
}

static bool put_sum(ShvRecord *record, const ShvFrameView *frame, const RowSums *sums)
{
    const ShvFrameSum sum = {frame->fragment_count, record->events, record->probe_rows,
                             shv_frame_checksum(record->sums, sums->events, sums->times, sums->samples)};
    record->last_checksum = sum.checksum;
    return shv_series_write(&record->series[SHV_SERIES_SUM], record->frames, 1, 0, &sum, NULL);
}

/* ---- the frame ---- */

/* Everything that the first frame tells of sizes. */
static bool create_series(ShvRecord *record, const ShvSimulation *simulation, const ShvFrameView *frame)
{
    /* Every fragment but the first ones has a parent of its own, and at least one tet at its end. */
    const int64_t fragments = 2 * (int64_t)record->element_count;
    const ShvWidths widths = {{[SHV_WIDTH_FRAGMENT] = fragments,
                               [SHV_WIDTH_OBSTACLE] = frame->obstacle_count,
                               [SHV_WIDTH_ELEMENT] = record->element_count,
                               [SHV_WIDTH_COST] = frame->cost_count,
                               [SHV_WIDTH_BYTES] = frame->bytes_count,
                               [SHV_WIDTH_PROBE] = frame->probe_count}};
    record->obstacle_count = frame->obstacle_count;
    record->cost_count = frame->cost_count;
    record->bytes_count = frame->bytes_count;
    record->probe_count = frame->probe_count;
    if (frame->probe_count > 0 && !shv_group_put(record->file, "/probes")) return false;
    for (int i = 0; i < SHV_SERIES_COUNT; i++) {
        if (shv_series_of_nodes((ShvSeriesName)i) && !record->nodes) continue;
        if (shv_series_of_probes((ShvSeriesName)i) && frame->probe_count == 0) continue;
        if (!shv_series_create(&record->series[i], record->file, (ShvSeriesName)i, &widths)) return false;
    }
    return shv_record_write_obstacles(record->file, simulation, frame->obstacle_count) &&
           shv_record_write_names(record->file, frame);
}

static bool put_all(ShvRecord *record, const ShvSimulation *simulation, const ShvFrameView *frame)
{
    RowSums sums = {0, 0, 0};
    memset(record->sums, 0, sizeof record->sums);
    if (record->frames == 0 && !create_series(record, simulation, frame)) return false;
    return put_births(record, simulation, frame) && put_genealogy(record, frame) && put_probes(record, frame, &sums) &&
           put_events(record, frame, &sums) && put_motion(record, frame) && put_cost(record, frame) &&
           put_moment(record, frame) && (!record->nodes || put_nodes(record, simulation)) &&
           put_sum(record, frame, &sums) && H5Fflush(record->file, H5F_SCOPE_GLOBAL) >= 0;
}

static ShvStatus check_frame(const ShvRecord *record, const ShvFrameView *frame, ShvError *error)
{
    const bool same = frame->obstacle_count == record->obstacle_count && frame->cost_count == record->cost_count &&
                      frame->bytes_count == record->bytes_count && frame->probe_count == record->probe_count;
    if (frame->fragment_count < record->fragment_count || (record->frames > 0 && !same))
        return shv_fail(error, SHV_BAD_INPUT, "the frame belongs to another simulation than the record was made for");
    return SHV_OK;
}

ShvStatus shv_record_append(ShvRecord *record, const ShvSimulation *simulation, ShvError *error)
{
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    SHV_TRY(check_frame(record, frame, error));
    SHV_TRY(make_room(record, frame, error));
    if (!put_all(record, simulation, frame) || shv_stage_failure(record->stage) != 0)
        return shv_record_fail(record, error);
    record->frames++;
    record->resumed = false;
    return SHV_OK;
}
