#include "record/record.h"

#include <errno.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/publish.h"
#include "base/timer.h"
#include "record/hdf5_text.h"

ShvRecordDefinition shv_record_default(void)
{
    return (ShvRecordDefinition){.cookie = SHV_DEFINITION_COOKIE, .sync_interval = 5.0};
}

ShvStatus shv_record_fail(const ShvRecord *record, ShvError *error)
{
    const int number = shv_stage_failure(record->stage);
    if (number == ENOMEM || (number == 0 && shv_memory_missed()))
        return shv_fail(error, SHV_NO_MEMORY, "out of memory for the run file '%s'", record->path);
    if (number == 0)
        return shv_fail(error, SHV_FILE_ERROR, "HDF5 could not write frame %lld of '%s'; the frames before it are kept",
                        (long long)record->frames, record->path);
    char reason[128] = "unknown error";
    if (strerror_r(number, reason, sizeof reason) != 0) strcpy(reason, "unknown error");
    const bool full = number == ENOSPC || number == EDQUOT || number == EFBIG;
    return shv_fail(error, SHV_FILE_ERROR, "%s frame %lld of '%s': %s; %sthe frames before it are kept",
                    full ? "no space for" : "cannot write", (long long)record->frames, record->path, reason,
                    full ? "make room on the disk (or raise the limit of file size); " : "");
}

/* ---- making ---- */

ShvStatus shv_record_allocate(ShvRecord *record, const ShvRecordDefinition *definition, const ShvMeshView *mesh,
                              ShvError *error)
{
    const size_t elements = (size_t)mesh->element_count;
    record->path = shv_copy_text(record->memory, SHV_PART_RECORD, definition->path);
    record->element_fragment = shv_allocate(record->memory, SHV_PART_RECORD, elements, sizeof(int32_t));
    if (definition->nodes)
        record->corners = shv_allocate(record->memory, SHV_PART_RECORD, 12 * elements, sizeof(double));
    if (!record->path || !record->element_fragment || (definition->nodes && !record->corners))
        return shv_fail_memory(error, "the run file", elements * (definition->nodes ? 100 : 4));
    record->element_count = mesh->element_count;
    return SHV_OK;
}

/* The lock tells readers, also HDF5's own tools, that the file is being written. */
static void lock_file(int descriptor)
{
    (void)flock(descriptor, LOCK_EX | LOCK_NB);
}

static ShvStatus open_file(ShvRecord *record, ShvError *error)
{
    SHV_TRY(shv_publish_begin(record->memory, record->path, &record->temporary, &record->descriptor, error));
    lock_file(record->descriptor);
    SHV_TRY(shv_stage_create(&record->stage, record->memory, record->descriptor, error));
    record->file = shv_stage_make(record->stage, record->temporary);
    return record->file >= 0 ? SHV_OK : shv_record_fail(record, error);
}

static void close_objects(ShvRecord *record)
{
    for (int i = 0; i < SHV_SERIES_COUNT; i++) shv_series_close(&record->series[i]);
    if (record->owners >= 0) H5Dclose(record->owners);
    if (record->file >= 0) H5Fclose(record->file);
    record->owners = record->file = -1;
}

void shv_record_release(ShvRecord *record)
{
    if (record->stage) shv_stage_discard(record->stage);
    close_objects(record);
    shv_stage_release(record->stage);
    if (record->descriptor >= 0) close(record->descriptor);
    if (record->temporary) unlink(record->temporary);
    shv_release(record->temporary);
    shv_release(record->path);
    shv_release(record->fragments);
    shv_release(record->lines.lineage);
    shv_release(record->lines.first_element);
    shv_release(record->lines.heir);
    shv_release(record->values);
    shv_release(record->element_fragment);
    shv_release(record->corners);
    shv_release(record->chosen);
    shv_release(record);
}

static ShvStatus start(ShvRecord *record, const ShvRecordDefinition *definition, const ShvSimulation *simulation,
                       ShvError *error)
{
    const ShvMeshView mesh = shv_simulation_mesh(simulation);
    SHV_TRY(shv_publish_check(definition->path, definition->force, error));
    SHV_TRY(shv_record_allocate(record, definition, &mesh, error));
    SHV_TRY(shv_within_prepare(record, simulation, &mesh, error));
    SHV_TRY(open_file(record, error));
    if (!shv_record_write_badge(record->file, &record->badge) ||
        !shv_record_write_head(record->file, definition, simulation) ||
        !shv_record_write_mesh(record->file, &mesh, &record->owners) ||
        !shv_record_write_materials(record->file, simulation))
        return shv_record_fail(record, error);
    return SHV_OK;
}

