/* The star of a node (the term of simplicial topology; others say node patch or one-ring): the tets that share one copy of it, and
   the force that each facet between them passes on at the node.

   A node can open only once a closed disk of facets round it has been inserted. Facets judged one by one reach their
   strength long before and long after such a disk is complete, so that many are inserted for each that opens. Here the disk
   is judged as a whole: for a direction of opening, every facet at the node passes on a third of area × mean stress of its
   two tets, and could hold a third of area × what its law can carry in that direction. A minimal cut (cut.h) finds the
   group of tets whose pull is largest against what holds it. Forces across facets have no part in contact, inertia or
   tractions of open faces, and of a node's forces sum to zero.

   Strength in a direction at an angle θ to the facet's normal: σ √(cos² θ + β² sin² θ), β = shear/normal strength; the
   law starts with the components of just that traction (insert.c), so that what is inserted carries what it was judged by. A facet
   that is pressed by p holds p tan φ sin θ besides, as its faces will (closure.c). A facet that the motion would close holds
   whatever is asked of it. */
#ifndef SHV_COHESIVE_STAR_H
#define SHV_COHESIVE_STAR_H

#include "cohesive/cut.h"
#include "cohesive/front.h"
#include "cohesive/initiation.h"
#include "model/state.h"

struct ShvCohesive;

/* A facet between two tets of a star. */
typedef struct ShvStarFacet {
    int32_t facet;
    ShvVec3 area;                 /* a third of it, from the joint's first member to its second, m² */
    double size;                  /* its length */
    ShvVec3 force;                /* mean stress on it, N: of the second member on the first */
    double strength, shear_ratio; /* Pa, β */
    double friction;              /* tan φ × what presses it, N */
    ShvTip tip;                   /* what it counts with where a crack goes on */
    double share;                 /* of its strength that counts: above 1 where a tet would lose its last bonds */
} ShvStarFacet;

typedef struct ShvStar {
    int32_t node;
    ShvCut cut;
    ShvStarFacet *facets; /* as cut.joints */
    double stress[6];     /* mean over the tets by mass, Pa */
    ShvVec3 direction;    /* of the opening found */
    bool goes_on; /* from a crack whose front is there, or begins below its strength: facets hold what their tips do */
    double projected_share; /* where it goes on, of the disk's area: what its projection has */
    double ratio;           /* force / capacity of the disk found; 0: none */
    double
        nearest; /* of the facets, in the directions tried: the most that one passes on of what would do; below 1 none parts */
    int32_t disk_count;
    int32_t *disk; /* its facets, as numbers of joints, that are still intact */
} ShvStar;

ShvStatus shv_star_create(ShvStar *star, ShvMemory *memory, int32_t most_corners, ShvError *error);
void shv_star_release(ShvStar *star);
/* Looks for the disk of a node with the largest ratio, `least` or more. The stress of all its tets must be there. */
void shv_star_evaluate(ShvStar *star, const struct ShvCohesive *cohesive, const ShvState *state, const double *stress,
                       int32_t node, double least);
/* The disk across the tension in the surface at a node that has no cracks, where that reaches `least` times its strength; its
   facets hold what they pass on. The ratio is that of stresses. */
void shv_star_begin(ShvStar *star, const struct ShvCohesive *cohesive, const ShvState *state, const double *stress,
                    int32_t node, ShvSurfaceTension tension, double least);

#endif
