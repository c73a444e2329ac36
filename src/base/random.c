#include "base/random.h"

/* Finaliser of SplitMix64 (Steele, Lea, Flood, "Fast splittable pseudorandom number generators", 2014; constants
   of Stafford's variant 13): a bijection of 64 bits in which every input bit reaches every output bit. */
static uint64_t mix(uint64_t z)
{
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

/* The seed is mixed before the index comes in, so that neighbouring seeds do not give shifted copies of one
   sequence. */
uint64_t shv_random_bits(uint64_t seed, uint64_t index)
{
    const uint64_t golden = UINT64_C(0x9e3779b97f4a7c15);
    return mix(mix(seed + golden) + golden * (index + 1));
}

/* 52 bits and a half: 53 bits and a half would round up to 1. */
double shv_random_uniform(uint64_t seed, uint64_t index)
{
    return ((double)(shv_random_bits(seed, index) >> 12) + 0.5) * 0x1p-52;
}
