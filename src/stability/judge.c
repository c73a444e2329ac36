#include <string.h>

#include "base/line.h"
#include "stability/stability.h"

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
