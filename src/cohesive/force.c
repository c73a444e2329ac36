#include <math.h>

#include "cohesive/facet_rotation.h"
#include "cohesive/frame.h"
#include "cohesive/solve.h"

/* ---- softening ---- */

/* What a cluster's points may keep, and where the last step led them. */
static double softened_recoverable(const ShvCohesive *cohesive, int32_t cluster, double share, bool keep)
{
    double sum = 0.0;
    for (int32_t i = cohesive->cluster[cluster]; i < cohesive->cluster[cluster + 1]; i++) {
        const ShvCohesivePoint *point = &cohesive->points[i];
        const ShvLaw *law = &cohesive->law[point->point / 3];
        ShvInternalVariables *internal = &cohesive->internal[point->point];
        const ShvHistory history = internal->history;
        const double *end = law->final_opening;
        const double normal = history.normal + share * shv_larger(end[SHV_NORMAL] - history.normal, 0.0);
        const double shear = history.shear + share * shv_larger(end[SHV_SHEAR] - history.shear, 0.0);
        const ShvHistory softened = shv_law_grow(law, history, normal, law->kind == SHV_PPR ? shear : 0.0);
        sum += point->weight * shv_law_recoverable(law, softened, internal->opening.normal, internal->opening.shear);
        if (!keep) continue;
        internal->history = softened;
        internal->peak = shv_law_peak(law, softened);
    }
    return sum;
}

/* The share of what is left by which every largest opening grows at least `ratio` times itself. */
static double growing_share(const ShvCohesive *cohesive, int32_t cluster, double ratio)
{
    double share = 0.0;
    for (int32_t i = cohesive->cluster[cluster]; i < cohesive->cluster[cluster + 1]; i++) {
        const int32_t point = cohesive->points[i].point;
        const double largest[2] = {cohesive->internal[point].history.normal, cohesive->internal[point].history.shear};
        for (int k = 0; k < 2; k++) {
            const double left = cohesive->law[point / 3].final_opening[k] - largest[k];
            if (left > 0.0 && isfinite(left)) share = shv_larger(share, ratio * largest[k] / left);
        }
    }
    return share;
}

/* Softens a cluster until it stores no more than `allowed`: all points by the same share of what is left of their law. The end
   of the bracket that keeps the bound is taken, so that the bound holds however little the law is understood. Stiffness
   falls faster than the inverse of the largest opening: that gives the first guess; the inverse of what is stored is then
   nearly a line (Illinois steps), unless points are softened by very different degrees (geometric steps). Besides,
   a thousandth may go of the excess or of what may stay, whichever is less: neither is to be seen in the energies. */
static void soften(const ShvCohesive *cohesive, int32_t cluster, double allowed, double kept)
{
    const double spare = 1e-3 * shv_smaller(kept - allowed, allowed) + 1e-12 * allowed;
    const double aim = 1.0 / (allowed - 0.5 * spare);
    double low = 0.0, high = 1.0, at_low = 1.0 / kept - aim, at_high = (double)INFINITY, least = 0.0;
    double share = growing_share(cohesive, cluster, kept / allowed - 1.0);
    int side = 0; /* end that moved last */
    for (int i = 0; i < 100 && allowed - least > spare && high - low > 1e-15 * high; i++) {
        if (!(share > low && share < high) || i % 4 == 3) share = low > 0.0 ? sqrt(low * high) : 1e-3 * high;
        const double stored = softened_recoverable(cohesive, cluster, share, false);
        if (stored <= allowed) {
            if (side > 0) at_low *= 0.5;
            side = 1;
            high = share;
            at_high = 1.0 / stored - aim;
            least = stored;
        } else {
            if (side < 0) at_high *= 0.5;
            side = -1;
            low = share;
            at_low = 1.0 / stored - aim;
        }
        share = low - (high - low) * (at_low / (at_high - at_low));
    }
    softened_recoverable(cohesive, cluster, high, true);
}

