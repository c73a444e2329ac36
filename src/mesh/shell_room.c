/* How far a vertex sees through the body. Triangles are binned into the cells of a uniform grid that they may touch; a
   ray asks the cells around it. */
#include <stdbool.h>

#include "mesh/shell.h"

typedef struct Grid {
    ShvVec3 origin;
    double reach, cell;
    int32_t counts[3];
    int64_t *start;     /* cells + 1 */
    int32_t *triangles; /* of the cells, one after the other */
} Grid;

typedef struct Range {
    int32_t low[3], high[3]; /* both inclusive */
} Range;

static ShvVec3 smaller(ShvVec3 a, ShvVec3 b)
{
    return shv_vec3(fmin(a.x, b.x), fmin(a.y, b.y), fmin(a.z, b.z));
}
static ShvVec3 larger(ShvVec3 a, ShvVec3 b)
{
    return shv_vec3(fmax(a.x, b.x), fmax(a.y, b.y), fmax(a.z, b.z));
}

static int32_t cell_at(const Grid *grid, double offset, int axis)
{
    const double index = floor(offset / grid->cell);
    return index <= 0.0 ? 0 : index >= grid->counts[axis] ? grid->counts[axis] - 1 : (int32_t)index;
}

/* Cells that the box from `low` to `high` touches. */
static Range range_of(const Grid *grid, ShvVec3 low, ShvVec3 high)
{
    const ShvVec3 a = shv_sub(low, grid->origin), b = shv_sub(high, grid->origin);
    return (Range){{cell_at(grid, a.x, 0), cell_at(grid, a.y, 1), cell_at(grid, a.z, 2)},
                   {cell_at(grid, b.x, 0), cell_at(grid, b.y, 1), cell_at(grid, b.z, 2)}};
}

static Range range_of_triangle(const Grid *grid, const ShvShell *shell, int32_t triangle)
{
    const int32_t *c = shv_shell_corners(shell, triangle);
    const ShvVec3 x = shv_surface_position(&shell->surface, c[0]), y = shv_surface_position(&shell->surface, c[1]),
                  z = shv_surface_position(&shell->surface, c[2]);
    return range_of(grid, smaller(x, smaller(y, z)), larger(x, larger(y, z)));
}

static int64_t cells_in(const Range *r)
{
    return (int64_t)(r->high[0] - r->low[0] + 1) * (r->high[1] - r->low[1] + 1) * (r->high[2] - r->low[2] + 1);
}

static int64_t cell_index(const Grid *grid, int32_t i, int32_t j, int32_t k)
{
    return ((int64_t)k * grid->counts[1] + j) * grid->counts[0] + i;
}

/* Cells as small as `reach` and the number of triangles make sensible; doubled while large triangles touch too many. */
static void choose_cells(Grid *grid, const ShvShell *shell, double reach)
{
    const int32_t triangles = shell->surface.triangle_count;
    ShvVec3 low = shv_surface_position(&shell->surface, 0), high = low;
    for (int32_t v = 1; v < shell->surface.node_count; v++) {
        low = smaller(low, shv_surface_position(&shell->surface, v));
        high = larger(high, shv_surface_position(&shell->surface, v));
    }
    const ShvVec3 extent = shv_sub(high, low);
    const double longest = fmax(extent.x, fmax(extent.y, extent.z));
    int32_t most = 1; /* along an axis: at most about 8 cells a triangle */
    while ((int64_t)most * most * most < triangles) most *= 2;
    grid->origin = low;
    grid->reach = fmin(reach, 2.0 * longest); /* the diagonal is at most √3 × longest */
    grid->cell = fmax(grid->reach, longest / (double)most);
    for (;; grid->cell *= 2.0) {
        int64_t entries = 0;
        grid->counts[0] = (int32_t)(extent.x / grid->cell) + 1;
        grid->counts[1] = (int32_t)(extent.y / grid->cell) + 1;
        grid->counts[2] = (int32_t)(extent.z / grid->cell) + 1;
        for (int32_t t = 0; t < triangles; t++) {
            const Range r = range_of_triangle(grid, shell, t);
            entries += cells_in(&r);
        }
        if (entries <= 32 * (int64_t)triangles) return;
    }
}

/* Counts (list NULL) or enters a triangle into its cells, from the end of each backwards. */
static void bin_triangle(Grid *grid, const Range *r, int32_t triangle)
{
    for (int32_t k = r->low[2]; k <= r->high[2]; k++)
        for (int32_t j = r->low[1]; j <= r->high[1]; j++)
            for (int32_t i = r->low[0]; i <= r->high[0]; i++) {
                const int64_t cell = cell_index(grid, i, j, k);
                if (grid->triangles)
                    grid->triangles[--grid->start[cell]] = triangle;
                else
                    grid->start[cell]++;
            }
}

