/* Populations of specimens whose heights are known, and shots at them. */
#ifndef SHV_TESTS_SURVIVE_POPULATIONS_H
#define SHV_TESTS_SURVIVE_POPULATIONS_H

#include <math.h>

#include "base/random.h"
#include "survive/design.h"

enum { MOST = 400 };

/* ---- populations ---- */

typedef struct Population {
    double median, scale; /* m, of ln height */
    uint64_t seed;
    bool weibull;
} Population;

static inline double normal(uint64_t seed, uint64_t index)
{
    const double radius = sqrt(-2.0 * log(shv_random_uniform(seed, 2 * index)));
    return radius * cos(6.28318530717958647692 * shv_random_uniform(seed, 2 * index + 1));
}

static inline double own_height(const Population *population, uint64_t specimen)
{
    if (!population->weibull) return population->median * exp(population->scale * normal(population->seed, specimen));
    const double exponential = -log(shv_random_uniform(population->seed, specimen));
    return population->median * pow(exponential / log(2.0), population->scale);
}

static inline ShvShot shoot(const Population *population, uint64_t specimen, double height)
{
    return (ShvShot){.specimen = specimen, .height = height, .broken = height >= own_height(population, specimen)};
}

/* Shots of the design; returns how many. */
static inline int32_t follow(const Population *population, const ShvDesign *design, ShvShot *shots)
{
    ShvSpecimen specimens[MOST];
    for (int32_t count = 0;; count++) {
        const ShvNextShot next = shv_design_next(design, shots, count, specimens);
        if (next.done) return count;
        shots[count] = shoot(population, next.specimen, next.height);
    }
}

static const ShvDesign wide = {.first = 1.0, .lowest = 1e-3, .highest = 1e3, .most_shots = 40, .every = 1};

static inline void assert_close(double a, double b, double tolerance)
{
    if (!(fabs(a - b) <= tolerance)) fail_msg("%.9g is not %.9g", a, b);
}

#endif
