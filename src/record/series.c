#include "record/series.h"

#include <math.h>
#include <string.h>
#include <zlib.h>

#include "record/hdf5_array.h"
#include "record/types.h"

typedef enum Type {
    TYPE_DOUBLE,
    TYPE_FLOAT,
    TYPE_INT,
    TYPE_LONG,
    TYPE_BYTE,
    TYPE_LEDGER,
    TYPE_PROGRESS,
    TYPE_FRAGMENT,
    TYPE_EVENT,
    TYPE_SUM
} Type;

typedef struct Kind {
    const char *path, *unit;
    Type type;
    ShvWidth width;
    int components; /* size of the last dimension; 0: there is none */
    bool compressed;
} Kind;

/* Compressed entries have chunks of one frame and are written once. All other chunks hold many frames, never change
   their size and are filled in place. Every chunk has a checksum of its own (Fletcher-32, HDF5's). */
static const Kind KINDS[SHV_SERIES_COUNT] = {
    [SHV_SERIES_TIME] = {"/trajectory/time", "s", TYPE_DOUBLE, SHV_WIDTH_NONE, 0, false},
    [SHV_SERIES_MODE] = {"/trajectory/mode", "", TYPE_BYTE, SHV_WIDTH_NONE, 0, false},
    [SHV_SERIES_ANIMATION] = {"/trajectory/animation", "", TYPE_BYTE, SHV_WIDTH_NONE, 0, false},
    [SHV_SERIES_POSITION] = {"/trajectory/position", "m", TYPE_DOUBLE, SHV_WIDTH_FRAGMENT, 3, true},
    [SHV_SERIES_ORIENTATION] = {"/trajectory/orientation", "", TYPE_DOUBLE, SHV_WIDTH_FRAGMENT, 4, true},
    [SHV_SERIES_VELOCITY] = {"/trajectory/velocity", "m/s", TYPE_DOUBLE, SHV_WIDTH_FRAGMENT, 3, true},
    [SHV_SERIES_ANGULAR_VELOCITY] = {"/trajectory/angular_velocity", "rad/s", TYPE_DOUBLE, SHV_WIDTH_FRAGMENT, 3, true},
    [SHV_SERIES_ALIVE] = {"/trajectory/alive", "", TYPE_BYTE, SHV_WIDTH_FRAGMENT, 0, true},
    [SHV_SERIES_OBSTACLE_POSITION] = {"/obstacles/position", "m", TYPE_DOUBLE, SHV_WIDTH_OBSTACLE, 3, false},
    [SHV_SERIES_OBSTACLE_ORIENTATION] = {"/obstacles/orientation", "", TYPE_DOUBLE, SHV_WIDTH_OBSTACLE, 4, false},
    [SHV_SERIES_OBSTACLE_VELOCITY] = {"/obstacles/velocity", "m/s", TYPE_DOUBLE, SHV_WIDTH_OBSTACLE, 3, false},
    [SHV_SERIES_OBSTACLE_ANGULAR_VELOCITY] = {"/obstacles/angular_velocity", "rad/s", TYPE_DOUBLE, SHV_WIDTH_OBSTACLE,
                                              3, false},
    [SHV_SERIES_LEDGER] = {"/ledger", "J unless the name says otherwise: s, m2, kg m/s, kg m2/s", TYPE_LEDGER,
                           SHV_WIDTH_NONE, 0, false},
    [SHV_SERIES_PROGRESS] = {"/progress", "step in s", TYPE_PROGRESS, SHV_WIDTH_NONE, 0, false},
    [SHV_SERIES_WALL] = {"/cost/wall", "s", TYPE_DOUBLE, SHV_WIDTH_NONE, 0, false},
    [SHV_SERIES_COST_SECONDS] = {"/cost/seconds", "s", TYPE_DOUBLE, SHV_WIDTH_COST, 0, false},
    [SHV_SERIES_COST_CALLS] = {"/cost/calls", "", TYPE_LONG, SHV_WIDTH_COST, 0, false},
    [SHV_SERIES_BYTES] = {"/cost/bytes", "byte", TYPE_LONG, SHV_WIDTH_BYTES, 0, false},
    [SHV_SERIES_BYTES_PEAK] = {"/cost/bytes_peak", "byte", TYPE_LONG, SHV_WIDTH_BYTES, 0, false},
    [SHV_SERIES_CORNERS] = {"/nodes/corners", "m", TYPE_DOUBLE, SHV_WIDTH_ELEMENT, 12, true},
    [SHV_SERIES_BOND] = {"/nodes/bond", "1: held across the facet", TYPE_BYTE, SHV_WIDTH_ELEMENT, 4, true},
    [SHV_SERIES_DAMAGE] = {"/nodes/damage", "", TYPE_FLOAT, SHV_WIDTH_ELEMENT, 4, true},
    [SHV_SERIES_NODE_FRAGMENT] = {"/nodes/fragment", "", TYPE_INT, SHV_WIDTH_ELEMENT, 0, true},
    [SHV_SERIES_SUM] = {"/frames", "", TYPE_SUM, SHV_WIDTH_NONE, 0, false},
    [SHV_SERIES_LINEAGE] = {"/fragments/lineage", "", TYPE_INT, SHV_WIDTH_NONE, 0, false},
    [SHV_SERIES_FRAGMENTS] = {"/fragments/list", "SI", TYPE_FRAGMENT, SHV_WIDTH_NONE, 0, false},
    [SHV_SERIES_EVENTS] = {"/events", "SI", TYPE_EVENT, SHV_WIDTH_NONE, 0, false},
    [SHV_SERIES_PROBE_TIME] = {"/probes/time", "s", TYPE_DOUBLE, SHV_WIDTH_NONE, 0, false},
    [SHV_SERIES_PROBE_SAMPLES] = {"/probes/samples", "displacement m, velocity m/s, stress Pa, contact N, reaction N",
                                  TYPE_DOUBLE, SHV_WIDTH_PROBE, SHV_PROBE_NUMBERS, false},
};

