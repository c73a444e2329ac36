#include "mesh/improve.h"

#include <math.h>
#include <string.h>

#include "base/deterministic.h"
#include "base/random.h"

/* Passes over all bad tets; tets round one edge; places tried for a node. */
enum { MOST_PASSES = 24, MOST_RING = 8, PLACES = 24 };
/* A change must better the worst of the tets concerned by this factor, so that passes end. */
static const double better = 1.001;
/* First way a node is tried at, of the wanted measure, and what is left of it after a place that is no better. */
static const double first_way = 0.8, shorter = 0.8;

typedef struct Work {
    ShvImprove *mesh;
    int32_t capacity;    /* tets */
    int32_t *start, *at; /* tets at each node, as they were when the pass began */
    uint8_t *changed;    /* nodes whose tets are others by now */
    bool any;            /* something got better in this pass */
    uint64_t drawn;
} Work;

static ShvVec3 place(const double *positions, int32_t node)
{
    return shv_load3(positions + 3 * (int64_t)node);
}

double shv_improve_measure(const double *positions, const int32_t tet[4])
{
    const ShvVec3 o = place(positions, tet[0]), a = shv_sub(place(positions, tet[1]), o);
    const ShvVec3 b = shv_sub(place(positions, tet[2]), o), c = shv_sub(place(positions, tet[3]), o);
    const ShvVec3 ab = shv_cross(a, b), bc = shv_cross(b, c), ca = shv_cross(c, a);
    const ShvVec3 last = shv_add(shv_add(ab, bc), ca);
    const double squares = shv_dot(ab, ab) + shv_dot(bc, bc) + shv_dot(ca, ca) + shv_dot(last, last);
    return squares > 0.0 ? shv_dot(a, bc) / sqrt(squares) : 0.0;
}

static double measure(const Work *w, int32_t a, int32_t b, int32_t c, int32_t d)
{
    return shv_improve_measure(w->mesh->positions, (int32_t[4]){a, b, c, d});
}

static const int32_t *tet_at(const Work *w, int32_t tet)
{
    return w->mesh->tets + 4 * (int64_t)tet;
}

static bool has(const int32_t *tet, int32_t node)
{
    return tet[0] == node || tet[1] == node || tet[2] == node || tet[3] == node;
}

/* ---- changing tets ---- */

/* A tet taken away has its first node −1 until the pass ends. */
static void take_away(Work *w, int32_t tet)
{
    int32_t *nodes = w->mesh->tets + 4 * (int64_t)tet;
    for (int i = 0; i < 4; i++) w->changed[nodes[i]] = 1;
    nodes[0] = -1;
    w->any = true;
}

static ShvStatus add(Work *w, int32_t a, int32_t b, int32_t c, int32_t d, ShvError *error)
{
    if (w->mesh->tet_count == w->capacity) {
        const int32_t more = w->capacity + w->capacity / 4 + 64;
        SHV_RESIZE(w->mesh->memory, SHV_PART_GENERAL, w->mesh->tets, 4 * (size_t)more, "better tets", 16 * (size_t)more,
                   error);
        w->capacity = more;
    }
    memcpy(w->mesh->tets + 4 * (int64_t)w->mesh->tet_count++, (int32_t[4]){a, b, c, d}, 4 * sizeof a);
    return SHV_OK;
}

/* ---- round an edge ---- */

typedef struct Ring {
    int32_t low, high;       /* the edge's nodes; seen from high the ring runs counter-clockwise */
    int32_t node[MOST_RING]; /* of the ring */
    int32_t tet[MOST_RING];  /* between node i and the next */
    int count;
    double worst; /* of them */
    double best[MOST_RING]
               [MOST_RING]; /* worst measure if the ring from i to j is cut into triangles as well as it can be */
    int split[MOST_RING][MOST_RING]; /* and the third node of the triangle on i and j */
} Ring;

