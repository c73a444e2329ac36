#include "mesh/scatter.h"

#include <math.h>

#include "base/deterministic.h"
#include "base/random.h"

/* Of the edge: how near points may lie, how far apart those along edges of the body are, and how deep those inside lie at
   least. The mean edge of the relaxed tets is then within some percent of what is asked. */
static const double apart = 0.74, along_edges = 0.98, depth_share = 0.5;
/* Darts thrown per place that a point could have; with more, hardly any find room. */
static const double darts = 24.0;

/* Cells as wide as points are apart, each with a list of its points. */
typedef struct Grid {
    int32_t cells[3];
    int32_t *first, *next; /* of a cell; of a point */
    ShvVec3 low;
    double width;
} Grid;

typedef struct Throw {
    ShvScatter *scatter;
    const ShvOutline *outline;
    Grid grid;
    double edge;
    uint64_t seed, drawn;
} Throw;

static double draw(Throw *t)
{
    return shv_random_uniform(t->seed, t->drawn++);
}

/* ---- the grid ---- */

static void cell_of(const Grid *grid, ShvVec3 x, int32_t cell[3])
{
    const double at[3] = {x.x - grid->low.x, x.y - grid->low.y, x.z - grid->low.z};
    for (int k = 0; k < 3; k++) {
        const double place = floor(at[k] / grid->width);
        cell[k] = (int32_t)fmax(0.0, fmin(place, grid->cells[k] - 1));
    }
}

static int64_t number_of(const Grid *grid, int32_t x, int32_t y, int32_t z)
{
    return ((int64_t)z * grid->cells[1] + y) * grid->cells[0] + x;
}

/* Sides of a wall have points of their own, however thin it is. */
static bool are_apart(const Throw *t, ShvVec3 x, uint8_t held, int32_t other)
{
    const ShvVec3 y = shv_load3(t->scatter->positions + 3 * (int64_t)other), d = shv_sub(y, x);
    if (shv_dot(d, d) >= t->grid.width * t->grid.width) return true;
    return held == SHV_HELD_SURFACE && t->scatter->held[other] == SHV_HELD_SURFACE &&
           shv_outline_are_opposite(t->outline, x, y);
}

static bool cell_has_near(const Throw *t, int64_t cell, ShvVec3 x, uint8_t held)
{
    for (int32_t i = t->grid.first[cell]; i > 0; i = t->grid.next[i - 1])
        if (!are_apart(t, x, held, i - 1)) return true;
    return false;
}

static bool has_near(const Throw *t, ShvVec3 x, uint8_t held)
{
    const Grid *grid = &t->grid;
    int32_t at[3], low[3], high[3];
    cell_of(grid, x, at);
    for (int k = 0; k < 3; k++) {
        low[k] = at[k] > 0 ? at[k] - 1 : 0;
        high[k] = at[k] + 1 < grid->cells[k] ? at[k] + 1 : at[k];
    }
    for (int32_t c = low[2]; c <= high[2]; c++)
        for (int32_t b = low[1]; b <= high[1]; b++)
            for (int32_t a = low[0]; a <= high[0]; a++)
                if (cell_has_near(t, number_of(grid, a, b, c), x, held)) return true;
    return false;
}

static ShvStatus make_grid(Throw *t, ShvError *error)
{
    Grid *grid = &t->grid;
    ShvVec3 middle;
    const ShvVec3 half = shv_outline_half(t->outline, &middle);
    const double size[3] = {2.0 * half.x, 2.0 * half.y, 2.0 * half.z};
    size_t cells = 1;
    grid->width = apart * t->edge;
    grid->low = shv_sub(middle, half);
    for (int k = 0; k < 3; k++) {
        grid->cells[k] = (int32_t)(size[k] / grid->width) + 1;
        cells *= (size_t)grid->cells[k];
    }
    grid->first = shv_allocate(t->scatter->memory, SHV_PART_GENERAL, cells, sizeof *grid->first);
    return grid->first ? SHV_OK : shv_fail_memory(error, "a grid of points", cells * sizeof *grid->first);
}

/* ---- points ---- */

static ShvStatus grow(Throw *t, ShvError *error)
{
    ShvScatter *s = t->scatter;
    const int32_t more = 2 * s->capacity + 1024;
    const size_t bytes = (size_t)more * 29;
    SHV_RESIZE(s->memory, SHV_PART_GENERAL, s->positions, 3 * (size_t)more, "points", bytes, error);
    SHV_RESIZE(s->memory, SHV_PART_GENERAL, s->held, (size_t)more, "points", bytes, error);
    SHV_RESIZE(s->memory, SHV_PART_GENERAL, t->grid.next, (size_t)more, "points", bytes, error);
    s->capacity = more;
    return SHV_OK;
}

static ShvStatus add(Throw *t, ShvVec3 x, uint8_t held, ShvError *error)
{
    ShvScatter *s = t->scatter;
    int32_t at[3];
    if (s->count == s->capacity) SHV_TRY(grow(t, error));
    cell_of(&t->grid, x, at);
    const int64_t cell = number_of(&t->grid, at[0], at[1], at[2]);
    shv_store3(s->positions + 3 * (int64_t)s->count, x);
    s->held[s->count] = held;
    t->grid.next[s->count] = t->grid.first[cell];
    t->grid.first[cell] = ++s->count;
    return SHV_OK;
}