enum { ROWS_A_CHUNK = 64 };

bool shv_series_of_nodes(ShvSeriesName name)
{
    return name >= SHV_SERIES_CORNERS && name <= SHV_SERIES_NODE_FRAGMENT;
}

bool shv_series_of_probes(ShvSeriesName name)
{
    return name == SHV_SERIES_PROBE_TIME || name == SHV_SERIES_PROBE_SAMPLES;
}

bool shv_series_of_cost(ShvSeriesName name)
{
    return name >= SHV_SERIES_WALL && name <= SHV_SERIES_BYTES_PEAK;
}

const char *shv_series_path(ShvSeriesName name)
{
    return KINDS[name].path;
}

/* A type that the caller closes. */
static hid_t make_type(Type type, bool file)
{
    switch (type) {
    case TYPE_DOUBLE:
        return H5Tcopy(file ? H5T_IEEE_F64LE : H5T_NATIVE_DOUBLE);
    case TYPE_FLOAT: /* damage: 0 … 1, read and written as double */
        return H5Tcopy(file ? H5T_IEEE_F32LE : H5T_NATIVE_DOUBLE);
    case TYPE_INT:
        return H5Tcopy(file ? H5T_STD_I32LE : H5T_NATIVE_INT32);
    case TYPE_LONG:
        return H5Tcopy(file ? H5T_STD_I64LE : H5T_NATIVE_INT64);
    case TYPE_BYTE:
        return H5Tcopy(file ? H5T_STD_U8LE : H5T_NATIVE_UINT8);
    case TYPE_LEDGER:
        return file ? shv_row_file_type(SHV_ROW_LEDGER) : shv_row_memory_type(SHV_ROW_LEDGER);
    case TYPE_PROGRESS:
        return file ? shv_row_file_type(SHV_ROW_PROGRESS) : shv_row_memory_type(SHV_ROW_PROGRESS);
    case TYPE_FRAGMENT:
        return file ? shv_row_file_type(SHV_ROW_FRAGMENT) : shv_row_memory_type(SHV_ROW_FRAGMENT);
    case TYPE_SUM:
        return file ? shv_row_file_type(SHV_ROW_SUM) : shv_row_memory_type(SHV_ROW_SUM);
    case TYPE_EVENT:
        break;
    }
    return file ? shv_row_file_type(SHV_ROW_EVENT) : shv_row_memory_type(SHV_ROW_EVENT);
}

static size_t size_of(hid_t type, const Kind *kind)
{
    return (type >= 0 ? H5Tget_size(type) : 0) * (size_t)(kind->components > 0 ? kind->components : 1);
}

