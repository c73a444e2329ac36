#include "convex/hull_fit.h"

#include <string.h>

#include "base/deterministic.h"

/* Steps, and the length of the first as a share of an edge; they shorten evenly to 2.1 edges in all, times the weight inwards:
   more than tips stand out. Nearly twice as many steps gain less than a fiftieth. */
enum { STEPS = 6, STEPS_A_HULL = 2, SAMPLES = 6, SETTLED_SAMPLES = 5 };
#define FIRST_STEP 0.6
/* Samples are taken this share of a cell before and behind a face. */
#define CELLS_ASIDE 0.5
/* What the fit may leave of a hull, as a share of the cluster's tets, before it is given up. */
#define SMALLEST_SHARE 0.25

/* A plane is flush where this share of the hull's area in it is faces of tets, and so many of them: two or three faces may be
   the side of a tip. The level is a share of an edge: the grid of hulls rounds to far less, meshes to far less still. */
enum { FEWEST_FACES = 4, MOST_FLUSH = 16 };
#define FLUSH_SHARE 0.75
#define FLUSH_LEVEL 1e-6
/* Squared edges: four faces of regular tets have 1.7. */
#define SMALLEST_FLUSH 1.0

static const double sample_points[SAMPLES][3] = {{0.8, 0.1, 0.1},   {0.1, 0.8, 0.1},   {0.1, 0.1, 0.8},
                                                 {0.45, 0.45, 0.1}, {0.45, 0.1, 0.45}, {0.1, 0.45, 0.45}};

typedef struct Pull {
    ShvVec3 force; /* integral of pressure × shape function × normal, m² */
    double area;   /* of shape functions, m² */
    int32_t kept;  /* directions in which the vertex must not move */
    ShvVec3 directions[3];
} Pull;

/* Sine of the angle to the planes kept already below which another adds nothing. */
#define NEW_DIRECTION 0.3

/* Keeps a vertex in the plane of a flush or settled face; a plane close to those it is kept in already adds nothing. */
static void keep(Pull *pull, ShvVec3 normal)
{
    if (pull->kept == 3) return;
    for (int32_t i = 0; i < pull->kept; i++)
        normal = shv_madd(normal, -shv_dot(normal, pull->directions[i]), pull->directions[i]);
    if (shv_norm(normal) > NEW_DIRECTION) pull->directions[pull->kept++] = shv_unit(normal);
}

/* 1 − cosine of the normals of coplanar faces: round-off. */
#define SAME_NORMAL 1e-12

/* Planes in which the hull lies flush with a smooth surface of the cluster: it shall rest and slide on those. */
typedef struct FlushPlanes {
    int32_t count;
    double planes[MOST_FLUSH][4];
    double level; /* m: points no farther than this are in the plane */
} FlushPlanes;

static bool is_on(const double plane[4], ShvVec3 x, double level)
{
    return fabs(shv_dot(shv_load3(plane), x) - plane[3]) <= level;
}

static double face_area(ShvVec3 a, ShvVec3 b, ShvVec3 c)
{
    return 0.5 * shv_norm(shv_cross(shv_sub(b, a), shv_sub(c, a)));
}

/* Area of the tets' faces in a plane that holds the cluster on one side, and their number. */
static double covered_area(const double plane[4], const ShvFragmentTets *tets, const int32_t *order,
                           const ShvHullCluster *cluster, double level, int32_t *faces)
{
    double area = 0.0;
    *faces = 0;
    for (int32_t i = cluster->begin; i < cluster->end; i++) {
        ShvVec3 x[4];
        bool on[4];
        int corners = 0;
        shv_fragment_tet_corners(tets, order[i], x);
        for (int a = 0; a < 4; a++) corners += on[a] = is_on(plane, x[a], level);
        if (corners != 3) continue;
        const int off = !on[0] ? 0 : !on[1] ? 1 : !on[2] ? 2 : 3;
        area += face_area(x[(off + 1) % 4], x[(off + 2) % 4], x[(off + 3) % 4]);
        ++*faces;
    }
    return area;
}

