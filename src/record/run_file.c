#include "shiver/run_file.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "record/hdf5_array.h"
#include "record/hdf5_text.h"
#include "record/journal.h"
#include "record/run_file.h"

/* ---- opening ---- */

static ShvStatus fail_open(ShvError *error, const char *path, const char *what)
{
    return shv_fail(error, SHV_BAD_INPUT, "'%s' %s", path, what);
}

/* The lock is asked for here and not left to HDF5, which tells a lock from a broken file by its error stack only and
   asks for none where HDF5_USE_FILE_LOCKING is FALSE. */
static bool is_locked(int descriptor)
{
    return flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
}

/* A journal is left by a writer that died. The lock keeps other readers from putting the file right at the same time. */
static ShvStatus put_right(const char *path, ShvMemory *memory, ShvError *error)
{
    const int descriptor = open(path, O_RDWR | O_CLOEXEC);
    if (descriptor < 0)
        return shv_fail(
            error, SHV_FILE_ERROR,
            "'%s' was left by a writer that died, and its last frames are in '%s.journal': copy both to where "
            "you may write",
            path, path);
    while (flock(descriptor, LOCK_EX) != 0 && errno == EINTR) continue;
    const ShvStatus status = shv_journal_recover(path, descriptor, memory, error);
    close(descriptor);
    return status;
}

static ShvStatus check_file(const char *path, int64_t *size, bool *locked, ShvError *error)
{
    const int descriptor = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor < 0) {
        char reason[128] = "unknown error";
        if (strerror_r(errno, reason, sizeof reason) != 0) strcpy(reason, "unknown error");
        return shv_fail(error, SHV_FILE_ERROR, "cannot read '%s': %s; check the name and the permissions", path,
                        reason);
    }
    struct stat found;
    ShvStatus status = SHV_OK;
    if (fstat(descriptor, &found) != 0 || !S_ISREG(found.st_mode))
        status = fail_open(error, path, "is not an ordinary file; give a run file");
    else if (found.st_size == 0)
        status = fail_open(error, path, "is empty; give a run file");
    if (status == SHV_OK) {
        *size = (int64_t)found.st_size;
        *locked = is_locked(descriptor);
    }
    close(descriptor);
    return status;
}

static ShvStatus open_hdf5(ShvRunFile *file, const char *path, ShvError *error)
{
    if (H5Fis_hdf5(path) <= 0) return fail_open(error, path, "is not a run file: it is no HDF5 file");
    file->file = file->snapshot ? shv_snapshot_open(file->snapshot, path) : H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    if (file->file < 0) return fail_open(error, path, "is truncated or damaged: HDF5 cannot open it");
    int32_t format = 0;
    if (!shv_attribute_get_number(file->file, "shiver_format", H5T_NATIVE_INT32, H5T_INTEGER, &format))
        return fail_open(error, path, "is an HDF5 file but no run file of shiver");
    if (format != SHV_RUN_FILE_FORMAT)
        return shv_fail(error, SHV_BAD_INPUT,
                        "'%s' has format %d of run files, and this version reads format %d: use the version "
                        "of shiver that wrote it",
                        path, (int)format, SHV_RUN_FILE_FORMAT);
    file->info.format = format;
    return SHV_OK;
}

/* ---- what is kept in memory ---- */

ShvStatus shv_run_fail_damaged(const ShvRunFile *file, const char *what, ShvError *error)
{
    /* HDF5 does not say whether memory was out; asking for a little tells. */
    enum { LITTLE = 1 << 16 };
    void *room = shv_memory_missed() ? NULL : shv_allocate(file->memory, SHV_PART_RECORD, LITTLE, 1);
    if (!room) return shv_fail_memory(error, what, LITTLE);
    shv_release(room);
    return shv_fail(error, SHV_BAD_INPUT, "'%s' is damaged: %s cannot be read", file->path, what);
}

static bool get_text(const ShvRunFile *file, const char *name, char *text, size_t size)
{
    return shv_attribute_get_text(file->file, name, text, size);
}

