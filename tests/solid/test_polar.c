/* The batched rotation against the one of base/vector.h, which finds it another way. */
#include "check.h"

#include "base/random.h"
#include "base/vector.h"
#include "solid/polar.h"

typedef struct Lanes {
    _Alignas(64) double lane[SHV_WIDE_LANES];
} Lanes;

/* R − I of eight gradients H. */
static void turns(const ShvMat3 h[SHV_WIDE_LANES], ShvMat3 turn[SHV_WIDE_LANES])
{
    ShvWide wide[3][3], result[3][3];
    Lanes lanes;
    for (int k = 0; k < 9; k++) {
        for (int lane = 0; lane < SHV_WIDE_LANES; lane++) lanes.lane[lane] = h[lane].m[k / 3][k % 3];
        wide[k / 3][k % 3] = shv_wide_load(lanes.lane);
    }
    shv_wide_polar_turn(wide, result);
    for (int k = 0; k < 9; k++) {
        shv_wide_store(lanes.lane, result[k / 3][k % 3]);
        for (int lane = 0; lane < SHV_WIDE_LANES; lane++) turn[lane].m[k / 3][k % 3] = lanes.lane[lane];
    }
}

static ShvMat3 random_matrix(uint64_t seed, double size)
{
    ShvMat3 a;
    for (uint64_t k = 0; k < 9; k++) a.m[k / 3][k % 3] = size * (2.0 * shv_random_uniform(seed, k) - 1.0);
    return a;
}

static ShvMat3 random_rotation(uint64_t seed)
{
    double q[4];
    for (uint64_t k = 0; k < 4; k++) q[k] = 2.0 * shv_random_uniform(seed, 100 + k) - 1.0;
    return shv_quat_to_matrix(shv_quat_unit((ShvQuat){q[0], q[1], q[2], q[3]}));
}

static ShvMat3 minus_identity(ShvMat3 a)
{
    for (int i = 0; i < 3; i++) a.m[i][i] -= 1.0;
    return a;
}

static ShvMat3 plus_identity(ShvMat3 a)
{
    for (int i = 0; i < 3; i++) a.m[i][i] += 1.0;
    return a;
}

static void check_same(const ShvMat3 *a, const ShvMat3 *b, double tolerance)
{
    for (int k = 0; k < 9; k++) check_near(a->m[k / 3][k % 3], b->m[k / 3][k % 3], tolerance);
}

/* Any rotation times I + strain up to 0.3: the gap between the eigenvalues is at least 2, so that rounding in the 4 × 4
   matrix (a few 1e-16 of 3) turns the vector by no more than that; products of three such entries make it tens. */
static void follows_any_rotation(void **state)
{
    (void)state;
    for (uint64_t round = 0; round < 400; round++) {
        ShvMat3 h[SHV_WIDE_LANES], turn[SHV_WIDE_LANES], f[SHV_WIDE_LANES];
        for (uint64_t lane = 0; lane < SHV_WIDE_LANES; lane++) {
            const ShvMat3 rotation = random_rotation(8 * round + lane);
            ShvMat3 stretch = random_matrix(9000 + 8 * round + lane, lane < 4 ? 0.3 : 1e-6);
            stretch = plus_identity(stretch);
            f[lane] = shv_multiply(&rotation, &stretch);
            h[lane] = minus_identity(f[lane]);
        }
        turns(h, turn);
        for (int lane = 0; lane < SHV_WIDE_LANES; lane++) {
            const ShvMat3 expected = shv_polar_rotation(&f[lane]), got = plus_identity(turn[lane]);
            check_same(&got, &expected, 1e-14);
        }
    }
}

/* Small H keep their small digits: R − I is the skew part to second order. */
static void small_turns_keep_their_digits(void **state)
{
    (void)state;
    ShvMat3 h[SHV_WIDE_LANES], turn[SHV_WIDE_LANES];
    for (uint64_t lane = 0; lane < SHV_WIDE_LANES; lane++) h[lane] = random_matrix(50 + lane, 1e-12);
    turns(h, turn);
    for (int lane = 0; lane < SHV_WIDE_LANES; lane++)
        for (int k = 0; k < 9; k++) {
            const int i = k / 3, j = k % 3;
            check_near(turn[lane].m[i][j], 0.5 * (h[lane].m[i][j] - h[lane].m[j][i]), 1e-23);
        }
}