static double hull_area(const double plane[4], const ShvPolytope *polytope, double level)
{
    double area = 0.0;
    for (int32_t f = 0; f < polytope->hull.face_count; f++) {
        ShvVec3 x[3];
        bool on = true;
        for (int i = 0; i < 3; i++) {
            x[i] = shv_load3(polytope->vertices + 3 * polytope->hull.faces[f][i]);
            on &= is_on(plane, x[i], level);
        }
        if (on) area += face_area(x[0], x[1], x[2]);
    }
    return area;
}

static void find_flush(FlushPlanes *flush, const ShvHullCluster *cluster, const ShvFragmentTets *tets,
                       const int32_t *order)
{
    ShvPlanes planes;
    shv_polytope_planes(&cluster->polytope, &planes);
    flush->count = 0;
    flush->level = FLUSH_LEVEL * tets->edge;
    /* of coplanar faces one is enough */
    double seen[SHV_HULL_FACES][4];
    int32_t seen_count = 0;
    for (int32_t p = 0; p < planes.count && flush->count < MOST_FLUSH; p++) {
        const double *plane = planes.planes[p];
        bool known = false;
        for (int32_t s = 0; s < seen_count && !known; s++)
            known = fabs(seen[s][3] - plane[3]) <= flush->level &&
                    shv_dot(shv_load3(seen[s]), shv_load3(plane)) > 1.0 - SAME_NORMAL;
        if (known) continue;
        memcpy(seen[seen_count++], plane, sizeof seen[0]);
        const double area = hull_area(plane, &cluster->polytope, flush->level);
        if (area < SMALLEST_FLUSH * tets->edge * tets->edge) continue;
        int32_t faces = 0;
        const double covered = covered_area(plane, tets, order, cluster, flush->level, &faces);
        if (faces < FEWEST_FACES || covered < FLUSH_SHARE * area) continue;
        memcpy(flush->planes[flush->count++], plane, sizeof flush->planes[0]);
    }
}

static bool in_flush(const FlushPlanes *flush, const ShvVec3 x[3])
{
    for (int32_t p = 0; p < flush->count; p++) {
        const double *plane = flush->planes[p];
        if (is_on(plane, x[0], flush->level) && is_on(plane, x[1], flush->level) && is_on(plane, x[2], flush->level))
            return true;
    }
    return false;
}

static void add_face(Pull *pulls, const ShvPolytope *polytope, int32_t index, uint8_t value,
                     const ShvOccupancy *occupancy, const FlushPlanes *flush, double weight)
{
    const uint8_t *face = polytope->hull.faces[index];
    ShvVec3 x[3];
    for (int i = 0; i < 3; i++) x[i] = shv_load3(polytope->vertices + 3 * face[i]);
    if (in_flush(flush, x)) return;
    const ShvVec3 area = shv_scale(shv_cross(shv_sub(x[1], x[0]), shv_sub(x[2], x[0])), 0.5);
    const double size = shv_norm(area);
    if (!(size > 0.0)) return;
    const ShvVec3 aside = shv_scale(area, CELLS_ASIDE * occupancy->cell / size);
    int32_t settled = 0;
    for (int s = 0; s < SAMPLES; s++) {
        const double *shape = sample_points[s];
        const ShvVec3 at = shv_madd(shv_madd(shv_scale(x[0], shape[0]), shape[1], x[1]), shape[2], x[2]);
        const uint8_t behind = shv_occupancy_at(occupancy, shv_sub(at, aside));
        const uint8_t before = shv_occupancy_at(occupancy, shv_add(at, aside));
        const double pressure = (before == value ? 1.0 : 0.0) - (behind == SHV_CELL_EMPTY ? weight : 0.0);
        settled += behind != SHV_CELL_EMPTY && before == SHV_CELL_EMPTY;
        for (int i = 0; i < 3; i++) {
            pulls[face[i]].area += size * shape[i];
            pulls[face[i]].force = shv_madd(pulls[face[i]].force, pressure * shape[i], area);
        }
    }
    for (int i = 0; i < 3 && settled >= SETTLED_SAMPLES; i++) keep(&pulls[face[i]], shv_scale(area, 1.0 / size));
}