static void describe(ShvSeries *series, ShvSeriesName name)
{
    const Kind *kind = &KINDS[name];
    *series = (ShvSeries){.dataset = -1, .name = name};
    series->width = kind->width;
    series->rank = 1 + (kind->width != SHV_WIDTH_NONE) + (kind->components > 0);
    series->doubles = kind->type == TYPE_DOUBLE || kind->type == TYPE_FLOAT;
    series->memory_type = make_type(kind->type, false);
    series->file_type = make_type(kind->type, true);
    series->entry_size = size_of(series->memory_type, kind);
    series->stored_size = size_of(series->file_type, kind);
}

/* ---- making ---- */

static hsize_t chunk_columns(const Kind *kind, const ShvWidths *widths)
{
    const int64_t count = widths->count[kind->width];
    const int64_t most = kind->width == SHV_WIDTH_ELEMENT ? 4096 : 2048;
    return (hsize_t)(count < 1 ? 1 : count > most ? most : count);
}

static hid_t creation_list(const Kind *kind, int rank, const hsize_t *chunk)
{
    const double nan_value = (double)NAN;
    const hid_t list = H5Pcreate(H5P_DATASET_CREATE);
    if (list < 0) return list;
    bool good = H5Pset_chunk(list, rank, chunk) >= 0 && H5Pset_obj_track_times(list, false) >= 0;
    if (kind->type == TYPE_DOUBLE || kind->type == TYPE_FLOAT)
        good = good && H5Pset_fill_value(list, H5T_NATIVE_DOUBLE, &nan_value) >= 0;
    if (good && shv_filters_put(list, kind->compressed)) return list;
    H5Pclose(list);
    return -1;
}

static hid_t make_dataset(const ShvSeries *series, hid_t file, const Kind *kind, const hsize_t *chunk)
{
    const hsize_t *extent = series->extent;
    const hsize_t most[3] = {H5S_UNLIMITED, kind->width != SHV_WIDTH_NONE && extent[1] == 0 ? H5S_UNLIMITED : extent[1],
                             extent[2]};
    const hid_t space = H5Screate_simple(series->rank, extent, most);
    const hid_t list = creation_list(kind, series->rank, chunk);
    hid_t dataset = -1;
    if (space >= 0 && list >= 0)
        dataset = H5Dcreate2(file, kind->path, series->file_type, space, H5P_DEFAULT, list, H5P_DEFAULT);
    if (list >= 0) H5Pclose(list);
    if (space >= 0) H5Sclose(space);
    return dataset;
}

bool shv_series_create(ShvSeries *series, hid_t file, ShvSeriesName name, const ShvWidths *widths)
{
    const Kind *kind = &KINDS[name];
    describe(series, name);
    if (series->memory_type < 0 || series->file_type < 0) return false;
    hsize_t chunk[3] = {kind->compressed ? 1 : ROWS_A_CHUNK, 1, 1};
    int last = 1;
    if (kind->width != SHV_WIDTH_NONE) {
        series->extent[1] = kind->width == SHV_WIDTH_FRAGMENT ? 0 : (hsize_t)widths->count[kind->width];
        chunk[1] = chunk_columns(kind, widths);
        last = 2;
    }
    if (kind->components > 0) series->extent[last] = chunk[last] = (hsize_t)kind->components;
    series->dataset = make_dataset(series, file, kind, chunk);
    return series->dataset >= 0;
}

/* ---- opening ---- */

/* Types agree when HDF5 converts the one to the other and they are of one class; a compound converts field by field. */
static bool types_agree(const ShvSeries *series)
{
    const hid_t found = H5Dget_type(series->dataset);
    const bool good = found >= 0 && H5Tequal(found, series->file_type) > 0;
    if (found >= 0) H5Tclose(found);
    return good;
}

static bool shape_agrees(ShvSeries *series, const Kind *kind)
{
    const hid_t space = H5Dget_space(series->dataset);
    if (space < 0) return false;
    bool good = H5Sget_simple_extent_ndims(space) == series->rank &&
                H5Sget_simple_extent_dims(space, series->extent, NULL) == series->rank;
    H5Sclose(space);
    if (kind->components > 0) good = good && series->extent[series->rank - 1] == (hsize_t)kind->components;
    good = good && series->extent[0] <= INT64_C(1) << 40;
    for (int i = 1; i < series->rank; i++) good = good && series->extent[i] <= INT32_MAX;
    return good;
}

