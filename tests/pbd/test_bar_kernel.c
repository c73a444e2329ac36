/* The wide kernel against plain loops that round in the same places, bit by bit. test_bar_kernel_avx2.c and
   test_bar_kernel_plain.c run the same test on the narrower paths. */
#include "check.h"

#include <stdalign.h>

#include "base/random.h"
#include "pbd/bar_kernel.h"

enum { N = SHV_WIDE_LANES, ROUNDS = 200 };

/* One bar; `a`, `b`: reference and inverse mass, `u`, `v`: displacement. */
static void relax_plainly(double stiffness, double rest, const double *a, const double *b, double *u, double *v)
{
    double edge[3], excess = 0.0, square = 0.0;
    for (int c = 0; c < 3; c++) {
        const double reference = a[c] - b[c], change = u[c] - v[c];
        edge[c] = reference + change;
        excess = fma(change, reference + edge[c], excess);
        square = fma(edge[c], edge[c], square);
    }
    const double length = sqrt(square), divisor = length * (length + rest) * (a[3] + b[3]);
    if (!(divisor > 0.0 && rest > 0.0)) return;
    const double f = stiffness * excess / divisor;
    for (int c = 0; c < 3; c++) {
        u[c] = fma(-(a[3] * f), edge[c], u[c]);
        v[c] = fma(b[3] * f, edge[c], v[c]);
    }
}

static double draw(uint64_t *index)
{
    return shv_random_uniform(11, (*index)++);
}

/* Nodes of eight items with `corners` nodes each; some pinned, some ends together. */
static void fill(double *anchors, double *shifts, int nodes, uint64_t *index)
{
    for (int i = 0; i < nodes; i++) {
        for (int c = 0; c < 3; c++) {
            anchors[4 * i + c] = draw(index);
            shifts[4 * i + c] = 0.1 * draw(index);
        }
        anchors[4 * i + 3] = draw(index) < 0.3 ? 0.0 : 1e3 * draw(index);
        shifts[4 * i + 3] = 0.0;
        if (i > 0 && draw(index) < 0.1)
            for (int c = 0; c < 3; c++) {
                anchors[4 * i + c] = anchors[4 * i + c - 4];
                shifts[4 * i + c] = shifts[4 * i + c - 4];
            }
    }
}

static void bars_and_tets_have_the_bits_of_plain_loops(void **state)
{
    (void)state;
    alignas(64) double anchors[16 * N], shifts[16 * N], rest[6 * N], plain[16 * N];
    uint64_t index = 0;
    for (int round = 0; round < ROUNDS; round++) {
        const int corners = round % 2 ? 4 : 2, edges = round % 2 ? 6 : 1;
        int32_t ends[4 * N];
        fill(anchors, shifts, corners * N, &index);
        for (int c = 0; c < corners; c++)
            for (int i = 0; i < N; i++) ends[c * N + i] = corners * i + c;
        for (int i = 0; i < edges * N; i++) rest[i] = draw(&index) < 0.1 ? 0.0 : draw(&index);
        memcpy(plain, shifts, sizeof plain);
        for (int i = 0; i < N; i++)
            for (int e = 0; e < edges; e++) {
                const int a = ends[shv_tet_edges[e][0] * N + i], b = ends[shv_tet_edges[e][1] * N + i];
                relax_plainly(0.7, rest[e * N + i], anchors + 4 * a, anchors + 4 * b, plain + 4 * a, plain + 4 * b);
            }
        (corners == 2 ? shv_bar_batch : shv_tet_batch)(shv_wide_set1(0.7), ends, rest, anchors, shifts);
        for (int i = 0; i < 4 * corners * N; i++)
            if (memcmp(&shifts[i], &plain[i], sizeof plain[i]) != 0)
                fail_msg("round %d, number %d: %a, expected %a", round, i, shifts[i], plain[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(bars_and_tets_have_the_bits_of_plain_loops)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