/* A cluster that was limited (limit_given) has given all it stored, but for round-off: to keep nothing it would have to let go
   for good, and lose its work of separation. It may keep this share of what it exchanged. */
static const double spared_share = 1e-9;
/* A point that has hardly opened exchanges round-off: it may keep this share of strength × opening of its start (shv_law_start),
   1e-11 of its work of separation at most. Without that a corner held shut by its neighbours is softened to nothing by the signs of
   numbers of 1e-40 J. */
static const double start_share = 1e-3;

/* Of its work of separation a cluster may be in debt by so much in all. Sweeps stop at a share of the peak: where forces are smaller than that,
   their work is uncertain by as much as what is stored, now one way and now the other. To soften the cluster by each such excess
   softened bonds to nothing in bodies that only vibrated; the debt is paid back by the next error the other way, and nothing is
   gained beyond this share, however long it vibrates. */
static const double debt_share = 1e-3;

static double separation_work(const ShvCohesive *cohesive, const ShvCohesivePoint *point)
{
    const double energy = cohesive->law[point->point / 3].energy[SHV_NORMAL];
    return energy < 1e50 ? point->weight * energy : 0.0; /* one that never softens has no debt */
}

static bool is_indebted(const ShvCohesive *cohesive, int32_t start, int32_t end)
{
    bool any = false;
    for (int32_t i = start; i < end; i++) any = any || cohesive->internal[cohesive->points[i].point].energy_debt > 0.0;
    return any;
}

/* Returns by how much more than its largest debt a cluster has kept, J. */
static double carry_debt(const ShvCohesive *cohesive, int32_t cluster, double excess)
{
    const int32_t start = cohesive->cluster[cluster], end = cohesive->cluster[cluster + 1];
    double energy_debt = excess, most = 0.0;
    if (excess <= 0.0 && !is_indebted(cohesive, start, end)) return 0.0;
    for (int32_t i = start; i < end; i++) {
        energy_debt += cohesive->internal[cohesive->points[i].point].energy_debt;
        most += debt_share * separation_work(cohesive, &cohesive->points[i]);
    }
    const double left = shv_smaller(shv_larger(energy_debt, 0.0), most);
    for (int32_t i = start; i < end; i++)
        cohesive->internal[cohesive->points[i].point].energy_debt = left / (end - start);
    return shv_larger(energy_debt - most, 0.0);
}

/* Moves the histories of a cluster along the step that was booked. Sweeps that have not settled leave a difference between
   the work of the tractions and the law; a cluster never keeps more than it had and was given. */
static void end_step(const ShvCohesive *cohesive, int32_t cluster)
{
    double allowed = 0.0, kept = 0.0, exchanged = 0.0, started = 0.0;
    for (int32_t i = cohesive->cluster[cluster]; i < cohesive->cluster[cluster + 1]; i++) {
        ShvCohesivePoint *point = &cohesive->points[i];
        const ShvLaw *law = &cohesive->law[point->point / 3];
        ShvInternalVariables *internal = &cohesive->internal[point->point];
        const ShvHistory before = internal->history;
        const ShvOpening at = point->reached;
        const ShvHistory next = shv_law_advance(law, before, internal->opening, at);
        internal->history = next;
        internal->opening = at;
        if (next.normal > before.normal || next.shear > before.shear) internal->peak = shv_law_peak(law, next);
        point->last = point->pull;
        allowed += point->stored + point->work;
        exchanged += point->stored + fabs(point->work);
        kept += point->weight * shv_springs_recoverable(law, shv_law_follow(law, next, &point->springs), at);
        started += point->start_energy;
    }
    allowed = shv_larger(allowed, shv_larger(spared_share * exchanged, start_share * started));
    const double excess = carry_debt(cohesive, cluster, kept - allowed);
    if (excess > 0.0) soften(cohesive, cluster, kept - excess, kept);
}

/* ---- begin ---- */

