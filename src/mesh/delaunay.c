#include "mesh/delaunay.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>

#include "base/random.h"
#include "mesh/hilbert.h"

/* Every facet of the hull has a tet on its outer side whose fourth corner, always the last, is no point: "at infinity". */
enum { INFINITE = -1, NONE = -1 };

typedef struct Tet {
    int32_t point[4];
    int32_t neighbour[4]; /* opposite each */
    int32_t replaced[4];  /* by a tet on the same facet, while a point is put in */
    int32_t looked_at;    /* the point for which … */
    bool conflict;        /* … it was found to be in the way */
} Tet;

typedef struct Build {
    ShvMemory *memory;
    const int32_t *points;
    Tet *tets;
    int32_t *cavity, *spare; /* tets that are in the way; that are free */
    int32_t count, capacity, cavity_count, spare_count, last;
} Build;

/* ---- exact signs ---- */

typedef struct Whole3 {
    int64_t x, y, z;
} Whole3;

static Whole3 between(const Build *b, int32_t from, int32_t to)
{
    const int32_t *p = b->points + 3 * (int64_t)from, *q = b->points + 3 * (int64_t)to;
    return (Whole3){q[0] - p[0], q[1] - p[1], q[2] - p[2]};
}

/* At most 2^60 in size, for sides on the grid. */
static int64_t determinant(Whole3 a, Whole3 b, Whole3 c)
{
    return a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
}

/* Positive where d lies on the side to which a, b, c run counter-clockwise. */
static int64_t side_of(const Build *b, const int32_t p[3], int32_t d)
{
    return determinant(between(b, p[0], p[1]), between(b, p[0], p[2]), between(b, p[0], d));
}

/* What is above the lowest `bits`, rounded down; they are left. */
static int64_t carry(int64_t *sum, int bits)
{
    const int64_t low = *sum & ((INT64_C(1) << bits) - 1), high = (*sum - low) / (INT64_C(1) << bits);
    *sum = low;
    return high;
}

/* Sign of Σ factor × square, |factor| ≤ 2^60, 0 ≤ square < 2^40: in parts of 30 and 20 bits. */
static int exact_sign(const int64_t factor[4], const int64_t square[4])
{
    int64_t sum[4] = {0}; /* of 2^0, 2^20, 2^30, 2^50 */
    for (int i = 0; i < 4; i++) {
        int64_t low = factor[i], small = square[i];
        const int64_t high = carry(&low, 30), large = carry(&small, 20);
        sum[0] += low * small;
        sum[1] += low * large;
        sum[2] += high * small;
        sum[3] += high * large;
    }
    sum[1] += carry(&sum[0], 20);
    sum[2] += carry(&sum[1], 10);
    sum[3] += carry(&sum[2], 20);
    if (sum[3] != 0) return sum[3] > 0 ? 1 : -1;
    return (sum[0] | sum[1] | sum[2]) != 0;
}

static int64_t square(Whole3 a)
{
    return a.x * a.x + a.y * a.y + a.z * a.z;
}

/* Whether p is inside the sphere through a tet of positive volume, not on it. */
static bool is_in_sphere(const Build *b, const int32_t tet[4], int32_t p)
{
    const double safe = 1e-14; /* some eight roundings of 2^-53 */
    Whole3 s[4];
    int64_t squares[4];
    for (int i = 0; i < 4; i++) {
        s[i] = between(b, p, tet[i]);
        squares[i] = square(s[i]);
    }
    const int64_t factors[4] = {determinant(s[1], s[2], s[3]), -determinant(s[0], s[2], s[3]),
                                determinant(s[0], s[1], s[3]), -determinant(s[0], s[1], s[2])};
    double sum = 0.0, size = 0.0;
    for (int i = 0; i < 4; i++) {
        const double part = (double)factors[i] * (double)squares[i];
        sum += part;
        size += fabs(part);
    }
    if (fabs(sum) > safe * size) return sum > 0.0;
    return exact_sign(factors, squares) > 0;
}

/* ---- where a point is in the way ---- */

