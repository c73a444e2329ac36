/* Random numbers that depend on nothing but a seed and a counter: the n-th draw does not depend on who drew
   before, so that results are the same for any number of threads and any order of insertion. */
#ifndef SHV_BASE_RANDOM_H
#define SHV_BASE_RANDOM_H

#include <stdint.h>

/* 64 well mixed bits of (seed, index). */
uint64_t shv_random_bits(uint64_t seed, uint64_t index);
/* Uniform in (0, 1): never 0, never 1. */
double shv_random_uniform(uint64_t seed, uint64_t index);

#endif
