#include "check.h"

#include "base/random.h"

/* SplitMix64 with seed 0 gives e220a8397b1dcdaf first, the finaliser of the golden constant; our seed goes through
   the same finaliser once, so the bits of (seed, index) follow from that sequence. */
static uint64_t splitmix_next(uint64_t *state)
{
    uint64_t z = (*state += UINT64_C(0x9e3779b97f4a7c15));
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

static void bits_are_a_splitmix_sequence_of_a_mixed_seed(void **state)
{
    (void)state;
    uint64_t seed_state = 0;
    uint64_t sequence = splitmix_next(&seed_state);
    assert_true(sequence == UINT64_C(0xe220a8397b1dcdaf));
    for (uint64_t i = 0; i < 100; i++) {
        const uint64_t expected = splitmix_next(&sequence);
        assert_true(shv_random_bits(0, i) == expected);
    }
}

/* Mean 1/2 and variance 1/12 of n draws: standard errors 0.289/√n and 0.0745/√n; six of them are allowed, and the
   draws are fixed, so the test never changes its mind. */
static void uniform_has_the_right_moments(void **state)
{
    (void)state;
    const int n = 200000;
    for (uint64_t seed = 0; seed < 5; seed++) {
        double sum = 0.0, squares = 0.0, product = 0.0;
        for (int i = 0; i < n; i++) {
            const double u = shv_random_uniform(seed, (uint64_t)i);
            assert_true(u > 0.0 && u < 1.0);
            sum += u;
            squares += (u - 0.5) * (u - 0.5);
            product += (u - 0.5) * (shv_random_uniform(seed + 1, (uint64_t)i) - 0.5);
        }
        check_near(sum / n, 0.5, 6.0 * 0.289 / sqrt(n));
        check_near(squares / n, 1.0 / 12.0, 6.0 * 0.0745 / sqrt(n));
        check_near(product / n, 0.0, 6.0 / 12.0 / sqrt(n)); /* neighbouring seeds are unrelated */
    }
}

/* Flipping one bit of seed or index flips each output bit with probability 1/2: of 64 bits × 1000 trials the mean
   share is 0.5 within 6 × 0.5/√64000. */
static void every_input_bit_reaches_the_output(void **state)
{
    (void)state;
    for (int bit = 0; bit < 64; bit++) {
        int64_t seed_flips = 0, index_flips = 0;
        for (uint64_t i = 0; i < 1000; i++) {
            const uint64_t here = shv_random_bits(i, 7 * i);
            uint64_t by_seed = here ^ shv_random_bits(i ^ (UINT64_C(1) << bit), 7 * i);
            uint64_t by_index = here ^ shv_random_bits(i, (7 * i) ^ (UINT64_C(1) << bit));
            for (; by_seed; by_seed &= by_seed - 1) seed_flips++;
            for (; by_index; by_index &= by_index - 1) index_flips++;
        }
        check_near((double)seed_flips / 64000.0, 0.5, 0.012);
        check_near((double)index_flips / 64000.0, 0.5, 0.012);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bits_are_a_splitmix_sequence_of_a_mixed_seed),
        cmocka_unit_test(uniform_has_the_right_moments),
        cmocka_unit_test(every_input_bit_reaches_the_output),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
