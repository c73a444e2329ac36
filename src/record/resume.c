/* A record that goes on from a checkpoint. What came after its frame is cut off together with the first new frame: until
   that is there the file stays as it was. */
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include "base/publish.h"
#include "base/timer.h"
#include "record/checkpoint.h"
#include "record/hdf5_text.h"
#include "record/record.h"
#include "record/types.h"

/* ---- the file ---- */

static ShvStatus open_descriptor(ShvRecord *record, ShvError *error)
{
    const int low = open(record->path, O_RDWR | O_CLOEXEC | O_NONBLOCK);
    if (low < 0)
        return shv_fail(error, SHV_FILE_ERROR, "cannot go on with '%s': %s", record->path,
                        errno == ENOENT ? "there is no such file" : "it cannot be opened for writing");
    record->descriptor = low > STDERR_FILENO ? low : fcntl(low, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (record->descriptor != low) close(low);
    if (record->descriptor < 0) return shv_fail(error, SHV_FILE_ERROR, "too many files are open");
    if (flock(record->descriptor, LOCK_EX | LOCK_NB) == 0) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT,
                    "'%s' is being written by another process; wait until that run has ended, or stop it",
                    record->path);
}

static ShvStatus fail_damaged(const ShvRecord *record, ShvError *error)
{
    return shv_fail(error, SHV_BAD_INPUT, "'%s' is damaged or of another version of shiver: the run cannot go on in it",
                    record->path);
}

static ShvStatus open_file(ShvRecord *record, ShvError *error)
{
    SHV_TRY(open_descriptor(record, error));
    SHV_TRY(shv_stage_create(&record->stage, record->memory, record->descriptor, error));
    SHV_TRY(shv_stage_adopt(record->stage, record->path, error));
    record->file = shv_stage_open(record->stage, record->path);
    int32_t format = 0;
    if (record->file < 0 ||
        !shv_attribute_get_number(record->file, "shiver_format", H5T_NATIVE_INT32, H5T_INTEGER, &format) ||
        format != SHV_RUN_FILE_FORMAT)
        return fail_damaged(record, error);
    record->owners = H5Dopen2(record->file, "/fragments/elements", H5P_DEFAULT);
    return record->owners >= 0 && shv_record_find_badge(record->file, &record->badge) ? SHV_OK
                                                                                      : fail_damaged(record, error);
}

static bool open_series(ShvRecord *record)
{
    record->probe_count = H5Lexists(record->file, "/probes", H5P_DEFAULT) > 0;
    record->nodes = H5Lexists(record->file, "/nodes", H5P_DEFAULT) > 0;
    for (int i = 0; i < SHV_SERIES_COUNT; i++) {
        const ShvSeriesName name = (ShvSeriesName)i;
        if ((shv_series_of_nodes(name) && !record->nodes) || (shv_series_of_probes(name) && !record->probe_count))
            continue;
        if (!shv_series_open(&record->series[i], record->file, name)) return false;
    }
    record->frames = (int64_t)record->series[SHV_SERIES_SUM].extent[0];
    record->obstacle_count = (int32_t)record->series[SHV_SERIES_OBSTACLE_POSITION].extent[1];
    record->cost_count = (int32_t)record->series[SHV_SERIES_COST_SECONDS].extent[1];
    record->bytes_count = (int32_t)record->series[SHV_SERIES_BYTES].extent[1];
    if (record->probe_count) record->probe_count = (int32_t)record->series[SHV_SERIES_PROBE_SAMPLES].extent[1];
    return true;
}

/* ---- the frame from which it goes on ---- */

static bool read_sum(const ShvRecord *record, int64_t frame, ShvFrameSum *sum)
{
    return frame >= 0 && frame < record->frames && shv_series_read(&record->series[SHV_SERIES_SUM], frame, 1, 0, sum);
}

static bool fits(void *data, const ShvCheckpointMark *mark)
{
    const ShvRecord *record = data;
    ShvFrameSum sum;
    return read_sum(record, mark->frames - 1, &sum) && sum.checksum == mark->checksum;
}

static ShvStatus make_fragments(ShvRecord *record, const ShvFrameSum *sum, ShvError *error)
{
    const size_t capacity = 2 * (size_t)sum->fragments + 1;
    if (sum->fragments < 0 || sum->fragments > 2 * (int64_t)record->element_count) return fail_damaged(record, error);
    record->fragments = shv_allocate(record->memory, SHV_PART_RECORD, capacity, sizeof *record->fragments);
    record->lines.lineage = shv_allocate(record->memory, SHV_PART_RECORD, capacity, sizeof(int32_t));
    record->lines.first_element = shv_allocate(record->memory, SHV_PART_RECORD, capacity, sizeof(int32_t));
    record->lines.heir = shv_allocate(record->memory, SHV_PART_RECORD, capacity, sizeof(int32_t));
    if (!record->fragments || !record->lines.lineage || !record->lines.first_element || !record->lines.heir)
        return shv_fail_memory(error, "fragments of the run file", capacity * sizeof *record->fragments);
    record->fragment_capacity = (int32_t)capacity;
    record->fragment_count = (int32_t)sum->fragments;
    return shv_series_read(&record->series[SHV_SERIES_LINEAGE], 0, sum->fragments, 0, record->lines.lineage)
               ? SHV_OK
               : fail_damaged(record, error);
}

