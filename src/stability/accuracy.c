/* How far off a step is where it is stable: the first body stretched along its longest axis. */
#include "stability/stability.h"

static const double rate_scale = 1e-6; /* strain rates in bar speeds a length: what is seen is linear */

static double stretch_rate(const ShvProbe *probe)
{
    return rate_scale * probe->bar_speed / probe->length;
}

/* ---- free vibration ---- */

typedef struct Swing {
    double before, now; /* q */
    double crossed[2];  /* s: q passed through zero */
    int count;
} Swing;

static void swing_add(Swing *swing, double time, double step, double q)
{
    swing->before = swing->now;
    swing->now = q;
    const bool passes = (swing->before > 0.0 && q <= 0.0) || (swing->before < 0.0 && q >= 0.0);
    if (!passes || swing->count == 2) return;
    swing->crossed[swing->count++] = time - step * q / (q - swing->before);
}

/* A damped swing may die out after its first half. */
static double swing_period(const Swing *swing)
{
    return swing->count == 2 ? swing->crossed[1] : swing->count == 1 ? 2.0 * swing->crossed[0] : (double)NAN;
}

/* ---- static stretch ---- */

/* q under a steady load of `rate` × s a second, from a run that mass-proportional friction near the critical one brings to
   rest. It does not change where that is: friction vanishes with the velocities. NaN where nothing settles. */
static double settle_with(ShvProbe *probe, double stiffness, int32_t iterations, double step, double friction)
{
    enum { MOST_PERIODS = 60, IN_A_ROW = 4 };
    static const double settled = 1e-6;
    const double period = probe->reference.period, rate = stretch_rate(probe) / period;
    const double keep = 1.0 / (1.0 + friction * step);
    double before = 0.0, next = 0.25 * period;
    int still = 0;
    shv_probe_restart(probe, NULL, 0.0, stiffness, iterations);
    for (double time = 0.0; time < MOST_PERIODS * period; time += step) {
        shv_probe_push(probe, rate * step, keep);
        if (shv_probe_step(probe, step) != SHV_OK) return (double)NAN;
        if (time < next) continue;
        const double q = shv_probe_elongation(probe);
        still = fabs(q - before) <= settled * fabs(q) ? still + 1 : 0;
        if (still == IN_A_ROW) return q / rate;
        before = q;
        next = fmax(next, time) + 0.25 * period;
    }
    return (double)NAN;
}

/* Near the limit friction may be too much; bars bring their own. */
static double settle(ShvProbe *probe, double stiffness, int32_t iterations, double step)
{
    static const double two_pi = 6.283185307179586;
    const double critical = 2.0 * two_pi / probe->reference.period;
    const double q = settle_with(probe, stiffness, iterations, step, critical);
    return isnan(q) && iterations > 0 ? settle_with(probe, stiffness, iterations, step, 0.0) : q;
}

/* ---- the reference ---- */

static ShvStatus swing_freely(ShvProbe *probe, ShvError *error)
{
    enum { MOST_STEPS = 4000000 };
    ShvProbeReference *reference = &probe->reference;
    const double rate = stretch_rate(probe);
    Swing swing = {0.0, 0.0, {0.0, 0.0}, 0};
    size_t room = 0;
    shv_probe_restart(probe, probe->stretch, rate, 0.0, 0);
    for (int32_t i = 0; i < MOST_STEPS && swing.count < 2; i++) {
        if ((size_t)i == room) {
            room = room ? 2 * room : 1024;
            SHV_RESIZE(probe->pool.memory, SHV_PART_GENERAL, reference->q, room, "the reference run",
                       room * sizeof(double), error);
        }
        if (i > 0 && shv_probe_step(probe, reference->step) != SHV_OK) break;
        const double q = shv_probe_elongation(probe) / rate;
        reference->q[reference->count++] = q;
        reference->largest = fmax(reference->largest, fabs(q));
        swing_add(&swing, i * reference->step, reference->step, q);
    }
    reference->period = swing_period(&swing);
    if (swing.count == 2 && reference->largest > 0.0) return SHV_OK;
    return shv_fail(error, SHV_DIVERGED, "the first body does not swing at a quarter of the stable step");
}

ShvStatus shv_probe_refer(ShvProbe *probe, ShvError *error)
{
    probe->reference.step = 0.25 * probe->hybrid.steps.stable;
    SHV_TRY(swing_freely(probe, error));
    probe->reference.compliance = settle(probe, 0.0, 0, 4.0 * probe->reference.step);
    return SHV_OK;
}

static double reference_at(const ShvProbeReference *reference, double time)
{
    const double place = fmin(time / reference->step, reference->count - 1.0);
    const int32_t i = (int32_t)fmin(floor(place), reference->count - 2.0);
    return reference->q[i] + (place - i) * (reference->q[i + 1] - reference->q[i]);
}

/* ---- one step ---- */

static void measure_swing(ShvProbe *probe, const ShvStabilityRow *row, ShvStabilityPoint *point)
{
    const ShvProbeReference *reference = &probe->reference;
    const double rate = stretch_rate(probe), step = point->multiple * row->stable_step;
    Swing swing = {0.0, 0.0, {0.0, 0.0}, 0};
    shv_probe_restart(probe, probe->stretch, rate, row->stiffness, row->iterations);
    const double start = shv_probe_energy(probe);
    point->displacement = point->energy_kept = (double)NAN; /* a step may be longer than the period */
    for (int64_t i = 1; (double)i * step < 4.0 * reference->period; i++) {
        if (shv_probe_step(probe, step) != SHV_OK) break;
        const double time = (double)i * step, q = shv_probe_elongation(probe) / rate;
        swing_add(&swing, time, step, q);
        if (time <= reference->period) {
            const double error = fabs(q - reference_at(reference, time)) / reference->largest;
            point->displacement = fmax(point->displacement, error);
            point->energy_kept = shv_probe_energy(probe) / start;
        }
    }
    /* Of a swing of fewer than four steps the crossings say nothing. */
    const double period = swing_period(&swing);
    point->frequency = period >= 4.0 * step ? reference->period / period : (double)NAN;
}

void shv_probe_measure(ShvProbe *probe, const ShvStabilityRow *row, ShvStabilityPoint *point)
{
    const double step = point->multiple * row->stable_step;
    measure_swing(probe, row, point);
    point->stiffness = probe->reference.compliance / settle(probe, row->stiffness, row->iterations, step);
}