static void bin_triangles(Grid *grid, const ShvShell *shell)
{
    for (int32_t t = shell->surface.triangle_count - 1; t >= 0; t--) {
        const Range r = range_of_triangle(grid, shell, t);
        bin_triangle(grid, &r, t);
    }
}

static void release(Grid *grid)
{
    shv_release(grid->start);
    shv_release(grid->triangles);
}

static ShvStatus make_grid(Grid *grid, const ShvShell *shell, double reach, ShvError *error)
{
    *grid = (Grid){0};
    choose_cells(grid, shell, reach);
    ShvMemory *memory = shell->surface.memory;
    const int64_t cells = (int64_t)grid->counts[0] * grid->counts[1] * grid->counts[2];
    grid->start = shv_allocate(memory, SHV_PART_GENERAL, (size_t)cells + 1, sizeof *grid->start);
    if (!grid->start) return shv_fail_memory(error, "the cells of a shell", (size_t)(cells + 1) * 8);
    bin_triangles(grid, shell);
    for (int64_t c = 0; c < cells; c++) grid->start[c + 1] += grid->start[c];
    const size_t entries = (size_t)grid->start[cells];
    grid->triangles = shv_allocate(memory, SHV_PART_GENERAL, entries, sizeof *grid->triangles);
    if (!grid->triangles) {
        release(grid);
        return shv_fail_memory(error, "the cells of a shell", entries * sizeof *grid->triangles);
    }
    bin_triangles(grid, shell);
    return SHV_OK;
}

/* Distance along the unit `direction` from `from` to the triangle, or infinity (Möller & Trumbore 1997). A ray through
   an edge or a corner must not slip between two triangles: the border is a little wider than the triangle. */
static double distance_to(const ShvShell *shell, int32_t triangle, ShvVec3 from, ShvVec3 direction)
{
    const double slack = 1e-9;
    const int32_t *c = shv_shell_corners(shell, triangle);
    const ShvVec3 a = shv_surface_position(&shell->surface, c[0]);
    const ShvVec3 ab = shv_sub(shv_surface_position(&shell->surface, c[1]), a);
    const ShvVec3 ac = shv_sub(shv_surface_position(&shell->surface, c[2]), a);
    const ShvVec3 p = shv_cross(direction, ac);
    const double determinant = shv_dot(ab, p);
    /* The far wall is met from inside, which the sign of the determinant tells. */
    if (!(determinant < 0.0)) return HUGE_VAL;
    const ShvVec3 s = shv_sub(from, a), q = shv_cross(s, ab);
    const double u = shv_dot(s, p) / determinant, v = shv_dot(direction, q) / determinant;
    if (!(u >= -slack && v >= -slack && u + v <= 1.0 + slack)) return HUGE_VAL;
    const double distance = shv_dot(ac, q) / determinant;
    return distance > 0.0 ? distance : HUGE_VAL;
}

static double room_at(const Grid *grid, const ShvShell *shell, int32_t node)
{
    const ShvVec3 from = shv_surface_position(&shell->surface, node);
    const ShvVec3 direction = shv_scale(shv_load3(shell->normals + 3 * (int64_t)node), -1.0);
    const ShvVec3 to = shv_madd(from, grid->reach, direction);
    const Range r = range_of(grid, smaller(from, to), larger(from, to));
    double nearest = HUGE_VAL;
    for (int32_t k = r.low[2]; k <= r.high[2]; k++)
        for (int32_t j = r.low[1]; j <= r.high[1]; j++)
            for (int32_t i = r.low[0]; i <= r.high[0]; i++) {
                const int64_t cell = cell_index(grid, i, j, k);
                for (int64_t e = grid->start[cell]; e < grid->start[cell + 1]; e++) {
                    const int32_t *c = shv_shell_corners(shell, grid->triangles[e]);
                    if (c[0] == node || c[1] == node || c[2] == node) continue;
                    nearest = fmin(nearest, distance_to(shell, grid->triangles[e], from, direction));
                }
            }
    return nearest;
}

ShvStatus shv_shell_cap_by_room(ShvShell *shell, double share, double reach, ShvError *error)
{
    Grid grid;
    SHV_TRY(make_grid(&grid, shell, reach, error));
    for (int32_t v = 0; v < shell->surface.node_count; v++)
        shell->depths[v] = fmin(shell->depths[v], share * room_at(&grid, shell, v));
    release(&grid);
    return SHV_OK;
}
