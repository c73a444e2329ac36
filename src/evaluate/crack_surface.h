/* The failed facets of a run as a surface in the reference mesh, and how far two such surfaces are from each other. */
#ifndef SHV_EVALUATE_CRACK_SURFACE_H
#define SHV_EVALUATE_CRACK_SURFACE_H

#include "base/memory.h"
#include "base/vector.h"
#include "shiver/simulation.h"

typedef struct ShvCrackFacet {
    int32_t nodes[3]; /* of the reference mesh, ascending */
    ShvVec3 corners[3];
} ShvCrackFacet;

enum { SHV_FACET_NUMBERS = 12 }; /* nodes, then corners */

typedef struct ShvCrackSurface {
    uint64_t mesh; /* hash of positions and elements of the reference mesh; 0: nothing is known of the cracks */
    ShvCrackFacet *facets;
    int32_t count; /* ascending by nodes */
} ShvCrackSurface;

/* From what holds across element facets (4 per element, as of shv_simulation_bonds): those across which both tets are free. */
ShvStatus shv_crack_surface_create(ShvCrackSurface *surface, const ShvMeshView *mesh, const uint8_t *bonds,
                                   ShvMemory *memory, ShvError *error);
void shv_crack_surface_release(ShvCrackSurface *surface);

double shv_crack_surface_area(const ShvCrackSurface *surface);
/* Jaccard: area failed in both over area failed in any; 1 where neither has cracked. NaN for different meshes. */
double shv_crack_overlap(const ShvCrackSurface *a, const ShvCrackSurface *b);

typedef struct ShvCrackDistance {
    double largest; /* m: Hausdorff distance */
    double mean;    /* m: the larger of both one-way means over the area */
} ShvCrackDistance;
/* Distances are measured from seven points a facet (corners, midpoints of edges, centroid) to the nearest point of the other
   surface's facets. Both zero where neither has cracked, NaN where one of them has not. */
ShvCrackDistance shv_crack_distance(const ShvCrackSurface *a, const ShvCrackSurface *b);

/* From a point to the nearest point of a triangle, m. */
double shv_distance_to_facet(ShvVec3 point, const ShvCrackFacet *facet);

#endif
