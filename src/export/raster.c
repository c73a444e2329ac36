#include "export/raster.h"

#include "base/memory.h"

static const double SAMPLES = 2.0; /* a pixel and direction */

ShvStatus shv_raster_create(ShvRaster *raster, double width, double height, struct ShvMemory *memory, ShvError *error)
{
    *raster = (ShvRaster){.columns = (int32_t)ceil(SAMPLES * width), .rows = (int32_t)ceil(SAMPLES * height)};
    const size_t count = (size_t)raster->columns * (size_t)raster->rows;
    raster->near = shv_allocate(memory, SHV_PART_RECORD, count, sizeof *raster->near);
    raster->item = shv_allocate(memory, SHV_PART_RECORD, count, sizeof *raster->item);
    if (raster->near && raster->item) return SHV_OK;
    shv_raster_release(raster);
    return shv_fail_memory(error, "the samples of a picture; ask for a smaller one", 16 * count);
}

void shv_raster_release(ShvRaster *raster)
{
    shv_release(raster->near);
    shv_release(raster->item);
    *raster = (ShvRaster){.near = NULL};
}

void shv_raster_clear(ShvRaster *raster)
{
    for (int64_t i = 0; i < (int64_t)raster->columns * raster->rows; i++) {
        raster->near[i] = 0.0;
        raster->item[i] = -1;
    }
}

/* First sample at or behind a place, and the end of those before it. */
static int32_t sample_at(double place, int32_t count)
{
    const double index = ceil(SAMPLES * place - 0.5);
    return index < 0.0 ? 0 : index > count ? count : (int32_t)index;
}

static double least(double a, double b, double c)
{
    return fmin(a, fmin(b, c));
}

static double most(double a, double b, double c)
{
    return fmax(a, fmax(b, c));
}

/* Twice the area left of the line from a to b, up to (x, y). */
static double side(ShvScreenPoint a, ShvScreenPoint b, double x, double y)
{
    return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

int64_t shv_raster_enter(ShvRaster *raster, const ShvScreenPoint corner[3], int64_t item)
{
    const ShvScreenPoint a = corner[0], b = corner[1], c = corner[2];
    const double area = side(a, b, c.x, c.y);
    if (!(fabs(area) > 0.0)) return 0;
    const int32_t left = sample_at(least(a.x, b.x, c.x), raster->columns);
    const int32_t right = sample_at(most(a.x, b.x, c.x), raster->columns);
    const int32_t bottom = sample_at(most(a.y, b.y, c.y), raster->rows);
    int64_t won = 0;
    for (int32_t row = sample_at(least(a.y, b.y, c.y), raster->rows); row < bottom; row++) {
        for (int32_t column = left; column < right; column++) {
            const double x = (column + 0.5) / SAMPLES, y = (row + 0.5) / SAMPLES;
            const double u = side(b, c, x, y) / area, v = side(c, a, x, y) / area, w = side(a, b, x, y) / area;
            if (u < 0.0 || v < 0.0 || w < 0.0) continue;
            const int64_t sample = (int64_t)row * raster->columns + column;
            const double near = u * a.near + v * b.near + w * c.near;
            if (!(near > raster->near[sample])) continue;
            raster->near[sample] = near;
            raster->item[sample] = item;
            won++;
        }
    }
    return won;
}