static bool is_outer(const Tet *tet)
{
    return tet->point[3] == INFINITE;
}

/* An outer tet holds what lies beyond its facet; in the facet's plane, what the sphere of the tet behind it holds. */
static bool holds(const Build *b, const Tet *tet, int32_t p)
{
    if (!is_outer(tet)) return is_in_sphere(b, tet->point, p);
    const int64_t side = side_of(b, tet->point, p);
    return side > 0 || (side == 0 && is_in_sphere(b, b->tets[tet->neighbour[3]].point, p));
}

static bool in_conflict(Build *b, int32_t t, int32_t p)
{
    Tet *tet = &b->tets[t];
    if (tet->looked_at != p) {
        tet->looked_at = p;
        tet->conflict = holds(b, tet, p);
    }
    return tet->conflict;
}

/* Face k of a tet, counter-clockwise seen from inside. */
static const int inward[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};

/* Walks from tet to tet towards p: to one that holds it, or out of the hull. */
static int32_t locate(const Build *b, int32_t p)
{
    int32_t at = b->last;
    if (is_outer(&b->tets[at])) at = b->tets[at].neighbour[3];
    for (int k = 0; k < 4;) {
        const Tet *tet = &b->tets[at];
        const int32_t face[3] = {tet->point[inward[k][0]], tet->point[inward[k][1]], tet->point[inward[k][2]]};
        if (side_of(b, face, p) >= 0) {
            k++;
            continue;
        }
        at = tet->neighbour[k];
        if (is_outer(&b->tets[at])) return at;
        k = 0;
    }
    return at;
}

/* ---- putting a point in ---- */

static ShvStatus take_tet(Build *b, int32_t *taken, ShvError *error)
{
    if (b->spare_count > 0) {
        *taken = b->spare[--b->spare_count];
        return SHV_OK;
    }
    if (b->count == b->capacity) {
        const int32_t more = 2 * b->capacity;
        const size_t bytes = (size_t)more * (sizeof(Tet) + 2 * sizeof(int32_t));
        SHV_RESIZE(b->memory, SHV_PART_GENERAL, b->tets, (size_t)more, "tets between points", bytes, error);
        SHV_RESIZE(b->memory, SHV_PART_GENERAL, b->cavity, (size_t)more, "tets between points", bytes, error);
        SHV_RESIZE(b->memory, SHV_PART_GENERAL, b->spare, (size_t)more, "tets between points", bytes, error);
        b->capacity = more;
    }
    *taken = b->count++;
    return SHV_OK;
}

static int place_of(const int32_t values[4], int32_t value)
{
    int k = 0;
    while (values[k] != value) k++;
    return k;
}

static void find_cavity(Build *b, int32_t start, int32_t p)
{
    b->cavity_count = 0;
    b->tets[start].looked_at = p;
    b->tets[start].conflict = true;
    b->cavity[b->cavity_count++] = start;
    for (int32_t i = 0; i < b->cavity_count; i++)
        for (int k = 0; k < 4; k++) {
            const int32_t next = b->tets[b->cavity[i]].neighbour[k];
            if (b->tets[next].looked_at != p && in_conflict(b, next, p)) b->cavity[b->cavity_count++] = next;
        }
}

/* A tet from p to each facet of the cavity, in the place of the tet inside it. */
static ShvStatus fill_cavity(Build *b, int32_t p, ShvError *error)
{
    for (int32_t i = 0; i < b->cavity_count; i++)
        for (int k = 0; k < 4; k++) {
            const int32_t old = b->cavity[i], outer = b->tets[old].neighbour[k];
            int32_t made;
            if (in_conflict(b, outer, p)) continue;
            SHV_TRY(take_tet(b, &made, error));
            Tet *tet = &b->tets[made];
            *tet = b->tets[old];
            tet->conflict = false;
            tet->point[k] = p;
            tet->neighbour[k] = outer;
            b->tets[outer].neighbour[place_of(b->tets[outer].neighbour, old)] = made;
            b->tets[old].replaced[k] = made;
            b->last = made;
        }
    return SHV_OK;
}