static ShvStatus read_attributes(ShvRunFile *file, ShvError *error)
{
    ShvRunTexts *texts = &file->texts;
    const bool good =
        get_text(file, "code_version", texts->code_version, sizeof texts->code_version) &&
        get_text(file, "status", texts->status, sizeof texts->status) &&
        get_text(file, "message", texts->message, sizeof texts->message) &&
        get_text(file, "scene_name", texts->scene_name, sizeof texts->scene_name) &&
        get_text(file, "processor", texts->processor, sizeof texts->processor) &&
        shv_attribute_get_number(file->file, "scene_hash", H5T_NATIVE_UINT64, H5T_INTEGER, &file->info.scene_hash) &&
        shv_attribute_get_number(file->file, "threads", H5T_NATIVE_INT32, H5T_INTEGER, &file->info.threads);
    /* Files of earlier versions do not tell. */
    if (H5Aexists(file->file, "rigid_engine") <= 0 ||
        !get_text(file, "rigid_engine", texts->rigid_engine, sizeof texts->rigid_engine))
        texts->rigid_engine[0] = '\0';
    if (!good) return shv_run_fail_damaged(file, "an attribute of its root", error);
    file->info.code_version = texts->code_version;
    file->info.status = texts->status;
    file->info.message = texts->message;
    file->info.scene_name = texts->scene_name;
    file->info.processor = texts->processor;
    file->info.rigid_engine = texts->rigid_engine;
    if (strcmp(texts->status, "running") != 0) return SHV_OK;
    file->info.live = file->snapshot != NULL;
    file->info.message = file->info.live
                             ? "it is being written: these are its frames so far"
                             : "its writer ended without a word: it was killed, or the machine stopped; what came "
                               "after the last frame is missing";
    return SHV_OK;
}

/* Whether the file holds as many bytes as the dataset says: HDF5 reads on beyond them. */
static bool is_sound(hid_t dataset, int rank, const hsize_t *extent, hid_t type)
{
    if (rank > 0 && extent[0] > 0 && extent[1] > 0)
        return (shv_filters_agree(dataset, false) || shv_filters_agree(dataset, true)) &&
               shv_chunks_sound(dataset, 0, (int64_t)extent[0]);
    const hid_t list = H5Dget_create_plist(dataset);
    const bool good = list >= 0 && H5Pget_layout(list) == H5D_CONTIGUOUS && H5Pget_external_count(list) == 0 &&
                      (rank > 0 || H5Dget_storage_size(dataset) == H5Tget_size(type));
    if (list >= 0) H5Pclose(list);
    return good;
}

/* Opens a dataset of known rank and class whose size the file can hold; extent beyond the rank is 1. */
static hid_t open_array(const ShvRunFile *file, const char *path, int rank, H5T_class_t class, hsize_t *extent)
{
    const hid_t dataset = H5Dopen2(file->file, path, H5P_DEFAULT);
    if (dataset < 0) return dataset;
    const hid_t space = H5Dget_space(dataset), type = H5Dget_type(dataset);
    extent[0] = extent[1] = 1;
    bool good = space >= 0 && type >= 0 && H5Tget_class(type) == class && H5Sget_simple_extent_ndims(space) == rank &&
                H5Sget_simple_extent_dims(space, extent, NULL) == rank;
    const double bytes = (double)extent[0] * (double)extent[1] * (type >= 0 ? (double)H5Tget_size(type) : 1.0);
    good = good && bytes <= 1100.0 * (double)file->bytes && extent[0] <= INT32_MAX;
    if (class == H5T_STRING) good = good && H5Tis_variable_str(type) == 0;
    good = good && is_sound(dataset, rank, extent, type);
    if (type >= 0) H5Tclose(type);
    if (space >= 0) H5Sclose(space);
    if (good) return dataset;
    H5Dclose(dataset);
    return -1;
}