/* The other two nodes c, d of a tet, such that (a, b, c, d) is right handed. */
static void others(const int32_t *tet, int32_t a, int32_t b, int32_t found[2])
{
    static const int8_t order[4][4][2] = {{{-1, -1}, {2, 3}, {3, 1}, {1, 2}},
                                          {{3, 2}, {-1, -1}, {0, 3}, {2, 0}},
                                          {{1, 3}, {3, 0}, {-1, -1}, {0, 1}},
                                          {{2, 1}, {0, 2}, {1, 0}, {-1, -1}}};
    int i = 0, j = 0;
    while (tet[i] != a) i++;
    while (tet[j] != b) j++;
    found[0] = tet[order[i][j][0]];
    found[1] = tet[order[i][j][1]];
}

/* Whether the tets at an edge, as they were, are still there and close round it. */
static bool find_ring(const Work *w, int32_t low, int32_t high, Ring *ring)
{
    int32_t tets[MOST_RING], from[MOST_RING], to[MOST_RING];
    int count = 0;
    for (int32_t k = w->start[low]; k < w->start[low + 1]; k++) {
        const int32_t *tet = tet_at(w, w->at[k]);
        if (!has(tet, high)) continue;
        if (count == MOST_RING) return false;
        int32_t pair[2];
        others(tet, low, high, pair);
        tets[count] = w->at[k];
        from[count] = pair[0];
        to[count++] = pair[1];
    }
    *ring = (Ring){.low = low, .high = high, .count = count, .worst = (double)INFINITY};
    for (int i = 0, now = 0; i < count; i++) {
        ring->tet[i] = tets[now];
        ring->node[i] = from[now];
        ring->worst = fmin(ring->worst, shv_improve_measure(w->mesh->positions, tet_at(w, tets[now])));
        const int32_t wanted = to[now];
        for (now = 0; now < count && from[now] != wanted; now++) {
        }
        if (now == count) return false;
        if (i + 1 < count && from[now] == ring->node[0]) return false;
    }
    return count >= 3;
}

/* The best way to cut the ring into triangles, by the best ways of its parts (Klincsek): each triangle makes two tets. */
static double best_cut(const Work *w, Ring *ring)
{
    const int32_t *n = ring->node;
    for (int i = 0; i + 1 < ring->count; i++) ring->best[i][i + 1] = (double)INFINITY;
    for (int width = 2; width < ring->count; width++)
        for (int i = 0; i + width < ring->count; i++) {
            const int j = i + width;
            ring->best[i][j] = -(double)INFINITY;
            for (int k = i + 1; k < j; k++) {
                double worst = fmin(ring->best[i][k], ring->best[k][j]);
                if (worst > ring->best[i][j]) worst = fmin(worst, measure(w, n[i], n[k], n[j], ring->high));
                if (worst > ring->best[i][j]) worst = fmin(worst, measure(w, n[i], n[j], n[k], ring->low));
                if (!(worst > ring->best[i][j])) continue;
                ring->best[i][j] = worst;
                ring->split[i][j] = k;
            }
        }
    return ring->best[0][ring->count - 1];
}

static ShvStatus cut_ring(Work *w, const Ring *ring, int i, int j, ShvError *error)
{
    const int32_t *n = ring->node;
    const int k = ring->split[i][j];
    if (j - i < 2) return SHV_OK;
    SHV_TRY(add(w, n[i], n[k], n[j], ring->high, error));
    SHV_TRY(add(w, n[i], n[j], n[k], ring->low, error));
    SHV_TRY(cut_ring(w, ring, i, k, error));
    return cut_ring(w, ring, k, j, error);
}

/* Takes away the edge of a tet whose going betters the tets round it by most. */
static ShvStatus remove_edge(Work *w, int32_t tet, bool *done, ShvError *error)
{
    Ring best = {0}, ring;
    double gain = better;
    int32_t nodes[4];
    memcpy(nodes, tet_at(w, tet), sizeof nodes);
    for (int i = 0; i < 4; i++)
        for (int j = i + 1; j < 4; j++) {
            if (!find_ring(w, nodes[i], nodes[j], &ring)) continue;
            const double cut = best_cut(w, &ring);
            const double factor = ring.worst > 0.0 ? cut / ring.worst : cut > 0.0 ? (double)INFINITY : 0.0;
            if (!(factor > gain)) continue;
            gain = factor;
            best = ring;
        }
    *done = best.count > 0;
    if (!*done) return SHV_OK;
    SHV_TRY(cut_ring(w, &best, 0, best.count - 1, error));
    for (int i = 0; i < best.count; i++) take_away(w, best.tet[i]);
    return SHV_OK;
}