/* Failed when no point can carry any more; separated when, besides, a pair is farther apart than half the edge of an
   equilateral triangle of the facet's area: the pairs no longer say where the faces meet. */
static ShvCohesivePhase next_phase(const ShvCohesive *cohesive, const ShvFacetRotation *rotation,
                                   const ShvFacetGaps *gaps)
{
    double farthest = 0.0;
    for (int i = 0; i < 3; i++) {
        if (rotation->first[i] == rotation->second[i]) return SHV_COHESIVE_CARRYING;
        if (rotation->carries && cohesive->internal[3 * (int64_t)rotation->index + i].peak > 0.0)
            return SHV_COHESIVE_CARRYING;
        farthest = shv_larger(farthest, shv_dot(gaps->opening[i], gaps->opening[i]));
    }
    const double edge_squared = rotation->area * SHV_SQUARE_OF_EDGE;
    return farthest > 0.25 * edge_squared ? SHV_COHESIVE_SEPARATED : SHV_COHESIVE_FAILED;
}

static void begin_facet(ShvCohesive *cohesive, const ShvState *state, int32_t k)
{
    ShvFacetRotation *rotation = &cohesive->rotations[k];
    ShvFacetGaps *gaps = &cohesive->gaps[k];
    const int32_t index = rotation->index;
    if (shv_cohesive_is_pushed(cohesive, k)) *gaps = (ShvFacetGaps){0};
    shv_facet_rotation_begin(rotation, state);
    for (int i = 0; i < 3; i++) {
        const int64_t first = 3 * (int64_t)rotation->first[i], second = 3 * (int64_t)rotation->second[i];
        if (first == second) continue;
        const ShvVec3 rate = shv_sub(shv_load3(state->velocity + second), shv_load3(state->velocity + first));
        gaps->opening[i] = shv_cohesive_opening(state, rotation->first[i], rotation->second[i]);
        gaps->before[i] = shv_scale(shv_sub(rate, shv_cross(rotation->rate, gaps->opening[i])), 0.5 * state->last_step);
    }
    cohesive->phase[index] = (uint8_t)next_phase(cohesive, rotation, gaps);
    const bool elastic = rotation->returned > 0.0; /* what its faces hold they give back when they part */
    cohesive->apart[index] = elastic ? 0.0 : shv_cohesive_way_apart(rotation, gaps);
}

static void begin_point(ShvCohesive *cohesive, ShvCohesivePoint *point)
{
    const ShvLaw *law = &cohesive->law[point->point / 3];
    const ShvFacetGaps *gaps = &cohesive->gaps[point->rotation];
    const int corner = point->point % 3;
    point->opening = gaps->opening[corner];
    point->from = shv_sub(point->opening, gaps->before[corner]);
    point->settled = shv_vec3((double)NAN, 0.0, 0.0);
    point->pull = shv_vec3(0.0, 0.0, 0.0);
    const ShvOpening now = shv_cohesive_components(point->from, cohesive->rotations[point->rotation].normal);
    ShvInternalVariables *internal = &cohesive->internal[point->point];
    const ShvHistory before = internal->history;
    const ShvHistory history = shv_law_advance(law, before, internal->opening, now);
    if (history.normal > before.normal || history.shear > before.shear) internal->peak = shv_law_peak(law, history);
    internal->history = history;
    internal->opening = now;
    point->peak = internal->peak;
    point->stored = point->weight * shv_springs_recoverable(law, shv_law_follow(law, history, &point->springs), now);
}

static bool has_moved(const ShvCohesive *cohesive, const ShvState *state, int32_t cluster)
{
    for (int32_t i = cohesive->cluster[cluster]; i < cohesive->cluster[cluster + 1]; i++) {
        const ShvCohesivePoint *point = &cohesive->points[i];
        const ShvVec3 displacement = shv_sub(shv_cohesive_opening(state, point->first, point->second), point->opening);
        if (displacement.x != 0.0 || displacement.y != 0.0 || displacement.z != 0.0) return true;
    }
    return false; /* the same time again */
}

