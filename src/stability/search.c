/* The largest stable step. */
#include <string.h>

#include "base/line.h"
#include "stability/stability.h"

/* ---- one step: is it stable? ---- */

static const double bound = 100.0, growth = 0.05, gone = 1e-15;

/* One step, and the energy of the time it starts from: strain and Σ ½ m v₋·v₊, which central difference keeps exactly where it
   is linear. With one of the velocities alone the sum would beat, which looks like growth. */
static ShvStatus step_and_measure(ShvProbe *probe, double step, double *energy)
{
    const ShvState *state = &probe->hybrid.state;
    const int64_t count = 3 * (int64_t)state->node_count;
    double sum = shv_solid_strain_energy(&probe->hybrid.solid, state);
    memcpy(probe->before, state->velocity, (size_t)count * sizeof(double));
    SHV_TRY(shv_probe_step(probe, step));
    for (int64_t i = 0; i < count; i++) sum += 0.5 * state->mass[i / 3] * probe->before[i] * state->velocity[i];
    *energy = fabs(sum);
    return SHV_OK;
}

/* Beyond the bound: does it end in numbers that are not finite? */
static ShvStabilityClass follow(ShvProbe *probe, double step)
{
    enum { FOLLOWED = 500 };
    for (int i = 0; i < FOLLOWED; i++)
        if (shv_probe_step(probe, step) != SHV_OK || !isfinite(shv_probe_energy(probe))) return SHV_OVERFLOW;
    return SHV_GROWING;
}

/* What has lost all but 1e-15 of its energy is stable: a mode that grows never falls below its share of the start. Rounding keeps
   some 1e-20 at long steps. */
ShvStabilityClass shv_probe_judge(ShvProbe *probe, const ShvStabilityRow *row, double multiple, int32_t steps)
{
    enum { EVERY = 10 };
    shv_probe_restart(probe, probe->shake, 1.0, row->stiffness, row->iterations);
    const double step = multiple * row->stable_step, start = shv_probe_energy(probe);
    const int32_t third = steps / 3;
    ShvLine line = {0.0, 0.0, 0.0, 0.0, 0.0};
    for (int32_t i = 1; i <= steps; i++) {
        double energy;
        if (i % EVERY != 0) {
            if (shv_probe_step(probe, step) != SHV_OK) return SHV_OVERFLOW;
            continue;
        }
        if (step_and_measure(probe, step, &energy) != SHV_OK || !isfinite(energy)) return SHV_OVERFLOW;
        const double now = energy / start;
        if (now > bound) return follow(probe, step);
        if (now < gone) return SHV_STABLE;
        if (i > steps - third) shv_line_add(&line, i, log(now));
    }
    return shv_line_slope(&line) * third <= log1p(growth) ? SHV_STABLE : SHV_GROWING;
}

/* ---- the search ---- */

/* Steps upwards by SCAN, then halves down to RESOLUTION, with a tenth of the steps; what is found must last all of them. */
static const double scan = 1.2, resolution = 1.02;

typedef struct Search {
    ShvProbe *probe;
    ShvStabilityRow *row;
    int32_t few, steps;
    double most;
} Search;

static bool holds(const Search *search, double multiple, int32_t steps)
{
    return shv_probe_judge(search->probe, search->row, multiple, steps) == SHV_STABLE;
}

static void bracket(const Search *search, double *low, double *high)
{
    *low = 0.0;
    *high = 0.5;
    while (*high <= search->most && holds(search, *high, search->few)) {
        *low = *high;
        *high *= scan;
    }
    /* The first one may fail already. */
    for (int i = 0; i < 20 && *low == 0.0; i++) {
        if (holds(search, *high / scan, search->few))
            *low = *high / scan;
        else
            *high /= scan;
    }
}

static void halve(const Search *search, double *low, double *high, int32_t steps)
{
    while (*low > 0.0 && *high <= search->most && *high > resolution * *low) {
        const double middle = sqrt(*low * *high);
        *(holds(search, middle, steps) ? low : high) = middle;
    }
}

/* What lasted a tenth of the steps and not all of them is no limit: down until one does. */
static void confirm(const Search *search, double *low, double *high)
{
    const double least = 0.25 * *low;
    while (*low > least && !holds(search, *low, search->steps)) {
        *high = *low;
        *low /= resolution;
    }
    if (!(*low > least)) *low = 0.0;
}

/* And what a tenth of the steps took for growth may be bounded: up until it is not. */
static void extend(const Search *search, double *low, double *high)
{
    while (*low > 0.0 && *high <= search->most && holds(search, *high, search->steps)) {
        *low = *high;
        *high *= resolution;
    }
}

static void sample_below(const Search *search)
{
    static const double shares[] = {0.9, 0.75, 0.5, 0.25};
    ShvStabilityRow *row = search->row;
    for (size_t i = 0; i < sizeof shares / sizeof shares[0] && row->limit > 0.0; i++)
        if (!holds(search, shares[i] * row->limit, search->steps)) row->unstable_below = shares[i] * row->limit;
}

static void sample_above(const Search *search)
{
    ShvStabilityRow *row = search->row;
    if (isinf(row->failed)) {
        row->beyond = row->far = SHV_STABLE;
        return;
    }
    row->beyond = shv_probe_judge(search->probe, row, row->failed, search->steps);
    row->far = shv_probe_judge(search->probe, row, 3.0 * row->failed, search->few);
    double multiple = row->failed;
    for (int i = 0; i < 3; i++) {
        multiple *= scan;
        if (holds(search, multiple, search->steps)) row->stable_again = multiple;
    }
}

void shv_probe_search(ShvProbe *probe, const ShvStabilityOptions *options, ShvStabilityRow *row)
{
    const int32_t few = options->steps / 10 > 300 ? options->steps / 10 : 300;
    const Search search = {probe, row, few < options->steps ? few : options->steps, options->steps, options->most};
    double low, high;
    row->stable_step = probe->hybrid.steps.stable;
    row->unstable_below = row->stable_again = (double)NAN;
    bracket(&search, &low, &high);
    halve(&search, &low, &high, search.few);
    confirm(&search, &low, &high);
    extend(&search, &low, &high);
    row->limit = low;
    row->failed = high > search.most ? HUGE_VAL : high;
    sample_below(&search);
    sample_above(&search);
    row->monotone = isnan(row->unstable_below) && isnan(row->stable_again);
}
