/* The failed facets of a run as a surface in the reference mesh, and how far two such surfaces are from each other. */
#ifndef SHV_EVALUATE_CRACK_SURFACE_H
#define SHV_EVALUATE_CRACK_SURFACE_H

#include "base/vector.h"
#include "scene/pool.h"
#include "shiver/simulation.h"

/* Numbers alone, so that a list of an outcome is one of facets. */
typedef struct ShvCrackFacet {
    double nodes[3]; /* of the reference mesh, ascending */
    ShvVec3 corners[3];
} ShvCrackFacet;
enum { SHV_FACET_NUMBERS = sizeof(ShvCrackFacet) / sizeof(double) };

typedef struct ShvCrackSurface {
    uint64_t mesh; /* hash of positions and elements of the reference mesh; 0: nothing is known of the cracks */
    const ShvCrackFacet *facets;
    int32_t count; /* ascending by nodes */
} ShvCrackSurface;

/* From what holds across element facets (4 per element, as of shv_simulation_bonds): those across which both tets are free. They
   are of the pool, and NULL when memory is out. */
ShvCrackSurface shv_crack_surface(const ShvMeshView *mesh, const uint8_t *bonds, ShvPool *pool);

/* Jaccard: area failed in both over area failed in any; 1 where neither has cracked. NaN for different meshes. */
double shv_crack_overlap(const ShvCrackSurface *a, const ShvCrackSurface *b);

typedef struct ShvCrackDistance {
    double largest; /* m: Hausdorff distance */
    double mean;    /* m: the larger of both one-way means over the area */
} ShvCrackDistance;
/* Distances are measured from seven points a facet (corners, midpoints of edges, centroid) to the nearest point of the other
   surface's facets. Both zero where neither has cracked, NaN where one of them has not. */
ShvCrackDistance shv_crack_distance(const ShvCrackSurface *a, const ShvCrackSurface *b);

/* Arms of a star of cracks about the z axis: directions, seen along it, in which the edges of `count` facets (three corners each) cross
   the circle of a radius, those that are no more than `gap` apart along it counted as one; m. 0 where they close a ring. */
int32_t shv_crack_arms(const ShvVec3 *corners, int64_t count, double radius, double gap);

#endif
