#include <math.h>

#include "cohesive/cohesive.h"
#include "cohesive/frame.h"
#include "cohesive/turn.h"

/* Below this many facets, starting threads costs more than they save. */
enum { FEWEST_PARALLEL_FACETS = 256 };
/* Sweeps over a cluster end when no point's force changes by more than this share of its peak, or after so many; what is
   then left is made up for by `limit_given` and `wear`. */
enum { MOST_SWEEPS = 32, MOST_ROUNDS = 8 };
static const double settled_share = 5e-3;
/* A point is looked at again when its neighbours' news may change its force by more than this share of its peak. */
static const double news_share = 1e-3;

static bool in_parallel(const ShvCohesive *cohesive, int32_t facets)
{
    return cohesive->model->threads > 1 && facets >= FEWEST_PARALLEL_FACETS;
}

/* Seen by one who turns with the facet. */
static ShvVec3 opening_rate(const ShvState *state, const ShvCohesivePoint *point)
{
    const ShvVec3 rate = shv_sub(shv_load3(state->velocity + 3 * (int64_t)point->second),
                                 shv_load3(state->velocity + 3 * (int64_t)point->first));
    return shv_sub(rate, point->carried);
}

/* ---- wear ---- */

/* What a cluster's points may keep, and where the last step led them. */
static double worn_recoverable(const ShvCohesive *cohesive, int32_t cluster, double share, bool keep)
{
    double sum = 0.0;
    for (int32_t i = cohesive->cluster[cluster]; i < cohesive->cluster[cluster + 1]; i++) {
        const ShvCohesivePoint *point = &cohesive->points[cohesive->active[i]];
        const ShvLaw *law = &cohesive->law[point->point / 3];
        const ShvHistory history = cohesive->history[point->point];
        const double *end = law->final_opening;
        const double normal = history.normal + share * shv_larger(end[SHV_NORMAL] - history.normal, 0.0);
        const double shear = history.shear + share * shv_larger(end[SHV_SHEAR] - history.shear, 0.0);
        const ShvHistory worn = shv_law_grow(law, history, normal, law->kind == SHV_PPR ? shear : 0.0);
        const ShvOpening at = cohesive->opening[point->point];
        sum += point->weight * shv_law_recoverable(law, worn, at.normal, at.shear);
        if (!keep) continue;
        cohesive->history[point->point] = worn;
        cohesive->peak[point->point] = shv_law_peak(law, worn);
    }
    return sum;
}