static void pass_clusters(ShvCohesive *cohesive, const ShvState *state, bool end, bool begin)
{
    const int32_t clusters = cohesive->cluster_count, threads = cohesive->model->threads;
#pragma omp parallel for schedule(static) num_threads(threads) if (shv_cohesive_in_parallel(cohesive, clusters))
    for (int32_t c = 0; c < clusters; c++) {
        if (end && has_moved(cohesive, state, c)) end_step(cohesive, c);
        for (int32_t i = cohesive->cluster[c]; begin && i < cohesive->cluster[c + 1]; i++)
            begin_point(cohesive, &cohesive->points[i]);
    }
}

/* Lists are made anew when this share of their facets carries no more. */
static const double idle_share = 0.05;

/* In a step nodes may become faster by this factor before faces that were apart meet unseen; the next step finds them. */
static const double most_speeding = 4.0;

/* A facet that has failed, and whose faces will not meet in this step; `anew`: it has not been asked at this time before. */
static bool stays_apart(ShvCohesive *cohesive, const ShvState *state, int32_t k, bool anew)
{
    const ShvFacetRotation *rotation = &cohesive->rotations[k];
    double *apart = &cohesive->apart[rotation->index];
    if (!(*apart > 0.0) || rotation->carries || !(state->last_step > 0.0)) return false;
    const double way = state->last_step * shv_cohesive_spread_of_speeds(rotation, state);
    if (anew) *apart -= way;
    return *apart > most_speeding * way;
}

static void begin_facets(ShvCohesive *cohesive, const ShvState *state, bool anew)
{
    const int32_t count = cohesive->rotation_count, threads = cohesive->model->threads;
    int32_t separated = 0, idle = 0;
#pragma omp parallel for schedule(static) num_threads(threads) if (shv_cohesive_in_parallel(cohesive, count))          \
    reduction(+ : separated, idle)
    for (int32_t k = 0; k < count; k++) {
        ShvFacetRotation *rotation = &cohesive->rotations[k];
        if (cohesive->phase[rotation->index] == SHV_COHESIVE_SEPARATED) continue;
        rotation->known = !stays_apart(cohesive, state, k, anew);
        if (rotation->known) begin_facet(cohesive, state, k);
        separated += cohesive->phase[rotation->index] == SHV_COHESIVE_SEPARATED;
        idle += rotation->carries && cohesive->phase[rotation->index] != SHV_COHESIVE_CARRYING;
    }
    cohesive->pushed = false;
    if (separated > 0) shv_cohesive_drop_separated(cohesive);
    cohesive->pair_count -= 3 * separated;
    cohesive->idle = idle > idle_share * count;
}

/* What is called opened for good, so that faces are elastic when they close: a tenth of the final opening, or of the elastic
   displacement under the strength (shv_law_start). Below, bonds that only vibrate lose what their closing nodes bring. */
static const double opened_starts = 1e7;

static bool has_opened(const ShvCohesive *cohesive, int64_t point)
{
    return cohesive->internal[point].peak == 0.0 ||
           cohesive->internal[point].history.normal > opened_starts * cohesive->sides[point / 3].start;
}

/* What faces at a node have given beyond what they held is paid back first; of the rest they hold a share. */
static void hold(double *held, double *overdrawn, double taken, double returned)
{
    *held += shv_smaller(taken, 0.0);
    *overdrawn -= shv_smaller(*held, 0.0) + shv_larger(taken, 0.0);
    *held = shv_larger(*held, 0.0) - returned * shv_smaller(*overdrawn, 0.0);
    *overdrawn = shv_larger(*overdrawn, 0.0);
}

