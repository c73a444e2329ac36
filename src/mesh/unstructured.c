#include "mesh/unstructured.h"

#include <math.h>
#include <string.h>

#include "mesh/delaunay.h"
#include "mesh/improve.h"
#include "mesh/scatter.h"

/* How often points are moved to the mean of their tets. */
enum { ROUNDS = 6 };
/* Tets whose measure (improve.h) is this share of the edge and more are left alone: a regular tet has 0.41, those of the
   body-centred lattice have 0.35 to 0.39. */
static const double wanted_share = 0.31;
/* Tets on the surface of a turned body that are flatter than this share of the edge are left out. */
static const double flat_share = 0.1;

typedef struct Filling {
    ShvMemory *memory;
    const ShvOutline *outline; /* stretched */
    ShvScatter scatter;
    int32_t *grid; /* 3 a point, as delaunay.h wants them */
    double *sums;  /* 4 a point */
    ShvDelaunay delaunay;
    ShvVec3 stretch;
    double edge;
} Filling;

static ShvVec3 point(const Filling *f, int32_t i)
{
    return shv_load3(f->scatter.positions + 3 * (int64_t)i);
}

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

static ShvVec3 middle_of(const Filling *f, const int32_t tet[4])
{
    const ShvVec3 sum =
        shv_add(shv_add(point(f, tet[0]), point(f, tet[1])), shv_add(point(f, tet[2]), point(f, tet[3])));
    return shv_scale(sum, 0.25);
}

/* Those of the convex hull whose middle is in the body. */
static void drop_outer(Filling *f)
{
    int32_t kept = 0;
    if (!f->outline->profile) return;
    for (int32_t t = 0; t < f->delaunay.tet_count; t++) {
        const int32_t *tet = f->delaunay.tets + 4 * (int64_t)t;
        if (!(shv_outline_depth(f->outline, middle_of(f, tet)) > 0.0)) continue;
        memmove(f->delaunay.tets + 4 * (int64_t)kept++, tet, 4 * sizeof *tet);
    }
    f->delaunay.tet_count = kept;
}

static ShvStatus join_points(Filling *f, ShvError *error)
{
    put_on_grid(f);
    shv_delaunay_release(&f->delaunay);
    SHV_TRY(shv_delaunay_make(&f->delaunay, f->memory, f->grid, f->scatter.count, error));
    drop_outer(f);
    return SHV_OK;
}

static double volume_of(const Filling *f, const int32_t tet[4])
{
    const ShvVec3 o = point(f, tet[0]), a = shv_sub(point(f, tet[1]), o), b = shv_sub(point(f, tet[2]), o);
    return fmax(0.0, shv_dot(shv_cross(a, b), shv_sub(point(f, tet[3]), o)));
}

static void relax(Filling *f)
{
    memset(f->sums, 0, 4 * (size_t)f->scatter.count * sizeof *f->sums);
    for (int32_t t = 0; t < f->delaunay.tet_count; t++) {
        const int32_t *tet = f->delaunay.tets + 4 * (int64_t)t;
        const double volume = volume_of(f, tet);
        const ShvVec3 part = shv_scale(middle_of(f, tet), volume);
        for (int i = 0; i < 4; i++) {
            double *sum = f->sums + 4 * (int64_t)tet[i];
            shv_add_to3(sum, part);
            sum[3] += volume;
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

/* ---- the surface of a turned body ---- */

/* Four points of a curved surface may make a flat tet on it: without it the surface is as good. */
static void peel(Filling *f)
{
    int32_t kept = 0;
    if (!f->outline->profile) return;
    for (int32_t t = 0; t < f->delaunay.tet_count; t++) {
        const int32_t *tet = f->delaunay.tets + 4 * (int64_t)t;
        bool outside = true;
        for (int i = 0; i < 4; i++) outside = outside && f->scatter.held[tet[i]] != SHV_HELD_NOT;
        if (outside && shv_improve_measure(f->scatter.positions, tet) < flat_share * f->edge &&
            shv_outline_depth(f->outline, middle_of(f, tet)) < flat_share * f->edge)
            continue;
        memmove(f->delaunay.tets + 4 * (int64_t)kept++, tet, 4 * sizeof *tet);
    }
    f->delaunay.tet_count = kept;
}

/* ---- all ---- */

static ShvStatus fill(Filling *f, uint64_t seed, ShvError *error)
{
    SHV_TRY(shv_scatter_make(&f->scatter, f->memory, f->outline, f->edge, seed, error));
    const size_t count = (size_t)f->scatter.count;
    f->grid = shv_allocate(f->memory, SHV_PART_GENERAL, 3 * count, sizeof *f->grid);
    f->sums = shv_allocate(f->memory, SHV_PART_GENERAL, 4 * count, sizeof *f->sums);
    if (!f->grid || !f->sums) return shv_fail_memory(error, "points of a mesh", 44 * count);
    SHV_TRY(join_points(f, error));
    for (int round = 0; round < ROUNDS; round++) {
        relax(f);
        SHV_TRY(join_points(f, error));
    }
    peel(f);
    return SHV_OK;
}

static ShvStatus better(Filling *f, uint64_t seed, ShvError *error)
{
    for (int32_t i = 0; i < f->scatter.count; i++) {
        double *x = f->scatter.positions + 3 * (int64_t)i;
        shv_store3(x, shv_vec3(x[0] / f->stretch.x, x[1] / f->stretch.y, x[2] / f->stretch.z));
    }
    const double flattest = fmax(f->stretch.x, fmax(f->stretch.y, f->stretch.z));
    ShvImprove improve = {.memory = f->memory,
                          .outline = f->outline,
                          .held = f->scatter.held,
                          .positions = f->scatter.positions,
                          .node_count = f->scatter.count,
                          .tet_count = f->delaunay.tet_count,
                          .tets = f->delaunay.tets,
                          .wanted = wanted_share * f->edge / flattest,
                          .seed = seed + 1};
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

ShvStatus shv_mesh_unstructured(ShvMesh *mesh, ShvMemory *memory, const ShvOutline *outline, ShvVec3 stretch,
                                double edge, uint64_t seed, ShvError *error)
{
    *mesh = (ShvMesh){0};
    Filling f = {.memory = memory, .outline = outline, .stretch = stretch, .edge = edge};
    ShvStatus status = fill(&f, seed, error);
    if (status == SHV_OK) status = better(&f, seed, error);
    if (status == SHV_OK) status = hand_over(&f, mesh, error);
    shv_scatter_release(&f.scatter);
    shv_delaunay_release(&f.delaunay);
    shv_release(f.grid);
    shv_release(f.sums);
    return status;
}
