#include "mesh/unstructured.h"

#include <math.h>
#include <string.h>

#include "base/random.h"
#include "mesh/delaunay.h"
#include "mesh/improve.h"
#include "mesh/scatter.h"

/* How often points are moved to the mean of their tets, or triangles. */
enum { ROUNDS = 6 };
/* Tets whose measure (improve.h) is this share of the edge and more are left alone: a regular tet has 0.41, those of the
   body-centred lattice have 0.35 to 0.39. */
static const double wanted_share = 0.31;
/* The same of half a plate's thickness, on which edges have hardly any influence there. */
static const double wanted_half_share = 0.6;
/* Tets on the surface of a turned body that are flatter than this share of the edge are left out. */
static const double flat_share = 0.1;

typedef struct Filling {
    ShvMemory *memory;
    const ShvOutline *outline;
    bool flat; /* points in a plane, and one above it: their tets are triangles with it */
    ShvScatter scatter;
    int32_t *grid; /* 3 a point, as delaunay.h wants them */
    double *sums;  /* 4 a point */
    ShvDelaunay delaunay;
    double edge;
} Filling;

static ShvVec3 point(const Filling *f, int32_t i)
{
    return shv_load3(f->scatter.positions + 3 * (int64_t)i);
}

/* ---- tets between the points ---- */

/* Positions go to the nearest knot of a grid: what is in a plane of the body is so on the grid. */
static void put_on_grid(Filling *f)
{
    ShvVec3 middle;
    const ShvVec3 half = shv_outline_half(f->outline, &middle), low = shv_sub(middle, half);
    const double longest = 2.0 * fmax(half.x, fmax(half.y, half.z)), scale = (SHV_DELAUNAY_GRID - 1) / longest;
    for (int32_t i = 0; i < f->scatter.count; i++) {
        const ShvVec3 x = shv_scale(shv_sub(point(f, i), low), scale);
        const double at[3] = {x.x, x.y, x.z};
        for (int k = 0; k < 3; k++)
            f->grid[3 * (int64_t)i + k] = (int32_t)fmax(0.0, fmin(nearbyint(at[k]), SHV_DELAUNAY_GRID - 1));
    }
}

/* A sphere through three points of a plane and one off it is empty where the circle through the three is: the tets stand on the
   Delaunay triangles. The point above comes last in each of them. */
static void put_apex_last(Filling *f)
{
    static const int even[4][4] = {{1, 3, 2, 0}, {0, 2, 3, 1}, {0, 3, 1, 2}, {0, 1, 2, 3}};
    for (int32_t t = 0; t < f->delaunay.tet_count; t++) {
        int32_t *tet = f->delaunay.tets + 4 * (int64_t)t, old[4];
        int apex = 0;
        memcpy(old, tet, sizeof old);
        while (old[apex] != f->scatter.count) apex++;
        for (int i = 0; i < 4; i++) tet[i] = old[even[apex][i]];
    }
}

/* Of a tet, or of its triangle. */
static ShvVec3 middle_of(const Filling *f, const int32_t tet[4])
{
    const ShvVec3 three = shv_add(shv_add(point(f, tet[0]), point(f, tet[1])), point(f, tet[2]));
    return f->flat ? shv_scale(three, 1.0 / 3.0) : shv_scale(shv_add(three, point(f, tet[3])), 0.25);
}

static double size_of(const Filling *f, const int32_t tet[4])
{
    const ShvVec3 o = point(f, tet[0]);
    const ShvVec3 normal = shv_cross(shv_sub(point(f, tet[1]), o), shv_sub(point(f, tet[2]), o));
    return fmax(0.0, f->flat ? normal.z : shv_dot(normal, shv_sub(point(f, tet[3]), o)));
}

/* Those of the convex hull whose middle is not in the body. */
static bool is_outside(const Filling *f, const int32_t tet[4])
{
    return !(shv_outline_depth(f->outline, middle_of(f, tet)) > 0.0);
}

/* Four points of a curved surface may make a flat tet on it: without it the surface is as good. */
static bool is_flat(const Filling *f, const int32_t tet[4])
{
    for (int i = 0; i < 4; i++)
        if (f->scatter.held[tet[i]] == SHV_HELD_NOT) return false;
    return shv_improve_measure(f->scatter.positions, tet) < flat_share * f->edge &&
           shv_outline_depth(f->outline, middle_of(f, tet)) < flat_share * f->edge;
}

static void drop(Filling *f, bool (*unwanted)(const Filling *, const int32_t *))
{
    int32_t kept = 0;
    if (!f->outline->profile) return;
    for (int32_t t = 0; t < f->delaunay.tet_count; t++) {
        const int32_t *tet = f->delaunay.tets + 4 * (int64_t)t;
        if (unwanted(f, tet)) continue;
        memmove(f->delaunay.tets + 4 * (int64_t)kept++, tet, 4 * sizeof *tet);
    }
    f->delaunay.tet_count = kept;
}