/* `count` terminated texts of *size bytes each; rank 0: one text. The caller releases *texts. */
ShvStatus shv_run_read_texts(const ShvRunFile *file, const char *path, int rank, char **texts, size_t *size,
                             int32_t *count, ShvError *error)
{
    hsize_t extent[2];
    const hid_t dataset = open_array(file, path, rank, H5T_STRING, extent);
    if (dataset < 0) return shv_run_fail_damaged(file, path, error);
    const hid_t stored = H5Dget_type(dataset);
    *size = (stored >= 0 ? H5Tget_size(stored) : 0) + 1;
    if (stored >= 0) H5Tclose(stored);
    *count = (int32_t)extent[0];
    *texts = shv_allocate(file->memory, SHV_PART_RECORD, extent[0], *size);
    const hid_t type = shv_text_type(*size);
    ShvStatus status = SHV_OK;
    if (!*texts)
        status = shv_fail_memory(error, "texts of the run file", extent[0] * *size);
    else if (type < 0 || (*count > 0 && H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, *texts) < 0))
        status = shv_run_fail_damaged(file, path, error);
    if (type >= 0) H5Tclose(type);
    H5Dclose(dataset);
    return status;
}

static ShvStatus read_scene(ShvRunFile *file, ShvError *error)
{
    size_t size;
    int32_t count;
    SHV_TRY(shv_run_read_texts(file, "/scene/text", 0, &file->scene_text, &size, &count, error));
    SHV_TRY(shv_run_read_texts(file, "/scene/overrides", 0, &file->overrides, &size, &count, error));
    file->info.scene_text = file->scene_text;
    file->info.overrides = file->overrides;
    return SHV_OK;
}

/* Reads a whole array of int32_t or double whose extents must be these. */
ShvStatus shv_run_read_array(const ShvRunFile *file, const char *path, int64_t rows, int64_t columns, bool real,
                             void *data, ShvError *error)
{
    hsize_t extent[2];
    const hid_t dataset = open_array(file, path, columns > 0 ? 2 : 1, real ? H5T_FLOAT : H5T_INTEGER, extent);
    if (dataset < 0) return shv_run_fail_damaged(file, path, error);
    const bool fits = extent[0] == (hsize_t)rows && (columns == 0 || extent[1] == (hsize_t)columns);
    const hid_t type = real ? H5T_NATIVE_DOUBLE : H5T_NATIVE_INT32;
    const bool good = fits && (rows == 0 || H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0);
    H5Dclose(dataset);
    return good ? SHV_OK : shv_run_fail_damaged(file, path, error);
}

static ShvStatus count_rows(const ShvRunFile *file, const char *path, int32_t columns, H5T_class_t class, int32_t *rows,
                            ShvError *error)
{
    hsize_t extent[2];
    const hid_t dataset = open_array(file, path, 2, class, extent);
    if (dataset < 0) return shv_run_fail_damaged(file, path, error);
    H5Dclose(dataset);
    *rows = (int32_t)extent[0];
    return extent[1] == (hsize_t)columns ? SHV_OK : shv_run_fail_damaged(file, path, error);
}

ShvStatus shv_run_check_rows(const ShvRunFile *file, const char *path, bool real, int32_t rows, ShvError *error)
{
    int32_t found = 0;
    SHV_TRY(count_rows(file, path, 3, real ? H5T_FLOAT : H5T_INTEGER, &found, error));
    return found == rows ? SHV_OK : shv_run_fail_damaged(file, path, error);
}

static bool range_fits(const int32_t *range, int32_t count)
{
    return 0 <= range[0] && range[0] <= range[1] && range[1] <= count;
}

static ShvStatus read_objects(ShvRunFile *file, ShvError *error)
{
    size_t name_size, material_size;
    int32_t count = 0, materials = 0, ranges = 0;
    SHV_TRY(count_rows(file, "/mesh/positions", 3, H5T_FLOAT, &file->info.node_count, error));
    SHV_TRY(count_rows(file, "/mesh/elements", 4, H5T_INTEGER, &file->info.element_count, error));
    SHV_TRY(shv_run_read_texts(file, "/mesh/object_names", 1, &file->object_names, &name_size, &count, error));
    SHV_TRY(shv_run_read_texts(file, "/mesh/object_materials", 1, &file->object_materials, &material_size, &materials,
                               error));
    SHV_TRY(count_rows(file, "/mesh/object_ranges", 4, H5T_INTEGER, &ranges, error));
    if (count != materials || count != ranges) return shv_run_fail_damaged(file, "the list of objects", error);
    file->info.object_count = count;
    file->objects = shv_allocate(file->memory, SHV_PART_RECORD, (size_t)count, sizeof *file->objects);
    int32_t *range = shv_allocate(file->memory, SHV_PART_RECORD, 4 * (size_t)count, sizeof *range);
    ShvStatus status = file->objects && range ? SHV_OK : shv_fail_memory(error, "objects", (size_t)count * 16);
    if (status == SHV_OK) status = shv_run_read_array(file, "/mesh/object_ranges", count, 4, false, range, error);
    for (int32_t i = 0; status == SHV_OK && i < count; i++) {
        const int32_t *own = range + 4 * (int64_t)i;
        if (!range_fits(own, file->info.element_count) || !range_fits(own + 2, file->info.node_count))
            status = shv_run_fail_damaged(file, "/mesh/object_ranges", error);
        file->objects[i] = (ShvObjectView){file->object_names + (size_t)i * name_size,
                                           file->object_materials + (size_t)i * material_size,
                                           own[0],
                                           own[1],
                                           own[2],
                                           own[3]};
    }
    shv_release(range);
    return status;
}