bool shv_series_open(ShvSeries *series, hid_t file, ShvSeriesName name)
{
    describe(series, name);
    if (series->memory_type < 0 || series->file_type < 0) return false;
    series->dataset = H5Dopen2(file, KINDS[name].path, H5P_DEFAULT);
    return series->dataset >= 0 && types_agree(series) && shape_agrees(series, &KINDS[name]) &&
           shv_filters_agree(series->dataset, KINDS[name].compressed);
}

void shv_series_close(ShvSeries *series)
{
    if (series->dataset >= 0) H5Dclose(series->dataset);
    if (series->memory_type >= 0) H5Tclose(series->memory_type);
    if (series->file_type >= 0) H5Tclose(series->file_type);
    shv_release(series->stored);
    *series = (ShvSeries){.dataset = -1, .memory_type = -1, .file_type = -1};
}

/* ---- entries ---- */

typedef herr_t (*Transfer)(hid_t dataset, hid_t type, hid_t memory, hid_t file, void *data);

static herr_t read_selected(hid_t dataset, hid_t type, hid_t memory, hid_t file, void *data)
{
    return H5Dread(dataset, type, memory, file, H5P_DEFAULT, data);
}

static herr_t write_selected(hid_t dataset, hid_t type, hid_t memory, hid_t file, void *data)
{
    return H5Dwrite(dataset, type, memory, file, H5P_DEFAULT, data);
}

static bool transfer(const ShvSeries *series, hid_t type, int64_t begin, int64_t count, int64_t columns, void *data,
                     Transfer move)
{
    const hsize_t start[3] = {(hsize_t)begin, 0, 0};
    hsize_t size[3] = {(hsize_t)count, series->extent[1], series->extent[2]};
    if (series->width != SHV_WIDTH_NONE) size[1] = (hsize_t)columns;
    const hid_t file = H5Dget_space(series->dataset), memory = H5Screate_simple(series->rank, size, NULL);
    const bool good = file >= 0 && memory >= 0 &&
                      H5Sselect_hyperslab(file, H5S_SELECT_SET, start, NULL, size, NULL) >= 0 &&
                      move(series->dataset, type, memory, file, data) >= 0;
    if (memory >= 0) H5Sclose(memory);
    if (file >= 0) H5Sclose(file);
    return good;
}

static bool reading(const ShvSeries *series, hid_t type, int64_t begin, int64_t count, int64_t columns, void *data)
{
    return shv_chunks_sound(series->dataset, begin, count) &&
           transfer(series, type, begin, count, columns, data, read_selected);
}

static size_t entries_of(const ShvSeries *series, int64_t count, int64_t columns)
{
    return (size_t)(series->width == SHV_WIDTH_NONE ? count : count * columns);
}

/* ---- as it lies in the file ---- */

static ShvRow row_of(Type type)
{
    switch (type) {
    case TYPE_LEDGER:
        return SHV_ROW_LEDGER;
    case TYPE_PROGRESS:
        return SHV_ROW_PROGRESS;
    case TYPE_FRAGMENT:
        return SHV_ROW_FRAGMENT;
    case TYPE_SUM:
        return SHV_ROW_SUM;
    default:
        return SHV_ROW_EVENT;
    }
}

static bool make_stored(ShvSeries *series, size_t size)
{
    if (size <= series->room) return true;
    unsigned char *grown = shv_reallocate(NULL, SHV_PART_RECORD, series->stored, size, 1);
    if (!grown) return false;
    series->stored = grown;
    series->room = size;
    return true;
}

/* NULL when memory is out. */
static void *stored_form(ShvSeries *series, size_t entries, const void *data)
{
    const Kind *kind = &KINDS[series->name];
    const bool row = kind->type >= TYPE_LEDGER;
    if (!row && kind->type != TYPE_FLOAT) return (void *)(uintptr_t)data;
    if (!make_stored(series, entries * series->stored_size + 1)) return NULL;
    if (row) {
        shv_row_pack(row_of(kind->type), data, entries, series->stored);
        return series->stored;
    }
    const double *values = data;
    float *stored = (float *)(void *)series->stored;
    for (size_t i = 0; i < entries * (series->entry_size / sizeof *values); i++) stored[i] = (float)values[i];
    return series->stored;
}

