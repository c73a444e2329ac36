#include "convex/hull_clusters.h"

/* A hull is split where it is emptiest: across the longest principal axis of its tets, through their centre. More planes to
   choose from (all three axes, several offsets) were tried and won at most a thirtieth of the error for two to five times
   the work: what remains is the roughness of crack faces along element faces. */

/* Hulls worth having for a share of emptiness of the single hull: of pieces of meshed balls, 4 hulls were within 5 % of what
   12 reached at a share of 0.2, and 12 paid at 0.5. */
#define HULLS_A_SHARE 25.0
/* A hull stands for this many tets or more, unless a few tets that hold together by a corner or an edge leave this share of
   their one hull empty. */
#define TETS_A_HULL 8
#define LOOSE       0.8
/* Emptiness of a hull that is left alone, as a share of the volume of the whole fragment. */
#define NEGLIGIBLE 0.01

double shv_hull_cluster_concavity(const ShvHullCluster *cluster)
{
    return cluster->polytope.hull.volume / cluster->volume - 1.0;
}

static int32_t smaller(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

/* Emptiness beyond which the number of hulls does not grow. */
#define MOST_CONCAVITY 100.0

static int32_t hull_limit(const ShvFragmentTets *tets, double concavity)
{
    const int32_t by_size = (tets->tet_count + TETS_A_HULL - 1) / TETS_A_HULL;
    const int32_t by_share = (int32_t)ceil(HULLS_A_SHARE * fmin(concavity, MOST_CONCAVITY));
    const int32_t least =
        concavity > LOOSE ? smaller(tets->tet_count, 1 + (int32_t)ceil(fmin(concavity, MOST_CONCAVITY))) : 1;
    const int32_t limit = smaller(by_share, by_size);
    return smaller(limit > least ? limit : least, concavity < 1.0 ? SHV_CLUSTERS : SHV_CLUSTERS_CONCAVE);
}

static ShvStatus allocate(ShvHullClusters *clusters, ShvMemory *memory, const ShvFragmentTets *tets, ShvError *error)
{
    const size_t nodes = (size_t)tets->node_count, count = (size_t)tets->tet_count;
    clusters->order = shv_allocate(memory, SHV_PART_RIGID, count, sizeof(int32_t));
    clusters->points = shv_allocate(memory, SHV_PART_RIGID, 3 * nodes, sizeof(double));
    clusters->marked = shv_allocate(memory, SHV_PART_RIGID, nodes, sizeof(int32_t));
    clusters->items = shv_allocate(memory, SHV_PART_RIGID, 1, sizeof *clusters->items);
    if (clusters->order && clusters->points && clusters->marked && clusters->items) return SHV_OK;
    return shv_fail_memory(error, "the convex pieces of a fragment", 28 * nodes + 4 * count);
}

/* Volume, centre and hull of a range of `order`. */
static ShvStatus set_cluster(ShvHullClusters *clusters, ShvHullCluster *cluster, const ShvFragmentTets *tets,
                             ShvHullScratch *scratch, ShvError *error)
{
    const int32_t stamp = ++clusters->gatherings;
    int32_t count = 0;
    ShvVec3 moment = {0};
    cluster->volume = 0.0;
    for (int32_t i = cluster->begin; i < cluster->end; i++) {
        const int32_t tet = clusters->order[i];
        cluster->volume += tets->volumes[tet];
        moment = shv_madd(moment, tets->volumes[tet], shv_load3(tets->centroids + 3 * (int64_t)tet));
        for (int a = 0; a < 4; a++) {
            const int32_t node = tets->tets[4 * (int64_t)tet + a];
            if (clusters->marked[node] == stamp) continue;
            clusters->marked[node] = stamp;
            shv_store3(clusters->points + 3 * (int64_t)count++, shv_load3(tets->positions + 3 * (int64_t)node));
        }
    }
    cluster->centre = shv_scale(moment, 1.0 / cluster->volume);
    cluster->divisible = cluster->end - cluster->begin > 1;
    return shv_polytope_make(&cluster->polytope, scratch, clusters->points, count, error);
}

static ShvVec3 longest_axis(const ShvHullClusters *clusters, const ShvHullCluster *cluster, const ShvFragmentTets *tets)
{
    ShvMat3 moment = {{{0.0}}}, axes;
    double values[3];
    for (int32_t i = cluster->begin; i < cluster->end; i++) {
        const int32_t tet = clusters->order[i];
        double x[3];
        shv_store3(x, shv_sub(shv_load3(tets->centroids + 3 * (int64_t)tet), cluster->centre));
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) moment.m[a][b] += tets->volumes[tet] * x[a] * x[b];
    }
    shv_symmetric_eigen(&moment, values, &axes);
    return shv_vec3(axes.m[0][2], axes.m[1][2], axes.m[2][2]);
}