double shv_cohesive_releasable(const ShvCohesive *cohesive, const ShvState *state, const ShvFacetRotation *rotation,
                               int corner)
{
    const double held = cohesive->internal[3 * (int64_t)rotation->index + corner].held;
    return held > 0.0 ? shv_larger(held - cohesive->overdrawn[state->origin[rotation->first[corner]]], 0.0) : 0.0;
}

/* Closing faces of the step that was booked, if it was taken. */
static void end_pushes(ShvCohesive *cohesive, const ShvState *state)
{
    if (!cohesive->pushed || state->time == cohesive->booked_time) return;
    for (int32_t k = 0; k < cohesive->rotation_count; k++) {
        if (!shv_cohesive_is_pushed(cohesive, k)) continue;
        const int32_t index = cohesive->rotations[k].index;
        for (int i = 0; i < 3; i++) {
            const int64_t point = 3 * (int64_t)index + i;
            const double taken = cohesive->gaps[k].taken[i];
            if (taken == 0.0) continue;
            const double returned = has_opened(cohesive, point) ? cohesive->sides[index].returned : 0.0;
            hold(&cohesive->internal[point].held, &cohesive->overdrawn[state->origin[cohesive->rotations[k].first[i]]],
                 taken, returned);
        }
    }
}

void shv_cohesive_begin(ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake)
{
    const bool goes_on =
        state->time != cohesive->begun_time; /* else the observer has looked at this time, which changes nothing */
    cohesive->begun_time = state->time;
    end_pushes(cohesive, state);
    const bool anew = cohesive->unlisted || (goes_on && cohesive->idle) || cohesive->list_awake != awake;
    if (anew) {
        pass_clusters(cohesive, state, true, false);
        shv_cohesive_keep_pulls(cohesive);
        shv_cohesive_list(cohesive, state, awake);
    }
    begin_facets(cohesive, state, goes_on);
    pass_clusters(cohesive, state, !anew, true);
    cohesive->torn = false;
    cohesive->pull_kick = cohesive->pull_step = 0.0;
}

/* ---- book ---- */

/* Works in both halves of the step, J. */
typedef struct PointWork {
    double before, after;
} PointWork;

static PointWork book_point(const ShvCohesive *cohesive, const ShvState *state, double step, ShvCohesivePoint *point)
{
    const ShvVec3 before = shv_sub(point->opening, point->from);
    const ShvVec3 after = shv_scale(shv_cohesive_rate(cohesive, state, point), 0.5 * step);
    const PointWork work = {shv_dot(point->pull, before), shv_dot(point->pull, after)};
    point->reached =
        shv_cohesive_components(shv_add(point->opening, after), cohesive->rotations[point->rotation].normal);
    point->work = work.before + work.after;
    return work;
}

static bool acts(ShvVec3 force)
{
    return force.x != 0.0 || force.y != 0.0 || force.z != 0.0;
}

/* Of a force on the first node of a pair, on the second the opposite, J. */
static PointWork work_of(ShvVec3 force, ShvVec3 before, ShvVec3 after)
{
    return (PointWork){-shv_dot(force, before), -shv_dot(force, after)};
}

static void book_pushes(ShvCohesive *cohesive, const ShvState *state, double step, ShvLedger *ledger)
{
    PointWork closing = {0.0, 0.0}, sliding = {0.0, 0.0};
    for (int32_t k = 0; cohesive->pushed && k < cohesive->rotation_count; k++) {
        if (!shv_cohesive_is_pushed(cohesive, k)) continue;
        const ShvFacetRotation *rotation = &cohesive->rotations[k];
        ShvFacetGaps *gaps = &cohesive->gaps[k];
        for (int i = 0; i < 3; i++) {
            if (!acts(gaps->push[i]) && !acts(gaps->friction[i])) continue;
            const ShvVec3 velocity = shv_sub(shv_load3(state->velocity + 3 * (int64_t)rotation->second[i]),
                                             shv_load3(state->velocity + 3 * (int64_t)rotation->first[i]));
            const ShvVec3 after = shv_scale(shv_sub(velocity, shv_cross(rotation->rate, gaps->opening[i])), 0.5 * step);
            const PointWork push = work_of(gaps->push[i], gaps->before[i], after);
            const PointWork friction = work_of(gaps->friction[i], gaps->before[i], after);
            gaps->taken[i] = -(push.before + push.after);
            closing = (PointWork){closing.before + push.before, closing.after + push.after};
            sliding = (PointWork){sliding.before + friction.before, sliding.after + friction.after};
        }
    }
    cohesive->booked_time = state->time;
    shv_ledger_book(ledger, SHV_WORK_CLOSURE, closing.before, closing.after);
    shv_ledger_book(ledger, SHV_WORK_CRACK_FRICTION, sliding.before, sliding.after);
}

