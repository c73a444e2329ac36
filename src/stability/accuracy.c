/* How far off a step is where it is stable: the first body stretched along its longest axis. */
#include <stdlib.h>

#include "stability/stability.h"

static const double rate_scale = 1e-6; /* strain rates in bar speeds a length: what is seen is linear */

static double stretch_rate(const ShvProbe *probe)
{
    return rate_scale * probe->bar_speed / probe->length;
}

/* ---- free vibration ---- */

typedef struct Swing {
    double q, crossed[2]; /* q, as of a stretching rate of 1/s; s: q passed through zero */
    int count;
} Swing;

static void swing_add(Swing *swing, const ShvProbe *probe, double time, double step)
{
    const double before = swing->q, q = shv_probe_elongation(probe) / stretch_rate(probe);
    swing->q = q;
    const bool passes = (before > 0.0 && q <= 0.0) || (before < 0.0 && q >= 0.0);
    if (passes && swing->count < 2) swing->crossed[swing->count++] = time - step * q / (q - before);
}

/* A damped swing may die out after its first half. */
static double swing_period(const Swing *swing)
{
    return swing->count == 2 ? swing->crossed[1] : swing->count == 1 ? 2.0 * swing->crossed[0] : (double)NAN;
}

static void measure_swing(ShvProbe *probe, const ShvStabilityRow *row, ShvStabilityPoint *point)
{
    const ShvProbeReference *reference = &probe->reference;
    const double step = point->multiple * row->stable_step;
    Swing swing = {.count = 0};
    shv_probe_restart(probe, probe->stretch, stretch_rate(probe), row->stiffness, row->iterations);
    const double start = shv_probe_energy(probe);
    point->displacement = point->energy_kept = (double)NAN; /* a step may be longer than the period */
    for (int64_t i = 1; (double)i * step < 4.0 * reference->period; i++) {
        if (shv_probe_step(probe, step) != SHV_OK) break;
        const double time = (double)i * step;
        swing_add(&swing, probe, time, step);
        if (time > reference->period) continue;
        const double place = fmin(time / reference->step, reference->count - 1.0);
        const int32_t k = (int32_t)fmin(floor(place), reference->count - 2.0);
        const double wanted = reference->q[k] + (place - k) * (reference->q[k + 1] - reference->q[k]);
        point->displacement = fmax(point->displacement, fabs(swing.q - wanted) / reference->largest);
        point->energy_kept = shv_probe_energy(probe) / start;
    }
    /* Of a swing of fewer than four steps the crossings say nothing. */
    const double period = swing_period(&swing);
    point->frequency = period >= 4.0 * step ? reference->period / period : (double)NAN;
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

/* ---- bars alone ----

   The stiffness of bars if none fought its neighbours. A bar of reduced mass m that n projections by k leave r = (1 − k)^n of its
   error, stretches under a steady relative acceleration g by g Δt² r/(1 − r): it acts as a spring m (1 − r)/(r Δt²).
   In a stretch ε along the axis, with the lateral contraction ν ε, an edge at the angle θ to it changes its length by
   h (cos²θ − ν sin²θ) ε. Springs beside the solid then make it stiffer by 1 + Σ K h² (cos²θ − ν sin²θ)²/(E V). */

static int compare_bars(const void *a, const void *b)
{
    const ShvBarAlone *p = a, *q = b;
    for (int i = 0; i < 2; i++)
        if (p->ends[i] != q->ends[i]) return p->ends[i] < q->ends[i] ? -1 : 1;
    return 0;
}

static double weight_of(const ShvProbe *probe, const ShvBarAlone *bar)
{
    const ShvHybrid *hybrid = &probe->hybrid;
    const ShvMaterial *material = &hybrid->model.materials[hybrid->model.objects[0].material];
    const int64_t a = bar->ends[0], b = bar->ends[1];
    const ShvVec3 d = shv_sub(shv_load3(hybrid->state.reference + 3 * b), shv_load3(hybrid->state.reference + 3 * a));
    const double square = shv_dot(d, d), along = shv_dot(d, probe->axis), cosine2 = along * along / square;
    const double change = cosine2 - material->poissons_ratio * (1.0 - cosine2);
    const double mass = 1.0 / (1.0 / hybrid->state.mass[a] + 1.0 / hybrid->state.mass[b]);
    return mass * square * change * change / (material->youngs_modulus * hybrid->fragments.items[0].volume);
}

/* The edges of the first body, each once, with how often one sweep visits it. */
static ShvStatus list_bars(ShvProbe *probe, ShvError *error)
{
    const ShvObject *object = &probe->hybrid.model.objects[0];
    const size_t most = 6 * (size_t)(object->element_end - object->element_begin);
    ShvBarAlone *bars = probe->bars = shv_pool_take(&probe->pool, most, sizeof *bars);
    if (!bars) return shv_fail_memory(error, "edges", most * sizeof *bars);
    ShvBarAlone *end = bars;
    for (int32_t e = object->element_begin; e < object->element_end; e++)
        for (int a = 0; a < 4; a++)
            for (int b = a + 1; b < 4; b++) {
                const int32_t i = shv_state_node(&probe->hybrid.state, e, a);
                const int32_t k = shv_state_node(&probe->hybrid.state, e, b);
                *end++ = (ShvBarAlone){.ends = {i < k ? i : k, i < k ? k : i}};
            }
    qsort(bars, most, sizeof *bars, compare_bars);
    for (size_t i = 0; i < most; i++) {
        if (i == 0 || compare_bars(&bars[i], &bars[probe->bar_count - 1]) != 0) bars[probe->bar_count++] = bars[i];
        bars[probe->bar_count - 1].visits++;
    }
    for (int32_t i = 0; i < probe->bar_count; i++) {
        bars[i].weight = weight_of(probe, &bars[i]);
        if (probe->scene.pbd.form == SHV_BARS_EDGE) bars[i].visits = 1;
    }
    return SHV_OK;
}

double shv_probe_bars_alone(const ShvProbe *probe, double stiffness, int32_t iterations, double step)
{
    double sum = 0.0;
    for (int32_t i = 0; i < probe->bar_count && iterations > 0; i++) {
        const double left = pow(1.0 - stiffness, (double)iterations * probe->bars[i].visits);
        sum += probe->bars[i].weight * (1.0 - left) / (left * step * step);
    }
    return 1.0 + sum;
}

/* ---- what all is compared with, and one step ---- */

ShvStatus shv_probe_refer(ShvProbe *probe, ShvError *error)
{
    enum { MOST_STEPS = 4000000 };
    ShvProbeReference *reference = &probe->reference;
    Swing swing = {.count = 0};
    size_t room = 0;
    SHV_TRY(list_bars(probe, error));
    reference->step = 0.25 * probe->hybrid.steps.stable;
    shv_probe_restart(probe, probe->stretch, stretch_rate(probe), 0.0, 0);
    for (int32_t i = 0; i < MOST_STEPS && swing.count < 2; i++) {
        if ((size_t)i == room) {
            room = room ? 2 * room : 1024;
            SHV_RESIZE(probe->pool.memory, SHV_PART_GENERAL, reference->q, room, "the reference run",
                       room * sizeof(double), error);
        }
        if (i > 0 && shv_probe_step(probe, reference->step) != SHV_OK) break;
        swing_add(&swing, probe, i * reference->step, reference->step);
        reference->q[reference->count++] = swing.q;
        reference->largest = fmax(reference->largest, fabs(swing.q));
    }
    reference->period = swing_period(&swing);
    if (swing.count < 2 || !(reference->largest > 0.0))
        return shv_fail(error, SHV_DIVERGED, "the first body does not swing at a quarter of the stable step");
    reference->compliance = settle(probe, 0.0, 0, 4.0 * reference->step);
    return SHV_OK;
}

void shv_probe_measure(ShvProbe *probe, const ShvStabilityRow *row, ShvStabilityPoint *point)
{
    measure_swing(probe, row, point);
    point->stiffness = probe->reference.compliance /
                       settle(probe, row->stiffness, row->iterations, point->multiple * row->stable_step);
}