/* A row counts when it has its time and all samples. */
static ShvStatus read_probes(ShvRunFile *file, ShvError *error)
{
    const ShvSeries *times = &file->series[SHV_SERIES_PROBE_TIME], *samples = &file->series[SHV_SERIES_PROBE_SAMPLES];
    SHV_TRY(shv_run_read_texts(file, "/probes/name", 1, &file->probe_names, &file->probe_name_size,
                               &file->info.probe_count, error));
    if (samples->extent[1] != (hsize_t)file->info.probe_count)
        return shv_run_fail_damaged(file, "the list of probes", error);
    file->info.probe_row_count =
        (int64_t)(times->extent[0] < samples->extent[0] ? times->extent[0] : samples->extent[0]);
    return SHV_OK;
}

/* Files of before have all corners and do not say so. */
static bool is_partial(const ShvRunFile *file)
{
    int32_t partial = 0;
    const hid_t group = H5Gopen2(file->file, "/nodes", H5P_DEFAULT);
    const bool told = group >= 0 && H5Aexists(group, "partial") > 0 &&
                      shv_attribute_get_number(group, "partial", H5T_NATIVE_INT32, H5T_INTEGER, &partial);
    if (group >= 0) H5Gclose(group);
    return told && partial != 0;
}

static ShvStatus open_series(ShvRunFile *file, ShvError *error)
{
    file->info.nodes = H5Lexists(file->file, "/nodes", H5P_DEFAULT) > 0;
    file->partial = file->info.nodes && is_partial(file);
    const bool probes = H5Lexists(file->file, "/probes", H5P_DEFAULT) > 0;
    for (int i = 0; i < SHV_SERIES_COUNT; i++) {
        if (shv_series_of_nodes((ShvSeriesName)i) && !file->info.nodes) continue;
        if (shv_series_of_probes((ShvSeriesName)i) && !probes) continue;
        if (!shv_series_open(&file->series[i], file->file, (ShvSeriesName)i) ||
            !shv_series_plausible(&file->series[i], file->bytes))
            return shv_run_fail_damaged(file, shv_series_path((ShvSeriesName)i), error);
    }
    return probes ? read_probes(file, error) : SHV_OK;
}