static ShvStatus join_points(Filling *f, ShvError *error)
{
    const int32_t count = f->scatter.count;
    put_on_grid(f);
    for (int k = 0; f->flat && k < 3; k++) f->grid[3 * (int64_t)count + k] = k < 2 ? 0 : SHV_DELAUNAY_GRID - 1;
    shv_delaunay_release(&f->delaunay);
    SHV_TRY(shv_delaunay_make(&f->delaunay, f->memory, f->grid, f->flat ? count + 1 : count, error));
    if (f->flat) put_apex_last(f);
    drop(f, is_outside);
    return SHV_OK;
}

static void relax(Filling *f)
{
    memset(f->sums, 0, 4 * (size_t)f->scatter.count * sizeof *f->sums);
    for (int32_t t = 0; t < f->delaunay.tet_count; t++) {
        const int32_t *tet = f->delaunay.tets + 4 * (int64_t)t;
        const double size = size_of(f, tet);
        const ShvVec3 part = shv_scale(middle_of(f, tet), size);
        for (int i = 0; i < (f->flat ? 3 : 4); i++) {
            double *sum = f->sums + 4 * (int64_t)tet[i];
            shv_add_to3(sum, part);
            sum[3] += size;
        }
    }
    for (int32_t i = 0; i < f->scatter.count; i++) {
        const double *sum = f->sums + 4 * (int64_t)i;
        if (!(sum[3] > 0.0)) continue;
        const ShvVec3 mean = shv_scale(shv_load3(sum), 1.0 / sum[3]);
        shv_store3(f->scatter.positions + 3 * (int64_t)i,
                   shv_outline_keep(f->outline, f->scatter.held[i], point(f, i), mean));
    }
}

static ShvStatus fill(Filling *f, uint64_t seed, ShvError *error)
{
    SHV_TRY(shv_scatter_make(&f->scatter, f->memory, f->outline, f->edge, seed, error));
    const size_t count = (size_t)f->scatter.count + 1;
    f->grid = shv_allocate(f->memory, SHV_PART_GENERAL, 3 * count, sizeof *f->grid);
    f->sums = shv_allocate(f->memory, SHV_PART_GENERAL, 4 * count, sizeof *f->sums);
    if (!f->grid || !f->sums) return shv_fail_memory(error, "points of a mesh", 44 * count);
    SHV_TRY(join_points(f, error));
    for (int round = 0; round < ROUNDS; round++) {
        relax(f);
        SHV_TRY(join_points(f, error));
    }
    drop(f, is_flat);
    return SHV_OK;
}

/* ---- a plate ---- */

static bool comes_before(uint64_t seed, int32_t a, int32_t b)
{
    const uint64_t x = shv_random_bits(seed, (uint64_t)a), y = shv_random_bits(seed, (uint64_t)b);
    return x != y ? x < y : a < b;
}

/* Nodes of column i: i below, i + columns above; that in the middle of triangle t: t + 2 columns. */
static void raise_points(const Filling *f, ShvScatter *raised, double thickness)
{
    const int32_t columns = f->scatter.count;
    raised->count = 2 * columns + f->delaunay.tet_count;
    for (int32_t i = 0; i < 2 * columns; i++) {
        ShvVec3 x = point(f, i % columns);
        x.z = i < columns ? -0.5 * thickness : 0.5 * thickness;
        shv_store3(raised->positions + 3 * (int64_t)i, x);
        raised->held[i] = (uint8_t)(f->scatter.held[i % columns] | 4);
    }
    for (int32_t t = 0; t < f->delaunay.tet_count; t++)
        shv_store3(raised->positions + 3 * (int64_t)(2 * columns + t), middle_of(f, f->delaunay.tets + 4 * (int64_t)t));
}

/* The sides of a prism have their diagonals by chance, neighbours the same. */
static void cut_prisms(const Filling *f, int32_t *tets, uint64_t seed)
{
    const int32_t up = f->scatter.count;
    for (int32_t t = 0; t < f->delaunay.tet_count; t++) {
        const int32_t *n = f->delaunay.tets + 4 * (int64_t)t, middle = 2 * up + t;
        int32_t triangles[8][3] = {{n[0], n[1], n[2]}, {n[0] + up, n[2] + up, n[1] + up}};
        for (int side = 0; side < 3; side++) {
            const int32_t a = n[side], b = n[(side + 1) % 3];
            const bool rises = comes_before(seed, a, b);
            const int32_t first[3] = {a, a + up, rises ? b + up : b}, second[3] = {rises ? a : a + up, b + up, b};
            memcpy(triangles[2 + 2 * side], first, sizeof first);
            memcpy(triangles[3 + 2 * side], second, sizeof second);
        }
        for (int k = 0; k < 8; k++) {
            int32_t *tet = tets + 4 * (8 * (int64_t)t + k);
            memcpy(tet, triangles[k], sizeof triangles[k]);
            tet[3] = middle;
        }
    }
}