ShvStatus shv_record_prepare(ShvRecord **record, const ShvRecordDefinition *definition, ShvError *error)
{
    *record = NULL;
    if (!definition || definition->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the record definition did not start from shv_record_default()");
    ShvRecord *made = shv_allocate(definition->memory, SHV_PART_RECORD, 1, sizeof *made);
    if (!made) return shv_fail_memory(error, "the run file", sizeof *made);
    *made = (ShvRecord){.memory = definition->memory,
                        .force = definition->force,
                        .nodes = definition->nodes,
                        .sync_interval = definition->sync_interval,
                        .resume_hash = definition->resume_hash,
                        .descriptor = -1,
                        .file = -1,
                        .owners = -1,
                        .start = shv_now()};
    for (int i = 0; i < SHV_SERIES_COUNT; i++)
        made->series[i] = (ShvSeries){.dataset = -1, .memory_type = -1, .file_type = -1};
    *record = made;
    return SHV_OK;
}

ShvStatus shv_record_create(ShvRecord **record, const ShvRecordDefinition *definition, const ShvSimulation *simulation,
                            ShvError *error)
{
    *record = NULL;
    ShvRecord *made;
    SHV_TRY(shv_record_prepare(&made, definition, error));
    const ShvSilence silence = shv_silence_begin();
    const ShvStatus status = start(made, definition, simulation, error);
    if (status != SHV_OK)
        shv_record_release(made);
    else
        *record = made;
    shv_silence_end(silence);
    return status;
}

/* ---- frames ---- */

static ShvStatus publish(ShvRecord *record, ShvError *error)
{
    if (!record->temporary) return SHV_OK;
    SHV_TRY(shv_publish_end(record->temporary, record->descriptor, record->path, record->force, error));
    shv_release(record->temporary);
    record->temporary = NULL;
    shv_checkpoint_remove(record->path, record->memory, -1);
    return shv_stage_journal(record->stage, record->path, record->badge, record->sync_interval, error);
}

ShvStatus shv_record_frame(ShvRecord *record, const ShvSimulation *simulation, ShvError *error)
{
    if (record->broken.status != SHV_OK) return shv_fail(error, record->broken.status, "%s", record->broken.message);
    const ShvSilence silence = shv_silence_begin();
    ShvStatus status = shv_record_append(record, simulation, &record->broken);
    if (status == SHV_OK) status = publish(record, &record->broken);
    shv_silence_end(silence);
    if (status == SHV_OK) return SHV_OK;
    shv_stage_discard(record->stage);
    return shv_fail(error, status, "%s", record->broken.message);
}

/* ---- the end ---- */

static const char *status_text(ShvStatus status)
{
    return status == SHV_OK ? "finished" : status == SHV_INTERRUPTED ? "interrupted" : "failed";
}

/* After a failure: brings the file to its last whole frame and opens it anew. */
static ShvStatus reopen(ShvRecord *record, ShvError *error)
{
    shv_stage_discard(record->stage);
    close_objects(record);
    SHV_TRY(shv_stage_restore(record->stage, error));
    record->file = shv_stage_open(record->stage, record->path);
    return record->file >= 0 ? SHV_OK : shv_fail(error, SHV_FILE_ERROR, "cannot open '%s' anew", record->path);
}

/* What is written where nobody will find it is lost. */
static ShvStatus check_name(const ShvRecord *record, ShvError *error)
{
    struct stat own, named;
    if (fstat(record->descriptor, &own) != 0 || stat(record->path, &named) != 0)
        return shv_fail(error, SHV_FILE_ERROR, "'%s' was deleted or moved away while the run wrote it; run it again",
                        record->path);
    if (own.st_dev == named.st_dev && own.st_ino == named.st_ino) return SHV_OK;
    return shv_fail(error, SHV_FILE_ERROR,
                    "'%s' was replaced by another file while the run wrote it; run it again under another name",
                    record->path);
}

/* The texts have their room since the file was made: this works on a full disk. */
static ShvStatus write_end(ShvRecord *record, ShvStatus status, const char *message, ShvError *error)
{
    if (record->broken.status != SHV_OK) SHV_TRY(reopen(record, error));
    const bool good = shv_attribute_set_text(record->file, "status", status_text(status)) &&
                      shv_attribute_set_text(record->file, "message", message ? message : "");
    if (!good || H5Fflush(record->file, H5F_SCOPE_GLOBAL) < 0 || shv_stage_failure(record->stage) != 0)
        return shv_record_fail(record, error);
    shv_stage_discard(record->stage);
    close_objects(record);
    SHV_TRY(shv_stage_end(record->stage, error));
    SHV_TRY(check_name(record, error));
    /* Of a whole run the last one is enough: to make it longer. */
    if (status == SHV_OK && record->mark.sequence > 0)
        shv_checkpoint_remove(record->path, record->memory, (int)(record->mark.sequence % SHV_CHECKPOINTS));
    return SHV_OK;
}

void shv_record_abandon(ShvRecord *record)
{
    if (!record) return;
    const ShvSilence silence = shv_silence_begin();
    shv_record_release(record);
    shv_silence_end(silence);
}

ShvStatus shv_record_close(ShvRecord *record, ShvStatus status, const char *message, ShvError *error)
{
    if (!record) return SHV_OK;
    const ShvSilence silence = shv_silence_begin();
    ShvStatus written = SHV_OK;
    if (!record->temporary) written = write_end(record, status, message, error);
    shv_record_release(record);
    shv_silence_end(silence);
    return written;
}