/* Sums over blocks of points, then over the blocks: the same for any number of threads. */
enum { BOOK_BLOCK = 1024, MOST_BOOK_BLOCKS = 256 };

void shv_cohesive_book(ShvCohesive *cohesive, const ShvState *state, double step, ShvLedger *ledger)
{
    PointWork sums[MOST_BOOK_BLOCKS] = {0}, sum = {0};
    const int32_t count = cohesive->point_count, rotations = cohesive->rotation_count,
                  threads = cohesive->model->threads;
    const int32_t least = count / MOST_BOOK_BLOCKS + 1, size = least > BOOK_BLOCK ? least : BOOK_BLOCK;
#pragma omp parallel for schedule(static) num_threads(threads) if (shv_cohesive_in_parallel(cohesive, rotations))
    for (int32_t k = 0; k < rotations; k++)
        if (cohesive->rotations[k].carries || shv_cohesive_is_pushed(cohesive, k))
            cohesive->rotations[k].rate = shv_facet_rotation_rate(&cohesive->rotations[k], state);
#pragma omp parallel for schedule(static) num_threads(threads) if (shv_cohesive_in_parallel(cohesive, count))
    for (int32_t b = 0; b < (count + size - 1) / size; b++)
        for (int32_t i = b * size; i < count && i < (b + 1) * size; i++) {
            const PointWork own = book_point(cohesive, state, step, &cohesive->points[i]);
            sums[b].before += own.before;
            sums[b].after += own.after;
        }
    for (int32_t b = 0; b < MOST_BOOK_BLOCKS; b++) {
        sum.before += sums[b].before;
        sum.after += sums[b].after;
    }
    shv_ledger_book(ledger, SHV_WORK_COHESIVE, -sum.before, -sum.after);
    book_pushes(cohesive, state, step, ledger);
}

/* ---- resolution ---- */

static double time_to(double final_opening, double largest, double rate)
{
    return rate > 0.0 && largest < final_opening ? 0.1 * (final_opening - largest) / rate : (double)INFINITY;
}

double shv_cohesive_resolution_step(const ShvCohesive *cohesive, const ShvState *state)
{
    double least = (double)INFINITY;
    for (int32_t i = 0; i < cohesive->point_count; i++) {
        const ShvCohesivePoint *point = &cohesive->points[i];
        const ShvLaw *law = &cohesive->law[point->point / 3];
        const ShvHistory history = cohesive->internal[point->point].history;
        const ShvVec3 rate = shv_sub(shv_load3(state->velocity + 3 * (int64_t)point->second),
                                     shv_load3(state->velocity + 3 * (int64_t)point->first));
        const ShvVec3 normal = cohesive->rotations[point->rotation].normal;
        const double opening = shv_dot(rate, normal), slipping = shv_norm(shv_madd(rate, -opening, normal));
        const double slipped = law->kind == SHV_PPR ? history.shear : cohesive->internal[point->point].opening.shear;
        least = shv_smaller(least, time_to(law->final_opening[SHV_NORMAL], history.normal, opening));
        least = shv_smaller(least, time_to(law->final_opening[SHV_SHEAR], slipped, slipping));
    }
    return least;
}
