/* Opens a run file, reads all of it, and writes what `export` and `view` make of it. HDF5 finds most damage by its checksums: so half
   of the inputs are changed through HDF5, which makes new ones. */
#include "fuzz.h"

#include <hdf5.h>
#include <sys/stat.h>

#include "shiver/export.h"
#include "shiver/view.h"

enum { FRAMES = 3, MOST_ITEMS = 1 << 20, LARGEST_VALUE = 1 << 16 };

size_t LLVMFuzzerMutate(uint8_t *data, size_t size, size_t most);
size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed);
int LLVMFuzzerInitialize(int *count, char ***arguments);

/* ---- what a reader does ---- */

/* Arrays as long as any that is asked for; NULL where the file says that it is larger than what is tried here. */
typedef struct Room {
    double *values;
    int32_t *numbers;
    uint16_t *objects;
    uint8_t *bytes;
    ShvFragmentView *fragments;
    ShvObstacleView *obstacles;
    ShvProbeSample *samples;
} Room;

static bool make_room(Room *room, const ShvRunFileInfo *info)
{
    if (info->fragment_count > MOST_ITEMS || info->element_count > MOST_ITEMS || info->node_count > MOST_ITEMS ||
        info->obstacle_count > MOST_ITEMS || info->probe_count > 1000)
        return false;
    const size_t fragments = (size_t)info->fragment_count, elements = (size_t)info->element_count,
                 nodes = (size_t)info->node_count;
    room->values = calloc(4 * fragments + 12 * elements + 3 * nodes + 100, sizeof(double));
    room->numbers = calloc(fragments + 4 * elements + 1, sizeof(int32_t));
    room->objects = calloc(elements + 1, sizeof(uint16_t));
    room->bytes = calloc(fragments + 4 * elements + 1, 1);
    room->fragments = calloc(fragments + 1, sizeof *room->fragments);
    room->obstacles = calloc((size_t)info->obstacle_count + 1, sizeof *room->obstacles);
    room->samples = calloc(10 * (size_t)info->probe_count + 1, sizeof *room->samples);
    return room->values && room->numbers && room->objects && room->bytes && room->fragments && room->obstacles &&
           room->samples;
}

static void release(Room *room)
{
    free(room->values);
    free(room->numbers);
    free(room->objects);
    free(room->bytes);
    free(room->fragments);
    free(room->obstacles);
    free(room->samples);
}

static void read_frame(ShvRunFile *file, int64_t frame, Room *room)
{
    ShvError error;
    ShvLedgerView ledger;
    ShvProgressView progress;
    double time, wall;
    int32_t mode;
    double *values = room->values;
    (void)shv_run_file_frame(file, frame, &time, &mode, room->bytes, values, NULL, NULL, NULL, &error);
    (void)shv_run_file_frame(file, frame, NULL, NULL, NULL, NULL, values, NULL, NULL, &error);
    (void)shv_run_file_frame(file, frame, NULL, NULL, NULL, NULL, NULL, values, NULL, &error);
    (void)shv_run_file_frame(file, frame, NULL, NULL, NULL, NULL, NULL, NULL, values, &error);
    (void)shv_run_file_corners(file, frame, values, NULL, room->numbers, &error);
    (void)shv_run_file_corners(file, frame, NULL, values, NULL, &error);
    (void)shv_run_file_bonds(file, frame, room->bytes, &error);
    (void)shv_run_file_obstacles(file, frame, room->obstacles, &error);
    (void)shv_run_file_cost_at(file, frame, &wall, NULL, &error);
    (void)shv_run_file_ledger(file, frame, &ledger, &error);
    (void)shv_run_file_progress(file, frame, &progress, &error);
}