static void move_vertices(ShvPolytope *polytope, uint8_t value, const ShvOccupancy *occupancy, const FlushPlanes *flush,
                          double step, double weight)
{
    Pull pulls[SHV_HULL_VERTICES];
    memset(pulls, 0, (size_t)polytope->hull.vertex_count * sizeof *pulls);
    for (int32_t v = 0; v < polytope->hull.vertex_count; v++)
        for (int32_t p = 0; p < flush->count; p++)
            if (is_on(flush->planes[p], shv_load3(polytope->vertices + 3 * v), flush->level))
                keep(&pulls[v], shv_load3(flush->planes[p]));
    for (int32_t f = 0; f < polytope->hull.face_count; f++)
        add_face(pulls, polytope, f, value, occupancy, flush, weight);
    for (int32_t v = 0; v < polytope->hull.vertex_count; v++) {
        const Pull *pull = &pulls[v];
        if (!(pull->area > 0.0)) continue;
        ShvVec3 shift = shv_scale(pull->force, step / pull->area);
        for (int32_t i = 0; i < pull->kept; i++)
            shift = shv_madd(shift, -shv_dot(shift, pull->directions[i]), pull->directions[i]);
        shv_add_to3(polytope->vertices + 3 * v, shift);
    }
}

/* Draws vertices that left the hull of the cluster's nodes back to it, towards the cluster's centre. */
static void draw_back(ShvPolytope *polytope, const ShvHullCluster *cluster)
{
    ShvPlanes planes;
    shv_polytope_planes(&cluster->polytope, &planes);
    for (int32_t v = 0; v < polytope->hull.vertex_count; v++) {
        const ShvVec3 out = shv_sub(shv_load3(polytope->vertices + 3 * v), cluster->centre);
        double share = 1.0;
        for (int32_t p = 0; p < planes.count; p++) {
            const ShvVec3 normal = shv_load3(planes.planes[p]);
            const double room = planes.planes[p][3] - shv_dot(normal, cluster->centre), way = shv_dot(normal, out);
            if (way * share > room) share = fmax(room, 0.0) / way;
        }
        if (share < 1.0) shv_store3(polytope->vertices + 3 * v, shv_madd(cluster->centre, share, out));
    }
}

void shv_hull_shrink(ShvPolytope *polytope, const ShvHullCluster *cluster)
{
    *polytope = cluster->polytope;
    /* tets that overlap, some inside out, can have more volume than their hull */
    const double share = fmin(cluster->volume / polytope->hull.volume, 1.0);
    shv_polytope_scale(polytope, cluster->centre, shv_power(share, 1.0 / 3.0));
}

ShvStatus shv_hull_fit(ShvPolytope *polytope, const ShvHullClusters *clusters, int32_t index,
                       const ShvFragmentTets *tets, const ShvOccupancy *occupancy, double weight,
                       ShvHullScratch *scratch, ShvError *error)
{
    const ShvHullCluster *cluster = &clusters->items[index];
    FlushPlanes flush;
    find_flush(&flush, cluster, tets, clusters->order);
    *polytope = cluster->polytope;
    for (int step = 0; step < STEPS; step++) {
        const double length = FIRST_STEP * tets->edge * (STEPS - step) / STEPS;
        move_vertices(polytope, (uint8_t)(index + 1), occupancy, &flush, length, weight);
        const bool last = step + 1 == STEPS;
        if (last && !cluster->polytope.hull.reduced) draw_back(polytope, cluster);
        if (!last && (step + 1) % STEPS_A_HULL != 0) continue;
        SHV_TRY(shv_polytope_make(polytope, scratch, polytope->vertices, polytope->hull.vertex_count, error));
        if (polytope->hull.rank != SHV_HULL_SOLID || polytope->hull.volume < SMALLEST_SHARE * cluster->volume) {
            shv_hull_shrink(polytope, cluster);
            break;
        }
    }
    return SHV_OK;
}
