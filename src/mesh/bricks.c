#include "mesh/bricks.h"

#include <math.h>

#include "mesh/parameters.h"
#include "mesh/tet.h"

/* Sides of bricks: `first` at the notch, growing by `growth` of the distance up to `last`. */
typedef struct Sides {
    double first, last, growth;
} Sides;

typedef struct Bricks {
    const char *what;  /* "box", "notched beam": for messages */
    int32_t count[3];  /* along each axis */
    double *planes[3]; /* count + 1 each, increasing */
    int32_t slit, tip; /* the slit is in plane `slit` across x, below plane `tip` across z */
} Bricks;

static double side_at(const Sides *sides, double distance)
{
    return fmin(sides->last, sides->first + sides->growth * distance);
}

/* Bricks that fill a length best, at least one, and how far they reach before they are scaled to it. */
static int32_t count_bricks(const Sides *sides, double length, double *reach)
{
    int32_t count = 0;
    *reach = 0.0;
    while (count == 0 || (*reach + 0.5 * side_at(sides, *reach) <= length && count < SHV_MESH_LARGEST)) {
        *reach += side_at(sides, *reach);
        count++;
    }
    return count;
}

/* Planes from the knot, planes[0], to an end of the beam: planes[count] above it, planes[−count] below. */
static void place_run(const Sides *sides, double knot, double end, double *planes)
{
    const int sign = end > knot ? 1 : -1;
    double reach, at = 0.0;
    const int32_t count = count_bricks(sides, fabs(end - knot), &reach);
    const double scale = (end - knot) / reach;
    planes[0] = knot;
    for (int32_t i = 1; i < count; i++) {
        at += side_at(sides, at);
        planes[sign * i] = knot + scale * at;
    }
    planes[sign * count] = end;
}

/* Planes of one axis, finest at the knot; `plane` receives the knot's. A knot at −half makes one run. */
static ShvStatus place_axis(Bricks *bricks, ShvMemory *memory, int axis, double half, double knot, const Sides *sides,
                            int32_t *plane, ShvError *error)
{
    double reach;
    const int32_t below = knot > -half ? count_bricks(sides, knot + half, &reach) : 0;
    const int32_t count = below + count_bricks(sides, half - knot, &reach);
    SHV_TRY(shv_require_count(count, sides->first, bricks->what, error));
    double *planes = shv_allocate(memory, SHV_PART_MESH, (size_t)count + 1, sizeof(double));
    if (!planes) return shv_fail_memory(error, "planes between bricks", ((size_t)count + 1) * sizeof(double));
    if (below > 0) place_run(sides, knot, -half, planes + below);
    place_run(sides, knot, half, planes + below);
    bricks->planes[axis] = planes;
    bricks->count[axis] = count;
    *plane = below;
    return SHV_OK;
}

static ShvStatus place_even_planes(Bricks *bricks, ShvMemory *memory, const ShvMeshDefinition *d, ShvError *error)
{
    const double side = d->edge / SHV_BRICK_EDGE;
    const Sides even = {side, side, 0.0};
    for (int axis = 0; axis < 3; axis++) {
        int32_t bottom;
        SHV_TRY(place_axis(bricks, memory, axis, 0.5 * d->size[axis], -0.5 * d->size[axis], &even, &bottom, error));
    }
    return SHV_OK;
}

static ShvStatus place_planes(Bricks *bricks, ShvMemory *memory, const ShvMeshDefinition *d, ShvError *error)
{
    if (d->notch_edge > 0.0 && d->notch_edge < 0.1 * d->edge)
        return shv_fail(
            error, SHV_BAD_INPUT,
            "notched beam: notch_edge %g m is less than a tenth of edge, which makes flat bricks; choose at "
            "least %g m, or the pattern lattice",
            d->notch_edge, 0.1 * d->edge);
    const double side = d->edge / SHV_BRICK_EDGE, half[3] = {0.5 * d->size[0], 0.5 * d->size[1], 0.5 * d->size[2]};
    const double finest = d->notch_edge > 0.0 ? fmin(side, d->notch_edge / SHV_BRICK_EDGE) : side;
    const Sides even = {side, side, 0.0}, graded = {finest, side, d->notch_growth};
    int32_t bottom;
    SHV_TRY(place_axis(bricks, memory, 0, half[0], d->notch_offset, &graded, &bricks->slit, error));
    SHV_TRY(place_axis(bricks, memory, 1, half[1], -half[1], &even, &bottom, error));
    return place_axis(bricks, memory, 2, half[2], d->notch_depth - half[2], &even, &bricks->tip, error);
}

