/* A grid of samples over a picture that finds out which triangles can be seen. */
#ifndef SHV_EXPORT_RASTER_H
#define SHV_EXPORT_RASTER_H

#include <stdint.h>

#include "export/camera.h"
#include "shiver/status.h"

struct ShvMemory;

typedef struct ShvRaster {
    int32_t columns, rows;
    double *near;  /* of the nearest triangle at each sample; 0: none */
    int64_t *item; /* its number, −1: none */
} ShvRaster;

/* Two samples a pixel in each direction. On failure everything is released. */
ShvStatus shv_raster_create(ShvRaster *raster, double width, double height, struct ShvMemory *memory, ShvError *error);
void shv_raster_release(ShvRaster *raster);
void shv_raster_clear(ShvRaster *raster);
/* Enters a triangle, seen from either side, where it is nearer than what is there; returns the number of samples it won. */
int64_t shv_raster_enter(ShvRaster *raster, const ShvScreenPoint corner[3], int64_t item);

#endif