bool shv_series_write(ShvSeries *series, int64_t begin, int64_t count, int64_t columns, const void *data, uint32_t *sum)
{
    hsize_t extent[3];
    memcpy(extent, series->extent, sizeof extent);
    if (extent[0] < (hsize_t)(begin + count)) extent[0] = (hsize_t)(begin + count);
    if (series->width != SHV_WIDTH_NONE && extent[1] < (hsize_t)columns) extent[1] = (hsize_t)columns;
    if (memcmp(extent, series->extent, sizeof extent) != 0) {
        if (H5Dset_extent(series->dataset, extent) < 0) return false;
        memcpy(series->extent, extent, sizeof extent);
    }
    const size_t entries = entries_of(series, count, columns);
    if (entries == 0) return true;
    void *stored = stored_form(series, entries, data);
    if (!stored) return false;
    if (sum) *sum = (uint32_t)crc32_z(*sum, stored, entries * series->stored_size);
    return transfer(series, series->file_type, begin, count, columns, stored, write_selected);
}

bool shv_series_cut(ShvSeries *series, int64_t count, int64_t fragments)
{
    hsize_t extent[3];
    memcpy(extent, series->extent, sizeof extent);
    extent[0] = (hsize_t)count;
    if (series->width == SHV_WIDTH_FRAGMENT) extent[1] = (hsize_t)fragments;
    if (memcmp(extent, series->extent, sizeof extent) == 0) return true;
    for (int i = 0; i < series->rank; i++)
        if (extent[i] > series->extent[i]) return false;
    if (H5Dset_extent(series->dataset, extent) < 0) return false;
    memcpy(series->extent, extent, sizeof extent);
    return true;
}

bool shv_series_sum(const ShvSeries *series, int64_t begin, int64_t count, int64_t columns, uint32_t *sum)
{
    const size_t entries = entries_of(series, count, columns), size = entries * series->stored_size;
    if (entries == 0) return true;
    if (begin < 0 || (hsize_t)(begin + count) > series->extent[0]) return false;
    if (series->width != SHV_WIDTH_NONE && (hsize_t)columns > series->extent[1]) return false;
    unsigned char *stored = shv_allocate(NULL, SHV_PART_RECORD, size, 1);
    const bool good = stored && reading(series, series->file_type, begin, count, columns, stored);
    if (good) *sum = (uint32_t)crc32_z(*sum, stored, size);
    shv_release(stored);
    return good;
}

static void fill_missing(const ShvSeries *series, void *data, size_t entries)
{
    if (series->doubles) {
        double *values = data;
        for (size_t i = 0; i < entries * (series->entry_size / sizeof(double)); i++) values[i] = (double)NAN;
    } else {
        memset(data, 0, entries * series->entry_size);
    }
}

bool shv_series_read(const ShvSeries *series, int64_t begin, int64_t count, int64_t columns, void *data)
{
    const bool wide = series->width != SHV_WIDTH_NONE;
    const int64_t stored = wide && (int64_t)series->extent[1] < columns ? (int64_t)series->extent[1] : columns;
    const size_t row = wide ? (size_t)columns * series->entry_size : series->entry_size;
    fill_missing(series, data, wide ? (size_t)(count * columns) : (size_t)count);
    if (begin < 0 || (hsize_t)(begin + count) > series->extent[0]) return false;
    if (wide && stored == 0) return true;
    if (!wide || stored == columns)
        return count == 0 || reading(series, series->memory_type, begin, count, columns, data);
    for (int64_t i = 0; i < count; i++)
        if (!reading(series, series->memory_type, begin + i, 1, stored, (char *)data + (size_t)i * row)) return false;
    return true;
}

bool shv_series_plausible(const ShvSeries *series, int64_t file_bytes)
{
    const double columns = series->width == SHV_WIDTH_NONE ? 1.0 : (double)series->extent[1];
    const double one = (double)series->entry_size * columns, most = 1100.0 * (double)file_bytes + 1e6;
    return one <= most && (double)series->extent[0] * (double)sizeof(double) <= most;
}