static void rest_is_exactly_no_turn(void **state)
{
    (void)state;
    ShvMat3 h[SHV_WIDE_LANES] = {{{{0.0}}}}, turn[SHV_WIDE_LANES];
    turns(h, turn);
    for (int lane = 0; lane < SHV_WIDE_LANES; lane++)
        for (int k = 0; k < 9; k++) assert_true(turn[lane].m[k / 3][k % 3] == 0.0);
}

/* Inverted, flattened, collapsed, stretched out of proportion, half turns, reflections: always a proper rotation;
   and where the nearest one is unique it is found. */
static void hard_cases_give_rotations(void **state)
{
    (void)state;
    static const double diagonal[SHV_WIDE_LANES][3] = {{1, 1, -1},     {1, 1, -0.5}, {1, 1, 0},    {0, 0, 0},
                                                       {1e6, 1, 1e-6}, {-1, -1, 1},  {-1, -1, -1}, {1, 2, -0.25}};
    ShvMat3 h[SHV_WIDE_LANES] = {{{{0.0}}}}, turn[SHV_WIDE_LANES];
    for (int lane = 0; lane < SHV_WIDE_LANES; lane++)
        for (int i = 0; i < 3; i++) h[lane].m[i][i] = diagonal[lane][i] - 1.0;
    turns(h, turn);
    for (int lane = 0; lane < SHV_WIDE_LANES; lane++) {
        const ShvMat3 rotation = plus_identity(turn[lane]), back = shv_transpose(&rotation);
        const ShvMat3 product = shv_multiply(&rotation, &back), unit = shv_identity();
        check_same(&product, &unit, 1e-14);
        check_near(shv_determinant(&rotation), 1.0, 1e-14);
    }
    /* F = diag(1, 1, −½), diag(1, 1, 0), diag(1e6, 1, 1e-6), diag(1, 2, −¼): the identity; diag(−1, −1, 1): itself.
       The gap to the next eigenvalue, 2 (s₂ + s₃), is at least 1 but for the third, where it is 2 of 1e6. */
    const ShvMat3 unit = shv_identity(), half_turn = {{{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}};
    const int plain[3] = {1, 2, 7};
    for (int i = 0; i < 3; i++) {
        const ShvMat3 rotation = plus_identity(turn[plain[i]]);
        check_same(&rotation, &unit, 1e-14);
    }
    const ShvMat3 stretched = plus_identity(turn[4]), turned = plus_identity(turn[5]);
    check_same(&stretched, &unit, 1e-9);
    check_same(&turned, &half_turn, 1e-14);
}

/* A lane's bits do not depend on its neighbours. */
static void lanes_are_independent(void **state)
{
    (void)state;
    ShvMat3 h[SHV_WIDE_LANES], together[SHV_WIDE_LANES], alone[SHV_WIDE_LANES];
    for (uint64_t lane = 0; lane < SHV_WIDE_LANES; lane++) h[lane] = random_matrix(70 + lane, lane < 4 ? 2.0 : 1e-3);
    turns(h, together);
    for (int lane = 0; lane < SHV_WIDE_LANES; lane++) {
        ShvMat3 same[SHV_WIDE_LANES];
        for (int i = 0; i < SHV_WIDE_LANES; i++) same[i] = h[lane];
        turns(same, alone);
        assert_memory_equal(&alone[lane], &together[lane], sizeof alone[lane]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(follows_any_rotation),    cmocka_unit_test(small_turns_keep_their_digits),
        cmocka_unit_test(rest_is_exactly_no_turn), cmocka_unit_test(hard_cases_give_rotations),
        cmocka_unit_test(lanes_are_independent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