/* ---- through a facet ---- */

/* The other tet on the facet opposite a corner, or −1. */
static int32_t across(const Work *w, int32_t tet, int corner)
{
    const int32_t *nodes = tet_at(w, tet), *face[3];
    for (int i = 0, k = 0; i < 4; i++)
        if (i != corner) face[k++] = nodes + i;
    for (int32_t k = w->start[*face[0]]; k < w->start[*face[0] + 1]; k++) {
        const int32_t *other = tet_at(w, w->at[k]);
        if (w->at[k] != tet && has(other, *face[1]) && has(other, *face[2])) return w->at[k];
    }
    return -1;
}

/* Three tets round the line from one apex to the other, in place of two on a facet, where that is better. */
static ShvStatus remove_facet(Work *w, int32_t tet, bool *done, ShvError *error)
{
    static const int inward[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};
    *done = false;
    for (int corner = 0; corner < 4 && !*done; corner++) {
        const int32_t other = across(w, tet, corner);
        if (other < 0) continue;
        int32_t n[4], face[3], high, low = -1;
        memcpy(n, tet_at(w, tet), sizeof n);
        high = n[corner];
        for (int i = 0; i < 3; i++) face[i] = n[inward[corner][i]];
        for (int i = 0; i < 4; i++)
            if (!has(n, tet_at(w, other)[i])) low = tet_at(w, other)[i];
        const double now =
            fmin(shv_improve_measure(w->mesh->positions, n), shv_improve_measure(w->mesh->positions, tet_at(w, other)));
        double then = (double)INFINITY;
        for (int i = 0; i < 3; i++) then = fmin(then, measure(w, low, high, face[i], face[(i + 1) % 3]));
        if (!(then > 0.0 && then > better * now)) continue;
        for (int i = 0; i < 3; i++) SHV_TRY(add(w, low, high, face[i], face[(i + 1) % 3], error));
        take_away(w, tet);
        take_away(w, other);
        *done = true;
    }
    return SHV_OK;
}

/* ---- places of nodes ---- */

typedef struct Worst {
    double measure;
    int32_t at; /* index of the tet into Work.at */
} Worst;

/* Of the tets at a node. One that is no better than `than` is an answer: most places are given up at the tet that is the worst of
   all where the node is now, which is asked first. */
static Worst worst_at(const Work *w, int32_t node, Worst than)
{
    const int32_t begin = w->start[node], end = w->start[node + 1];
    Worst worst = {(double)INFINITY, begin};
    for (int32_t i = begin - 1; i < end && worst.measure > than.measure; i++) {
        const int32_t at = i < begin ? than.at : i;
        const double found = shv_improve_measure(w->mesh->positions, tet_at(w, w->at[at]));
        if (found < worst.measure) worst = (Worst){found, at};
    }
    return worst;
}

static ShvVec3 draw_way(Work *w)
{
    double x[3];
    for (int k = 0; k < 3; k++) x[k] = 2.0 * shv_random_uniform(w->mesh->seed, w->drawn++) - 1.0;
    return shv_load3(x);
}

/* Where it goes when it would move that way. */
static ShvVec3 keep(const ShvImprove *mesh, int32_t node, ShvVec3 old, ShvVec3 way)
{
    if (mesh->outline) return shv_outline_keep(mesh->outline, mesh->held[node], old, shv_add(old, way));
    const ShvVec3 wanted = shv_add(old, shv_freedom_shift(&mesh->freedom, node, way));
    const double slid = shv_norm(shv_sub(wanted, place(mesh->original, node)));
    return mesh->freedom.kind[node] == SHV_FREE || slid < mesh->wanted ? wanted : old;
}

