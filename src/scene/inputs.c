#include "scene/inputs.h"

#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "base/text.h"

typedef struct Reading {
    ShvMemory *memory;
    const char *folder;
    uint64_t *hash;
} Reading;

static ShvStatus hash_file(const Reading *reading, const char *file, const char *ending, ShvError *error)
{
    char *path, *data;
    size_t size;
    char name[1024];
    if (!file) return SHV_OK;
    shv_format(name, sizeof name, "%s%s", file, ending);
    SHV_TRY(shv_path_join(reading->memory, SHV_PART_GENERAL, reading->folder, name, &path, error));
    const ShvStatus status =
        shv_read_file(reading->memory, SHV_PART_GENERAL, path, (size_t)1 << 30, &data, &size, error);
    if (status == SHV_OK) *reading->hash = shv_hash_bytes(*reading->hash, data, size);
    shv_release(data);
    shv_release(path);
    return status == SHV_NO_MEMORY ? status : SHV_OK;
}

/* TetGen's elements are in a second file. */
static ShvStatus hash_mesh(const Reading *reading, const ShvMeshDefinition *mesh, ShvError *error)
{
    if (mesh->kind != SHV_MESH_TETGEN) return hash_file(reading, mesh->file, "", error);
    const size_t length = strlen(mesh->file);
    const bool node = length > 5 && strcmp(mesh->file + length - 5, ".node") == 0;
    char base[1000];
    shv_format(base, sizeof base, "%.*s", (int)(node ? length - 5 : length), mesh->file);
    SHV_TRY(hash_file(reading, base, ".node", error));
    return hash_file(reading, base, ".ele", error);
}

ShvStatus shv_inputs_hash(ShvMemory *memory, const char *folder, const ShvSceneDefinition *scene, uint64_t *hash,
                          ShvError *error)
{
    const Reading reading = {.memory = memory, .folder = folder, .hash = hash};
    for (int32_t i = 0; i < scene->object_count; i++) SHV_TRY(hash_mesh(&reading, &scene->objects[i].mesh, error));
    for (int32_t i = 0; i < scene->obstacle_count; i++)
        SHV_TRY(hash_file(&reading, scene->obstacles[i].file, "", error));
    return SHV_OK;
}