/* A frame counts when every series has it: a writer that was killed may have left one more in some. */
static ShvStatus count_frames(ShvRunFile *file, ShvError *error)
{
    hsize_t frames = file->series[SHV_SERIES_TIME].extent[0];
    for (int i = 0; i < SHV_SERIES_FRAMES; i++) {
        if (file->series[i].dataset >= 0 && file->series[i].extent[0] < frames) frames = file->series[i].extent[0];
    }
    const hsize_t fragments = file->series[SHV_SERIES_FRAGMENTS].extent[0];
    if (fragments > INT32_MAX || frames == 0 || file->series[SHV_SERIES_LINEAGE].extent[0] != fragments)
        return shv_run_fail_damaged(file, "the list of frames", error);
    file->info.frame_count = (int64_t)frames;
    file->info.fragment_count = (int32_t)fragments;
    file->info.event_count = (int64_t)file->series[SHV_SERIES_EVENTS].extent[0];
    file->info.obstacle_count = (int32_t)file->series[SHV_SERIES_OBSTACLE_POSITION].extent[1];
    file->times = shv_allocate(file->memory, SHV_PART_RECORD, frames, sizeof *file->times);
    file->modes = shv_allocate(file->memory, SHV_PART_RECORD, 2 * frames, sizeof *file->modes);
    if (!file->times || !file->modes) return shv_fail_memory(error, "the list of frames", frames * 10);
    file->animation = file->modes + frames;
    double wall;
    if (!shv_series_read(&file->series[SHV_SERIES_TIME], 0, (int64_t)frames, 0, file->times) ||
        !shv_series_read(&file->series[SHV_SERIES_MODE], 0, (int64_t)frames, 0, file->modes) ||
        !shv_series_read(&file->series[SHV_SERIES_ANIMATION], 0, (int64_t)frames, 0, file->animation) ||
        !shv_series_read(&file->series[SHV_SERIES_WALL], (int64_t)frames - 1, 1, 0, &wall))
        return shv_run_fail_damaged(file, "the list of frames", error);
    file->info.first_time = file->times[0];
    file->info.last_time = file->times[frames - 1];
    file->info.wall_seconds = wall;
    return SHV_OK;
}

/* Decides how the file is read: as it is, put right first, or beside its writer. */
static ShvStatus begin_reading(ShvRunFile *file, const char *path, ShvError *error)
{
    bool locked = false;
    SHV_TRY(check_file(path, &file->bytes, &locked, error));
    if (!locked && shv_journal_exists(path)) {
        SHV_TRY(put_right(path, file->memory, error));
        SHV_TRY(check_file(path, &file->bytes, &locked, error));
    }
    return locked ? shv_snapshot_take(&file->snapshot, file->memory, path, &file->bytes, error) : SHV_OK;
}

static ShvStatus read_head(ShvRunFile *file, const char *path, ShvError *error)
{
    SHV_TRY(begin_reading(file, path, error));
    file->path = shv_copy_text(file->memory, SHV_PART_RECORD, path);
    if (!file->path) return shv_fail_memory(error, "a path", strlen(path) + 1);
    SHV_TRY(open_hdf5(file, path, error));
    SHV_TRY(read_attributes(file, error));
    SHV_TRY(read_scene(file, error));
    SHV_TRY(read_objects(file, error));
    SHV_TRY(shv_run_read_materials(file, error));
    SHV_TRY(open_series(file, error));
    if (file->snapshot) SHV_TRY(shv_snapshot_freeze(file->snapshot, file->series, error));
    return count_frames(file, error);
}

static void release(ShvRunFile *file)
{
    for (int i = 0; i < SHV_SERIES_COUNT; i++) shv_series_close(&file->series[i]);
    if (file->file >= 0) H5Fclose(file->file);
    shv_snapshot_release(file->snapshot);
    shv_release(file->path);
    shv_release(file->scene_text);
    shv_release(file->material_names);
    shv_release(file->materials);
    shv_release(file->overrides);
    shv_release(file->object_names);
    shv_release(file->object_materials);
    shv_release(file->objects);
    shv_release(file->obstacle_names);
    shv_obstacle_bodies_release(file->bodies);
    shv_release(file->times);
    shv_release(file->modes);
    shv_release(file->costs);
    shv_release(file->parts);
    shv_release(file->cost_names);
    shv_release(file->part_names);
    shv_release(file->probe_names);
    shv_release(file);
}

/* *moved: the writer changed the file meanwhile, and what has been read does not count. */
static ShvStatus open_once(ShvRunFile **file, const char *path, ShvMemory *memory, bool *moved, ShvError *error)
{
    ShvRunFile *made = shv_allocate(memory, SHV_PART_RECORD, 1, sizeof *made);
    *moved = false;
    if (!made) return shv_fail_memory(error, "the run file", sizeof *made);
    made->memory = memory;
    made->file = -1;
    for (int i = 0; i < SHV_SERIES_COUNT; i++)
        made->series[i] = (ShvSeries){.dataset = -1, .memory_type = -1, .file_type = -1};
    const ShvStatus status = read_head(made, path, error);
    *moved = status != SHV_NO_MEMORY && made->snapshot && shv_snapshot_moved(made->snapshot);
    if (status == SHV_OK && !*moved)
        *file = made;
    else
        release(made);
    return status;
}