/* ---- nodes and tets ---- */

static int64_t grid_nodes(const Bricks *b)
{
    return ((int64_t)b->count[0] + 1) * ((int64_t)b->count[1] + 1) * ((int64_t)b->count[2] + 1);
}

/* Nodes of the right lip follow those of the grid, which has the left one. */
static int64_t node_at(const Bricks *b, const int32_t at[3], bool right)
{
    const int64_t row = (int64_t)b->count[1] + 1;
    if (right && at[0] == b->slit && at[2] < b->tip) return grid_nodes(b) + at[1] + row * at[2];
    return at[0] + ((int64_t)b->count[0] + 1) * (at[1] + row * at[2]);
}

static void place_nodes(ShvMesh *mesh, const Bricks *b)
{
    int32_t at[3];
    for (at[2] = 0; at[2] <= b->count[2]; at[2]++)
        for (at[1] = 0; at[1] <= b->count[1]; at[1]++)
            for (at[0] = 0; at[0] <= b->count[0]; at[0]++) {
                const ShvVec3 x = shv_vec3(b->planes[0][at[0]], b->planes[1][at[1]], b->planes[2][at[2]]);
                shv_store3(mesh->positions + 3 * node_at(b, at, false), x);
                shv_store3(mesh->positions + 3 * node_at(b, at, true), x);
            }
}

/* The corners of a brick are numbered by bits, x first. The middle tet takes the four with an even number of ones, or in
   every other brick those with an odd number; each of the other tets is one of the remaining corners and its three
   neighbours. */
static void add_brick(ShvMesh *mesh, int64_t *count, const Bricks *b, const int32_t brick[3])
{
    static const int8_t even[4] = {0, 3, 5, 6};
    int32_t nodes[8];
    for (int corner = 0; corner < 8; corner++) {
        const int32_t at[3] = {brick[0] + (corner & 1), brick[1] + (corner >> 1 & 1), brick[2] + (corner >> 2)};
        nodes[corner] = (int32_t)node_at(b, at, brick[0] >= b->slit);
    }
    const int flip = (brick[0] + brick[1] + brick[2]) & 1 ? 7 : 0;
    int32_t middle[4];
    for (int i = 0; i < 4; i++) middle[i] = nodes[even[i] ^ flip];
    shv_tet_write(mesh, (*count)++, middle);
    for (int i = 0; i < 4; i++) {
        const int corner = even[i] ^ flip ^ 7;
        shv_tet_write(mesh, (*count)++,
                      (const int32_t[4]){nodes[corner], nodes[corner ^ 1], nodes[corner ^ 2], nodes[corner ^ 4]});
    }
}

static void add_bricks(ShvMesh *mesh, const Bricks *b)
{
    int64_t count = 0;
    int32_t brick[3];
    for (brick[2] = 0; brick[2] < b->count[2]; brick[2]++)
        for (brick[1] = 0; brick[1] < b->count[1]; brick[1]++)
            for (brick[0] = 0; brick[0] < b->count[0]; brick[0]++) add_brick(mesh, &count, b, brick);
}

static ShvStatus fill(ShvMesh *mesh, ShvMemory *memory, const Bricks *b, double edge, ShvError *error)
{
    const double elements = 5.0 * (double)b->count[0] * (double)b->count[1] * (double)b->count[2];
    SHV_TRY(shv_require_count(elements, edge, b->what, error));
    const int64_t lip = ((int64_t)b->count[1] + 1) * b->tip;
    SHV_TRY(shv_mesh_allocate(mesh, memory, grid_nodes(b) + lip, (int64_t)elements, error));
    place_nodes(mesh, b);
    add_bricks(mesh, b);
    return SHV_OK;
}

ShvStatus shv_mesh_brick_beam(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error)
{
    *mesh = (ShvMesh){0};
    Bricks bricks = {.what = "notched beam"};
    ShvStatus status = place_planes(&bricks, memory, definition, error);
    if (status == SHV_OK) status = fill(mesh, memory, &bricks, definition->edge, error);
    for (int axis = 0; axis < 3; axis++) shv_release(bricks.planes[axis]);
    return status;
}

ShvStatus shv_mesh_brick_box(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error)
{
    *mesh = (ShvMesh){0};
    Bricks bricks = {.what = "box"};
    ShvStatus status = place_even_planes(&bricks, memory, definition, error);
    if (status == SHV_OK) status = fill(mesh, memory, &bricks, definition->edge, error);
    for (int axis = 0; axis < 3; axis++) shv_release(bricks.planes[axis]);
    return status;
}
