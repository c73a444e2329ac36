/* Files of reader tests: small files written to a folder of their own, cut off and corrupted on purpose. */
#ifndef SHV_TESTS_MESH_FILES_H
#define SHV_TESTS_MESH_FILES_H

#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/file.h"
#include "base/random.h"
#include "mesh/mesh.h"

typedef struct Bytes {
    char *data;
    size_t size;
} Bytes;

/* A file "stem.extension" in a fresh folder. */
typedef struct TemporaryFile {
    char folder[256];
    char path[320];
} TemporaryFile;

static inline TemporaryFile temporary_file(const char *name)
{
    TemporaryFile file;
    const char *base = getenv("TMPDIR");
    snprintf(file.folder, sizeof file.folder, "%.200s/shiver_test_XXXXXX", base ? base : "/tmp");
    assert_non_null(mkdtemp(file.folder));
    snprintf(file.path, sizeof file.path, "%s/%s", file.folder, name);
    return file;
}

static inline void remove_temporary_file(const TemporaryFile *file)
{
    unlink(file->path);
    assert_int_equal(rmdir(file->folder), 0);
}

static inline void write_bytes(const char *path, const void *data, size_t size)
{
    FILE *out = fopen(path, "wb");
    assert_non_null(out);
    assert_int_equal(fwrite(data, 1, size, out), size);
    assert_int_equal(fclose(out), 0);
}

static inline Bytes read_bytes(const char *path)
{
    Bytes bytes;
    ShvError error;
    check_ok(shv_read_file(NULL, SHV_PART_GENERAL, path, 1 << 20, &bytes.data, &bytes.size, &error), error);
    return bytes;
}

/* Reads the file at a path and releases the result; whatever it checks of a mesh that was read is its own business. */
typedef ShvStatus (*ReadOnce)(ShvMemory *memory, const char *path, ShvError *error);

/* No result may depend on bytes that are not there, or allocate by announced counts: the peak stays within 64 bytes
   a byte of the file (a tet takes 48 bytes from at least 9, arrays double, and are copied when they do) and 64 KiB. */
static inline void read_and_count(ReadOnce read, ShvMemory *memory, const char *path, size_t size, ShvStatus *status)
{
    ShvError error = {0};
    *status = read(memory, path, &error);
    assert_true(*status == SHV_OK || *status == SHV_BAD_INPUT);
    if (*status != SHV_OK) assert_true(strlen(error.message) > 0);
    assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
    assert_true(shv_memory_peak_bytes(memory, SHV_PART_COUNT) <= 64 * size + 65536);
}

/* Reads the file cut off after every byte up to `size`; all that are shorter than `complete` must be refused. */
static inline void check_truncations(ReadOnce read, Bytes bytes, const char *name, size_t complete)
{
    const TemporaryFile file = temporary_file(name);
    write_bytes(file.path, bytes.data, bytes.size);
    for (size_t size = bytes.size; size-- > 0;) {
        ShvStatus status;
        ShvMemory *memory = shv_memory_create();
        assert_int_equal(truncate(file.path, (off_t)size), 0);
        read_and_count(read, memory, file.path, bytes.size, &status);
        if (size < complete && status == SHV_OK) fail_msg("%s cut off after %zu bytes was read", name, size);
        shv_memory_destroy(memory);
    }
    remove_temporary_file(&file);
}

/* Reads the file with one to three bytes changed at random. */
static inline void check_corruptions(ReadOnce read, Bytes bytes, const char *name, int trials)
{
    const TemporaryFile file = temporary_file(name);
    char *copy = malloc(bytes.size);
    assert_non_null(copy);
    for (uint64_t trial = 0; trial < (uint64_t)trials; trial++) {
        ShvStatus status;
        ShvMemory *memory = shv_memory_create();
        memcpy(copy, bytes.data, bytes.size);
        for (uint64_t change = 0; change <= trial % 3; change++) {
            const uint64_t draw = shv_random_bits(trial, change);
            /* Half of the time a digit, which keeps the file plausible. */
            copy[draw % bytes.size] = (char)(draw >> 63 ? '0' + (draw >> 40) % 10 : draw >> 32);
        }
        write_bytes(file.path, copy, bytes.size);
        read_and_count(read, memory, file.path, bytes.size, &status);
        shv_memory_destroy(memory);
    }
    free(copy);
    remove_temporary_file(&file);
}

/* Every allocation fails in turn, and the reader says so and leaks nothing. */
static inline void check_allocation_failures(ReadOnce read, const char *path)
{
    for (int64_t allowed = 0;; allowed++) {
        ShvError error;
        ShvMemory *memory = shv_memory_create();
        shv_memory_fail_after(memory, allowed);
        const ShvStatus status = read(memory, path, &error);
        assert_int_equal(shv_memory_bytes(memory, SHV_PART_COUNT), 0);
        shv_memory_destroy(memory);
        if (status == SHV_OK) {
            assert_true(allowed > 2);
            return;
        }
        assert_int_equal(status, SHV_NO_MEMORY);
    }
}

/* A file of this text must fail with a message that contains `part`. */
static inline void check_text_fails(ReadOnce read, const char *name, const char *text, const char *part)
{
    ShvError error = {0};
    const TemporaryFile file = temporary_file(name);
    write_bytes(file.path, text, strlen(text));
    check_fails(read(NULL, file.path, &error), SHV_BAD_INPUT, error, part);
    remove_temporary_file(&file);
}

/* What a reader promises of a mesh it gives, whatever the file. */
static inline void check_mesh_sound(const ShvMesh *mesh)
{
    assert_true(mesh->node_count >= 4 && mesh->element_count >= 1);
    for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++) assert_true(isfinite(mesh->positions[i]));
    for (int64_t i = 0; i < 4 * (int64_t)mesh->element_count; i++)
        assert_in_range(mesh->elements[i], 0, mesh->node_count - 1);
    for (int32_t e = 0; e < mesh->element_count; e++) assert_true(shv_mesh_element_volume(mesh, e) > 0.0);
}

static inline double mesh_volume(const ShvMesh *mesh)
{
    double volume = 0.0;
    for (int32_t e = 0; e < mesh->element_count; e++) volume += shv_mesh_element_volume(mesh, e);
    return volume;
}

#endif
