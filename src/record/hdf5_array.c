#include "record/hdf5_array.h"

bool shv_group_put(hid_t file, const char *path)
{
    const hid_t list = H5Pcreate(H5P_GROUP_CREATE);
    if (list < 0) return false;
    hid_t group = -1;
    if (H5Pset_obj_track_times(list, false) >= 0) group = H5Gcreate2(file, path, H5P_DEFAULT, list, H5P_DEFAULT);
    H5Pclose(list);
    return group >= 0 && H5Gclose(group) >= 0;
}

bool shv_array_put(hid_t file, const char *path, hid_t file_type, hid_t memory_type, int64_t rows, int64_t columns,
                   bool compressed, const void *data, hid_t *dataset)
{
    const hsize_t extent[2] = {(hsize_t)rows, (hsize_t)columns},
                  chunk[2] = {rows < 8192 ? (hsize_t)rows : 8192, extent[1]};
    const int rank = columns > 0 ? 2 : 1;
    const hid_t space = H5Screate_simple(rank, extent, NULL), list = H5Pcreate(H5P_DATASET_CREATE);
    bool good = space >= 0 && list >= 0 && H5Pset_obj_track_times(list, false) >= 0;
    if (good && compressed && rows > 0)
        good = H5Pset_chunk(list, rank, chunk) >= 0 && H5Pset_shuffle(list) >= 0 && H5Pset_deflate(list, 1) >= 0;
    if (good && !compressed) good = H5Pset_alloc_time(list, H5D_ALLOC_TIME_EARLY) >= 0;
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
