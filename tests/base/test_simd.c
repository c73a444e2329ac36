/* The compiled path against plain loops, bit by bit. test_simd_avx2.c and test_simd_plain.c run the same tests on
   the narrower paths. */
#include "check.h"

#include <stdalign.h>

#include "base/random.h"
#include "base/simd.h"

enum { ROUNDS = 2000, N = SHV_WIDE_LANES };

/* Any magnitude from 1e-30 to 1e30 and either sign, with zeros and equal lanes among them. */
static void fill(double *values, uint64_t seed)
{
    for (uint64_t i = 0; i < N; i++) {
        const double u = shv_random_uniform(seed, 2 * i), v = shv_random_uniform(seed, 2 * i + 1);
        values[i] = u < 0.05 ? 0.0 : u < 0.1 ? -0.0 : u < 0.2 ? 1.0 : (v - 0.5) * pow(10.0, 60.0 * u - 30.0);
    }
}

typedef double Lanes[N];

static void check_bits(const char *what, ShvWide wide, const double *expected)
{
    alignas(64) Lanes got;
    shv_wide_store(got, wide);
    if (memcmp(got, expected, sizeof got) != 0)
        for (int i = 0; i < N; i++)
            if (memcmp(&got[i], &expected[i], sizeof got[i]) != 0)
                fail_msg("%s lane %d: %a, expected %a", what, i, got[i], expected[i]);
}

#define CHECK_LANES(what, wide, expression)                                                                            \
    do {                                                                                                               \
        Lanes expected_;                                                                                               \
        for (int i = 0; i < N; i++) expected_[i] = (expression);                                                       \
        check_bits(what, (wide), expected_);                                                                           \
    } while (0)

static void arithmetic_has_the_bits_of_plain_loops(void **state)
{
    (void)state;
    alignas(64) Lanes a, b, c;
    for (uint64_t round = 0; round < ROUNDS; round++) {
        fill(a, 3 * round);
        fill(b, 3 * round + 1);
        fill(c, 3 * round + 2);
        for (int i = 0; i < N; i++)
            if (b[i] == 0.0) b[i] = 3.0; /* no 0/0: the sign of a NaN is nobody's promise */
        const ShvWide x = shv_wide_load(a), y = shv_wide_load(b), z = shv_wide_load(c);
        CHECK_LANES("load", x, a[i]);
        CHECK_LANES("add", shv_wide_add(x, y), a[i] + b[i]);
        CHECK_LANES("sub", shv_wide_sub(x, y), a[i] - b[i]);
        CHECK_LANES("mul", shv_wide_mul(x, y), a[i] * b[i]);
        CHECK_LANES("div", shv_wide_div(x, y), a[i] / b[i]);
        CHECK_LANES("fma", shv_wide_fma(x, y, z), fma(a[i], b[i], c[i]));
        CHECK_LANES("fnma", shv_wide_fnma(x, y, z), fma(-a[i], b[i], c[i]));
        CHECK_LANES("sqrt", shv_wide_sqrt(shv_wide_mul(x, x)), sqrt(a[i] * a[i]));
    }
}

static void choices_have_the_bits_of_plain_loops(void **state)
{
    (void)state;
    alignas(64) Lanes a, b;
    for (uint64_t round = 0; round < ROUNDS; round++) {
        fill(a, 2 * round);
        fill(b, 2 * round + 1);
        if (round % 4 == 0) a[round % N] = (double)NAN;
        if (round % 7 == 0) b[round % N] = (double)NAN;
        const ShvWide x = shv_wide_load(a), y = shv_wide_load(b);
        CHECK_LANES("min", shv_wide_min(x, y), a[i] < b[i] ? a[i] : b[i]);
        CHECK_LANES("max", shv_wide_max(x, y), a[i] > b[i] ? a[i] : b[i]);
        CHECK_LANES("less", shv_wide_select(shv_wide_less(x, y), x, y), a[i] < b[i] ? a[i] : b[i]);
        CHECK_LANES("less_equal", shv_wide_select(shv_wide_less_equal(x, y), x, y), a[i] <= b[i] ? a[i] : b[i]);
    }
}

/* A sum with one rounding differs from one with two: 1 + 2⁻⁵² squared. */
static void products_are_fused(void **state)
{
    (void)state;
    const ShvWide x = shv_wide_set1(1.0 + 0x1p-52), one = shv_wide_set1(1.0 + 0x1p-51);
    CHECK_LANES("fma", shv_wide_fma(x, x, shv_wide_sub(shv_wide_zero(), one)), 0x1p-104);
    CHECK_LANES("fnma", shv_wide_fnma(x, x, one), -0x1p-104);
}

static void any_looks_at_every_lane(void **state)
{
    (void)state;
    alignas(64) Lanes a = {0.0};
    assert_int_equal(shv_wide_any(shv_wide_less(shv_wide_load(a), shv_wide_zero())), 0);
    for (int i = 0; i < N; i++) {
        a[i] = -1.0;
        assert_int_not_equal(shv_wide_any(shv_wide_less(shv_wide_load(a), shv_wide_zero())), 0);
        a[i] = 0.0;
    }
}

static void gather_reads_any_order(void **state)
{
    (void)state;
    double table[64];
    for (int i = 0; i < 64; i++) table[i] = (double)i + 0.25;
    for (uint64_t round = 0; round < 100; round++) {
        int32_t index[N + 1];
        for (uint64_t i = 0; i <= N; i++) index[i] = (int32_t)(shv_random_bits(round, i) % 64) - 32;
        const int32_t *at = index + round % 2; /* both alignments */
        CHECK_LANES("gather", shv_wide_gather(table + 32, at), table[32 + at[i]]);
        CHECK_LANES("set", shv_wide_set(table + 32), table[32 + i]);
    }
    CHECK_LANES("set1", shv_wide_set1(0.1), 0.1);
    CHECK_LANES("zero", shv_wide_zero(), 0.0);
}

static void quads_are_records_of_four(void **state)
{
    (void)state;
    enum { RECORDS = 20 };
    alignas(64) double base[4 * RECORDS], kept[4 * RECORDS];
    for (int i = 0; i < 4 * RECORDS; i++) base[i] = kept[i] = shv_random_uniform(5, (uint64_t)i);
    const int32_t index[N] = {3, 19, 0, 7, 11, 3, 12, 5}; /* lanes 0 and 5 are the same record */
    ShvWide q[4];
    shv_wide_load_quads(base, index, q);
    for (int c = 0; c < 4; c++) CHECK_LANES("load_quads", q[c], base[4 * index[i] + c]);
    for (int c = 0; c < 4; c++) q[c] = shv_wide_add(q[c], shv_wide_set1(c + 1.0));
    shv_wide_store_quads(base, index, q);
    for (int record = 0; record < RECORDS; record++)
        for (int c = 0; c < 4; c++) {
            int stored = 0;
            for (int i = 0; i < N; i++) stored |= index[i] == record;
            assert_true(base[4 * record + c] == kept[4 * record + c] + (stored ? c + 1.0 : 0.0));
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(arithmetic_has_the_bits_of_plain_loops),
        cmocka_unit_test(quads_are_records_of_four),
        cmocka_unit_test(choices_have_the_bits_of_plain_loops),
        cmocka_unit_test(products_are_fused),
        cmocka_unit_test(any_looks_at_every_lane),
        cmocka_unit_test(gather_reads_any_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