static ShvStatus raise_plate(Filling *f, double thickness, uint64_t seed, ShvError *error)
{
    const size_t triangles = (size_t)f->delaunay.tet_count, nodes = 2 * (size_t)f->scatter.count + triangles;
    ShvScatter raised = {.memory = f->memory};
    raised.positions = shv_allocate(f->memory, SHV_PART_GENERAL, 3 * nodes, sizeof *raised.positions);
    raised.held = shv_allocate(f->memory, SHV_PART_GENERAL, nodes, sizeof *raised.held);
    int32_t *cut = shv_allocate(f->memory, SHV_PART_GENERAL, 32 * triangles, sizeof *cut);
    int32_t *grid = shv_allocate(f->memory, SHV_PART_GENERAL, nodes, sizeof *grid);
    if (!raised.positions || !raised.held || !cut || !grid) {
        shv_scatter_release(&raised);
        shv_release(cut);
        shv_release(grid);
        return shv_fail_memory(error, "a plate", 29 * nodes + 128 * triangles);
    }
    raise_points(f, &raised, thickness);
    cut_prisms(f, cut, seed);
    shv_scatter_release(&f->scatter);
    shv_delaunay_release(&f->delaunay);
    shv_release(f->grid);
    f->scatter = raised;
    f->delaunay = (ShvDelaunay){(int32_t)(8 * triangles), cut};
    f->grid = grid;
    return SHV_OK;
}

/* ---- all ---- */

static ShvStatus better(Filling *f, double wanted, uint64_t seed, ShvError *error)
{
    ShvImprove improve = {.memory = f->memory,
                          .outline = f->outline,
                          .held = f->scatter.held,
                          .positions = f->scatter.positions,
                          .node_count = f->scatter.count,
                          .tet_count = f->delaunay.tet_count,
                          .tets = f->delaunay.tets,
                          .wanted = wanted,
                          .seed = seed + 2};
    const ShvStatus status = shv_improve(&improve, error);
    f->delaunay.tets = improve.tets;
    f->delaunay.tet_count = improve.tet_count;
    return status;
}

/* Nodes that no tet uses are left out. */
static ShvStatus hand_over(const Filling *f, ShvMesh *mesh, ShvError *error)
{
    int32_t nodes = 0;
    memset(f->grid, 0, (size_t)f->scatter.count * sizeof *f->grid);
    for (int64_t i = 0; i < 4 * (int64_t)f->delaunay.tet_count; i++)
        if (!f->grid[f->delaunay.tets[i]]) f->grid[f->delaunay.tets[i]] = ++nodes;
    SHV_TRY(shv_mesh_allocate(mesh, f->memory, nodes, f->delaunay.tet_count, error));
    for (int32_t i = 0; i < f->scatter.count; i++)
        if (f->grid[i]) shv_store3(mesh->positions + 3 * (int64_t)(f->grid[i] - 1), point(f, i));
    for (int64_t i = 0; i < 4 * (int64_t)f->delaunay.tet_count; i++)
        mesh->elements[i] = f->grid[f->delaunay.tets[i]] - 1;
    return SHV_OK;
}

static void release(Filling *f)
{
    shv_scatter_release(&f->scatter);
    shv_delaunay_release(&f->delaunay);
    shv_release(f->grid);
    shv_release(f->sums);
}

ShvStatus shv_mesh_unstructured(ShvMesh *mesh, ShvMemory *memory, const ShvOutline *outline, double edge, uint64_t seed,
                                ShvError *error)
{
    *mesh = (ShvMesh){0};
    Filling f = {.memory = memory, .outline = outline, .edge = edge};
    ShvStatus status = fill(&f, seed, error);
    if (status == SHV_OK) status = better(&f, wanted_share * edge, seed, error);
    if (status == SHV_OK) status = hand_over(&f, mesh, error);
    release(&f);
    return status;
}

ShvStatus shv_mesh_plate(ShvMesh *mesh, ShvMemory *memory, const double size[3], double edge, uint64_t seed,
                         ShvError *error)
{
    const ShvOutline outline = {.half = {0.5 * size[0], 0.5 * size[1]}};
    *mesh = (ShvMesh){0};
    Filling f = {.memory = memory, .outline = &outline, .flat = true, .edge = edge};
    ShvStatus status = fill(&f, seed, error);
    if (status == SHV_OK) status = raise_plate(&f, size[2], seed, error);
    if (status == SHV_OK) status = better(&f, wanted_half_share * 0.5 * size[2], seed, error);
    if (status == SHV_OK) status = hand_over(&f, mesh, error);
    release(&f);
    return status;
}
