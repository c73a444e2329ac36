#include "mesh/generate.h"

#include <stdio.h>
#include <string.h>

#include "mesh/fill.h"
#include "mesh/improve.h"

static const char *kind_name(ShvMeshKind kind)
{
    switch (kind) {
    case SHV_MESH_BOX:
        return "box";
    case SHV_MESH_BALL:
        return "ball";
    case SHV_MESH_HOLLOW_BALL:
        return "hollow ball";
    case SHV_MESH_CYLINDER:
        return "cylinder";
    case SHV_MESH_NOTCHED_BEAM:
        return "notched beam";
    case SHV_MESH_GMSH:
        return "gmsh mesh";
    case SHV_MESH_TETGEN:
        return "tetgen mesh";
    case SHV_MESH_SHELL:
        return "shell";
    case SHV_MESH_STL:
        return "filled surface";
    case SHV_MESH_MEMORY:
        return "mesh from memory";
    case SHV_MESH_TURNED:
        return "turned body";
    }
    return NULL;
}

static bool is_read(ShvMeshKind kind)
{
    return kind == SHV_MESH_GMSH || kind == SHV_MESH_TETGEN || kind == SHV_MESH_SHELL || kind == SHV_MESH_STL;
}

static ShvStatus check_definition(const ShvMeshDefinition *definition, ShvError *error)
{
    if (definition->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "a mesh definition must start from shv_mesh_default()");
    const char *name = kind_name(definition->kind);
    if (!name) return shv_fail(error, SHV_BAD_INPUT, "%d is no kind of mesh", (int)definition->kind);
    if (!(definition->jitter >= 0.0 && definition->jitter <= 0.3))
        return shv_fail(error, SHV_BAD_INPUT, "%s: jitter is %g, but must lie between 0 and 0.3", name,
                        definition->jitter);
    const bool read = is_read(definition->kind);
    if (definition->improve && (!(read || definition->kind == SHV_MESH_MEMORY) || definition->kind == SHV_MESH_SHELL))
        return shv_fail(error, SHV_BAD_INPUT, "%s: 'improve' is for tets from a file or from memory; leave it out",
                        name);
    if (!read && definition->kind != SHV_MESH_MEMORY) return SHV_OK;
    if (read && (!definition->file || !*definition->file))
        return shv_fail(error, SHV_BAD_INPUT, "%s: no file is named; set file", name);
    if (!(isfinite(definition->scale) && definition->scale > 0.0))
        return shv_fail(error, SHV_BAD_INPUT, "%s %s: scale is %g, but must be positive and finite", name,
                        read ? definition->file : "", definition->scale);
    if (definition->kind == SHV_MESH_STL && !(isfinite(definition->edge) && definition->edge > 0.0))
        return shv_fail(error, SHV_BAD_INPUT, "%s %s: edge is %g, but must be positive and finite", name,
                        definition->file, definition->edge);
    return SHV_OK;
}

/* `file` itself when it is absolute or there is no folder; else folder/file. NULL when memory is out. */
static char *resolve_path(ShvMemory *memory, const char *folder, const char *file)
{
    if (!folder || !*folder || file[0] == '/') return shv_copy_text(memory, SHV_PART_GENERAL, file);
    const size_t length = strlen(folder) + strlen(file) + 2;
    char *path = shv_allocate(memory, SHV_PART_GENERAL, length, 1);
    if (path) snprintf(path, length, "%s/%s", folder, file);
    return path;
}

static void scale_positions(ShvMesh *mesh, double scale)
{
    for (int64_t i = 0; i < 3 * (int64_t)mesh->node_count; i++) mesh->positions[i] *= scale;
}

static ShvStatus read_mesh(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, const char *path,
                           ShvError *error)
{
    if (definition->kind == SHV_MESH_SHELL) return shv_mesh_shell(mesh, memory, definition, path, error);
    if (definition->kind == SHV_MESH_STL)
        SHV_TRY(shv_mesh_fill(mesh, memory, definition, path, error));
    else if (definition->kind == SHV_MESH_GMSH)
        SHV_TRY(shv_mesh_read_gmsh(mesh, memory, path, error));
    else
        SHV_TRY(shv_mesh_read_tetgen(mesh, memory, path, error));
    scale_positions(mesh, definition->scale);
    return SHV_OK;
}

