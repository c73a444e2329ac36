#include "convex/hull.h"

#include <string.h>

/* Quickhull (Barber, Dobkin, Huhdanpaa 1996) on whole numbers: the points are rounded to a grid of 2²⁵ cells along the
   largest extent, where a plane's normal is exact in double precision and the side of a point can always be decided
   exactly. With exact decisions the faces that a new point sees form a disc, so the horizon is one closed loop however
   many points share planes, lines or places; no tolerance is needed anywhere. */

enum { GRID_BITS = 25, NO_POINT = -1, NO_FACE = 255 };

/* Products of a normal (below 2⁵²) and a coordinate (at most 2²⁵) are rounded to 2⁻⁵³ of themselves: six of them and their
   sums err by less than 2²⁸. */
#define DOUBTFUL 268435456.0

/* Cells: rounding to the grid puts points of one plane up to this far apart from the plane of three of them. Points no higher
   than this over a face are left outside; of points that differ less in height, the one farther along the face is taken, for
   it is a corner of what lies in that plane. So a turned box keeps its eight corners and no more. */
#define LEVEL 2.0

typedef struct Face {
    uint8_t corners[3], neighbours[3]; /* neighbour i lies across the edge from corner i to the next */
    bool alive, visible;
    int32_t outside;  /* list of the points that see this face and are kept by it */
    int32_t farthest; /* of them */
    double height;    /* of the highest, in cells */
    double reach;     /* squared distance of the farthest from the first corner, in cells */
    double normal[3], offset, size;
} Face;

typedef struct Builder {
    const double *grid;
    int32_t *next;
    int32_t vertices[SHV_HULL_VERTICES];
    uint8_t uses[SHV_HULL_VERTICES]; /* faces at a vertex; 0: the slot is free */
    int32_t vertex_count;
    Face faces[SHV_HULL_FACES + 1];
    int32_t face_end;
    uint8_t free_faces[SHV_HULL_FACES + 1];
    int32_t free_count;
} Builder;

static void subtract(const double *a, const double *b, double out[3])
{
    for (int i = 0; i < 3; i++) out[i] = a[i] - b[i];
}

