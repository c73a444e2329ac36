/* Longest-edge bisection of a closed surface. The longest edge of the whole surface is the longest of both its
   triangles, so every split is a longest-edge bisection, whose smallest angle is at least half the smallest one of the
   start (Rosenberg & Stenger 1975). */
#include "mesh/edge_table.h"
#include "mesh/surface.h"

typedef struct Bisection {
    ShvSurface *surface; /* arrays already grown to their final size */
    int32_t edge_count;
    int32_t *edge_of;    /* half-edge → edge */
    int32_t *half_edges; /* 2 an edge */
    double *lengths;     /* squared, an edge */
    int32_t *heap;       /* edges, longest at 0 */
    int32_t heap_count;
} Bisection;

static void release(Bisection *b)
{
    shv_release(b->edge_of);
    shv_release(b->half_edges);
    shv_release(b->lengths);
    shv_release(b->heap);
}

static int comes_first(const Bisection *b, int32_t e, int32_t f)
{
    if (b->lengths[e] != b->lengths[f]) return b->lengths[e] > b->lengths[f];
    return e < f;
}

static void sift_down(Bisection *b, int32_t at)
{
    const int32_t edge = b->heap[at];
    for (;;) {
        int64_t child = 2 * (int64_t)at + 1;
        if (child >= b->heap_count) break;
        if (child + 1 < b->heap_count && comes_first(b, b->heap[child + 1], b->heap[child])) child++;
        if (!comes_first(b, b->heap[child], edge)) break;
        b->heap[at] = b->heap[child];
        at = (int32_t)child;
    }
    b->heap[at] = edge;
}

static void push(Bisection *b, int32_t edge)
{
    int32_t at = b->heap_count++;
    while (at > 0 && comes_first(b, edge, b->heap[(at - 1) / 2])) {
        b->heap[at] = b->heap[(at - 1) / 2];
        at = (at - 1) / 2;
    }
    b->heap[at] = edge;
}

static double length_squared(const Bisection *b, int32_t half_edge)
{
    const int32_t *triangles = b->surface->triangles;
    const ShvVec3 d = shv_sub(shv_surface_position(b->surface, shv_half_edge_end(triangles, half_edge)),
                              shv_surface_position(b->surface, shv_half_edge_start(triangles, half_edge)));
    return shv_dot(d, d);
}

static void set_edge(Bisection *b, int32_t edge, int32_t half_edge, int32_t twin)
{
    b->half_edges[2 * (int64_t)edge] = half_edge;
    b->half_edges[2 * (int64_t)edge + 1] = twin;
    b->edge_of[half_edge] = b->edge_of[twin] = edge;
    b->lengths[edge] = length_squared(b, half_edge);
}

/* Half-edge `from` is now called `to`. */
static void move_half_edge(Bisection *b, int32_t from, int32_t to)
{
    const int32_t edge = b->edge_of[from];
    int32_t *pair = b->half_edges + 2 * (int64_t)edge;
    pair[pair[0] == from ? 0 : 1] = to;
    b->edge_of[to] = edge;
}

static void set_triangle(ShvSurface *surface, int32_t triangle, int32_t a, int32_t b, int32_t c)
{
    int32_t *corners = surface->triangles + 3 * (int64_t)triangle;
    corners[0] = a;
    corners[1] = b;
    corners[2] = c;
}

/* Triangles (a, b, c) and (b, a, d) become (a, m, c), (m, b, c), (m, a, d) and (b, m, d). */
static void split_longest(Bisection *b)
{
    ShvSurface *s = b->surface;
    const int32_t edge = b->heap[0];
    const int32_t ab = b->half_edges[2 * (int64_t)edge], ba = b->half_edges[2 * (int64_t)edge + 1];
    const int32_t bc = shv_half_edge_next(ab), db = shv_half_edge_next(shv_half_edge_next(ba));
    const int32_t node_a = s->triangles[ab], node_b = s->triangles[ba];
    const int32_t node_c = shv_half_edge_end(s->triangles, bc), node_d = s->triangles[db];

    const int32_t middle = s->node_count++;
    shv_store3(s->positions + 3 * (int64_t)middle,
               shv_scale(shv_add(shv_surface_position(s, node_a), shv_surface_position(s, node_b)), 0.5));
    const int32_t left = s->triangle_count++, right = s->triangle_count++;
    s->triangles[bc] = middle;
    s->triangles[ba] = middle;
    set_triangle(s, left, middle, node_b, node_c);
    set_triangle(s, right, node_b, middle, node_d);

    move_half_edge(b, bc, 3 * left + 1);
    move_half_edge(b, db, 3 * right + 2);
    const int32_t fresh = b->edge_count;
    b->edge_count += 3;
    set_edge(b, edge, ab, ba);
    set_edge(b, fresh, 3 * left, 3 * right);
    set_edge(b, fresh + 1, bc, 3 * left + 2);
    set_edge(b, fresh + 2, db, 3 * right + 1);
    sift_down(b, 0);
    for (int k = 0; k < 3; k++) push(b, fresh + k);
}

