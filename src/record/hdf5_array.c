#include "record/hdf5_array.h"

#include <zlib.h>

#include "base/memory.h"

bool shv_group_put(hid_t file, const char *path)
{
    const hid_t list = H5Pcreate(H5P_GROUP_CREATE);
    if (list < 0) return false;
    hid_t group = -1;
    if (H5Pset_obj_track_times(list, false) >= 0) group = H5Gcreate2(file, path, H5P_DEFAULT, list, H5P_DEFAULT);
    H5Pclose(list);
    return group >= 0 && H5Gclose(group) >= 0;
}

bool shv_filters_put(hid_t creation, bool compressed)
{
    return (!compressed || (H5Pset_shuffle(creation) >= 0 && H5Pset_deflate(creation, 1) >= 0)) &&
           H5Pset_fletcher32(creation) >= 0;
}

/* The filters as they are applied in writing. */
static int expected_filters(bool compressed, H5Z_filter_t filters[3])
{
    int count = 0;
    if (compressed) {
        filters[count++] = H5Z_FILTER_SHUFFLE;
        filters[count++] = H5Z_FILTER_DEFLATE;
    }
    filters[count++] = H5Z_FILTER_FLETCHER32;
    return count;
}

bool shv_filters_agree(hid_t dataset, bool compressed)
{
    H5Z_filter_t wanted[3];
    const int count = expected_filters(compressed, wanted);
    const hid_t list = H5Dget_create_plist(dataset);
    bool good = list >= 0 && H5Pget_layout(list) == H5D_CHUNKED && H5Pget_nfilters(list) == count;
    for (int i = 0; good && i < count; i++) {
        size_t values = 0;
        unsigned flags, configuration;
        good = H5Pget_filter2(list, (unsigned)i, &flags, &values, NULL, 0, NULL, &configuration) == wanted[i];
    }
    if (list >= 0) H5Pclose(list);
    return good;
}

/* ---- chunks ---- */

enum { MOST_DIMENSIONS = 3, CHECKSUM_BYTES = 4 };

typedef struct Chunks {
    hid_t dataset;
    int rank;
    hsize_t extent[MOST_DIMENSIONS], size[MOST_DIMENSIONS];
    size_t bytes; /* of a chunk, without filters */
    bool compressed;
} Chunks;

static bool look_at(Chunks *chunks, hid_t dataset)
{
    const hid_t list = H5Dget_create_plist(dataset), space = H5Dget_space(dataset), type = H5Dget_type(dataset);
    bool good = list >= 0 && space >= 0 && type >= 0;
    chunks->dataset = dataset;
    chunks->rank = good ? H5Sget_simple_extent_ndims(space) : 0;
    good = good && chunks->rank >= 1 && chunks->rank <= MOST_DIMENSIONS &&
           H5Sget_simple_extent_dims(space, chunks->extent, NULL) == chunks->rank &&
           H5Pget_chunk(list, chunks->rank, chunks->size) == chunks->rank;
    chunks->bytes = good ? H5Tget_size(type) : 0;
    for (int i = 0; good && i < chunks->rank; i++) {
        good = chunks->size[i] > 0 && chunks->size[i] <= UINT32_MAX / (chunks->bytes ? chunks->bytes : 1);
        chunks->bytes *= (size_t)chunks->size[i];
    }
    chunks->compressed = good && H5Pget_nfilters(list) > 1;
    if (type >= 0) H5Tclose(type);
    if (space >= 0) H5Sclose(space);
    if (list >= 0) H5Pclose(list);
    return good;
}

static bool inflates(const unsigned char *stored, size_t size, size_t bytes)
{
    unsigned char *plain = shv_allocate(NULL, SHV_PART_RECORD, bytes, 1);
    uLongf length = bytes;
    const bool good = plain && uncompress(plain, &length, stored, size) == Z_OK && length == bytes;
    shv_release(plain);
    return good;
}

/* Bytes of a chunk in the file, 0: it has never been written. HDF5 1.10 tells the place of a chunk by looking at all of them;
   its size it tells at once, but fails where there is none. */
static bool chunk_size(const Chunks *chunks, const hsize_t *offset, hsize_t *size)
{
    unsigned left_out;
    haddr_t address = HADDR_UNDEF;
    if (H5Dget_chunk_storage_size(chunks->dataset, offset, size) >= 0) return true;
    if (H5Dget_chunk_info_by_coord(chunks->dataset, offset, &left_out, &address, size) < 0) return false;
    if (address == HADDR_UNDEF) *size = 0;
    return true;
}

