/* The tets of a fragment in clusters that are each not far from convex, and the hull of each cluster. */
#ifndef SHV_CONVEX_HULL_CLUSTERS_H
#define SHV_CONVEX_HULL_CLUSTERS_H

#include "convex/fragment_tets.h"
#include "convex/hull.h"

typedef struct ShvHullCluster {
    int32_t begin, end; /* into ShvHullClusters.order */
    ShvVec3 centre;     /* of volume, m */
    double volume;      /* of its tets, m³ */
    bool divisible;
    ShvPolytope polytope; /* of the nodes of its tets; rank below solid: the tets are flat to 2⁻²⁴ of their size */
} ShvHullCluster;

typedef struct ShvHullClusters {
    int32_t count;
    ShvHullCluster *items;
    int32_t *order;  /* tets, those of a cluster together */
    double *points;  /* scratch: 3 a node */
    int32_t *marked; /* scratch: per node, the last gathering it was in */
    int32_t gatherings;
} ShvHullClusters;

enum { SHV_CLUSTERS = 12, SHV_CLUSTERS_CONCAVE = 32 };

/* At most SHV_CLUSTERS, or SHV_CLUSTERS_CONCAVE where less than half of the one hull is filled. One where that is good
   enough. On failure `clusters` is zeroed and owns nothing. */
ShvStatus shv_hull_clusters_make(ShvHullClusters *clusters, const ShvFragmentTets *tets, ShvHullScratch *scratch,
                                 ShvError *error);
void shv_hull_clusters_release(ShvHullClusters *clusters);
/* Volume of the cluster's hull that its tets leave empty, as a share of their volume. */
double shv_hull_cluster_concavity(const ShvHullCluster *cluster);

#endif