static void read_tables(ShvRunFile *file, Room *room)
{
    ShvError error;
    ShvEventView event;
    ShvObstacleBody body;
    const ShvCostView *costs;
    const ShvBytesView *bytes;
    int32_t cost_count, bytes_count;
    const ShvRunFileInfo *info = shv_run_file_info(file);
    for (int64_t i = 0; i < info->event_count && i < 100; i++) (void)shv_run_file_event(file, i, &event, &error);
    for (int32_t i = 0; i < info->object_count && i < 100; i++) {
        (void)shv_run_file_object(file, i);
        (void)strlen(shv_run_file_object_name(file, i));
    }
    for (int32_t i = 0; i < shv_run_file_material_count(file) && i < 100; i++) (void)shv_run_file_material(file, i);
    for (int32_t i = 0; i < info->obstacle_count && i < 100; i++) (void)shv_run_file_obstacle(file, i, &body, &error);
    for (int32_t i = 0; i < info->probe_count; i++) (void)strlen(shv_run_file_probe_name(file, i));
    if (info->probe_row_count > 0)
        (void)shv_run_file_probes(file, 0, info->probe_row_count < 10 ? info->probe_row_count : 10, room->values,
                                  room->samples, &error);
    (void)shv_run_file_fragments(file, room->fragments, &error);
    (void)shv_run_file_lineages(file, room->numbers, &error);
    (void)shv_run_file_cost(file, &costs, &cost_count, &bytes, &bytes_count, &error);
    (void)shv_run_file_mesh(file, room->values, NULL, NULL, NULL, &error);
    (void)shv_run_file_mesh(file, NULL, room->numbers, room->objects, NULL, &error);
    (void)shv_run_file_mesh(file, NULL, NULL, NULL, room->numbers, &error);
}

static void read_all(ShvRunFile *file)
{
    ShvError error;
    uint32_t checksum;
    Room room = {0};
    const ShvRunFileInfo *info = shv_run_file_info(file);
    if (make_room(&room, info)) {
        for (int64_t i = 0; i < info->frame_count && i < FRAMES; i++) read_frame(file, i, &room);
        if (info->frame_count > FRAMES) read_frame(file, info->frame_count - 1, &room);
        read_tables(file, &room);
    }
    release(&room);
    (void)shv_run_file_checksum(file, &checksum, &error);
    (void)shv_run_file_verify(file, &error);
}

/* ---- exports: one an input, since each takes longer than reading ---- */

static char folder[64];

static void empty_folder(void)
{
    char line[128];
    snprintf(line, sizeof line, "rm -rf %s/*", folder);
    if (system(line) != 0) abort();
}

static void write_export(ShvRunFile *file, unsigned which)
{
    ShvError error = {SHV_OK, ""};
    char prefix[80];
    ShvStatus status = SHV_OK;
    const ShvRunFileInfo *info = shv_run_file_info(file);
    if (info->frame_count > 40 || info->element_count > 20000 || info->fragment_count > 20000) return;
    snprintf(prefix, sizeof prefix, "%s/out", folder);
    ShvExportOptions options = shv_export_default();
    ShvSvgOptions svg = shv_svg_default();
    ShvViewOptions view = shv_view_default();
    const ShvViewRun run = {.file = file};
    options.force = svg.force = view.force = true;
    view.page = "SHIVER_TITLE SHIVER_DATA";
    if (which == 0) status = shv_export_csv(file, prefix, &options, &error);
    if (which == 1) status = shv_export_vtk(file, prefix, &options, &error);
    if (which == 2) status = shv_export_gltf(file, prefix, &options, &error);
    if (which == 3) status = shv_export_usd(file, prefix, &options, &error);
    if (which == 4) status = shv_export_svg(file, prefix, &svg, &error);
    if (which == 5) status = shv_export_xdmf(file, prefix, &options, &error);
    if (which == 6) status = shv_view_write(&run, 1, prefix, &view, &error);
    fuzz_judge(status, &error);
    empty_folder();
}

/* ---- changes through HDF5 ---- */

typedef struct Choice {
    int wanted, seen; /* number of the data set */
    unsigned seed;
    bool changed;
} Choice;

/* Keeps its length. */
static void change_bytes(uint8_t *bytes, size_t size, unsigned seed)
{
    static const int64_t extremes[] = {-1, 0, 1, INT32_MAX, INT32_MIN, INT64_MAX, INT64_MIN, 1 << 20};
    const int64_t extreme = extremes[seed / 2 % (sizeof extremes / sizeof extremes[0])];
    const size_t width = seed % 3 == 0 ? 8 : 4, place = seed / 16 % size / width * width;
    if (seed % 2 == 0 && place + width <= size)
        memcpy(bytes + place, &extreme, width);
    else
        (void)LLVMFuzzerMutate(bytes, size, size);
}

