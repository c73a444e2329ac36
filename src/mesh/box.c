#include "mesh/bricks.h"
#include "mesh/generate.h"
#include "mesh/lattice.h"
#include "mesh/parameters.h"
#include "mesh/unstructured.h"

/* Mean length of the six edges of every tet of a uniform lattice, over the cell length: a face inside carries four
   tets of two long (1) and four short (√¾) edges; one on the surface two tets of 2 sides, the diagonal √2 and 3 short. */
static double mean_edge(const int32_t n[3])
{
    const double cells = (double)n[0] * n[1] * n[2];
    const double surface = 2.0 * ((double)n[0] * n[1] + (double)n[1] * n[2] + (double)n[2] * n[0]);
    const double inside = (6.0 * cells - surface) / 2.0, half_diagonal = sqrt(0.75);
    const double length =
        4.0 * inside * (2.0 + 4.0 * half_diagonal) + 2.0 * surface * (2.0 + sqrt(2.0) + 3.0 * half_diagonal);
    return length / (6.0 * (4.0 * inside + 2.0 * surface));
}

/* A body of fewer edges than this has no room for disorder through it. */
static const double thin_edges = 1.7;

/* Along the thin side lie a plate's columns. */
static ShvStatus disordered_plate(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, int thin,
                                  ShvError *error)
{
    const int first = (thin + 1) % 3, second = (thin + 2) % 3;
    const double *s = definition->size, edge = definition->edge, size[3] = {s[first], s[second], s[thin]};
    const double tets_a_triangle = 8.0, triangles = 2.3094 * size[0] * size[1] / (edge * edge);
    SHV_TRY(shv_require_count(tets_a_triangle * triangles, edge, "box", error));
    SHV_TRY(shv_mesh_plate(mesh, memory, size, edge, definition->seed, error));
    for (int32_t i = 0; i < mesh->node_count; i++) {
        double *x = mesh->positions + 3 * (int64_t)i;
        const double old[3] = {x[0], x[1], x[2]};
        x[first] = old[0];
        x[second] = old[1];
        x[thin] = old[2];
    }
    return SHV_OK;
}

static ShvStatus disordered_box(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error)
{
    const double edge = definition->edge, *size = definition->size;
    const ShvOutline outline = {.half = {0.5 * size[0], 0.5 * size[1], 0.5 * size[2]}};
    int thin = 0;
    for (int axis = 1; axis < 3; axis++)
        if (size[axis] < size[thin]) thin = axis;
    if (size[thin] < thin_edges * edge) return disordered_plate(mesh, memory, definition, thin, error);
    const double tets = 6.0 * sqrt(2.0) * size[0] * size[1] * size[2] / (edge * edge * edge);
    SHV_TRY(shv_require_count(tets, edge, "box", error));
    return shv_mesh_unstructured(mesh, memory, &outline, edge, definition->seed, error);
}

ShvStatus shv_mesh_box(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error)
{
    static const char *const names[3] = {"size along x", "size along y", "size along z"};
    *mesh = (ShvMesh){0};
    double thinnest = HUGE_VAL;
    for (int axis = 0; axis < 3; axis++) {
        SHV_TRY(shv_require_length(definition->size[axis], "box", names[axis], error));
        thinnest = fmin(thinnest, definition->size[axis]);
    }
    SHV_TRY(shv_require_edge(definition->edge, thinnest, "box", "thinnest side", error));
    if (definition->pattern == SHV_PATTERN_UNSTRUCTURED) return disordered_box(mesh, memory, definition, error);
    if (definition->pattern == SHV_PATTERN_BRICKS) return shv_mesh_brick_box(mesh, memory, definition, error);
    /* A thin box has many surface tets with long diagonals: the cell length is corrected for them once. */
    ShvLattice lattice = shv_lattice_box(definition->size, definition->edge / SHV_LATTICE_EDGE);
    lattice = shv_lattice_box(definition->size, definition->edge / mean_edge(lattice.roots));
    SHV_TRY(shv_require_count(shv_lattice_estimate(&lattice), definition->edge, "box", error));
    return shv_lattice_mesh(mesh, memory, &lattice, error);
}