/* Tries places near a node for one where the worst of its tets is better. */
static void move(Work *w, int32_t node)
{
    ShvImprove *mesh = w->mesh;
    const Worst none = {-(double)INFINITY, w->start[node]};
    double *x = mesh->positions + 3 * (int64_t)node, way = first_way * mesh->wanted;
    Worst worst = worst_at(w, node, none);
    for (int i = 0; i < PLACES && worst.measure < mesh->wanted; i++) {
        const ShvVec3 old = shv_load3(x);
        shv_store3(x, keep(mesh, node, old, shv_scale(draw_way(w), way)));
        const Worst now = worst_at(w, node, worst);
        if (now.measure > worst.measure) {
            w->any = w->any || now.measure > worst.measure + (better - 1.0) * mesh->wanted;
            worst = now;
        } else {
            shv_store3(x, old);
            way *= shorter;
        }
    }
}

/* ---- passes ---- */

static void list_tets(Work *w)
{
    const ShvImprove *mesh = w->mesh;
    memset(w->start, 0, ((size_t)mesh->node_count + 2) * sizeof *w->start);
    for (int64_t i = 0; i < 4 * (int64_t)mesh->tet_count; i++) w->start[mesh->tets[i] + 2]++;
    for (int32_t n = 0; n < mesh->node_count; n++) w->start[n + 2] += w->start[n + 1];
    for (int64_t i = 0; i < 4 * (int64_t)mesh->tet_count; i++) w->at[w->start[mesh->tets[i] + 1]++] = (int32_t)(i / 4);
    memset(w->changed, 0, (size_t)mesh->node_count);
}

static bool is_settled(const Work *w, const int32_t nodes[4])
{
    for (int i = 0; i < 4; i++)
        if (w->changed[nodes[i]]) return false;
    return true;
}

static ShvStatus better_tet(Work *w, int32_t tet, ShvError *error)
{
    int32_t nodes[4];
    bool done;
    memcpy(nodes, tet_at(w, tet), sizeof nodes);
    if (nodes[0] < 0 || !is_settled(w, nodes) || shv_improve_measure(w->mesh->positions, nodes) >= w->mesh->wanted)
        return SHV_OK;
    SHV_TRY(remove_edge(w, tet, &done, error));
    if (!done) SHV_TRY(remove_facet(w, tet, &done, error));
    for (int i = 0; i < 4 && !done; i++) move(w, nodes[i]);
    return SHV_OK;
}

static void drop_gaps(ShvImprove *mesh)
{
    int32_t kept = 0;
    for (int32_t t = 0; t < mesh->tet_count; t++) {
        if (mesh->tets[4 * (int64_t)t] < 0) continue;
        memmove(mesh->tets + 4 * (int64_t)kept++, mesh->tets + 4 * (int64_t)t, 4 * sizeof *mesh->tets);
    }
    mesh->tet_count = kept;
}

static ShvStatus pass(Work *w, ShvError *error)
{
    ShvImprove *mesh = w->mesh;
    const int32_t count = mesh->tet_count;
    SHV_RESIZE(mesh->memory, SHV_PART_GENERAL, w->at, 4 * (size_t)count, "tets at nodes", 16 * (size_t)count, error);
    list_tets(w);
    w->any = false;
    ShvStatus status = SHV_OK;
    for (int32_t t = 0; t < count && status == SHV_OK; t++) status = better_tet(w, t, error);
    drop_gaps(mesh);
    return status;
}

ShvStatus shv_improve(ShvImprove *mesh, ShvError *error)
{
    const size_t nodes = (size_t)mesh->node_count;
    Work w = {.mesh = mesh, .capacity = mesh->tet_count, .any = true};
    w.start = shv_allocate(mesh->memory, SHV_PART_GENERAL, nodes + 2, sizeof *w.start);
    w.changed = shv_allocate(mesh->memory, SHV_PART_GENERAL, nodes, sizeof *w.changed);
    ShvStatus status = w.start && w.changed ? SHV_OK : shv_fail_memory(error, "tets at nodes", 5 * nodes);
    for (int i = 0; i < MOST_PASSES && w.any && status == SHV_OK; i++) status = pass(&w, error);
    shv_release(w.start);
    shv_release(w.at);
    shv_release(w.changed);
    return status;
}
