#include "convex/occupancy.h"

#include "base/deterministic.h"

/* Edge of a cell as a share of the mean edge of the tets: finer cells no longer change the fitted hulls' error. */
#define CELL_SHARE 0.2
/* A tet of mean size holds 15 cells; a body that fills a third of its box needs 45 a tet. */
#define CELLS_A_TET  60.0
#define FEWEST_CELLS 4096.0

static void find_box(const ShvFragmentTets *tets, double low[3], double extent[3])
{
    for (int i = 0; i < 3; i++) {
        double high = low[i] = tets->positions[i];
        for (int64_t n = 1; n < tets->node_count; n++) {
            const double x = tets->positions[3 * n + i];
            low[i] = x < low[i] ? x : low[i];
            high = x > high ? x : high;
        }
        extent[i] = high - low[i];
    }
}

/* One empty cell beyond the box on every side, so that what reaches out of it is seen as outside. */
static double count_cells(ShvOccupancy *occupancy, const double extent[3])
{
    double cells = 1.0;
    for (int i = 0; i < 3; i++) {
        const double along = ceil(extent[i] / occupancy->cell) + 2.0;
        occupancy->size[i] = along < 1e9 ? (int32_t)along : 1000000000;
        cells *= along;
    }
    return cells;
}

static void size_grid(ShvOccupancy *occupancy, const ShvFragmentTets *tets)
{
    double low[3], extent[3];
    find_box(tets, low, extent);
    const double most = fmax(FEWEST_CELLS, CELLS_A_TET * tets->tet_count);
    occupancy->cell = CELL_SHARE * tets->edge;
    for (double cells = count_cells(occupancy, extent); cells > most; cells = count_cells(occupancy, extent))
        occupancy->cell *= fmax(1.05, shv_power(cells / most, 1.0 / 3.0));
    occupancy->inverse = 1.0 / occupancy->cell;
    for (int i = 0; i < 3; i++) occupancy->low[i] = low[i] + 0.5 * (extent[i] - occupancy->cell * occupancy->size[i]);
}

/* Cells of one axis whose centres lie in [low, high]. */
static void cell_range(const ShvOccupancy *occupancy, int axis, double low, double high, int32_t *first, int32_t *end)
{
    const double a = ceil((low - occupancy->low[axis]) * occupancy->inverse - 0.5);
    const double b = floor((high - occupancy->low[axis]) * occupancy->inverse - 0.5) + 1.0;
    *first = a > 0.0 ? (a < occupancy->size[axis] ? (int32_t)a : occupancy->size[axis]) : 0;
    *end = b > 0.0 ? (b < occupancy->size[axis] ? (int32_t)b : occupancy->size[axis]) : 0;
}

/* A convex body as `count` half-spaces in a box. */
typedef struct Body {
    int32_t count;
    const double (*planes)[4];
    const double *low, *high;
} Body;

/* The part of a line along z at (x, y) that lies in the body. */
static void clip_row(const Body *body, double x, double y, double *low, double *high)
{
    for (int32_t p = 0; p < body->count; p++) {
        const double *n = body->planes[p];
        const double rest = n[3] - n[0] * x - n[1] * y;
        if (n[2] > 0.0 && rest < *high * n[2])
            *high = rest / n[2];
        else if (n[2] < 0.0 && rest < *low * n[2])
            *low = rest / n[2];
        else if (n[2] == 0.0 && rest < 0.0)
            *high = -(double)INFINITY;
        if (*high < *low) return;
    }
}

