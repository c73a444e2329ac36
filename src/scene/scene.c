#include "shiver/scene.h"

#include <string.h>

#include "base/file.h"
#include "base/hash.h"
#include "scene/check.h"
#include "scene/expand.h"
#include "scene/override.h"
#include "scene/read.h"
#include "scene/source.h"

struct ShvScene {
    ShvPool pool;
    ShvSceneDefinition definition;
    ShvObjectDefinition *objects; /* of the definition */
    const char *text, *folder;
    size_t length;
    const char **overrides;
    int32_t override_count;
    uint64_t hash;
};

/* What one parsing is given. */
typedef struct Source {
    const char *text;
    size_t length;
    const char *name, *folder;
    const char *const *overrides;
    int32_t override_count;
} Source;

/* "drop" of "scenes/drop.yaml". */
static const char *name_from_file(ShvPool *pool, const char *file)
{
    const char *slash = strrchr(file, '/');
    const char *base = slash ? slash + 1 : file;
    const char *dot = strrchr(base, '.');
    const size_t length = dot && dot != base ? (size_t)(dot - base) : strlen(base);
    return shv_pool_text(pool, base, length);
}

static void keep_source(ShvScene *scene, const Source *source)
{
    ShvPool *pool = &scene->pool;
    const char *folder = source->folder ? source->folder : "";
    scene->text = shv_pool_text(pool, source->text, source->length);
    scene->length = source->length;
    scene->folder = shv_pool_text(pool, folder, strlen(folder));
    scene->overrides = shv_pool_take(pool, (size_t)source->override_count, sizeof *scene->overrides);
    if (pool->failed) return;
    scene->hash = shv_hash_text(SHV_HASH_START, scene->text);
    for (int32_t i = 0; i < source->override_count; i++) {
        scene->overrides[i] = shv_pool_text(pool, source->overrides[i], strlen(source->overrides[i]));
        scene->hash = shv_hash_text(scene->hash, source->overrides[i]);
    }
    scene->override_count = source->override_count;
}

/* Tree, overrides, items, definitions, checks. Each part works on what the one before could make of the text. */
static void make_scene(ShvScene *scene, const Source *source, ShvPool *work, ShvDiagnostics *diagnostics)
{
    ShvNode *root = shv_tree_read(work, diagnostics, source->text, source->length, 0);
    if (!root) return;
    for (int32_t i = 0; i < source->override_count && !work->failed; i++)
        root = shv_override_apply(work, diagnostics, root, source->overrides[i], i);
    root = work->failed ? NULL : shv_expand_materials(work, diagnostics, root);
    ShvSceneItem *items = shv_pool_take(work, 1, sizeof *items);
    if (!items || work->failed) return;
    ShvReader reader = {work, &scene->pool, diagnostics, NULL};
    shv_read_scene(&reader, root, items);
    if (work->failed || scene->pool.failed) return;
    ShvAssembly assembly;
    shv_assemble(&assembly, items, &scene->pool, work, diagnostics);
    if (work->failed || scene->pool.failed) return;
    shv_check_scene(items, &assembly, source->folder, work, diagnostics);
    scene->definition = assembly.definition;
    scene->objects = assembly.objects;
    if (!scene->definition.name) scene->definition.name = name_from_file(&scene->pool, source->name);
}

static ShvStatus parse(ShvScene **scene, const Source *source, ShvMemory *memory, ShvDiagnostics *diagnostics,
                       ShvError *error)
{
    ShvScene *made = shv_allocate(memory, SHV_PART_SCENE, 1, sizeof *made);
    if (!made) return shv_fail_memory(error, "a scene", sizeof *made);
    made->pool.memory = memory;
    ShvPool work = {.memory = memory};
    keep_source(made, source);
    if (!made->pool.failed) make_scene(made, source, &work, diagnostics);
    const bool failed = work.failed || made->pool.failed;
    shv_pool_release(&work);
    const ShvStatus status = shv_diagnostics_end(diagnostics, failed, "the scene", source->length, error);
    if (status == SHV_OK)
        *scene = made;
    else
        shv_scene_destroy(made);
    return status;
}

