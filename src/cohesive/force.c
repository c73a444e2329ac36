#include <math.h>

#include "cohesive/cohesive.h"
#include "cohesive/frame.h"
#include "cohesive/pair.h"

/* Below this many facets, starting threads costs more than they save. */
enum { FEWEST_PARALLEL_FACETS = 256 };
/* Sweeps over a cluster end when no point's force changes by more than this share of its peak, or after so many. */
enum { MOST_SWEEPS = 32 };
static const double sweep_tolerance = 1e-3;

static bool in_parallel(const ShvCohesive *cohesive, int32_t facets)
{
    return cohesive->model->threads > 1 && facets >= FEWEST_PARALLEL_FACETS;
}

static bool rests(const ShvCohesive *cohesive, const ShvState *state, int32_t index, const uint8_t *awake)
{
    const int32_t *elements = cohesive->model->adjacency.facet_elements + 2 * (int64_t)cohesive->facet[index];
    return awake && !(awake[state->element_fragment[elements[0]]] && awake[state->element_fragment[elements[1]]]);
}

/* ---- begin ---- */

static void begin_point(ShvCohesive *cohesive, const ShvState *state, const ShvCohesiveFrame *frame, int32_t index,
                        int corner, ShvCohesivePoint *point)
{
    const int32_t first = frame->first[corner], second = frame->second[corner], k = 3 * index + corner;
    point->first = first;
    point->second = second;
    point->peak = 0.0;
    if (first == second) return;
    point->opening = shv_cohesive_opening(state, first, second);
    const ShvVec3 rate =
        shv_sub(shv_load3(state->velocity + 3 * (int64_t)second), shv_load3(state->velocity + 3 * (int64_t)first));
    point->from = shv_madd(point->opening, -0.5 * state->last_step, rate);
    point->pull = point->push = shv_vec3(0.0, 0.0, 0.0);
    if (!point->carrying) return;
    const ShvLaw *law = &cohesive->law[index];
    const ShvOpening now = shv_cohesive_components(point->from, frame->normal);
    const ShvHistory history = shv_law_advance(law, cohesive->history[k], cohesive->opening[k], now);
    const bool grown = history.normal > cohesive->history[k].normal || history.shear > cohesive->history[k].shear;
    cohesive->history[k] = history;
    cohesive->opening[k] = now;
    if (grown) cohesive->peak[k] = shv_law_peak(law, history);
    point->peak = cohesive->peak[k];
}

/* Failed when no point can carry any more; separated when, besides, a pair is farther apart than half the edge of an
   equilateral triangle of the facet's area: the pairs no longer say where the faces meet. */
static ShvCohesivePhase next_phase(const ShvCohesive *cohesive, int32_t index, const ShvCohesivePoint *points)
{
    double farthest = 0.0;
    for (int i = 0; i < 3; i++) {
        if (points[i].first == points[i].second) return SHV_COHESIVE_CARRYING;
        if (points[i].peak > 0.0) return SHV_COHESIVE_CARRYING;
        farthest = fmax(farthest, shv_dot(points[i].opening, points[i].opening));
    }
    const double edge_squared = cohesive->area[index] * (4.0 / sqrt(3.0));
    return farthest > 0.25 * edge_squared ? SHV_COHESIVE_SEPARATED : SHV_COHESIVE_FAILED;
}

static void begin_facet(ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake, int32_t index,
                        ShvCohesivePoint *points)
{
    const bool resting = rests(cohesive, state, index, awake);
    if (resting) {
        for (int i = 0; i < 3; i++) points[i].first = points[i].second = 0;
        return;
    }
    const ShvCohesiveFrame frame = shv_cohesive_frame(cohesive, state, index);
    for (int i = 0; i < 3; i++) {
        points[i].point = 3 * index + i;
        points[i].carrying = cohesive->phase[index] == SHV_COHESIVE_CARRYING;
        points[i].weight = cohesive->area[index] / 3.0;
        points[i].normal = frame.normal;
        begin_point(cohesive, state, &frame, index, i, &points[i]);
    }
    cohesive->phase[index] = (uint8_t)next_phase(cohesive, index, points);
}

/* Active points sorted by the node they stem from, in order of facets within one: pairs of copies of one node make a
   cluster, and no two clusters share a node. */