/* The share of what is left by which every largest opening grows at least `ratio` times itself. */
static double growing_share(const ShvCohesive *cohesive, int32_t cluster, double ratio)
{
    double share = 0.0;
    for (int32_t i = cohesive->cluster[cluster]; i < cohesive->cluster[cluster + 1]; i++) {
        const int32_t point = cohesive->points[cohesive->active[i]].point;
        const double largest[2] = {cohesive->history[point].normal, cohesive->history[point].shear};
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
static void wear(const ShvCohesive *cohesive, int32_t cluster, double allowed, double kept)
{
    const double spare = 1e-3 * shv_smaller(kept - allowed, allowed) + 1e-12 * allowed;
    const double aim = 1.0 / (allowed - 0.5 * spare);
    double low = 0.0, high = 1.0, at_low = 1.0 / kept - aim, at_high = (double)INFINITY, least = 0.0;
    double share = growing_share(cohesive, cluster, kept / allowed - 1.0);
    int side = 0; /* end that moved last */
    for (int i = 0; i < 100 && allowed - least > spare && high - low > 1e-15 * high; i++) {
        if (!(share > low && share < high) || i % 4 == 3) share = low > 0.0 ? sqrt(low * high) : 1e-3 * high;
        const double stored = worn_recoverable(cohesive, cluster, share, false);
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
    worn_recoverable(cohesive, cluster, high, true);
}

/* A cluster that was limited (limit_given) has given all it stored, but for round-off: to keep nothing it would have to let go
   for good, and lose its work of separation. It may keep this share of what it exchanged. */
static const double spared_share = 1e-9;
/* A point that has hardly opened exchanges round-off: it may keep this share of strength × opening of its start (shv_law_start),
   1e-11 of its work of separation at most. Without that a corner held shut by its neighbours is worn to nothing by the signs of
   numbers of 1e-40 J. */
static const double start_share = 1e-3;

static double start_energy(const ShvCohesive *cohesive, const ShvCohesivePoint *point)
{
    const int32_t index = point->point / 3;
    return point->weight * cohesive->law[index].strength[SHV_NORMAL] * cohesive->sides[index].start;
}

/* Moves the histories of a cluster along the last step, in the frame its tractions had. Sweeps that have not settled leave
   a difference between the work of the tractions and the law; a cluster never keeps more than it had and was given. */
static void end_step(ShvCohesive *cohesive, const ShvState *state, int32_t cluster)
{
    double allowed = 0.0, kept = 0.0, exchanged = 0.0, started = 0.0;
    bool moved = false;
    for (int32_t i = cohesive->cluster[cluster]; i < cohesive->cluster[cluster + 1] && !moved; i++) {
        const ShvCohesivePoint *point = &cohesive->points[cohesive->active[i]];
        const ShvVec3 way = shv_sub(shv_cohesive_opening(state, point->first, point->second), point->opening);
        moved = way.x != 0.0 || way.y != 0.0 || way.z != 0.0;
    }
    if (!moved) return; /* the same moment again */
    for (int32_t i = cohesive->cluster[cluster]; i < cohesive->cluster[cluster + 1]; i++) {
        const ShvCohesivePoint *point = &cohesive->points[cohesive->active[i]];
        const ShvLaw *law = &cohesive->law[point->point / 3];
        ShvHistory *history = &cohesive->history[point->point];
        const ShvVec3 now = shv_cohesive_opening(state, point->first, point->second);
        const ShvVec3 back = shv_madd(opening_rate(state, point), 2.0, point->carried); /* which goes the other way */
        const ShvVec3 to = shv_madd(now, -0.5 * state->last_step, back);
        const ShvOpening at = shv_cohesive_components(to, point->normal);
        const ShvHistory next = shv_law_advance(law, *history, cohesive->opening[point->point], at);
        const bool grown = next.normal > history->normal || next.shear > history->shear;
        *history = next;
        cohesive->opening[point->point] = at;
        if (grown) cohesive->peak[point->point] = shv_law_peak(law, next);
        const double work = shv_dot(point->pull, shv_sub(to, point->from));
        allowed += point->stored + work;
        exchanged += point->stored + fabs(work);
        kept += point->weight * shv_law_recoverable(law, next, at.normal, at.shear);
        started += start_energy(cohesive, point);
    }
    allowed = shv_larger(allowed, shv_larger(spared_share * exchanged, start_share * started));
    if (kept > allowed) wear(cohesive, cluster, allowed, kept);
}

/* ---- begin ---- */

static void begin_pair(const ShvState *state, const ShvCohesiveFrame *frame, int corner, ShvCohesivePoint *point)
{
    point->first = frame->first[corner];
    point->second = frame->second[corner];
    point->peak = 0.0;
    point->opening = shv_cohesive_opening(state, point->first, point->second);
}

static void begin_point(ShvCohesive *cohesive, const ShvState *state, const ShvCohesiveFrame *frame, int32_t index,
                        int corner, ShvCohesivePoint *point)
{
    const int32_t k = 3 * index + corner;
    if (point->first == point->second) return;
    point->from = shv_madd(point->opening, -0.5 * state->last_step, opening_rate(state, point));
    point->settled = shv_vec3((double)NAN, 0.0, 0.0);
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
    point->stored = point->weight * shv_law_recoverable(law, history, now.normal, now.shear);
}

/* Failed when no point can carry any more; separated when, besides, a pair is farther apart than half the edge of an
   equilateral triangle of the facet's area: the pairs no longer say where the faces meet. */
static ShvCohesivePhase next_phase(const ShvCohesive *cohesive, int32_t index, const ShvCohesivePoint *points)
{
    double farthest = 0.0;
    for (int i = 0; i < 3; i++) {
        if (points[i].first == points[i].second) return SHV_COHESIVE_CARRYING;
        if (points[i].peak > 0.0) return SHV_COHESIVE_CARRYING;
        farthest = shv_larger(farthest, shv_dot(points[i].opening, points[i].opening));
    }
    const double edge_squared = cohesive->area[index] * (4.0 / sqrt(3.0));
    return farthest > 0.25 * edge_squared ? SHV_COHESIVE_SEPARATED : SHV_COHESIVE_FAILED;
}

static void begin_facet(ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake, int32_t place)
{
    const int32_t index = cohesive->live[place];
    ShvCohesivePoint *points = cohesive->points + 3 * (int64_t)place;
    if (!cohesive->sides[index].split || shv_cohesive_rests(cohesive, state, index, awake)) {
        for (int i = 0; i < 3; i++) points[i].first = points[i].second = 0;
        cohesive->turns[place].turns = false;
        return;
    }
    const ShvCohesiveFrame frame = shv_cohesive_frame(cohesive, state, index);
    for (int i = 0; i < 3; i++) {
        points[i].point = 3 * index + i;
        points[i].carrying = cohesive->phase[index] == SHV_COHESIVE_CARRYING;
        points[i].weight = cohesive->area[index] / 3.0;
        points[i].normal = frame.normal;
        begin_pair(state, &frame, i, &points[i]);
    }
    shv_turn_begin(&cohesive->turns[place], points, state);
    shv_turn_follow(&cohesive->turns[place], points, state);
    for (int i = 0; i < 3; i++) begin_point(cohesive, state, &frame, index, i, &points[i]);
    cohesive->phase[index] = (uint8_t)next_phase(cohesive, index, points);
}

static bool same_pair(const ShvCohesivePoint *a, const ShvCohesivePoint *b)
{
    return (a->first == b->first && a->second == b->second) || (a->first == b->second && a->second == b->first);
}

static int64_t pair_key(const ShvCohesivePoint *point)
{
    const int32_t low = point->first < point->second ? point->first : point->second;
    const int32_t high = point->first < point->second ? point->second : point->first;
    return ((int64_t)low << 32) + high;
}

/* Points of one pair side by side, in order of facets; clusters are small. */
static void sort_pairs(const ShvCohesive *cohesive, int32_t *points, int32_t count)
{
    for (int32_t i = 1; i < count; i++) {
        const int32_t p = points[i];
        const int64_t key = pair_key(&cohesive->points[p]);
        int32_t k = i;
        for (; k > 0 && pair_key(&cohesive->points[points[k - 1]]) > key; k--) points[k] = points[k - 1];
        points[k] = p;
    }
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
    for (int32_t c = 0; c < cohesive->cluster_count; c++)
        sort_pairs(cohesive, cohesive->active + cohesive->cluster[c], cohesive->cluster[c + 1] - cohesive->cluster[c]);
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
    cohesive->pull_kick = cohesive->pull_step = 0.0;
    sort_clusters(cohesive, state);
}

void shv_cohesive_begin(ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake)
{
    const int32_t live = cohesive->live_count, threads = cohesive->model->threads;
    const int32_t clusters = cohesive->cluster_count;
#pragma omp parallel for schedule(static) num_threads(threads) if (in_parallel(cohesive, clusters))
    for (int32_t c = 0; c < clusters; c++) end_step(cohesive, state, c);
#pragma omp parallel for schedule(static) num_threads(threads) if (in_parallel(cohesive, live))
    for (int32_t k = 0; k < live; k++) begin_facet(cohesive, state, awake, k);
    cohesive->looked_count = live;
    collect(cohesive, state);
}

/* ---- pull ---- */

static int32_t block_end(const ShvCohesive *cohesive, int32_t start, int32_t end)
{
    const ShvCohesivePoint *first = &cohesive->points[cohesive->active[start]];
    int32_t stop = start + 1;
    while (stop < end && same_pair(first, &cohesive->points[cohesive->active[stop]])) stop++;
    return stop;
}

/* Points of one pair of nodes, as in a plane crack, move together: each with its share of the nodes' masses in proportion
   to what it may pull. As the shares sum to the masses, that takes no less energy than each would by itself, and where the
   points are alike it is exact at once. */
static void share_masses(ShvCohesive *cohesive, const ShvState *state, int32_t start, int32_t end)
{
    double sum = 0.0;
    for (int32_t i = start; i < end; i++) {
        const ShvCohesivePoint *point = &cohesive->points[cohesive->active[i]];
        sum += point->weight * point->peak;
    }
    const ShvCohesivePoint *pair = &cohesive->points[cohesive->active[start]];
    const double whole = 1.0 / state->mass[pair->first] + 1.0 / state->mass[pair->second];
    for (int32_t i = start; i < end; i++) {
        ShvCohesivePoint *point = &cohesive->points[cohesive->active[i]];
        point->response = whole * (sum / (point->weight * point->peak));
    }
}

static void prepare_cluster(ShvCohesive *cohesive, const ShvState *state, int32_t start, int32_t end, double kick,
                            double step)
{
    for (int32_t block = start, stop; block < end; block = stop) {
        stop = block_end(cohesive, block, end);
        share_masses(cohesive, state, block, stop);
    }
    for (int32_t i = start; i < end; i++) {
        const ShvCohesivePoint *point = &cohesive->points[cohesive->active[i]];
        cohesive->laws[i] =
            shv_pair_make(&cohesive->law[point->point / 3], cohesive->history[point->point], point->normal, point->from,
                          point->opening, 0.5 * step * kick * point->response * point->weight);
    }
}

/* The force that the point would want, the others held; returns its change in units of the point's peak. As traction never
   rises faster than free opening/compliance, neighbours that have hardly moved since the point was last looked at need no
   new look. */
static double want(const ShvState *state, const ShvPair *law, ShvCohesivePoint *point, double kick, double step)
{
    const ShvVec3 rate = opening_rate(state, point), news = shv_sub(rate, point->settled);
    const double peak = point->weight * point->peak, slight = news_share * peak * kick * point->response;
    point->change = shv_vec3(0.0, 0.0, 0.0);
    if (shv_dot(news, news) <= slight * slight) return 0.0;
    const ShvVec3 without = shv_madd(rate, kick * point->response, point->pull);
    const ShvVec3 traction = shv_pair_traction(law, shv_madd(point->opening, 0.5 * step, without));
    point->change = shv_sub(shv_scale(traction, point->weight), point->pull);
    return shv_norm(point->change) / peak;
}

static void move(ShvState *state, ShvCohesivePoint *point, double kick, ShvVec3 change)
{
    point->pull = shv_add(point->pull, change);
    shv_add_to3(state->velocity + 3 * (int64_t)point->first, shv_scale(change, kick / state->mass[point->first]));
    shv_add_to3(state->velocity + 3 * (int64_t)point->second, shv_scale(change, -kick / state->mass[point->second]));
    shv_add_to3(state->force + 3 * (int64_t)point->first, change);
    shv_add_to3(state->force + 3 * (int64_t)point->second, shv_scale(change, -1.0));
}

/* The rate that the pulls of one pair's points answer. */
static void settle_block(ShvCohesive *cohesive, const ShvState *state, int32_t start, int32_t end)
{
    const ShvCohesivePoint *pair = &cohesive->points[cohesive->active[start]];
    const ShvVec3 whole = shv_add(opening_rate(state, pair), pair->carried);
    for (int32_t i = start; i < end; i++) {
        ShvCohesivePoint *point = &cohesive->points[cohesive->active[i]];
        point->settled = shv_sub(point->first == pair->first ? whole : shv_scale(whole, -1.0), point->carried);
    }
}

/* Blocks one after another, each with the others' forces as they are. */
static double sweep(ShvCohesive *cohesive, ShvState *state, int32_t start, int32_t end, double kick, double step)
{
    double largest = 0.0;
    for (int32_t block = start, stop; block < end; block = stop) {
        stop = block_end(cohesive, block, end);
        double change = 0.0;
        for (int32_t i = block; i < stop; i++)
            change =
                shv_larger(change, want(state, &cohesive->laws[i], &cohesive->points[cohesive->active[i]], kick, step));
        if (!(change > 0.0)) continue;
        for (int32_t i = block; i < stop; i++) {
            ShvCohesivePoint *point = &cohesive->points[cohesive->active[i]];
            move(state, point, kick, point->change);
        }
        settle_block(cohesive, state, block, stop);
        largest = shv_larger(largest, stop - block == end - start && stop - block == 1 ? 0.0 : change);
    }
    return largest;
}

/* Of a sum of works, as a share of their magnitudes. */
static const double rounding = 1e-13;

/* Forces that have not settled could give more than the cluster stores. All are then scaled by λ, the largest for which
   stored + Σ λ pull·(to(λ) − from) = stored + λ a − λ² b ≥ 0, a = Σ pull·(free − from), b = Σ pull·(free − to) > 0.
   Returns whether they were. */
static bool limit_given(ShvCohesive *cohesive, ShvState *state, int32_t cluster, double kick, double step)
{
    const int32_t start = cohesive->cluster[cluster], end = cohesive->cluster[cluster + 1];
    double stored = 0.0, work = 0.0, size = 0.0, a = 0.0;
    for (int32_t i = start; i < end; i++) {
        const ShvCohesivePoint *point = &cohesive->points[cohesive->active[i]];
        const ShvVec3 to = shv_madd(point->opening, 0.5 * step, opening_rate(state, point));
        const double own = shv_dot(point->pull, shv_sub(to, point->from));
        stored += point->stored;
        work += own;
        size += point->stored + fabs(own);
    }
    if (stored + work >= -rounding * size) return false;
    for (int32_t i = start; i < end; i++) {
        ShvCohesivePoint *point = &cohesive->points[cohesive->active[i]];
        point->change = point->pull;
        move(state, point, kick, shv_scale(point->pull, -1.0));
    }
    for (int32_t i = start; i < end; i++) {
        const ShvCohesivePoint *point = &cohesive->points[cohesive->active[i]];
        const ShvVec3 free = shv_madd(point->opening, 0.5 * step, opening_rate(state, point));
        a += shv_dot(point->change, shv_sub(free, point->from));
    }
    const double b = a - work, root = sqrt(a * a + 4.0 * b * stored);
    const double scale = shv_smaller(a > 0.0 ? 0.5 * (a + root) / b : 2.0 * stored / (root - a), 1.0);
    for (int32_t i = start; i < end; i++) {
        ShvCohesivePoint *point = &cohesive->points[cohesive->active[i]];
        point->pull = shv_vec3(0.0, 0.0, 0.0);
        move(state, point, kick, shv_scale(point->change, scale));
    }
    return true;
}

static int32_t pull_cluster(ShvCohesive *cohesive, ShvState *state, int32_t cluster, double kick, double step,
                            bool again)
{
    const int32_t start = cohesive->cluster[cluster], end = cohesive->cluster[cluster + 1];
    if (!again) prepare_cluster(cohesive, state, start, end, kick, step);
    int32_t sweeps = 1;
    while (sweep(cohesive, state, start, end, kick, step) > settled_share && sweeps < MOST_SWEEPS) sweeps++;
    limit_given(cohesive, state, cluster, kick, step);
    return sweeps;
}

/* `first`: of the facet's points in `unsorted`. */
static int32_t facet_end(const ShvCohesive *cohesive, int32_t first)
{
    int32_t end = first + 1;
    while (end < cohesive->active_count && cohesive->unsorted[end] / 3 == cohesive->unsorted[first] / 3) end++;
    return end;
}

/* What the pulls' couples have become since they were last answered. Facets share nodes: one after another. */
static void answer_couples(ShvCohesive *cohesive, ShvState *state, double kick)
{
    for (int32_t start = 0, end; start < cohesive->active_count; start = end) {
        end = facet_end(cohesive, start);
        const int32_t facet = cohesive->unsorted[start] / 3;
        ShvFacetTurn *turn = &cohesive->turns[facet];
        ShvVec3 couple = {0.0, 0.0, 0.0};
        for (int32_t i = start; i < end; i++) {
            const ShvCohesivePoint *point = &cohesive->points[cohesive->unsorted[i]];
            couple = shv_add(couple, shv_cross(point->opening, point->pull));
        }
        const ShvVec3 change = shv_sub(couple, turn->couple);
        if (change.x == 0.0 && change.y == 0.0 && change.z == 0.0) continue;
        shv_turn_strike(turn, cohesive->points + 3 * (int64_t)facet, state, change, kick);
        turn->couple = couple;
    }
}

/* All facets, or those that carry. */
static void follow_turns(ShvCohesive *cohesive, const ShvState *state, bool all)
{
    const int32_t count = cohesive->looked_count, threads = cohesive->model->threads;
#pragma omp parallel for schedule(static) num_threads(threads) if (in_parallel(cohesive, count))
    for (int32_t k = 0; k < count; k++) {
        ShvCohesivePoint *points = cohesive->points + 3 * (int64_t)k;
        if (all || points->carrying) shv_turn_follow(&cohesive->turns[k], points, state);
    }
}

/* Answers move the openings of other facets, a little, and clusters that give all they store would give more than that. */
static void answer_within_limits(ShvCohesive *cohesive, ShvState *state, double kick, double step)
{
    const int32_t count = cohesive->cluster_count, threads = cohesive->model->threads;
    bool limited = true;
    answer_couples(cohesive, state, kick);
    for (int round = 0; limited && round < MOST_ROUNDS; round++) {
        follow_turns(cohesive, state, false);
        limited = false;
#pragma omp parallel for schedule(static) num_threads(threads) if (in_parallel(cohesive, count)) reduction(|| : limited)
        for (int32_t c = 0; c < count; c++) limited = limit_given(cohesive, state, c, kick, step) || limited;
        if (limited) answer_couples(cohesive, state, kick);
    }
}

void shv_cohesive_pull(ShvCohesive *cohesive, ShvState *state, double kick, double step)
{
    cohesive->sweeps = 0;
    if (!(step > 0.0 && kick > 0.0)) return;
    const int32_t count = cohesive->cluster_count, threads = cohesive->model->threads;
    const bool again = cohesive->pull_kick == kick && cohesive->pull_step == step;
    int64_t sweeps = 0;
    follow_turns(cohesive, state, false);
#pragma omp parallel for schedule(static) num_threads(threads) if (in_parallel(cohesive, count)) reduction(+ : sweeps)
    for (int32_t c = 0; c < count; c++) sweeps += pull_cluster(cohesive, state, c, kick, step, again);
    answer_within_limits(cohesive, state, kick, step);
    cohesive->pull_kick = kick;
    cohesive->pull_step = step;
    cohesive->sweeps = sweeps;
}

/* ---- book ---- */

void shv_cohesive_book(ShvCohesive *cohesive, const ShvState *state, double step, ShvLedger *ledger)
{
    double pulled[2] = {0.0, 0.0}, pushed[2] = {0.0, 0.0};
    follow_turns(cohesive, state, true);
    for (int32_t i = 0; i < cohesive->pair_count; i++) {
        const ShvCohesivePoint *point = &cohesive->points[cohesive->pairs[i]];
        const ShvVec3 before = shv_sub(point->opening, point->from);
        const ShvVec3 after = shv_scale(opening_rate(state, point), 0.5 * step);
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
        least = shv_smaller(least, time_to(law->final_opening[SHV_NORMAL], history.normal, opening));
        least = shv_smaller(least, time_to(law->final_opening[SHV_SHEAR], slipped, slipping));
    }
    return least;
}