/* A writer changes what the file has every few seconds, and for a time. */
static ShvStatus open_steadily(ShvRunFile **file, const char *path, ShvMemory *memory, ShvError *error)
{
    enum { MOST_TRIES = 100 };
    const struct timespec moment = {.tv_nsec = 5000000};
    bool moved = true;
    ShvStatus status = SHV_OK;
    for (int i = 0; moved && i < MOST_TRIES; i++) {
        if (i > 0) nanosleep(&moment, NULL);
        status = open_once(file, path, memory, &moved, error);
    }
    return moved ? fail_open(error, path, "is changed faster by its writer than it can be read; try again") : status;
}

ShvStatus shv_run_file_open(ShvRunFile **file, const char *path, ShvMemory *memory, ShvError *error)
{
    *file = NULL;
    const ShvSilence silence = shv_silence_begin();
    const ShvStatus status = open_steadily(file, path, memory, error);
    shv_silence_end(silence);
    return status;
}

void shv_run_file_close(ShvRunFile *file)
{
    if (!file) return;
    const ShvSilence silence = shv_silence_begin();
    release(file);
    shv_silence_end(silence);
}

/* ---- what is known without reading ---- */

const ShvRunFileInfo *shv_run_file_info(const ShvRunFile *file)
{
    return &file->info;
}

const char *shv_run_file_object_name(const ShvRunFile *file, int32_t object)
{
    return object >= 0 && object < file->info.object_count ? file->objects[object].name : "";
}

ShvObjectView shv_run_file_object(const ShvRunFile *file, int32_t object)
{
    if (object >= 0 && object < file->info.object_count) return file->objects[object];
    return (ShvObjectView){"", "", 0, 0, 0, 0};
}

const double *shv_run_file_times(const ShvRunFile *file)
{
    return file->times;
}

const uint8_t *shv_run_file_animation(const ShvRunFile *file)
{
    return file->animation;
}

/* ---- frames ---- */

ShvStatus shv_run_check_frame(const ShvRunFile *file, int64_t frame, ShvError *error)
{
    if (frame >= 0 && frame < file->info.frame_count) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "'%s' has frames 0 to %lld and no frame %lld", file->path,
                    (long long)(file->info.frame_count - 1), (long long)frame);
}

/* Reads one entry quietly; nothing when `data` is NULL. */
ShvStatus shv_run_get(ShvRunFile *file, ShvSeriesName name, int64_t index, int64_t columns, void *data, ShvError *error)
{
    if (!data) return SHV_OK;
    const ShvSilence silence = shv_silence_begin();
    const bool good = shv_series_read(&file->series[name], index, 1, columns, data);
    shv_silence_end(silence);
    return good ? SHV_OK : shv_run_fail_damaged(file, shv_series_path(name), error);
}

/* Of a time: what is rounded to six digits is off by half of this at most. */
static const double printed_digits = 1e-5;

int64_t shv_run_file_nearest(const ShvRunFile *file, double time)
{
    int64_t best = 0;
    const double first = file->info.first_time, last = file->info.last_time;
    const double rounding = printed_digits * fmax(fabs(first), fabs(last));
    if (file->info.frame_count < 1 || !(time >= first - rounding && time <= last + rounding)) return -1;
    for (int64_t i = 1; i < file->info.frame_count; i++)
        if (fabs(file->times[i] - time) < fabs(file->times[best] - time)) best = i;
    return best;
}

ShvStatus shv_run_file_frame(ShvRunFile *file, int64_t frame, double *time, int32_t *mode, uint8_t *alive,
                             double *positions, double *orientations, double *velocities, double *angular_velocities,
                             ShvError *error)
{
    SHV_TRY(shv_run_check_frame(file, frame, error));
    const int64_t count = file->info.fragment_count;
    if (time) *time = file->times[frame];
    if (mode) *mode = file->modes[frame] ? SHV_FRAGMENT_FRACTURE : SHV_FRAGMENT_FLIGHT;
    SHV_TRY(shv_run_get(file, SHV_SERIES_ALIVE, frame, count, alive, error));
    SHV_TRY(shv_run_get(file, SHV_SERIES_POSITION, frame, count, positions, error));
    SHV_TRY(shv_run_get(file, SHV_SERIES_ORIENTATION, frame, count, orientations, error));
    SHV_TRY(shv_run_get(file, SHV_SERIES_VELOCITY, frame, count, velocities, error));
    return shv_run_get(file, SHV_SERIES_ANGULAR_VELOCITY, frame, count, angular_velocities, error);
}