static int64_t rows_of(const ShvRecord *record, ShvSeriesName name)
{
    if (name < SHV_SERIES_FRAMES) return record->frames;
    if (name == SHV_SERIES_FRAGMENTS || name == SHV_SERIES_LINEAGE) return record->fragment_count;
    return name == SHV_SERIES_EVENTS ? record->events : record->probe_rows;
}

static bool cut_series(ShvRecord *record)
{
    for (int i = 0; i < SHV_SERIES_COUNT; i++)
        if (record->series[i].dataset >= 0 &&
            !shv_series_cut(&record->series[i], rows_of(record, (ShvSeriesName)i), record->fragment_count))
            return false;
    return true;
}

static ShvStatus go_back(ShvRecord *record, int64_t frames, ShvError *error)
{
    ShvFrameSum sum;
    double wall;
    if (!read_sum(record, frames - 1, &sum) ||
        !shv_series_read(&record->series[SHV_SERIES_WALL], frames - 1, 1, 0, &wall))
        return fail_damaged(record, error);
    SHV_TRY(make_fragments(record, &sum, error));
    record->frames = frames;
    record->events = sum.events;
    record->probe_rows = sum.probe_rows;
    record->last_checksum = sum.checksum;
    record->start = shv_now() - wall;
    return cut_series(record) ? SHV_OK : fail_damaged(record, error);
}

static ShvStatus change_head(ShvRecord *record, const ShvRecordDefinition *definition, ShvError *error)
{
    const bool good = shv_record_rewrite_overrides(record->file, definition) &&
                      shv_attribute_set_text(record->file, "status", "running") &&
                      shv_attribute_set_text(record->file, "message", "");
    return good ? SHV_OK : shv_record_fail(record, error);
}

/* ---- together ---- */

static ShvStatus find(ShvCheckpoint *found, ShvRecord *record, const ShvRecordDefinition *definition,
                      const ShvSimulation *simulation, ShvError *error)
{
    const ShvCheckpointMark own = {.program = shv_checkpoint_program(),
                                   .scene = definition->resume_hash,
                                   .geometry = shv_simulation_geometry_hash(simulation)};
    record->mark = own;
    return shv_checkpoint_find(found, record->path, record->memory, &own, fits, record, error);
}

static ShvStatus go_on(ShvRecord *record, const ShvRecordDefinition *definition, const ShvCheckpoint *found,
                       ShvSimulation *simulation, ShvError *error)
{
    SHV_TRY(go_back(record, found->mark.frames, error));
    SHV_TRY(change_head(record, definition, error));
    SHV_TRY(shv_stage_journal(record->stage, record->path, record->badge, record->sync_interval, error));
    SHV_TRY(shv_simulation_load(simulation, found->descriptor, found->size, error));
    record->mark.sequence = found->mark.sequence;
    record->resumed = true;
    return SHV_OK;
}

static ShvStatus start(ShvRecord *record, const ShvRecordDefinition *definition, ShvSimulation *simulation,
                       ShvCheckpoint *found, ShvError *error)
{
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    SHV_TRY(shv_record_allocate(record, definition, &mesh, error));
    SHV_TRY(shv_within_prepare(record, simulation, &mesh, error));
    if (access(record->path, F_OK) != 0) return SHV_OK;
    SHV_TRY(open_file(record, error));
    if (!open_series(record)) return fail_damaged(record, error);
    SHV_TRY(find(found, record, definition, simulation, error));
    return found->descriptor >= 0 ? go_on(record, definition, found, simulation, error) : SHV_OK;
}

ShvStatus shv_record_resume(ShvRecord **record, const ShvRecordDefinition *definition, ShvSimulation *simulation,
                            void *note, size_t note_size, ShvError *error)
{
    *record = NULL;
    ShvRecord *made;
    SHV_TRY(shv_record_prepare(&made, definition, error));
    const ShvSilence silence = shv_silence_begin();
    ShvCheckpoint found = {.descriptor = -1};
    const ShvStatus status = start(made, definition, simulation, &found, error);
    if (status == SHV_OK && made->resumed) {
        memcpy(note, found.note, found.note_size < note_size ? found.note_size : note_size);
        *record = made;
    } else {
        shv_record_release(made);
    }
    shv_checkpoint_close(&found);
    shv_silence_end(silence);
    return status;
}

ShvStatus shv_record_checkpoint(ShvRecord *record, ShvSimulation *simulation, const void *note, size_t note_size,
                                ShvError *error)
{
    if (record->broken.status != SHV_OK) return shv_fail(error, record->broken.status, "%s", record->broken.message);
    if (record->frames == 0) return shv_fail(error, SHV_BAD_INPUT, "a checkpoint needs a frame in the run file");
    ShvCheckpointMark mark = record->mark;
    if (mark.program == 0) mark.program = shv_checkpoint_program();
    if (mark.geometry == 0) mark.geometry = shv_simulation_geometry_hash(simulation);
    mark.scene = record->resume_hash;
    mark.frames = record->frames;
    mark.checksum = record->last_checksum;
    mark.time = shv_simulation_summary(simulation).time;
    mark.sequence++;
    SHV_TRY(shv_stage_settle(record->stage, error));
    SHV_TRY(shv_checkpoint_write(record->path, record->memory, simulation, &mark, note, note_size, error));
    record->mark = mark;
    return SHV_OK;
}