static void cross(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Sign of normal · (p − a) in whole numbers: the normal is cut into a high and a low part so that all sums stay within
   64 bits. */
static int exact_side(const double normal[3], const double *a, const double *p)
{
    const int64_t base = (int64_t)1 << GRID_BITS;
    int64_t high = 0, low = 0;
    for (int i = 0; i < 3; i++) {
        const int64_t n = (int64_t)normal[i], d = (int64_t)(p[i] - a[i]);
        const int64_t coarse = n / base;
        high += coarse * d;
        low += (n - coarse * base) * d;
    }
    const int64_t carry = low / base;
    high += carry;
    low -= carry * base;
    if (high == 0) return (low > 0) - (low < 0);
    /* |low| < base: it cannot outweigh one unit of `high` */
    return high > 0 ? 1 : -1;
}

/* Height of point p over a face in cells; exactly 0 when in its plane, and of the right sign always. */
static double height(const Builder *builder, const Face *face, int32_t p)
{
    const double *x = builder->grid + 3 * (int64_t)p;
    const double value = face->normal[0] * x[0] + face->normal[1] * x[1] + face->normal[2] * x[2] - face->offset;
    if (fabs(value) > DOUBTFUL) return value * face->size;
    const double *corner = builder->grid + 3 * (int64_t)builder->vertices[face->corners[0]];
    const int side = exact_side(face->normal, corner, x);
    return side == 0 ? 0.0 : side * fmax(fabs(value), 1.0) * face->size;
}

static void set_plane(const Builder *builder, Face *face)
{
    const double *a = builder->grid + 3 * (int64_t)builder->vertices[face->corners[0]];
    double u[3], v[3];
    subtract(builder->grid + 3 * (int64_t)builder->vertices[face->corners[1]], a, u);
    subtract(builder->grid + 3 * (int64_t)builder->vertices[face->corners[2]], a, v);
    cross(u, v, face->normal);
    const double *n = face->normal;
    face->offset = n[0] * a[0] + n[1] * a[1] + n[2] * a[2];
    face->size = 1.0 / sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

static uint8_t new_vertex(Builder *builder, int32_t point)
{
    uint8_t slot = 0;
    while (builder->uses[slot] > 0) slot++;
    builder->vertices[slot] = point;
    builder->vertex_count++;
    return slot;
}

static uint8_t new_face(Builder *builder, uint8_t a, uint8_t b, uint8_t c)
{
    const int32_t slot = builder->free_count > 0 ? builder->free_faces[--builder->free_count] : builder->face_end++;
    Face *face = &builder->faces[slot];
    *face = (Face){.corners = {a, b, c}, .alive = true, .outside = NO_POINT, .farthest = NO_POINT};
    for (int i = 0; i < 3; i++) builder->uses[face->corners[i]]++;
    set_plane(builder, face);
    return (uint8_t)slot;
}

static double squared_distance(const double *a, const double *b)
{
    double d[3];
    subtract(a, b, d);
    return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

static void take(const Builder *builder, Face *face, int32_t point, double highest)
{
    builder->next[point] = face->outside;
    face->outside = point;
    if (highest < face->height - LEVEL) return;
    const double *corner = builder->grid + 3 * (int64_t)builder->vertices[face->corners[0]];
    const double reach = squared_distance(builder->grid + 3 * (int64_t)point, corner);
    if (highest > face->height + LEVEL || reach > face->reach) {
        face->farthest = point;
        face->reach = reach;
    }
    if (highest > face->height) face->height = highest;
}

/* Gives a point to the face of `faces` that it stands highest over; it is dropped when it stands over none. */
static void give(Builder *builder, int32_t point, const uint8_t *faces, int32_t count)
{
    double highest = LEVEL;
    Face *owner = NULL;
    for (int32_t i = 0; i < count; i++) {
        Face *face = &builder->faces[faces[i]];
        const double h = height(builder, face, point);
        if (h <= highest) continue;
        highest = h;
        owner = face;
    }
    if (owner) take(builder, owner, point, highest);
}

/* Marks the faces that see a point, from one that does, and lists them. */
static int32_t mark_visible(Builder *builder, uint8_t start, int32_t point, uint8_t *visible)
{
    int32_t count = 1;
    visible[0] = start;
    builder->faces[start].visible = true;
    for (int32_t k = 0; k < count; k++)
        for (int i = 0; i < 3; i++) {
            const uint8_t other = builder->faces[visible[k]].neighbours[i];
            Face *face = &builder->faces[other];
            if (face->visible || height(builder, face, point) <= 0.0) continue;
            face->visible = true;
            visible[count++] = other;
        }
    return count;
}

/* An edge of the rim of the visible faces, in their sense, and the face beyond. */
typedef struct Rim {
    uint8_t from, to, beyond;
} Rim;

static int32_t find_rim(const Builder *builder, const uint8_t *visible, int32_t count, Rim *rim)
{
    int32_t edges = 0;
    for (int32_t k = 0; k < count; k++) {
        const Face *face = &builder->faces[visible[k]];
        for (int i = 0; i < 3; i++)
            if (!builder->faces[face->neighbours[i]].visible)
                rim[edges++] = (Rim){face->corners[i], face->corners[(i + 1) % 3], face->neighbours[i]};
    }
    return edges;
}

/* Takes the visible faces out; their points are chained into one list, which is returned. */
static int32_t remove_visible(Builder *builder, const uint8_t *visible, int32_t count)
{
    int32_t list = NO_POINT;
    for (int32_t k = 0; k < count; k++) {
        Face *face = &builder->faces[visible[k]];
        for (int32_t p = face->outside; p != NO_POINT;) {
            const int32_t next = builder->next[p];
            builder->next[p] = list;
            list = p;
            p = next;
        }
        face->alive = face->visible = false;
        builder->free_faces[builder->free_count++] = visible[k];
        for (int i = 0; i < 3; i++)
            if (--builder->uses[face->corners[i]] == 0) builder->vertex_count--;
    }
    return list;
}

static void replace_neighbour(Face *face, uint8_t from, uint8_t by)
{
    for (int i = 0; i < 3; i++)
        if (face->corners[i] == from) face->neighbours[i] = by;
}

/* Joins the rim to the vertex `top`. Returns the new faces in `made`. */
static void close_rim(Builder *builder, const Rim *rim, int32_t edges, uint8_t top, uint8_t *made)
{
    uint8_t starting[SHV_HULL_VERTICES];
    for (int32_t k = 0; k < edges; k++) {
        made[k] = new_face(builder, rim[k].from, rim[k].to, top);
        builder->faces[made[k]].neighbours[0] = rim[k].beyond;
        /* the face beyond runs the edge the other way: from rim.to */
        replace_neighbour(&builder->faces[rim[k].beyond], rim[k].to, made[k]);
        starting[rim[k].from] = made[k];
    }
    for (int32_t k = 0; k < edges; k++) {
        const uint8_t following = starting[rim[k].to];
        builder->faces[made[k]].neighbours[1] = following;
        builder->faces[following].neighbours[2] = made[k];
    }
}

/* The face whose farthest point stands highest; NO_FACE when every point is inside. */
static uint8_t highest_face(const Builder *builder)
{
    uint8_t best = NO_FACE;
    double highest = 0.0;
    for (int32_t f = 0; f < builder->face_end; f++)
        if (builder->faces[f].alive && builder->faces[f].height > highest) {
            highest = builder->faces[f].height;
            best = (uint8_t)f;
        }
    return best;
}

static void add_point(Builder *builder, uint8_t seen)
{
    uint8_t visible[SHV_HULL_FACES + 1], made[SHV_HULL_FACES + 1];
    Rim rim[SHV_HULL_FACES + 1];
    const int32_t point = builder->faces[seen].farthest;
    const int32_t count = mark_visible(builder, seen, point, visible);
    const int32_t edges = find_rim(builder, visible, count, rim);
    /* vertices of the rim must keep their slots while the faces at them change */
    const uint8_t top = new_vertex(builder, point);
    builder->uses[top] = 1;
    for (int32_t k = 0; k < edges; k++) builder->uses[rim[k].from]++;
    int32_t list = remove_visible(builder, visible, count);
    for (int32_t k = 0; k < edges; k++) builder->uses[rim[k].from]--;
    builder->uses[top] = 0;
    close_rim(builder, rim, edges, top, made);
    while (list != NO_POINT) {
        const int32_t next = builder->next[list];
        if (list != point) give(builder, list, made, edges);
        list = next;
    }
}

/* Of points, the one of largest measure; of those within `level` of it, the one farthest from the origin. */
typedef struct Choice {
    int32_t point;
    double measure, reach, level;
} Choice;

static void consider(Choice *choice, int32_t point, double measure, double reach)
{
    if (measure < choice->measure - choice->level) return;
    if (measure > choice->measure + choice->level || reach > choice->reach) {
        choice->point = point;
        choice->reach = reach;
    }
    if (measure > choice->measure) choice->measure = measure;
}

/* Four points that span a volume, or how many dimensions there are. */
static ShvHullRank find_corners(const double *grid, int32_t count, int32_t corners[4])
{
    static const double middle[3] = {0x1p24, 0x1p24, 0x1p24};
    Choice first = {.point = 0}, second = {.point = 0}, third = {.point = 0}, fourth = {.point = 0};
    for (int32_t p = 0; p < count; p++) consider(&first, p, squared_distance(grid + 3 * (int64_t)p, middle), 0.0);
    const double *origin = grid + 3 * (int64_t)first.point;
    for (int32_t p = 0; p < count; p++) consider(&second, p, squared_distance(grid + 3 * (int64_t)p, origin), 0.0);
    if (second.measure == 0.0) return SHV_HULL_POINT;
    double u[3], v[3], n[3], normal[3];
    subtract(grid + 3 * (int64_t)second.point, origin, u);
    const double length = sqrt(second.measure);
    third.level = fourth.level = LEVEL;
    for (int32_t p = 0; p < count; p++) {
        subtract(grid + 3 * (int64_t)p, origin, v);
        cross(u, v, n);
        const double off = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / length;
        consider(&third, p, off, squared_distance(grid + 3 * (int64_t)p, origin));
    }
    if (third.measure <= LEVEL) return SHV_HULL_LINE;
    subtract(grid + 3 * (int64_t)third.point, origin, v);
    cross(u, v, normal);
    const double size = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    for (int32_t p = 0; p < count; p++) {
        subtract(grid + 3 * (int64_t)p, origin, v);
        const double value = (normal[0] * v[0] + normal[1] * v[1] + normal[2] * v[2]) / size;
        consider(&fourth, p, fabs(value), squared_distance(grid + 3 * (int64_t)p, origin));
    }
    if (fourth.measure <= LEVEL) return SHV_HULL_FLAT;
    /* the fourth point must lie below the face (0, 1, 2) */
    const bool above = exact_side(normal, origin, grid + 3 * (int64_t)fourth.point) > 0;
    corners[0] = first.point;
    corners[1] = above ? third.point : second.point;
    corners[2] = above ? second.point : third.point;
    corners[3] = fourth.point;
    return SHV_HULL_SOLID;
}

static void begin(Builder *builder, const int32_t corners[4], int32_t count)
{
    /* every edge runs once each way */
    static const uint8_t faces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}},
                         neighbours[4][3] = {{1, 2, 3}, {3, 2, 0}, {1, 3, 0}, {2, 1, 0}};
    uint8_t all[4];
    for (int i = 0; i < 4; i++) {
        const uint8_t slot = new_vertex(builder, corners[i]);
        builder->uses[slot] = 1;
    }
    for (int f = 0; f < 4; f++) all[f] = new_face(builder, faces[f][0], faces[f][1], faces[f][2]);
    for (int f = 0; f < 4; f++) {
        memcpy(builder->faces[all[f]].neighbours, neighbours[f], 3);
        builder->uses[f]--;
    }
    for (int32_t p = 0; p < count; p++) give(builder, p, all, 4);
}

static void write_hull(ShvHull *hull, const Builder *builder, const double *points)
{
    uint8_t renumbered[SHV_HULL_VERTICES];
    for (int32_t v = 0; v < SHV_HULL_VERTICES; v++) {
        if (builder->uses[v] == 0) continue;
        renumbered[v] = (uint8_t)hull->vertex_count;
        hull->points[hull->vertex_count++] = builder->vertices[v];
    }
    const ShvVec3 origin = shv_load3(points + 3 * (int64_t)hull->points[0]);
    for (int32_t f = 0; f < builder->face_end; f++) {
        const Face *face = &builder->faces[f];
        if (!face->alive) continue;
        ShvVec3 x[3];
        for (int i = 0; i < 3; i++) {
            hull->faces[hull->face_count][i] = renumbered[face->corners[i]];
            x[i] = shv_sub(shv_load3(points + 3 * (int64_t)builder->vertices[face->corners[i]]), origin);
        }
        hull->face_count++;
        hull->volume += shv_dot(x[0], shv_cross(x[1], x[2])) / 6.0;
        hull->reduced |= face->outside != NO_POINT;
    }
}

static void round_to_grid(double *grid, const double *points, int32_t count)
{
    double low[3], extent = 0.0;
    for (int i = 0; i < 3; i++) {
        double high = low[i] = points[i];
        for (int32_t p = 1; p < count; p++) {
            const double x = points[3 * (int64_t)p + i];
            low[i] = x < low[i] ? x : low[i];
            high = x > high ? x : high;
        }
        extent = high - low[i] > extent ? high - low[i] : extent;
    }
    const double cells = extent > 0.0 ? (double)(1 << GRID_BITS) / extent : 0.0;
    for (int64_t p = 0; p < count; p++)
        for (int i = 0; i < 3; i++) grid[3 * p + i] = floor((points[3 * p + i] - low[i]) * cells + 0.5);
}

static ShvStatus reserve(ShvHullScratch *scratch, int32_t count, ShvError *error)
{
    if (count <= scratch->capacity) return SHV_OK;
    SHV_RESIZE(scratch->memory, SHV_PART_RIGID, scratch->grid, 3 * (size_t)count, "a convex hull", 28 * (size_t)count,
               error);
    SHV_RESIZE(scratch->memory, SHV_PART_RIGID, scratch->next, (size_t)count, "a convex hull", 28 * (size_t)count,
               error);
    scratch->capacity = count;
    return SHV_OK;
}

ShvStatus shv_hull_make(ShvHull *hull, ShvHullScratch *scratch, const double *points, int32_t count, int32_t most,
                        ShvError *error)
{
    hull->vertex_count = hull->face_count = 0;
    hull->volume = 0.0;
    hull->reduced = false;
    SHV_TRY(reserve(scratch, count, error));
    round_to_grid(scratch->grid, points, count);
    int32_t corners[4] = {0};
    hull->rank = find_corners(scratch->grid, count, corners);
    if (hull->rank != SHV_HULL_SOLID) return SHV_OK;
    Builder builder;
    builder.grid = scratch->grid;
    builder.next = scratch->next;
    builder.vertex_count = builder.face_end = builder.free_count = 0;
    memset(builder.uses, 0, sizeof builder.uses);
    begin(&builder, corners, count);
    while (builder.vertex_count < most) {
        const uint8_t face = highest_face(&builder);
        if (face == NO_FACE) break;
        add_point(&builder, face);
    }
    write_hull(hull, &builder, points);
    return SHV_OK;
}

ShvStatus shv_polytope_make(ShvPolytope *polytope, ShvHullScratch *scratch, const double *points, int32_t count,
                            ShvError *error)
{
    SHV_TRY(shv_hull_make(&polytope->hull, scratch, points, count, SHV_HULL_VERTICES, error));
    double vertices[3 * SHV_HULL_VERTICES];
    for (int32_t v = 0; v < polytope->hull.vertex_count; v++)
        shv_store3(vertices + 3 * v, shv_load3(points + 3 * (int64_t)polytope->hull.points[v]));
    memcpy(polytope->vertices, vertices, 3 * (size_t)polytope->hull.vertex_count * sizeof *vertices);
    return SHV_OK;
}

static void find_box(const ShvPolytope *polytope, ShvPlanes *planes)
{
    for (int i = 0; i < 3; i++) {
        double low = polytope->vertices[i], high = low;
        for (int32_t v = 1; v < polytope->hull.vertex_count; v++) {
            const double x = polytope->vertices[3 * v + i];
            low = x < low ? x : low;
            high = x > high ? x : high;
        }
        planes->low[i] = low;
        planes->high[i] = high;
    }
}

void shv_polytope_planes(const ShvPolytope *polytope, ShvPlanes *planes)
{
    planes->count = 0;
    find_box(polytope, planes);
    double size = 0.0;
    for (int i = 0; i < 3; i++) size = fmax(size, planes->high[i] - planes->low[i]);
    for (int32_t f = 0; f < polytope->hull.face_count; f++) {
        const uint8_t *face = polytope->hull.faces[f];
        const ShvVec3 a = shv_load3(polytope->vertices + 3 * face[0]);
        const ShvVec3 u = shv_sub(shv_load3(polytope->vertices + 3 * face[1]), a);
        const ShvVec3 v = shv_sub(shv_load3(polytope->vertices + 3 * face[2]), a);
        const ShvVec3 normal = shv_cross(u, v);
        const double length = shv_norm(normal);
        /* rounding to the grid moves a vertex by 2⁻²⁵ of the size: a triangle of less height than 2⁻¹² of it may be tilted
           against its neighbours by more than the rest of the hull can tell */
        const double longest = sqrt(fmax(shv_dot(u, u), shv_dot(v, v)));
        if (length <= longest * size / 4096.0) continue;
        double *plane = planes->planes[planes->count++];
        shv_store3(plane, shv_scale(normal, 1.0 / length));
        plane[3] = shv_dot(shv_load3(plane), a);
    }
}

void shv_polytope_scale(ShvPolytope *polytope, ShvVec3 centre, double scale)
{
    for (int32_t v = 0; v < polytope->hull.vertex_count; v++) {
        double *x = polytope->vertices + 3 * v;
        shv_store3(x, shv_madd(centre, scale, shv_sub(shv_load3(x), centre)));
    }
    polytope->hull.volume *= scale * scale * scale;
}

void shv_hull_scratch_release(ShvHullScratch *scratch)
{
    shv_release(scratch->grid);
    shv_release(scratch->next);
    *scratch = (ShvHullScratch){0};
}