static void sort_clusters(ShvCohesive *cohesive, const ShvState *state)
{
    int32_t *fill = cohesive->origin_fill, start = 0;
    cohesive->cluster_count = 0;
    for (int32_t i = 0; i < cohesive->active_count; i++) {
        const int32_t origin = state->origin[cohesive->points[cohesive->unsorted[i]].first];
        if (fill[origin]++ == 0) cohesive->cluster[cohesive->cluster_count++] = origin;
    }
    for (int32_t c = 0; c < cohesive->cluster_count; c++) {
        const int32_t origin = cohesive->cluster[c], size = fill[origin];
        cohesive->cluster[c] = fill[origin] = start;
        start += size;
    }
    cohesive->cluster[cohesive->cluster_count] = start;
    for (int32_t i = 0; i < cohesive->active_count; i++) {
        const int32_t p = cohesive->unsorted[i];
        cohesive->active[fill[state->origin[cohesive->points[p].first]]++] = p;
    }
    for (int32_t i = 0; i < cohesive->active_count; i++)
        fill[state->origin[cohesive->points[cohesive->active[i]].first]] = 0;
}

/* Separated facets leave the list for good; the others' points are sorted by what they need. */
static void collect(ShvCohesive *cohesive, const ShvState *state)
{
    int32_t live = 0;
    cohesive->active_count = cohesive->pair_count = 0;
    for (int32_t k = 0; k < cohesive->live_count; k++) {
        const int32_t index = cohesive->live[k];
        if (cohesive->phase[index] == SHV_COHESIVE_SEPARATED) continue;
        cohesive->live[live++] = index;
        for (int32_t p = 3 * k; p < 3 * k + 3; p++) {
            const ShvCohesivePoint *point = &cohesive->points[p];
            if (point->first == point->second) continue;
            cohesive->pairs[cohesive->pair_count++] = p;
            if (point->peak > 0.0) cohesive->unsorted[cohesive->active_count++] = p;
        }
    }
    cohesive->live_count = live;
    sort_clusters(cohesive, state);
}

void shv_cohesive_begin(ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake)
{
    const int32_t live = cohesive->live_count, threads = cohesive->model->threads;
#pragma omp parallel for schedule(static) num_threads(threads) if (in_parallel(cohesive, live))
    for (int32_t k = 0; k < live; k++)
        begin_facet(cohesive, state, awake, cohesive->live[k], cohesive->points + 3 * (int64_t)k);
    collect(cohesive, state);
}

/* ---- pull ---- */

/* Each point moves shares of its nodes' masses in proportion to what it may pull. For points that share both nodes, as in
   a plane crack, one sweep is then exact; and as the shares of a node sum to its mass, moving all points at once takes no
   less energy than moving each with its share (the node's velocity is the shares' mean). */
static void share_masses(ShvCohesive *cohesive, const ShvState *state, const int32_t *points, int32_t count)
{
    double *share = cohesive->node_share;
    for (int32_t i = 0; i < count; i++) {
        const ShvCohesivePoint *point = &cohesive->points[points[i]];
        share[point->first] += point->weight * point->peak;
        share[point->second] += point->weight * point->peak;
    }
    for (int32_t i = 0; i < count; i++) {
        ShvCohesivePoint *point = &cohesive->points[points[i]];
        const double own = point->weight * point->peak;
        point->response = share[point->first] / (own * state->mass[point->first]) +
                          share[point->second] / (own * state->mass[point->second]);
    }
    for (int32_t i = 0; i < count; i++) {
        const ShvCohesivePoint *point = &cohesive->points[points[i]];
        share[point->first] = share[point->second] = 0.0;
    }
}

/* The force that the point would want, the others held; returns its change in units of the point's peak. */
static double want(const ShvCohesive *cohesive, const ShvState *state, ShvCohesivePoint *point, double kick,
                   double step)
{
    const ShvVec3 rate = shv_sub(shv_load3(state->velocity + 3 * (int64_t)point->second),
                                 shv_load3(state->velocity + 3 * (int64_t)point->first));
    const ShvVec3 without = shv_madd(rate, kick * point->response, point->pull);
    const ShvPairStep pair = {point->from, point->opening, shv_madd(point->opening, 0.5 * step, without),
                              0.5 * step * kick * point->response * point->weight};
    const ShvVec3 traction =
        shv_pair_traction(&cohesive->law[point->point / 3], cohesive->history[point->point], point->normal, &pair);
    point->change = shv_sub(shv_scale(traction, point->weight), point->pull);
    return shv_norm(point->change) / (point->weight * point->peak);
}

