#include "convex/convex_pieces.h"

#include "convex/hull_fit.h"

/* A hull this close to its tets, in volume, is taken as it is. */
#define EXACT 1e-6
/* Below this share of emptiness the fragment counts as convex: nothing much was torn from it. */
#define NEARLY_CONVEX 0.05
/* Space outside counts this much more than tets left out. On a ball of 45,000 tets in 100 pieces, weights of 1, 1.5, 1.75
   and 3 left overlaps of 8.8, 6.8, 6.0 and 3.7 % of the volume, and sums of overlap and tets left out of 14.6, 14.5, 14.7 and
   17.2 %. */
#define OUTSIDE_WEIGHT 1.75

/* Fragments of this many tets or fewer come by the thousand: their hulls are drawn in to the volume of the tets, without a grid. */
#define FEW 16

typedef struct Maker {
    const ShvFragmentTets *tets;
    ShvHullScratch scratch;
    ShvHullClusters clusters;
    ShvOccupancy occupancy;
} Maker;

static bool is_exact(const ShvHullCluster *cluster)
{
    const ShvHull *hull = &cluster->polytope.hull;
    return hull->rank != SHV_HULL_SOLID || (!hull->reduced && fabs(shv_hull_cluster_concavity(cluster)) <= EXACT);
}

static bool all_exact(const ShvHullClusters *clusters)
{
    for (int32_t c = 0; c < clusters->count; c++)
        if (!is_exact(&clusters->items[c])) return false;
    return true;
}

static ShvStatus fit(ShvConvexPieces *pieces, Maker *maker, double weight, ShvError *error)
{
    ShvHullClusters *clusters = &maker->clusters;
    SHV_TRY(shv_occupancy_make(&maker->occupancy, pieces->memory, maker->tets, clusters, error));
    for (int32_t c = 0; c < clusters->count; c++) {
        ShvHullCluster *cluster = &clusters->items[c];
        if (is_exact(cluster)) continue;
        ShvPolytope fitted;
        SHV_TRY(shv_hull_fit(&fitted, clusters, c, maker->tets, &maker->occupancy, weight, &maker->scratch, error));
        cluster->polytope = fitted;
    }
    for (int32_t c = 0; c < clusters->count; c++) {
        if (clusters->items[c].polytope.hull.rank != SHV_HULL_SOLID) continue;
        ShvPlanes planes;
        shv_polytope_planes(&clusters->items[c].polytope, &planes);
        shv_occupancy_cover(&maker->occupancy, &planes);
    }
    double inside = 0.0;
    shv_occupancy_measure(&maker->occupancy, &pieces->outside, &pieces->missing, &inside);
    return SHV_OK;
}

static bool holds(const ShvPlanes *planes, ShvVec3 x)
{
    for (int32_t p = 0; p < planes->count; p++)
        if (shv_dot(shv_load3(planes->planes[p]), x) > planes->planes[p][3]) return false;
    return planes->count > 0;
}

enum { POINTS = 11 };
/* Shares of the four corners: equal weights match the mean and, within 2 %, the variance of uniform points in a tet. */
static const double point_shares[POINTS][4] = {{0.25, 0.25, 0.25, 0.25}, {0.7, 0.1, 0.1, 0.1}, {0.1, 0.7, 0.1, 0.1},
                                               {0.1, 0.1, 0.7, 0.1},     {0.1, 0.1, 0.1, 0.7}, {0.4, 0.4, 0.1, 0.1},
                                               {0.4, 0.1, 0.4, 0.1},     {0.4, 0.1, 0.1, 0.4}, {0.1, 0.4, 0.4, 0.1},
                                               {0.1, 0.4, 0.1, 0.4},     {0.1, 0.1, 0.4, 0.4}};

/* Volume of tets in no hull, by points. */
static double left_out(const ShvFragmentTets *tets, const ShvPlanes *planes, int32_t count)
{
    double missing = 0.0;
    for (int32_t t = 0; t < tets->tet_count; t++) {
        ShvVec3 x[4];
        shv_fragment_tet_corners(tets, t, x);
        for (int i = 0; i < POINTS; i++) {
            ShvVec3 point = {0};
            for (int a = 0; a < 4; a++) point = shv_madd(point, point_shares[i][a], x[a]);
            bool held = false;
            for (int32_t c = 0; c < count && !held; c++) held = holds(&planes[c], point);
            if (!held) missing += tets->volumes[t] / POINTS;
        }
    }
    return missing;
}

static void shrink(ShvConvexPieces *pieces, Maker *maker)
{
    ShvPlanes planes[FEW]; /* a cluster has a tet at least */
    double volume = 0.0;
    for (int32_t c = 0; c < maker->clusters.count; c++) {
        ShvHullCluster *cluster = &maker->clusters.items[c];
        planes[c].count = 0;
        if (cluster->polytope.hull.rank != SHV_HULL_SOLID) continue;
        if (!is_exact(cluster)) {
            ShvPolytope shrunk;
            shv_hull_shrink(&shrunk, cluster);
            cluster->polytope = shrunk;
        }
        shv_polytope_planes(&cluster->polytope, &planes[c]);
        volume += cluster->polytope.hull.volume;
    }
    pieces->missing = left_out(maker->tets, planes, maker->clusters.count);
    pieces->outside = fmax(0.0, volume - maker->tets->volume + pieces->missing);
}

