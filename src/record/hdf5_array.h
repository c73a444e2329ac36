/* Whole arrays that are written once. */
#ifndef SHV_RECORD_HDF5_ARRAY_H
#define SHV_RECORD_HDF5_ARRAY_H

#include <hdf5.h>
#include <stdbool.h>
#include <stdint.h>

/* A group, without the time of its making: equal runs give equal files. */
bool shv_group_put(hid_t file, const char *path);
/* A dataset of (rows, columns), or (rows) when `columns` is 0; data NULL: space only. The caller closes *dataset, or gives
   NULL. False when HDF5 fails; *dataset is then negative or to be closed all the same. */
bool shv_array_put(hid_t file, const char *path, hid_t file_type, hid_t memory_type, int64_t rows, int64_t columns,
                   bool compressed, const void *data, hid_t *dataset);

#endif