static int32_t parts_of(double length, double edge)
{
    return (int32_t)fmax(1.0, nearbyint(length / (along_edges * edge)));
}

/* Corners, and points along the edges of a box. */
static ShvStatus add_box_edges(Throw *t, ShvError *error)
{
    const double *half = t->outline->half;
    const bool flat = !(half[2] > 0.0);
    for (int corner = 0; corner < (flat ? 4 : 8); corner++)
        SHV_TRY(add(
            t,
            shv_vec3(corner & 1 ? half[0] : -half[0], corner & 2 ? half[1] : -half[1], corner & 4 ? half[2] : -half[2]),
            7, error));
    for (int edge = 0; edge < 12; edge++) {
        const int axis = edge / 4, second = (axis + 1) % 3, third = (axis + 2) % 3;
        const int32_t parts = parts_of(2.0 * half[axis], t->edge);
        const bool above = (second == 2 && (edge & 1)) || (third == 2 && (edge & 2));
        double x[3];
        if (flat && above) continue;
        x[second] = edge & 1 ? half[second] : -half[second];
        x[third] = edge & 2 ? half[third] : -half[third];
        for (int32_t i = 1; i < parts; i++) {
            x[axis] = half[axis] * (2.0 * i / parts - 1.0);
            SHV_TRY(add(t, shv_load3(x), (uint8_t)(7u & ~(1u << axis)), error));
        }
    }
    return SHV_OK;
}

/* Points along the rings that sharp corners of a profile sweep, each begun anywhere. */
static ShvStatus add_rings(Throw *t, ShvError *error)
{
    for (int32_t i = 0; i < t->outline->count; i++) {
        const double r = t->outline->profile[2 * (int64_t)i], z = t->outline->profile[2 * (int64_t)i + 1];
        if (!shv_outline_is_sharp(t->outline, i)) continue;
        const int32_t parts = (int32_t)fmax(6.0, parts_of(2.0 * SHV_PI * r, t->edge));
        const double begin = draw(t);
        for (int32_t k = 0; k < parts; k++) {
            const double angle = 2.0 * SHV_PI * (k + begin) / parts;
            SHV_TRY(add(t, shv_vec3(r * shv_cos(angle), r * shv_sin(angle), z), SHV_HELD_RING, error));
        }
    }
    return SHV_OK;
}

static ShvStatus add_surface(Throw *t, ShvError *error)
{
    const double width = t->grid.width, tries = darts * shv_outline_area(t->outline) / (width * width);
    if (!t->outline->profile && !(t->outline->half[2] > 0.0)) return SHV_OK;
    for (int64_t i = 0; i < (int64_t)tries; i++) {
        uint8_t held;
        double draws[3];
        for (int k = 0; k < 3; k++) draws[k] = draw(t);
        const ShvVec3 x = shv_outline_draw(t->outline, draws, &held);
        if (!has_near(t, x, held)) SHV_TRY(add(t, x, held, error));
    }
    return SHV_OK;
}

static ShvStatus add_inside(Throw *t, ShvError *error)
{
    ShvVec3 middle;
    const ShvVec3 half = shv_outline_half(t->outline, &middle);
    const double width = t->grid.width, depth = depth_share * t->edge;
    const double tries = darts * 8.0 * half.x * half.y * fmax(half.z, 0.5 * width) / (width * width * width);
    for (int64_t i = 0; i < (int64_t)tries; i++) {
        const double a = 2.0 * draw(t) - 1.0, b = 2.0 * draw(t) - 1.0, c = 2.0 * draw(t) - 1.0;
        const ShvVec3 x = shv_add(middle, shv_vec3(a * half.x, b * half.y, c * half.z));
        if (has_near(t, x, SHV_HELD_NOT) || shv_outline_depth(t->outline, x) < depth) continue;
        SHV_TRY(add(t, x, SHV_HELD_NOT, error));
    }
    return SHV_OK;
}

static ShvStatus throw_all(Throw *t, ShvError *error)
{
    SHV_TRY(make_grid(t, error));
    if (t->outline->profile)
        SHV_TRY(add_rings(t, error));
    else
        SHV_TRY(add_box_edges(t, error));
    SHV_TRY(add_surface(t, error));
    return add_inside(t, error);
}

ShvStatus shv_scatter_make(ShvScatter *scatter, ShvMemory *memory, const ShvOutline *outline, double edge,
                           uint64_t seed, ShvError *error)
{
    *scatter = (ShvScatter){.memory = memory};
    Throw t = {.scatter = scatter, .outline = outline, .edge = edge, .seed = seed};
    const ShvStatus status = throw_all(&t, error);
    shv_release(t.grid.first);
    shv_release(t.grid.next);
    if (status != SHV_OK) shv_scatter_release(scatter);
    return status;
}

void shv_scatter_release(ShvScatter *scatter)
{
    shv_release(scatter->positions);
    shv_release(scatter->held);
    *scatter = (ShvScatter){0};
}
