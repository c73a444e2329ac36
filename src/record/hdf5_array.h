/* Whole arrays that are written once. */
#ifndef SHV_RECORD_HDF5_ARRAY_H
#define SHV_RECORD_HDF5_ARRAY_H

#include <hdf5.h>
#include <stdbool.h>
#include <stdint.h>

/* A group, without the time of its making: equal runs give equal files. */
bool shv_group_put(hid_t file, const char *path);
/* The filters of all chunks: a checksum (Fletcher-32), and before it shuffling and deflate where `compressed`. */
bool shv_filters_put(hid_t creation, bool compressed);
/* Whether a dataset that was found has these filters, and chunks no larger than its extent in the last dimensions. */
bool shv_filters_agree(hid_t dataset, bool compressed);
/* Whether the chunks of entries [begin, begin + count) hold as many bytes as they say: HDF5 1.10 reads beyond the end of one
   that inflates to less, or of which a filter is left out. */
bool shv_chunks_sound(hid_t dataset, int64_t begin, int64_t count);
/* Reads each chunk whose entries are all there, as it lies in the file, for a driver that notes where they are: HDF5 1.10 tells the
   place of one chunk by looking at all. False when HDF5 fails. */
bool shv_chunks_touch(hid_t dataset);

/* A dataset of (rows, columns), or (rows) when `columns` is 0; data NULL: space only. The caller closes *dataset, or gives
   NULL. False when HDF5 fails; *dataset is then negative or to be closed all the same. */
bool shv_array_put(hid_t file, const char *path, hid_t file_type, hid_t memory_type, int64_t rows, int64_t columns,
                   bool compressed, const void *data, hid_t *dataset);

#endif