/* Round the edge that facets `face` and `cross` of a tet of the cavity have in common, through the cavity: the tet made on the
   facet where it ends. */
static int32_t turn(Build *b, int32_t at, int face, int cross, int32_t p)
{
    int32_t pivot = b->tets[at].point[face];
    for (;;) {
        const int32_t next = b->tets[at].neighbour[cross];
        if (b->tets[next].looked_at != p || !b->tets[next].conflict) return b->tets[at].replaced[cross];
        const Tet *tet = &b->tets[next];
        const int32_t apex = tet->point[place_of(tet->neighbour, at)];
        cross = place_of(tet->point, pivot);
        pivot = apex;
        at = next;
    }
}

static void join_made(Build *b, int32_t p)
{
    for (int32_t i = 0; i < b->cavity_count; i++)
        for (int k = 0; k < 4; k++) {
            const int32_t old = b->cavity[i], made = b->tets[old].replaced[k];
            if (made == NONE) continue;
            for (int j = 0; j < 4; j++)
                if (j != k) b->tets[made].neighbour[j] = turn(b, old, k, j, p);
        }
}

static ShvStatus put_in(Build *b, int32_t p, ShvError *error)
{
    find_cavity(b, locate(b, p), p);
    for (int32_t i = 0; i < b->cavity_count; i++)
        for (int k = 0; k < 4; k++) b->tets[b->cavity[i]].replaced[k] = NONE;
    SHV_TRY(fill_cavity(b, p, error));
    join_made(b, p);
    for (int32_t i = 0; i < b->cavity_count; i++) b->spare[b->spare_count++] = b->cavity[i];
    return SHV_OK;
}

/* ---- all points ---- */

typedef struct Turn {
    uint64_t key;
    int32_t point;
} Turn;

static int by_key(const void *a, const void *b)
{
    const Turn *x = a, *y = b;
    if (x->key != y->key) return x->key < y->key ? -1 : 1;
    return (x->point > y->point) - (x->point < y->point);
}

/* Rounds of twice as many points each, along the Hilbert curve in each: few steps from one to the next, and no order that
   makes many tets only to take them away again (Amenta, Choi, Rote, SoCG 2003). */
static void order_points(const int32_t *points, int32_t count, Turn *turns)
{
    enum { MOST_ROUNDS = 15, ROUND_BITS = 3 * (SHV_HILBERT_BITS - 1) };
    for (int32_t i = 0; i < count; i++) {
        uint64_t draw = shv_random_bits(0, (uint64_t)i);
        uint64_t round = MOST_ROUNDS;
        for (; round > 0 && (draw & 1u); draw >>= 1) round--;
        uint32_t x[3];
        for (int k = 0; k < 3; k++) x[k] = (uint32_t)points[3 * (int64_t)i + k];
        turns[i] = (Turn){round << ROUND_BITS | shv_hilbert_place(x), i};
    }
    qsort(turns, (size_t)count, sizeof *turns, by_key);
}

static bool is_on_line(Whole3 a, Whole3 b)
{
    return a.y * b.z == a.z * b.y && a.z * b.x == a.x * b.z && a.x * b.y == a.y * b.x;
}

/* Moves four points that are not in one plane to the front, in an order of positive volume. */
static bool find_first_tet(const Build *b, Turn *turns, int32_t count)
{
    int32_t first[4] = {turns[0].point};
    for (int32_t i = 1, found = 1; i < count && found < 4; i++) {
        const int32_t p = turns[i].point;
        if (found == 2 && is_on_line(between(b, first[0], first[1]), between(b, first[0], p))) continue;
        if (found == 3 && side_of(b, first, p) == 0) continue;
        first[found] = p;
        const Turn swap = turns[found];
        turns[found++] = turns[i];
        turns[i] = swap;
        if (found < 4) continue;
        if (side_of(b, first, p) > 0) return true;
        turns[0].point = first[1];
        turns[1].point = first[0];
        return true;
    }
    return false;
}

