/* A closed triangle surface becomes a shell: layers of prisms, extruded inwards along the vertex normals, three tets a
   prism. */
#include "mesh/shell.h"

#include "base/deterministic.h"
#include "mesh/generate.h"

const uint8_t shv_prism_tets[2][3][4] = {
    {{0, 4, 3, 5}, {0, 1, 4, 5}, {0, 2, 1, 5}},
    {{0, 3, 4, 5}, {0, 4, 1, 5}, {0, 1, 2, 5}},
};

int shv_shell_sort_corners(const int32_t *corners, int32_t sorted[3])
{
    static const uint8_t pairs[3][2] = {{0, 1}, {1, 2}, {0, 1}};
    int turned = 0;
    for (int k = 0; k < 3; k++) sorted[k] = corners[k];
    for (int k = 0; k < 3; k++) {
        int32_t *low = &sorted[pairs[k][0]], *high = &sorted[pairs[k][1]];
        if (*low <= *high) continue;
        const int32_t kept = *low;
        *low = *high;
        *high = kept;
        turned = !turned;
    }
    return turned;
}

static double angle_between(ShvVec3 a, ShvVec3 b)
{
    const double cosine = shv_dot(a, b) / (shv_norm(a) * shv_norm(b));
    return shv_acos(fmin(1.0, fmax(-1.0, cosine)));
}

/* Mean of the triangles' normals, weighted by their angle at the vertex: it does not depend on how a flat face is cut
   into triangles (Thürmer & Wüthrich 1998). */
static void weigh_normals(ShvShell *shell)
{
    for (int32_t t = 0; t < shell->surface.triangle_count; t++) {
        const int32_t *c = shv_shell_corners(shell, t);
        ShvVec3 x[3];
        for (int k = 0; k < 3; k++) x[k] = shv_surface_position(&shell->surface, c[k]);
        const ShvVec3 normal = shv_unit(shv_cross(shv_sub(x[1], x[0]), shv_sub(x[2], x[0])));
        for (int k = 0; k < 3; k++) {
            const double angle = angle_between(shv_sub(x[(k + 1) % 3], x[k]), shv_sub(x[(k + 2) % 3], x[k]));
            shv_add_to3(shell->normals + 3 * (int64_t)c[k], shv_scale(normal, angle));
        }
    }
    for (int64_t v = 0; v < shell->surface.node_count; v++)
        shv_store3(shell->normals + 3 * v, shv_unit(shv_load3(shell->normals + 3 * v)));
}

static ShvStatus prepare(ShvShell *shell, ShvMemory *memory, const ShvMeshDefinition *definition, const char *path,
                         ShvError *error)
{
    SHV_TRY(shv_surface_read(&shell->surface, memory, SHV_PART_GENERAL, path, definition->scale, error));
    SHV_TRY(shv_surface_require_closed(&shell->surface, path, error));
    if (definition->refine_to > 0) SHV_TRY(shv_surface_refine(&shell->surface, definition->refine_to, error));
    const int64_t layers = definition->layers, most = INT32_MAX;
    if ((layers + 1) * shell->surface.node_count > most || 3 * layers * shell->surface.triangle_count > most)
        return shv_fail(error, SHV_BAD_INPUT, "%s: %d layers of %d triangles are too many for one mesh; take fewer",
                        path, (int)layers, (int)shell->surface.triangle_count);
    const size_t nodes = (size_t)shell->surface.node_count;
    shell->layers = definition->layers;
    shell->normals = shv_allocate(memory, SHV_PART_GENERAL, nodes, 3 * sizeof *shell->normals);
    shell->depths = shv_allocate(memory, SHV_PART_GENERAL, nodes, sizeof *shell->depths);
    if (!shell->normals || !shell->depths) return shv_fail_memory(error, "a shell", nodes * 4 * sizeof(double));
    weigh_normals(shell);
    return shv_shell_find_depths(shell, definition->thickness, path, error);
}

static void fill_nodes(const ShvShell *shell, ShvMesh *mesh)
{
    const int64_t nodes = shell->surface.node_count;
    for (int32_t layer = 0; layer <= shell->layers; layer++)
        for (int64_t v = 0; v < nodes; v++)
            shv_store3(mesh->positions + 3 * (layer * nodes + v), shv_shell_point(shell, (int32_t)v, layer));
}

static void fill_tets(const ShvShell *shell, ShvMesh *mesh)
{
    const int32_t nodes = shell->surface.node_count;
    int32_t *element = mesh->elements;
    for (int32_t layer = 0; layer < shell->layers; layer++)
        for (int32_t t = 0; t < shell->surface.triangle_count; t++) {
            int32_t sorted[3];
            const int table = shv_shell_sort_corners(shv_shell_corners(shell, t), sorted);
            for (int tet = 0; tet < 3; tet++)
                for (int k = 0; k < 4; k++) {
                    const int corner = shv_prism_tets[table][tet][k];
                    *element++ = sorted[corner % 3] + (layer + corner / 3) * nodes;
                }
        }
}

/* Walls that meet in spite of shv_shell_find_depths count their common space twice. */
static ShvStatus refuse_overfull(const ShvShell *shell, const ShvMesh *mesh, const char *path, ShvError *error)
{
    double volume = 0.0;
    for (int32_t e = 0; e < mesh->element_count; e++) volume += shv_mesh_element_volume(mesh, e);
    const double room = shv_surface_mass(&shell->surface).mass;
    if (volume < room) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT,
                    "%s: a shell of this thickness has a volume of %g m³, more than the %g m³ inside "
                    "the surface; reduce the thickness",
                    path, volume, room);
}

static ShvStatus check_definition(const ShvMeshDefinition *definition, const char *path, ShvError *error)
{
    if (!(definition->thickness > 0.0) || !isfinite(definition->thickness))
        return shv_fail(error, SHV_BAD_INPUT,
                        "%s: the thickness of a shell must be a positive number of metres, not %g", path,
                        definition->thickness);
    if (definition->layers < 1)
        return shv_fail(error, SHV_BAD_INPUT, "%s: a shell needs at least 1 layer, not %d", path,
                        (int)definition->layers);
    if (definition->refine_to < 0)
        return shv_fail(error, SHV_BAD_INPUT, "%s: refine_to must be 0 or a number of triangles, not %lld", path,
                        (long long)definition->refine_to);
    return SHV_OK;
}

ShvStatus shv_mesh_shell(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, const char *path,
                         ShvError *error)
{
    *mesh = (ShvMesh){0};
    SHV_TRY(check_definition(definition, path, error));
    ShvShell shell = {0};
    ShvStatus status = prepare(&shell, memory, definition, path, error);
    if (status == SHV_OK) {
        const int64_t layers = shell.layers;
        status = shv_mesh_allocate(mesh, memory, (layers + 1) * shell.surface.node_count,
                                   3 * layers * shell.surface.triangle_count, error);
    }
    if (status == SHV_OK) {
        fill_nodes(&shell, mesh);
        fill_tets(&shell, mesh);
        status = refuse_overfull(&shell, mesh, path, error);
        if (status != SHV_OK) shv_mesh_release(mesh);
    }
    shv_surface_release(&shell.surface);
    shv_release(shell.normals);
    shv_release(shell.depths);
    return status;
}