ShvStatus shv_run_file_ledger(ShvRunFile *file, int64_t frame, ShvLedgerView *ledger, ShvError *error)
{
    SHV_TRY(shv_run_check_frame(file, frame, error));
    return shv_run_get(file, SHV_SERIES_LEDGER, frame, 0, ledger, error);
}

ShvStatus shv_run_file_progress(ShvRunFile *file, int64_t frame, ShvProgressView *progress, ShvError *error)
{
    SHV_TRY(shv_run_check_frame(file, frame, error));
    return shv_run_get(file, SHV_SERIES_PROGRESS, frame, 0, progress, error);
}

ShvStatus shv_run_file_event(ShvRunFile *file, int64_t index, ShvEventView *event, ShvError *error)
{
    if (index < 0 || index >= file->info.event_count)
        return shv_fail(error, SHV_BAD_INPUT, "'%s' has %lld events and no event %lld", file->path,
                        (long long)file->info.event_count, (long long)index);
    return shv_run_get(file, SHV_SERIES_EVENTS, index, 0, event, error);
}

const char *shv_run_file_probe_name(const ShvRunFile *file, int32_t probe)
{
    return probe >= 0 && probe < file->info.probe_count ? file->probe_names + (size_t)probe * file->probe_name_size
                                                        : "";
}

ShvStatus shv_run_file_probes(ShvRunFile *file, int64_t begin, int64_t count, double *times, ShvProbeSample *samples,
                              ShvError *error)
{
    if (begin < 0 || count < 0 || begin > file->info.probe_row_count - count)
        return shv_fail(error, SHV_BAD_INPUT, "'%s' has %lld rows of probes and no rows %lld to %lld", file->path,
                        (long long)file->info.probe_row_count, (long long)begin, (long long)(begin + count - 1));
    const ShvSilence silence = shv_silence_begin();
    const bool good =
        count == 0 || ((!times || shv_series_read(&file->series[SHV_SERIES_PROBE_TIME], begin, count, 0, times)) &&
                       (!samples || shv_series_read(&file->series[SHV_SERIES_PROBE_SAMPLES], begin, count,
                                                    file->info.probe_count, samples)));
    shv_silence_end(silence);
    return good ? SHV_OK : shv_run_fail_damaged(file, "/probes", error);
}

static ShvStatus check_nodes(ShvRunFile *file, int64_t frame, ShvError *error)
{
    if (!file->info.nodes)
        return shv_fail(error, SHV_UNSUPPORTED, "'%s' has no node positions: run the scene with output.nodes",
                        file->path);
    return shv_run_check_frame(file, frame, error);
}

ShvStatus shv_run_file_bonds(ShvRunFile *file, int64_t frame, uint8_t *bonds, ShvError *error)
{
    SHV_TRY(check_nodes(file, frame, error));
    return shv_run_get(file, SHV_SERIES_BOND, frame, file->info.element_count, bonds, error);
}

ShvStatus shv_run_file_corners(ShvRunFile *file, int64_t frame, double *corners, double *damage,
                               int32_t *element_fragment, ShvError *error)
{
    SHV_TRY(check_nodes(file, frame, error));
    const int64_t count = file->info.element_count;
    SHV_TRY(shv_run_get(file, SHV_SERIES_CORNERS, frame, count, corners, error));
    if (corners && file->partial) SHV_TRY(shv_within_fill(file, frame, corners, error));
    SHV_TRY(shv_run_get(file, SHV_SERIES_DAMAGE, frame, count, damage, error));
    return shv_run_get(file, SHV_SERIES_NODE_FRAGMENT, frame, count, element_fragment, error);
}