static void move(ShvState *state, int32_t node, double kick, ShvVec3 force)
{
    const double factor = kick / state->mass[node];
    shv_add_to3(state->velocity + 3 * (int64_t)node, shv_scale(force, factor));
    shv_add_to3(state->force + 3 * (int64_t)node, force);
}

static double sweep(ShvCohesive *cohesive, ShvState *state, const int32_t *points, int32_t count, double kick,
                    double step)
{
    double change = 0.0;
    for (int32_t i = 0; i < count; i++)
        change = fmax(change, want(cohesive, state, &cohesive->points[points[i]], kick, step));
    for (int32_t i = 0; i < count; i++) {
        ShvCohesivePoint *point = &cohesive->points[points[i]];
        point->pull = shv_add(point->pull, point->change);
        move(state, point->first, kick, point->change);
        move(state, point->second, kick, shv_scale(point->change, -1.0));
    }
    return change;
}

static int32_t pull_cluster(ShvCohesive *cohesive, ShvState *state, int32_t cluster, double kick, double step)
{
    const int32_t *points = cohesive->active + cohesive->cluster[cluster];
    const int32_t count = cohesive->cluster[cluster + 1] - cohesive->cluster[cluster];
    share_masses(cohesive, state, points, count);
    for (int32_t sweeps = 1; sweeps < MOST_SWEEPS; sweeps++)
        if (sweep(cohesive, state, points, count, kick, step) <= sweep_tolerance || count == 1) return sweeps;
    return MOST_SWEEPS;
}

void shv_cohesive_pull(ShvCohesive *cohesive, ShvState *state, double kick, double step)
{
    cohesive->sweeps = 0;
    if (!(step > 0.0 && kick > 0.0)) return;
    const int32_t count = cohesive->cluster_count, threads = cohesive->model->threads;
    int64_t sweeps = 0;
#pragma omp parallel for schedule(static) num_threads(threads) if (in_parallel(cohesive, count)) reduction(+ : sweeps)
    for (int32_t c = 0; c < count; c++) sweeps += pull_cluster(cohesive, state, c, kick, step);
    cohesive->sweeps = sweeps;
}

/* ---- book ---- */

void shv_cohesive_book(const ShvCohesive *cohesive, const ShvState *state, double step, ShvLedger *ledger)
{
    double pulled[2] = {0.0, 0.0}, pushed[2] = {0.0, 0.0};
    for (int32_t i = 0; i < cohesive->pair_count; i++) {
        const ShvCohesivePoint *point = &cohesive->points[cohesive->pairs[i]];
        const ShvVec3 rate = shv_sub(shv_load3(state->velocity + 3 * (int64_t)point->second),
                                     shv_load3(state->velocity + 3 * (int64_t)point->first));
        const ShvVec3 before = shv_sub(point->opening, point->from), after = shv_scale(rate, 0.5 * step);
        pulled[0] -= shv_dot(point->pull, before);
        pulled[1] -= shv_dot(point->pull, after);
        pushed[0] -= shv_dot(point->push, before);
        pushed[1] -= shv_dot(point->push, after);
    }
    shv_ledger_book(ledger, SHV_WORK_COHESIVE, pulled[0], pulled[1]);
    shv_ledger_book(ledger, SHV_WORK_CLOSURE, pushed[0], pushed[1]);
}

/* ---- resolution ---- */

static double time_to(double final_opening, double largest, double rate)
{
    return rate > 0.0 && largest < final_opening ? 0.1 * (final_opening - largest) / rate : (double)INFINITY;
}

double shv_cohesive_resolution_step(const ShvCohesive *cohesive, const ShvState *state)
{
    double least = (double)INFINITY;
    for (int32_t i = 0; i < cohesive->active_count; i++) {
        const ShvCohesivePoint *point = &cohesive->points[cohesive->active[i]];
        const ShvLaw *law = &cohesive->law[point->point / 3];
        const ShvHistory history = cohesive->history[point->point];
        const ShvVec3 rate = shv_sub(shv_load3(state->velocity + 3 * (int64_t)point->second),
                                     shv_load3(state->velocity + 3 * (int64_t)point->first));
        const double opening = shv_dot(rate, point->normal);
        const double slipping = shv_norm(shv_madd(rate, -opening, point->normal));
        const double slipped = law->kind == SHV_PPR ? history.shear : cohesive->opening[point->point].shear;
        least = fmin(least, time_to(law->final_opening[SHV_NORMAL], history.normal, opening));
        least = fmin(least, time_to(law->final_opening[SHV_SHEAR], slipped, slipping));
    }
    return least;
}