/* Cells with their centre in the body: those that are empty get `value`, all get the bits `mark`. */
static void rasterise(ShvOccupancy *occupancy, const Body *body, uint8_t value, uint8_t mark)
{
    int32_t i0, i1, j0, j1;
    cell_range(occupancy, 0, body->low[0], body->high[0], &i0, &i1);
    cell_range(occupancy, 1, body->low[1], body->high[1], &j0, &j1);
    for (int32_t i = i0; i < i1; i++)
        for (int32_t j = j0; j < j1; j++) {
            double low = body->low[2], high = body->high[2];
            clip_row(body, occupancy->low[0] + (i + 0.5) * occupancy->cell,
                     occupancy->low[1] + (j + 0.5) * occupancy->cell, &low, &high);
            if (high < low) continue;
            int32_t k0, k1;
            cell_range(occupancy, 2, low, high, &k0, &k1);
            uint8_t *row = occupancy->cells + ((int64_t)i * occupancy->size[1] + j) * occupancy->size[2];
            for (int32_t k = k0; k < k1; k++) row[k] = (uint8_t)((row[k] == SHV_CELL_EMPTY ? value : row[k]) | mark);
        }
}

static void rasterise_tet(ShvOccupancy *occupancy, const ShvFragmentTets *tets, int32_t tet, uint8_t value)
{
    ShvVec3 x[4];
    shv_fragment_tet_corners(tets, tet, x);
    double planes[4][4], low[3], high[3], corners[4][3];
    for (int f = 0; f < 4; f++) {
        const ShvVec3 a = x[shv_face_corners[f][0]], b = x[shv_face_corners[f][1]], c = x[shv_face_corners[f][2]];
        const ShvVec3 normal = shv_cross(shv_sub(b, a), shv_sub(c, a));
        shv_store3(planes[f], normal);
        planes[f][3] = shv_dot(normal, a);
        shv_store3(corners[f], x[f]);
    }
    for (int i = 0; i < 3; i++) {
        low[i] = high[i] = corners[0][i];
        for (int a = 1; a < 4; a++) {
            low[i] = corners[a][i] < low[i] ? corners[a][i] : low[i];
            high[i] = corners[a][i] > high[i] ? corners[a][i] : high[i];
        }
    }
    const Body body = {4, (const double(*)[4])planes, low, high};
    rasterise(occupancy, &body, value, 0);
}

ShvStatus shv_occupancy_make(ShvOccupancy *occupancy, ShvMemory *memory, const ShvFragmentTets *tets,
                             const ShvHullClusters *clusters, ShvError *error)
{
    *occupancy = (ShvOccupancy){0};
    size_grid(occupancy, tets);
    const size_t count = (size_t)occupancy->size[0] * (size_t)occupancy->size[1] * (size_t)occupancy->size[2];
    occupancy->cells = shv_allocate(memory, SHV_PART_RIGID, count, 1);
    if (!occupancy->cells) return shv_fail_memory(error, "the grid of a fragment", count);
    for (int32_t c = 0; c < clusters->count; c++)
        for (int32_t i = clusters->items[c].begin; i < clusters->items[c].end; i++)
            rasterise_tet(occupancy, tets, clusters->order[i], (uint8_t)(c + 1));
    return SHV_OK;
}

void shv_occupancy_release(ShvOccupancy *occupancy)
{
    shv_release(occupancy->cells);
    *occupancy = (ShvOccupancy){0};
}

void shv_occupancy_cover(ShvOccupancy *occupancy, const ShvPlanes *planes)
{
    const Body body = {planes->count, (const double(*)[4])planes->planes, planes->low, planes->high};
    rasterise(occupancy, &body, SHV_CELL_EMPTY, SHV_CELL_COVERED);
}

void shv_occupancy_measure(const ShvOccupancy *occupancy, double *outside, double *missing, double *inside)
{
    const int64_t cells = (int64_t)occupancy->size[0] * occupancy->size[1] * occupancy->size[2];
    int64_t counts[2][2] = {{0}};
    for (int64_t i = 0; i < cells; i++)
        counts[occupancy->cells[i] >= SHV_CELL_COVERED][(occupancy->cells[i] & ~SHV_CELL_COVERED) != SHV_CELL_EMPTY]++;
    const double volume = occupancy->cell * occupancy->cell * occupancy->cell;
    *outside = volume * (double)counts[1][0];
    *missing = volume * (double)counts[0][1];
    *inside = volume * (double)(counts[0][1] + counts[1][1]);
}