/* Puts the tets behind the plane first; returns where those before it begin. */
static int32_t partition(ShvHullClusters *clusters, const ShvHullCluster *cluster, const ShvFragmentTets *tets)
{
    const ShvVec3 axis = longest_axis(clusters, cluster, tets);
    const double offset = shv_dot(axis, cluster->centre);
    int32_t middle = cluster->begin;
    for (int32_t i = cluster->begin; i < cluster->end; i++) {
        const int32_t tet = clusters->order[i];
        if (shv_dot(axis, shv_load3(tets->centroids + 3 * (int64_t)tet)) >= offset) continue;
        clusters->order[i] = clusters->order[middle];
        clusters->order[middle++] = tet;
    }
    return middle;
}

static ShvStatus split(ShvHullClusters *clusters, int32_t index, const ShvFragmentTets *tets, ShvHullScratch *scratch,
                       ShvError *error)
{
    ShvHullCluster *first = &clusters->items[index], *second = &clusters->items[clusters->count];
    const int32_t middle = partition(clusters, first, tets);
    if (middle == first->begin || middle == first->end) {
        /* the centroids of all its tets lie in one place, as far as rounding can tell */
        first->divisible = false;
        return SHV_OK;
    }
    second->begin = middle;
    second->end = first->end;
    first->end = middle;
    clusters->count++;
    SHV_TRY(set_cluster(clusters, first, tets, scratch, error));
    return set_cluster(clusters, second, tets, scratch, error);
}

/* The cluster whose hull holds most that is not its own, or −1. */
static int32_t emptiest(const ShvHullClusters *clusters, double negligible)
{
    int32_t best = -1;
    double most = negligible;
    for (int32_t i = 0; i < clusters->count; i++) {
        const ShvHullCluster *cluster = &clusters->items[i];
        const double empty = cluster->polytope.hull.volume - cluster->volume;
        if (!cluster->divisible || empty <= most) continue;
        most = empty;
        best = i;
    }
    return best;
}

static ShvStatus fill(ShvHullClusters *clusters, const ShvFragmentTets *tets, ShvHullScratch *scratch, ShvError *error)
{
    SHV_TRY(allocate(clusters, scratch->memory, tets, error));
    for (int32_t t = 0; t < tets->tet_count; t++) clusters->order[t] = t;
    clusters->items[0].end = tets->tet_count;
    clusters->count = 1;
    SHV_TRY(set_cluster(clusters, &clusters->items[0], tets, scratch, error));
    const int32_t limit = hull_limit(tets, shv_hull_cluster_concavity(&clusters->items[0]));
    if (limit == 1) return SHV_OK;
    SHV_RESIZE(scratch->memory, SHV_PART_RIGID, clusters->items, (size_t)limit, "the convex pieces of a fragment",
               (size_t)limit * sizeof *clusters->items, error);
    while (clusters->count < limit) {
        const int32_t worst = emptiest(clusters, NEGLIGIBLE * tets->volume);
        if (worst < 0) break;
        SHV_TRY(split(clusters, worst, tets, scratch, error));
    }
    return SHV_OK;
}

ShvStatus shv_hull_clusters_make(ShvHullClusters *clusters, const ShvFragmentTets *tets, ShvHullScratch *scratch,
                                 ShvError *error)
{
    *clusters = (ShvHullClusters){0};
    const ShvStatus status = fill(clusters, tets, scratch, error);
    if (status != SHV_OK) shv_hull_clusters_release(clusters);
    return status;
}

void shv_hull_clusters_release(ShvHullClusters *clusters)
{
    shv_release(clusters->items);
    shv_release(clusters->order);
    shv_release(clusters->points);
    shv_release(clusters->marked);
    *clusters = (ShvHullClusters){0};
}