/* A chunk as it lies in the file; *stored is NULL and *size 0 where it has never been written. */
static bool read_chunk(const Chunks *chunks, const hsize_t *offset, unsigned char **stored, hsize_t *size,
                       uint32_t *left_out)
{
    *stored = NULL;
    *left_out = 0;
    if (!chunk_size(chunks, offset, size)) return false;
    if (*size == 0) return true;
    if (*size > 2 * chunks->bytes + 1024) return false;
    *stored = shv_allocate(NULL, SHV_PART_RECORD, *size, 1);
    return *stored && H5Dread_chunk(chunks->dataset, H5P_DEFAULT, offset, left_out, *stored) >= 0;
}

/* A chunk that has never been written reads as fill values. */
static bool chunk_sound(const Chunks *chunks, const hsize_t *offset)
{
    unsigned char *stored;
    uint32_t left_out;
    hsize_t size = 0;
    bool good = read_chunk(chunks, offset, &stored, &size, &left_out);
    if (good && size > 0) {
        good = left_out == 0 && size > CHECKSUM_BYTES;
        if (chunks->compressed)
            good = good && inflates(stored, size - CHECKSUM_BYTES, chunks->bytes);
        else
            good = good && size == chunks->bytes + CHECKSUM_BYTES;
    }
    shv_release(stored);
    return good;
}

typedef bool (*Visit)(const Chunks *chunks, const hsize_t *offset);

/* The chunks of entries [begin, end). */
static bool each_chunk(const Chunks *chunks, hsize_t begin, hsize_t end, Visit visit)
{
    hsize_t offset[MOST_DIMENSIONS] = {0};
    const hsize_t columns = chunks->rank > 1 ? chunks->extent[1] : 1, step = chunks->rank > 1 ? chunks->size[1] : 1;
    for (offset[0] = begin / chunks->size[0] * chunks->size[0]; offset[0] < end; offset[0] += chunks->size[0])
        for (offset[1] = 0; offset[1] < columns; offset[1] += step)
            if (!visit(chunks, offset)) return false;
    return true;
}

bool shv_chunks_sound(hid_t dataset, int64_t begin, int64_t count)
{
    Chunks chunks;
    return look_at(&chunks, dataset) && each_chunk(&chunks, (hsize_t)begin, (hsize_t)(begin + count), chunk_sound);
}

static bool touch(const Chunks *chunks, const hsize_t *offset)
{
    unsigned char *stored;
    uint32_t left_out;
    hsize_t size = 0;
    const bool good = read_chunk(chunks, offset, &stored, &size, &left_out);
    shv_release(stored);
    return good;
}

bool shv_chunks_touch(hid_t dataset)
{
    Chunks chunks;
    return look_at(&chunks, dataset) &&
           each_chunk(&chunks, 0, chunks.extent[0] / chunks.size[0] * chunks.size[0], touch);
}

/* ---- arrays ---- */

bool shv_array_put(hid_t file, const char *path, hid_t file_type, hid_t memory_type, int64_t rows, int64_t columns,
                   bool compressed, const void *data, hid_t *dataset)
{
    const hsize_t extent[2] = {(hsize_t)rows, (hsize_t)columns},
                  chunk[2] = {rows < 8192 ? (hsize_t)rows : 8192, extent[1]};
    const int rank = columns > 0 ? 2 : 1;
    const hid_t space = H5Screate_simple(rank, extent, NULL), list = H5Pcreate(H5P_DATASET_CREATE);
    bool good = space >= 0 && list >= 0 && H5Pset_obj_track_times(list, false) >= 0;
    if (good && rows > 0) good = H5Pset_chunk(list, rank, chunk) >= 0 && shv_filters_put(list, compressed);
    const hid_t made = good ? H5Dcreate2(file, path, file_type, space, H5P_DEFAULT, list, H5P_DEFAULT) : -1;
    good = made >= 0 && (!data || rows == 0 || H5Dwrite(made, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0);
    if (list >= 0) H5Pclose(list);
    if (space >= 0) H5Sclose(space);
    if (dataset)
        *dataset = made;
    else if (made >= 0)
        H5Dclose(made);
    return good;
}