ShvStatus shv_scene_parse(ShvScene **scene, const char *text, size_t length, const char *name, const char *folder,
                          const char *const *overrides, int32_t override_count, struct ShvMemory *memory,
                          ShvDiagnostics **diagnostics, ShvError *error)
{
    *scene = NULL;
    if (diagnostics) *diagnostics = NULL;
    if (length > SHV_SCENE_LARGEST_BYTES)
        return shv_fail(error, SHV_BAD_INPUT,
                        "%s has %zu bytes; a scene has at most %d, put large meshes into files of their own", name,
                        length, (int)SHV_SCENE_LARGEST_BYTES);
    ShvDiagnostics *list = shv_diagnostics_create(memory, name, overrides, override_count);
    if (!list) return shv_fail_memory(error, "the messages of a scene", 0);
    const Source source = {text, length, name, folder, overrides, override_count};
    const ShvStatus status = parse(scene, &source, memory, list, error);
    if (diagnostics && status != SHV_NO_MEMORY)
        *diagnostics = list;
    else
        shv_diagnostics_destroy(list);
    return status;
}

ShvStatus shv_scene_load(ShvScene **scene, const char *path, const char *const *overrides, int32_t override_count,
                         struct ShvMemory *memory, ShvDiagnostics **diagnostics, ShvError *error)
{
    char *text = NULL, *folder = NULL;
    size_t length = 0;
    *scene = NULL;
    if (diagnostics) *diagnostics = NULL;
    SHV_TRY(shv_read_file(memory, SHV_PART_SCENE, path, SHV_SCENE_LARGEST_BYTES, &text, &length, error));
    ShvStatus status = shv_path_folder(memory, SHV_PART_SCENE, path, &folder, error);
    if (status == SHV_OK)
        status =
            shv_scene_parse(scene, text, length, path, folder, overrides, override_count, memory, diagnostics, error);
    shv_release(folder);
    shv_release(text);
    return status;
}

void shv_scene_destroy(ShvScene *scene)
{
    if (!scene) return;
    shv_pool_release(&scene->pool);
    shv_release(scene);
}

const ShvSceneDefinition *shv_scene_definition(const ShvScene *scene)
{
    return &scene->definition;
}

/* "ball" is the object of that name, and "ball_1" where it is repeated. */
static bool is_named(const char *name, const char *wanted)
{
    const size_t length = strlen(wanted);
    if (strncmp(name, wanted, length) != 0) return false;
    return name[length] == '\0' || (name[length] == '_' && strspn(name + length + 1, "0123456789") > 0 &&
                                    strspn(name + length + 1, "0123456789") == strlen(name + length + 1));
}

ShvStatus shv_scene_give_mesh(ShvScene *scene, const char *object, const double *positions, int32_t node_count,
                              const int32_t *tets, int32_t tet_count, ShvError *error)
{
    ShvPool *pool = &scene->pool;
    if (node_count < 4 || tet_count < 1)
        return shv_fail(error, SHV_BAD_INPUT, "the mesh of '%s' has %d nodes and %d tets; give 4 and 1 at least",
                        object, (int)node_count, (int)tet_count);
    double *nodes = shv_pool_take(pool, 3 * (size_t)node_count, sizeof(double));
    int32_t *corners = shv_pool_take(pool, 4 * (size_t)tet_count, sizeof(int32_t));
    if (!nodes || !corners) return shv_fail_memory(error, "a mesh", 24 * (size_t)node_count + 16 * (size_t)tet_count);
    memcpy(nodes, positions, 3 * (size_t)node_count * sizeof(double));
    memcpy(corners, tets, 4 * (size_t)tet_count * sizeof(int32_t));
    int32_t given = 0;
    for (int32_t i = 0; i < scene->definition.object_count; i++) {
        ShvMeshDefinition *mesh = &scene->objects[i].mesh;
        if (mesh->kind != SHV_MESH_MEMORY || !is_named(scene->objects[i].name, object)) continue;
        mesh->positions = nodes;
        mesh->tets = corners;
        mesh->node_count = node_count;
        mesh->tet_count = tet_count;
        given++;
    }
    if (given > 0) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "the scene has no object '%s' with 'mesh: {memory: {scale: 1}}'", object);
}

const char *shv_scene_text(const ShvScene *scene)
{
    return scene->text;
}

size_t shv_scene_text_length(const ShvScene *scene)
{
    return scene->length;
}

int32_t shv_scene_override_count(const ShvScene *scene)
{
    return scene->override_count;
}

const char *shv_scene_override(const ShvScene *scene, int32_t index)
{
    return index >= 0 && index < scene->override_count ? scene->overrides[index] : NULL;
}

uint64_t shv_scene_hash(const ShvScene *scene)
{
    return scene->hash;
}

const char *shv_scene_folder(const ShvScene *scene)
{
    return scene->folder;
}
