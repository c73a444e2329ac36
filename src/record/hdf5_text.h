/* Small helpers over HDF5: silence, text and number attributes. */
#ifndef SHV_RECORD_HDF5_TEXT_H
#define SHV_RECORD_HDF5_TEXT_H

#include <hdf5.h>
#include <stdbool.h>
#include <stdint.h>

#include "base/memory.h"

/* HDF5 prints its errors by itself; between these two calls it does not. The caller's setting comes back. */
typedef struct ShvSilence {
    H5E_auto2_t function;
    void *data;
    bool saved;
} ShvSilence;
ShvSilence shv_silence_begin(void);
void shv_silence_end(ShvSilence silence);

/* A terminated string type of `size` bytes; the caller closes it. */
hid_t shv_text_type(size_t size);
/* Attributes of an object. A text takes `size` bytes in the file, at least its own length and one: it can be changed to
   any text up to that size without new space. */
bool shv_attribute_put_text(hid_t object, const char *name, const char *text, size_t size);
bool shv_attribute_set_text(hid_t object, const char *name, const char *text);
bool shv_attribute_put_number(hid_t object, const char *name, hid_t file_type, hid_t memory_type, const void *value);
/* False when it is missing or of another kind; texts are cut to `size`. */
bool shv_attribute_get_text(hid_t object, const char *name, char *text, size_t size);
bool shv_attribute_get_number(hid_t object, const char *name, hid_t memory_type, H5T_class_t class, void *value);

/* A scalar dataset that holds a text, with the CRC-32 of its bytes and terminator as attribute "checksum". */
bool shv_dataset_put_text(hid_t group, const char *path, const char *text);

#endif