static void change_length(hid_t set, hid_t space, unsigned seed)
{
    hsize_t now[H5S_MAX_RANK], most[H5S_MAX_RANK];
    const int rank = H5Sget_simple_extent_dims(space, now, most);
    for (int i = 0; i < rank; i++)
        if (now[i] < 10000 && (most[i] == H5S_UNLIMITED || now[i] + 1 < most[i])) now[i] += seed / 8 % 3 - 1u;
    if (rank > 0) (void)H5Dset_extent(set, now);
}

static void change_values(hid_t set, hid_t space, unsigned seed)
{
    const hid_t type = H5Dget_type(set);
    const hssize_t points = H5Sget_simple_extent_npoints(space);
    const size_t size = H5Tget_size(type), count = points > 0 ? (size_t)points : 0;
    if (count > 0 && size > 0 && count * size <= LARGEST_VALUE && H5Tis_variable_str(type) == 0) {
        uint8_t *bytes = malloc(count * size);
        if (bytes && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes) >= 0) {
            change_bytes(bytes, count * size, seed);
            (void)H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes);
        }
        free(bytes);
    }
    H5Tclose(type);
}

static herr_t change_set(hid_t object, const char *name, const H5O_info_t *info, void *data)
{
    Choice *choice = data;
    if (info->type != H5O_TYPE_DATASET || choice->seen++ != choice->wanted) return 0;
    const hid_t set = H5Dopen2(object, name, H5P_DEFAULT);
    if (set < 0) return 1;
    const hid_t space = H5Dget_space(set);
    if (choice->seed % 8 == 7)
        change_length(set, space, choice->seed);
    else
        change_values(set, space, choice->seed);
    choice->changed = true;
    H5Sclose(space);
    H5Dclose(set);
    return 1;
}

static bool change_file(const char *path, unsigned seed)
{
    Choice choice = {.wanted = (int)(seed / 64 % 64), .seed = seed};
    const hid_t file = H5Fopen(path, H5F_ACC_RDWR, H5P_DEFAULT);
    if (file < 0) return false;
    (void)H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, change_set, &choice, H5O_INFO_BASIC);
    return H5Fclose(file) >= 0 && choice.changed;
}

static size_t read_back(const char *path, uint8_t *data, size_t most)
{
    FILE *file = fopen(path, "rb");
    if (!file) return 0;
    const size_t size = fread(data, 1, most, file);
    const bool whole = fgetc(file) == EOF;
    fclose(file);
    return whole ? size : 0;
}

size_t LLVMFuzzerCustomMutator(uint8_t *data, size_t size, size_t most, unsigned seed)
{
    if (seed % 2 == 0) return LLVMFuzzerMutate(data, size, most);
    uint8_t *copy = malloc(most + 1);
    const char *path = fuzz_path(".h5");
    size_t changed = 0;
    seed = (seed / 2) * 2654435761u ^ seed >> 16;
    fuzz_write(path, data, size);
    if (copy && change_file(path, seed)) changed = read_back(path, copy, most);
    if (changed > 0) memcpy(data, copy, changed);
    free(copy);
    unlink(path);
    return changed > 0 ? changed : LLVMFuzzerMutate(data, size, most);
}

/* ---- */

static void remove_folder(void)
{
    rmdir(folder);
}

int LLVMFuzzerInitialize(int *count, char ***arguments)
{
    (void)count;
    (void)arguments;
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    snprintf(folder, sizeof folder, "%s", fuzz_path(".out"));
    if (mkdir(folder, 0700) != 0) abort();
    atexit(remove_folder);
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    ShvRunFile *file;
    ShvError error = {SHV_OK, ""};
    unsigned sum = 0;
    const char *path = fuzz_path(".h5");
    for (size_t i = 0; i < size; i++) sum = 31 * sum + data[i];
    fuzz_write(path, data, size);
    const ShvStatus status = shv_run_file_open(&file, path, NULL, &error);
    fuzz_judge(status, &error);
    if (status == SHV_OK) {
        read_all(file);
        write_export(file, sum / 8 % 14);
        shv_run_file_close(file);
    }
    unlink(path);
    return 0;
}
