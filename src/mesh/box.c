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

/* Half as many edges again as a body needs for two layers of tets: nodes inside have room for disorder. */
static const double least_edges = 1.7;

/* A flat box is filled as if it were thicker: the edges asked for are those along it. */
static ShvStatus disordered_box(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error)
{
    const double edge = definition->edge;
    ShvOutline outline = {.profile = NULL};
    double stretch[3], tets = 6.0 * sqrt(2.0);
    for (int axis = 0; axis < 3; axis++) {
        stretch[axis] = fmax(1.0, least_edges * edge / definition->size[axis]);
        outline.half[axis] = 0.5 * definition->size[axis] * stretch[axis];
        tets *= 2.0 * outline.half[axis] / edge;
    }
    SHV_TRY(shv_require_count(tets, edge, "box", error));
    return shv_mesh_unstructured(mesh, memory, &outline, shv_load3(stretch), edge, definition->seed, error);
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
