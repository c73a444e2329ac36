/* Moves a hull's faces from the tips of a rough crack face to its mean level. */
#ifndef SHV_CONVEX_HULL_FIT_H
#define SHV_CONVEX_HULL_FIT_H

#include "convex/occupancy.h"

/* The hull of all nodes of a cluster reaches over the tips of a rough surface. Its vertices are moved by repeated steps
   along the gradient of (weight × volume of it outside the fragment + volume of the cluster outside it); faces that lie flush
   with a smooth surface stay in their planes. The result lies within the hull it starts from where that holds all its points,
   and stays convex with at most as many vertices. */
ShvStatus shv_hull_fit(ShvPolytope *polytope, const ShvHullClusters *clusters, int32_t index,
                       const ShvFragmentTets *tets, const ShvOccupancy *occupancy, double weight,
                       ShvHullScratch *scratch, ShvError *error);

/* The cluster's hull drawn towards the cluster's centre to the volume of its tets: coarser, for next to nothing. */
void shv_hull_shrink(ShvPolytope *polytope, const ShvHullCluster *cluster);

#endif
