#include "record/hdf5_text.h"

#include <string.h>
#include <zlib.h>

ShvSilence shv_silence_begin(void)
{
    ShvSilence silence = {NULL, NULL, false};
    silence.saved = H5Eget_auto2(H5E_DEFAULT, &silence.function, &silence.data) >= 0;
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    (void)shv_memory_missed(); /* what failed before is no reason for what fails now */
    return silence;
}

void shv_silence_end(ShvSilence silence)
{
    if (silence.saved) H5Eset_auto2(H5E_DEFAULT, silence.function, silence.data);
}

hid_t shv_text_type(size_t size)
{
    const hid_t type = H5Tcopy(H5T_C_S1);
    if (type < 0) return type;
    if (H5Tset_size(type, size) >= 0 && H5Tset_strpad(type, H5T_STR_NULLTERM) >= 0 &&
        H5Tset_cset(type, H5T_CSET_UTF8) >= 0)
        return type;
    H5Tclose(type);
    return -1;
}

static bool put_attribute(hid_t object, const char *name, hid_t file_type, hid_t memory_type, const void *value)
{
    const hid_t space = H5Screate(H5S_SCALAR);
    if (space < 0) return false;
    const hid_t attribute = H5Acreate2(object, name, file_type, space, H5P_DEFAULT, H5P_DEFAULT);
    bool good = attribute >= 0;
    if (good) {
        good = H5Awrite(attribute, memory_type, value) >= 0;
        good = H5Aclose(attribute) >= 0 && good;
    }
    H5Sclose(space);
    return good;
}

/* The text as it lies in the file: cut or filled with zeros to `size` bytes. HDF5 converts no shorter text by itself. */
static bool write_text(hid_t attribute, const char *text, size_t size)
{
    char *padded = shv_allocate(NULL, SHV_PART_RECORD, size, 1);
    if (!padded) return false;
    strncpy(padded, text, size - 1);
    const hid_t type = shv_text_type(size);
    const bool good = type >= 0 && H5Awrite(attribute, type, padded) >= 0;
    if (type >= 0) H5Tclose(type);
    shv_release(padded);
    return good;
}

bool shv_attribute_put_text(hid_t object, const char *name, const char *text, size_t size)
{
    const size_t wanted = strlen(text) + 1;
    const size_t bytes = wanted > size ? wanted : size;
    const hid_t type = shv_text_type(bytes), space = H5Screate(H5S_SCALAR);
    bool good = type >= 0 && space >= 0;
    if (good) {
        const hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
        good = attribute >= 0 && write_text(attribute, text, bytes);
        if (attribute >= 0) H5Aclose(attribute);
    }
    if (space >= 0) H5Sclose(space);
    if (type >= 0) H5Tclose(type);
    return good;
}

/* Size of a fixed-length text attribute, 0 for any other kind. Beyond 64 KiB no attribute of ours is. */
static size_t text_size(hid_t attribute)
{
    const hid_t type = H5Aget_type(attribute), space = H5Aget_space(attribute);
    size_t size = 0;
    if (type >= 0 && space >= 0 && H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) == 0 &&
        H5Sget_simple_extent_npoints(space) == 1)
        size = H5Tget_size(type);
    if (type >= 0) H5Tclose(type);
    if (space >= 0) H5Sclose(space);
    return size <= 65536 ? size : 0;
}

bool shv_attribute_set_text(hid_t object, const char *name, const char *text)
{
    const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    if (attribute < 0) return false;
    const size_t size = text_size(attribute);
    const bool good = size > 0 && write_text(attribute, text, size);
    H5Aclose(attribute);
    return good;
}

bool shv_attribute_put_number(hid_t object, const char *name, hid_t file_type, hid_t memory_type, const void *value)
{
    return put_attribute(object, name, file_type, memory_type, value);
}

bool shv_attribute_get_text(hid_t object, const char *name, char *text, size_t size)
{
    const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    if (attribute < 0) return false;
    const size_t stored = text_size(attribute);
    char *whole = stored > 0 ? shv_allocate(NULL, SHV_PART_RECORD, stored + 1, 1) : NULL;
    const hid_t type = whole ? shv_text_type(stored + 1) : -1;
    const bool good = type >= 0 && H5Aread(attribute, type, whole) >= 0;
    if (good) {
        text[0] = '\0';
        strncat(text, whole, size - 1);
    }
    if (type >= 0) H5Tclose(type);
    shv_release(whole);
    H5Aclose(attribute);
    return good;
}

bool shv_attribute_get_number(hid_t object, const char *name, hid_t memory_type, H5T_class_t class, void *value)
{
    const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    if (attribute < 0) return false;
    const hid_t type = H5Aget_type(attribute), space = H5Aget_space(attribute);
    const bool good = type >= 0 && space >= 0 && H5Tget_class(type) == class &&
                      H5Sget_simple_extent_npoints(space) == 1 && H5Aread(attribute, memory_type, value) >= 0;
    if (type >= 0) H5Tclose(type);
    if (space >= 0) H5Sclose(space);
    H5Aclose(attribute);
    return good;
}

bool shv_dataset_put_text(hid_t group, const char *path, const char *text)
{
    const size_t size = strlen(text) + 1;
    const int64_t sum = (int64_t)crc32_z(0, (const unsigned char *)text, size);
    const hid_t type = shv_text_type(size), space = H5Screate(H5S_SCALAR), list = H5Pcreate(H5P_DATASET_CREATE);
    bool good = type >= 0 && space >= 0 && list >= 0 && H5Pset_obj_track_times(list, false) >= 0;
    if (good) {
        const hid_t dataset = H5Dcreate2(group, path, type, space, H5P_DEFAULT, list, H5P_DEFAULT);
        good = dataset >= 0 && H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text) >= 0 &&
               shv_attribute_put_number(dataset, "checksum", H5T_STD_I64LE, H5T_NATIVE_INT64, &sum);
        if (dataset >= 0) H5Dclose(dataset);
    }
    if (list >= 0) H5Pclose(list);
    if (space >= 0) H5Sclose(space);
    if (type >= 0) H5Tclose(type);
    return good;
}