/* One tet, and outer ones on its four facets. */
static ShvStatus start(Build *b, const Turn *turns, ShvError *error)
{
    int32_t all[5];
    for (int i = 0; i < 5; i++) SHV_TRY(take_tet(b, &all[i], error));
    Tet *inner = &b->tets[all[0]];
    for (int i = 0; i < 4; i++) inner->point[i] = turns[i].point;
    for (int k = 0; k < 4; k++) {
        Tet *outer = &b->tets[all[k + 1]];
        for (int i = 0; i < 3; i++) {
            outer->point[i] = inner->point[inward[k][2 - i]];
            outer->neighbour[i] = all[inward[k][2 - i] + 1];
        }
        outer->point[3] = INFINITE;
        outer->neighbour[3] = all[0];
        inner->neighbour[k] = all[k + 1];
        outer->looked_at = NONE;
    }
    inner->looked_at = NONE;
    return SHV_OK;
}

static ShvStatus build(Build *b, Turn *turns, int32_t count, ShvError *error)
{
    const int32_t guess = 8; /* tets a point; they grow when that is too few */
    b->capacity = guess * count + 64;
    b->tets = shv_allocate(b->memory, SHV_PART_GENERAL, (size_t)b->capacity, sizeof *b->tets);
    b->cavity = shv_allocate(b->memory, SHV_PART_GENERAL, (size_t)b->capacity, sizeof *b->cavity);
    b->spare = shv_allocate(b->memory, SHV_PART_GENERAL, (size_t)b->capacity, sizeof *b->spare);
    if (!b->tets || !b->cavity || !b->spare)
        return shv_fail_memory(error, "tets between points", (size_t)b->capacity * sizeof *b->tets);
    order_points(b->points, count, turns);
    if (!find_first_tet(b, turns, count))
        return shv_fail(error, SHV_BAD_INPUT, "%d points lie in one plane, and tets need four that do not", (int)count);
    SHV_TRY(start(b, turns, error));
    for (int32_t i = 4; i < count; i++) SHV_TRY(put_in(b, turns[i].point, error));
    return SHV_OK;
}

/* Those that are not outer ones, nor free. */
static ShvStatus keep_tets(ShvDelaunay *delaunay, Build *b, ShvError *error)
{
    for (int32_t i = 0; i < b->spare_count; i++) b->tets[b->spare[i]].point[3] = INFINITE;
    for (int32_t t = 0; t < b->count; t++) delaunay->tet_count += !is_outer(&b->tets[t]);
    delaunay->tets = shv_allocate(b->memory, SHV_PART_GENERAL, 4 * (size_t)delaunay->tet_count, sizeof *delaunay->tets);
    if (!delaunay->tets) return shv_fail_memory(error, "tets between points", 16 * (size_t)delaunay->tet_count);
    int64_t at = 0;
    for (int32_t t = 0; t < b->count; t++)
        for (int i = 0; i < 4 && !is_outer(&b->tets[t]); i++) delaunay->tets[at++] = b->tets[t].point[i];
    return SHV_OK;
}

ShvStatus shv_delaunay_make(ShvDelaunay *delaunay, ShvMemory *memory, const int32_t *points, int32_t count,
                            ShvError *error)
{
    Build b = {.memory = memory, .points = points};
    *delaunay = (ShvDelaunay){0};
    Turn *turns = shv_allocate(memory, SHV_PART_GENERAL, (size_t)count, sizeof *turns);
    ShvStatus status = turns ? build(&b, turns, count, error)
                             : shv_fail_memory(error, "an order of points", (size_t)count * sizeof *turns);
    if (status == SHV_OK) status = keep_tets(delaunay, &b, error);
    shv_release(turns);
    shv_release(b.tets);
    shv_release(b.cavity);
    shv_release(b.spare);
    if (status != SHV_OK) shv_delaunay_release(delaunay);
    return status;
}

void shv_delaunay_release(ShvDelaunay *delaunay)
{
    shv_release(delaunay->tets);
    *delaunay = (ShvDelaunay){0};
}
