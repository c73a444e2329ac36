/* Distances between triangulated surfaces, by FCL's trees of spheres and oriented boxes. */
#ifndef BULLET_BRIDGE_SURFACE_DISTANCE_H
#define BULLET_BRIDGE_SURFACE_DISTANCE_H

#include <stdint.h>

#include "shiver/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ShvDistanceSurface ShvDistanceSurface;

/* Triangles of 3 nodes each, whose positions (3 numbers each, m, world) are copied; at least one triangle. */
ShvStatus shv_distance_surface_create(ShvDistanceSurface **surface, const double *positions, const int32_t *triangles,
                                      int32_t triangle_count, ShvError *error);
void shv_distance_surface_destroy(ShvDistanceSurface *surface);

/* m; 0 where surfaces cross or touch. What lies wholly inside is as far from the surface round it as it is. */
typedef struct ShvSurfaceDistance {
    double distance;
    double first[3], second[3]; /* m: the nearest points; without meaning at distance 0 */
} ShvSurfaceDistance;

ShvStatus shv_surface_distance(const ShvDistanceSurface *first, const ShvDistanceSurface *second,
                               ShvSurfaceDistance *nearest, ShvError *error);
ShvStatus shv_surface_distance_to_sphere(const ShvDistanceSurface *surface, const double centre[3], double radius,
                                         ShvSurfaceDistance *nearest, ShvError *error);

#ifdef __cplusplus
}
#endif
#endif