/* Numbers the edges of the closed surface in the order of their first half-edge. */
static ShvStatus number_edges(Bisection *b, ShvError *error)
{
    const ShvSurface *s = b->surface;
    const int32_t half_edges = 3 * s->triangle_count;
    ShvEdgeTable table;
    SHV_TRY(shv_edge_table_create(&table, s->memory, s->triangles, half_edges, error));
    ShvStatus status = SHV_OK;
    for (int32_t h = 0; h < half_edges; h++)
        if (shv_edge_table_insert(&table, h) >= 0) status = SHV_BAD_INPUT;
    for (int32_t h = 0; h < half_edges && status == SHV_OK; h++) {
        const int32_t twin =
            shv_edge_table_find(&table, shv_half_edge_end(s->triangles, h), shv_half_edge_start(s->triangles, h));
        if (twin < 0) status = SHV_BAD_INPUT;
        if (twin > h) set_edge(b, b->edge_count++, h, twin);
    }
    shv_edge_table_release(&table);
    if (status == SHV_OK) return SHV_OK;
    return shv_fail(error, status, "only a closed surface can be refined; close its holes");
}

static ShvStatus grow(ShvSurface *surface, int64_t nodes, int64_t triangles, ShvError *error)
{
    double *positions =
        shv_reallocate(surface->memory, surface->part, surface->positions, (size_t)nodes, 3 * sizeof(double));
    if (!positions) return shv_fail_memory(error, "a refined surface", (size_t)nodes * 3 * sizeof(double));
    surface->positions = positions;
    int32_t *corners =
        shv_reallocate(surface->memory, surface->part, surface->triangles, (size_t)triangles, 3 * sizeof(int32_t));
    if (!corners) return shv_fail_memory(error, "a refined surface", (size_t)triangles * 3 * sizeof(int32_t));
    surface->triangles = corners;
    return SHV_OK;
}

ShvStatus shv_surface_refine(ShvSurface *surface, int64_t triangles, ShvError *error)
{
    if (triangles <= surface->triangle_count) return SHV_OK;
    if (triangles > INT32_MAX / 3 - 1)
        return shv_fail(error, SHV_BAD_INPUT, "a surface can be refined to at most %d triangles, not %lld",
                        INT32_MAX / 3 - 1, (long long)triangles);
    const int64_t splits = (triangles - surface->triangle_count + 1) / 2;
    const int64_t final_triangles = surface->triangle_count + 2 * splits, edges = 3 * final_triangles / 2 + 1;
    SHV_TRY(grow(surface, surface->node_count + splits, final_triangles, error));

    Bisection b = {.surface = surface};
    ShvMemory *memory = surface->memory;
    b.edge_of = shv_allocate(memory, SHV_PART_GENERAL, 3 * (size_t)final_triangles, sizeof *b.edge_of);
    b.half_edges = shv_allocate(memory, SHV_PART_GENERAL, 2 * (size_t)edges, sizeof *b.half_edges);
    b.lengths = shv_allocate(memory, SHV_PART_GENERAL, (size_t)edges, sizeof *b.lengths);
    b.heap = shv_allocate(memory, SHV_PART_GENERAL, (size_t)edges, sizeof *b.heap);
    ShvStatus status = SHV_OK;
    if (!b.edge_of || !b.half_edges || !b.lengths || !b.heap)
        status = shv_fail_memory(error, "the edges of a surface", (size_t)edges * 32);
    if (status == SHV_OK) status = number_edges(&b, error);
    if (status == SHV_OK) {
        for (int32_t e = 0; e < b.edge_count; e++) push(&b, e);
        for (int64_t k = 0; k < splits; k++) split_longest(&b);
    }
    release(&b);
    return status;
}