/* Nodes of a cluster without volume: those of its first and last tet. */
static int32_t flat_vertices(const Maker *maker, const ShvHullCluster *cluster, double *vertices)
{
    const int32_t ends[2] = {maker->clusters.order[cluster->begin], maker->clusters.order[cluster->end - 1]};
    const int32_t used = ends[0] == ends[1] ? 1 : 2;
    for (int32_t i = 0; i < used; i++) {
        ShvVec3 x[4];
        shv_fragment_tet_corners(maker->tets, ends[i], x);
        for (int a = 0; a < 4; a++) shv_store3(vertices + 3 * (4 * i + a), x[a]);
    }
    return 4 * used;
}

static int32_t write_vertices(const Maker *maker, const ShvHullCluster *cluster, double *vertices)
{
    const ShvPolytope *polytope = &cluster->polytope;
    if (polytope->hull.rank != SHV_HULL_SOLID) return flat_vertices(maker, cluster, vertices);
    for (int32_t i = 0; i < 3 * polytope->hull.vertex_count; i++) vertices[i] = polytope->vertices[i];
    return polytope->hull.vertex_count;
}

static ShvStatus write(ShvConvexPieces *pieces, const Maker *maker, ShvError *error)
{
    const ShvHullClusters *clusters = &maker->clusters;
    size_t room = 0;
    for (int32_t c = 0; c < clusters->count; c++) {
        const ShvHull *hull = &clusters->items[c].polytope.hull;
        room += hull->rank == SHV_HULL_SOLID ? (size_t)hull->vertex_count : 8;
    }
    const size_t count = (size_t)clusters->count;
    pieces->vertex_begin = shv_allocate(pieces->memory, SHV_PART_RIGID, count + 1, sizeof(int32_t));
    pieces->vertices = shv_allocate(pieces->memory, SHV_PART_RIGID, 3 * room, sizeof(double));
    pieces->volumes = shv_allocate(pieces->memory, SHV_PART_RIGID, count, sizeof(double));
    if (!pieces->vertex_begin || !pieces->vertices || !pieces->volumes)
        return shv_fail_memory(error, "the convex pieces of a fragment", 24 * room + 12 * count);
    for (int32_t c = 0; c < clusters->count; c++) {
        const int32_t begin = pieces->vertex_begin[c];
        const int32_t vertices = write_vertices(maker, &clusters->items[c], pieces->vertices + 3 * (int64_t)begin);
        pieces->vertex_begin[c + 1] = begin + vertices;
        pieces->volumes[c] = clusters->items[c].polytope.hull.volume;
        pieces->volume += pieces->volumes[c];
    }
    pieces->count = clusters->count;
    pieces->excess = pieces->volume / maker->tets->volume - 1.0;
    return SHV_OK;
}

static ShvStatus make(ShvConvexPieces *pieces, Maker *maker, ShvError *error)
{
    SHV_TRY(shv_hull_clusters_make(&maker->clusters, maker->tets, &maker->scratch, error));
    if (!all_exact(&maker->clusters)) {
        const bool convex =
            maker->clusters.count == 1 && shv_hull_cluster_concavity(&maker->clusters.items[0]) <= NEARLY_CONVEX;
        if (maker->tets->tet_count <= FEW)
            shrink(pieces, maker);
        else
            SHV_TRY(fit(pieces, maker, convex ? 1.0 : OUTSIDE_WEIGHT, error));
    }
    return write(pieces, maker, error);
}

ShvStatus shv_convex_pieces_of_tets(ShvConvexPieces *pieces, const ShvFragmentTets *tets, ShvMemory *memory,
                                    ShvError *error)
{
    *pieces = (ShvConvexPieces){.memory = memory};
    Maker maker = {.tets = tets, .scratch = {.memory = memory}};
    const ShvStatus status = make(pieces, &maker, error);
    shv_occupancy_release(&maker.occupancy);
    shv_hull_clusters_release(&maker.clusters);
    shv_hull_scratch_release(&maker.scratch);
    if (status != SHV_OK) shv_convex_pieces_release(pieces);
    return status;
}

ShvStatus shv_convex_pieces_make(ShvConvexPieces *pieces, const ShvFragments *fragments, const ShvModel *model,
                                 const ShvState *state, int32_t fragment, ShvError *error)
{
    ShvFragmentTets tets;
    *pieces = (ShvConvexPieces){.memory = model->memory};
    SHV_TRY(shv_fragment_tets_make(&tets, fragments, state, fragment, error));
    const ShvStatus status = shv_convex_pieces_of_tets(pieces, &tets, model->memory, error);
    shv_fragment_tets_release(&tets);
    return status;
}

void shv_convex_pieces_release(ShvConvexPieces *pieces)
{
    shv_release(pieces->vertex_begin);
    shv_release(pieces->vertices);
    shv_release(pieces->volumes);
    *pieces = (ShvConvexPieces){0};
}