static ShvStatus check_memory(const ShvMeshDefinition *definition, ShvError *error)
{
    const int32_t nodes = definition->node_count, tets = definition->tet_count;
    if (!definition->positions || !definition->tets || nodes < 4 || tets < 1 || tets > SHV_MESH_LARGEST)
        return shv_fail(error, SHV_BAD_INPUT,
                        "a mesh from memory has %d nodes and %d tets; give positions of at least 4 nodes and at least "
                        "one tet",
                        (int)nodes, (int)tets);
    for (int64_t i = 0; i < 4 * (int64_t)tets; i++)
        if (definition->tets[i] < 0 || definition->tets[i] >= nodes)
            return shv_fail(error, SHV_BAD_INPUT, "a mesh from memory: tet %d names node %d, of 0 to %d", (int)(i / 4),
                            (int)definition->tets[i], (int)nodes - 1);
    return SHV_OK;
}

static ShvStatus copy_mesh(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error)
{
    SHV_TRY(check_memory(definition, error));
    SHV_TRY(shv_mesh_allocate(mesh, memory, definition->node_count, definition->tet_count, error));
    memcpy(mesh->positions, definition->positions, 3 * (size_t)definition->node_count * sizeof(double));
    memcpy(mesh->elements, definition->tets, 4 * (size_t)definition->tet_count * sizeof(int32_t));
    scale_positions(mesh, definition->scale);
    return SHV_OK;
}

static ShvStatus make_mesh(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, const char *path,
                           ShvError *error)
{
    switch (definition->kind) {
    case SHV_MESH_BOX:
        return shv_mesh_box(mesh, memory, definition, error);
    case SHV_MESH_BALL:
        return shv_mesh_ball(mesh, memory, definition, error);
    case SHV_MESH_HOLLOW_BALL:
        return shv_mesh_hollow_ball(mesh, memory, definition, error);
    case SHV_MESH_CYLINDER:
        return shv_mesh_cylinder(mesh, memory, definition, error);
    case SHV_MESH_NOTCHED_BEAM:
        return shv_mesh_notched_beam(mesh, memory, definition, error);
    case SHV_MESH_GMSH:
    case SHV_MESH_TETGEN:
    case SHV_MESH_SHELL:
    case SHV_MESH_STL:
        break;
    case SHV_MESH_MEMORY:
        return copy_mesh(mesh, memory, definition, error);
    case SHV_MESH_TURNED:
        return shv_mesh_turned(mesh, memory, definition, error);
    }
    return read_mesh(mesh, memory, definition, path, error);
}

static ShvStatus finish_mesh(ShvMesh *mesh, const ShvMeshDefinition *definition, const char *what, ShvError *error)
{
    SHV_TRY(shv_mesh_validate(mesh, what, error));
    if (definition->jitter > 0.0) SHV_TRY(shv_mesh_jitter(mesh, definition->jitter, definition->seed, error));
    const bool filled = definition->improve || definition->kind == SHV_MESH_STL;
    if (filled || definition->jitter > 0.0) SHV_TRY(shv_mesh_improve(mesh, filled, definition->seed, error));
    return shv_mesh_renumber(mesh, NULL, NULL, error);
}

ShvStatus shv_mesh_generate(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, const char *folder,
                            ShvError *error)
{
    *mesh = (ShvMesh){0};
    SHV_TRY(check_definition(definition, error));
    char *path = NULL;
    if (is_read(definition->kind)) {
        path = resolve_path(memory, folder, definition->file);
        if (!path) return shv_fail_memory(error, "a file name", strlen(definition->file));
    }
    ShvMesh made = {0};
    ShvStatus status = make_mesh(&made, memory, definition, path, error);
    if (status == SHV_OK) status = finish_mesh(&made, definition, path ? path : kind_name(definition->kind), error);
    shv_release(path);
    if (status != SHV_OK) {
        shv_mesh_release(&made);
        return status;
    }
    *mesh = made;
    return SHV_OK;
}
