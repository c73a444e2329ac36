#include <math.h>
#include <omp.h>

#include "cohesive/facet_rotation.h"
#include "cohesive/solve.h"
#include "cohesive/spring.h"

/* Sweeps over a cluster end when no point's force changes by more than this share of its peak, or after so many; what is
   then left is made up for by `limit_given` and `soften`. */
enum { MOST_SWEEPS = 32, MOST_ROUNDS = 8 };
static const double settled_share = 5e-3;
/* A point is looked at again when its neighbours' news may change its force by more than this share of its peak. */
static const double news_share = 1e-3;
/* Changes of two sweeps lead on (extrapolation_factor) where their cosine and their ratio are larger than these; the ratio counts as no larger
   than the last. */
static const double least_cosine = 0.6, least_ratio = 0.2, largest_ratio = 0.9;

/* One pull of a step. */
typedef struct Pull {
    ShvCohesive *cohesive;
    ShvState *state;
    double kick, step;
} Pull;

/* ---- a cluster ---- */

/* Points between the copies of one node of the mesh, and what their pull needs besides, in the room of a thread. */
typedef struct Cluster {
    const Pull *pull;
    ShvCohesivePoint *points;
    ShvPointSolve *solves; /* as `points` */
    int32_t count;
} Cluster;

/* Turns of facets stand still while clusters settle. `thread`: of the loop that asks, 0 outside one: a program may call from a thread of
   its own loops. */
static Cluster begin_cluster(const Pull *pull, int32_t cluster, int thread)
{
    const ShvCohesive *cohesive = pull->cohesive;
    const int32_t start = cohesive->cluster[cluster];
    const Cluster made = {pull, cohesive->points + start, cohesive->solves + (int64_t)thread * cohesive->most_facets,
                          cohesive->cluster[cluster + 1] - start};
    for (int32_t i = 0; i < made.count; i++) {
        const ShvCohesivePoint *point = &made.points[i];
        ShvPointSolve *solve = &made.solves[i];
        solve->yield[0] = pull->kick / pull->state->mass[point->first];
        solve->yield[1] = pull->kick / pull->state->mass[point->second];
        solve->rotation_rate = shv_cross(cohesive->rotations[point->rotation].rate, point->opening);
    }
    return made;
}

/* Points of one pair of nodes, as in a plane crack, move together: each with its share of the nodes' masses in proportion
   to what it may pull. As the shares sum to the masses, that takes no less energy than each would by itself, and where the
   points are alike it is exact at once. */
static void share_masses(const ShvState *state, const ShvCohesivePoint *points, ShvPointSolve *solves)
{
    double sum = 0.0;
    for (int32_t i = 0; i < points->block; i++) sum += points[i].weight * points[i].peak;
    const double whole = 1.0 / state->mass[points->first] + 1.0 / state->mass[points->second];
    for (int32_t i = 0; i < points->block; i++)
        if (points[i].peak > 0.0) solves[i].response = whole * (sum / (points[i].weight * points[i].peak));
}

static void make_pairs(const Cluster *cluster)
{
    const Pull *pull = cluster->pull;
    const ShvCohesive *cohesive = pull->cohesive;
    for (int32_t i = 0; i < cluster->count; i += cluster->points[i].block)
        share_masses(pull->state, cluster->points + i, cluster->solves + i);
    for (int32_t i = 0; i < cluster->count; i++) {
        ShvCohesivePoint *point = &cluster->points[i];
        ShvPointSolve *solve = &cluster->solves[i];
        if (!(point->peak > 0.0)) continue;
        const ShvLaw *law = &cohesive->law[point->point / 3];
        const ShvLawSprings *springs = &point->springs;
        if (cohesive->torn) springs = shv_law_follow(law, cohesive->internal[point->point].history, &point->springs);
        solve->pair = shv_pair_make(law, springs, cohesive->rotations[point->rotation].normal, point->from,
                                    point->opening, 0.5 * pull->step * pull->kick * solve->response * point->weight);
    }
}

static void apply_force(const Cluster *cluster, int32_t i, ShvVec3 change)
{
    ShvState *state = cluster->pull->state;
    const ShvPointSolve *solve = &cluster->solves[i];
    const int64_t first = cluster->points[i].first, second = cluster->points[i].second;
    shv_add_to3(state->velocity + 3 * first, shv_scale(change, solve->yield[0]));
    shv_add_to3(state->velocity + 3 * second, shv_scale(change, -solve->yield[1]));
    shv_add_to3(state->force + 3 * first, change);
    shv_add_to3(state->force + 3 * second, shv_scale(change, -1.0));
}

/* The forces of the last step are where the sweeps begin. */
static void repeat_last(const Cluster *cluster)
{
    for (int32_t i = 0; i < cluster->count; i++) {
        ShvCohesivePoint *point = &cluster->points[i];
        if (!(point->peak > 0.0)) continue;
        point->pull = point->last;
        apply_force(cluster, i, point->last);
    }
}

/* Of opening, seen by one who turns with the facet. */
static ShvVec3 opening_rate(const Cluster *cluster, int32_t i)
{
    const double *velocity = cluster->pull->state->velocity;
    const ShvCohesivePoint *point = &cluster->points[i];
    const ShvVec3 rate =
        shv_sub(shv_load3(velocity + 3 * (int64_t)point->second), shv_load3(velocity + 3 * (int64_t)point->first));
    return shv_sub(rate, cluster->solves[i].rotation_rate);
}

/* What a sweep did, and how its changes of forces lie to those of the sweep before. */
typedef struct Sweep {
    double largest;        /* change, in units of the point's peak */
    double square, before; /* of the changes of all points: now, and in the sweep before */
    double product;        /* of the ones with the others */
} Sweep;

/* The force that the point would want, the others held; returns its change in units of the point's peak. As traction never
   rises faster than free opening/compliance, a point whose rate is what its own change was to lead to, but for
   neighbours that have hardly moved, needs no new evaluation. */
static double solve_point(const Cluster *cluster, int32_t i)
{
    const Pull *pull = cluster->pull;
    ShvCohesivePoint *point = &cluster->points[i];
    ShvPointSolve *solve = &cluster->solves[i];
    const ShvVec3 rate = opening_rate(cluster, i), news = shv_sub(rate, point->settled);
    const double peak = point->weight * point->peak, response = pull->kick * solve->response;
    const double slight = news_share * peak * response;
    solve->change = shv_vec3(0.0, 0.0, 0.0);
    if (!(peak > 0.0) || shv_dot(news, news) <= slight * slight) return 0.0;
    const ShvVec3 without = shv_madd(rate, response, point->pull);
    const ShvVec3 free = shv_madd(point->opening, 0.5 * pull->step, without);
    ShvVec3 traction;
    if (!shv_pair_stays(&solve->pair, free, &traction)) traction = shv_pair_traction(&solve->pair, free);
    const ShvVec3 force = shv_scale(traction, point->weight);
    solve->change = shv_sub(force, point->pull);
    point->settled = shv_madd(without, -response, force);
    return shv_norm(solve->change) / peak;
}

/* The same, where the changes of the sweep before still stand. */
static double solve_point_again(const Cluster *cluster, int32_t i, Sweep *sums)
{
    const ShvPointSolve *solve = &cluster->solves[i];
    const ShvVec3 before = solve->change;
    const double change = solve_point(cluster, i);
    sums->before += shv_dot(before, before);
    sums->product += shv_dot(solve->change, before);
    sums->square += shv_dot(solve->change, solve->change);
    return change;
}

static void change_pull(const Cluster *cluster, int32_t i, ShvVec3 change)
{
    cluster->points[i].pull = shv_add(cluster->points[i].pull, change);
    apply_force(cluster, i, change);
}

/* Pairs one after another, each with the others' forces as they are. */
static Sweep sweep(const Cluster *cluster, bool again)
{
    Sweep sums = {0.0, 0.0, 0.0, 0.0};
    for (int32_t block = 0, stop; block < cluster->count; block = stop) {
        stop = block + cluster->points[block].block;
        double change = 0.0;
        for (int32_t i = block; i < stop; i++)
            change = shv_larger(change, again ? solve_point_again(cluster, i, &sums) : solve_point(cluster, i));
        if (!(change > 0.0)) continue;
        for (int32_t i = block; i < stop; i++) change_pull(cluster, i, cluster->solves[i].change);
        sums.largest = shv_larger(sums.largest, change);
    }
    return sums;
}

/* Changes of two sweeps that point the same way fall by a ratio, and by it in the sweeps to come: how much of the last change is
   still to come; 0 where they do not fall like that. */
static double extrapolation_factor(const Sweep *sums)
{
    const double product = sums->product, least = least_cosine * least_cosine * sums->square * sums->before;
    if (!(product > least_ratio * sums->before && product * product > least)) return 0.0;
    const double ratio = shv_smaller(product / sums->before, largest_ratio);
    return ratio / (1.0 - ratio);
}

/* Goes on by a multiple of the last change. */
static void extrapolate(const Cluster *cluster, double more)
{
    for (int32_t i = 0; i < cluster->count; i++)
        if (cluster->points[i].peak > 0.0) change_pull(cluster, i, shv_scale(cluster->solves[i].change, more));
}

/* Sweeps that find less and less to do in one direction are spared by going all that way at once; two plain sweeps lie between.
   Returns the sweeps that found something to do. */
static int32_t settle(const Cluster *cluster)
{
    int32_t sweeps = 0, plain = 0;
    for (;;) {
        const Sweep sums = sweep(cluster, plain > 0);
        sweeps += sums.largest > 0.0;
        if (cluster->count == 1 || !(sums.largest > settled_share) || sweeps >= MOST_SWEEPS) return sweeps;
        const double more = plain > 0 ? extrapolation_factor(&sums) : 0.0;
        if (more > 0.0) extrapolate(cluster, more);
        plain = more > 0.0 ? 0 : plain + 1;
    }
}

/* ---- limits ---- */

/* Of a sum of works, as a share of their magnitudes. */
static const double rounding = 1e-13;
/* Besides, of the energy of the rigid start, 1e-14 of the work of separation: what noise of velocities does that others have brought
   to rest, with the sign of which a cluster would begin anew or not. */
static const double noise_share = 1e-6;
/* By this share pulls that are limited stay below what may be given: a and b (limit_given) may be 1e8 times their difference. */
static const double limit_margin = 1e-14;

/* What pulls do on the way they lead, J. */
static double find_budget(const Cluster *cluster, ShvClusterBudget *budget, double *stored)
{
    double work = 0.0, granted = 0.0;
    *budget = (ShvClusterBudget){0};
    *stored = 0.0;
    for (int32_t i = 0; i < cluster->count; i++) {
        const ShvCohesivePoint *point = &cluster->points[i];
        const ShvVec3 rate = opening_rate(cluster, i);
        const ShvVec3 displacement = shv_sub(shv_madd(point->opening, 0.5 * cluster->pull->step, rate), point->from);
        const double own = shv_dot(point->pull, displacement), force = shv_norm(point->pull);
        *stored += point->stored;
        work += own;
        granted += rounding * (point->stored + fabs(own)) + noise_share * point->start_energy;
        budget->force += force;
        budget->couple += force * shv_norm(point->opening);
    }
    budget->left = *stored + work + granted;
    return work;
}

static void let_go(const Cluster *cluster)
{
    for (int32_t i = 0; i < cluster->count; i++) {
        ShvCohesivePoint *point = &cluster->points[i];
        cluster->solves[i].change = point->pull;
        apply_force(cluster, i, shv_scale(point->pull, -1.0));
        point->pull = shv_vec3(0.0, 0.0, 0.0);
        point->settled = shv_vec3((double)NAN, 0.0, 0.0);
    }
}

/* Forces that have not settled could give more than the cluster stores. All are then scaled by λ, the largest for which
   stored + Σ λ pull·(to(λ) − from) = stored + λ a − λ² b ≥ 0, a = Σ pull·(free − from), b = Σ pull·(free − to) > 0.
   Returns whether they were. */
static bool limit_given(const Cluster *cluster, ShvClusterBudget *budget)
{
    double stored, a = 0.0;
    const double work = find_budget(cluster, budget, &stored);
    if (budget->left >= 0.0) return false;
    let_go(cluster);
    for (int32_t i = 0; i < cluster->count; i++) {
        const ShvCohesivePoint *point = &cluster->points[i];
        const ShvVec3 free = shv_madd(point->opening, 0.5 * cluster->pull->step, opening_rate(cluster, i));
        a += shv_dot(cluster->solves[i].change, shv_sub(free, point->from));
    }
    const double b = a - work, root = sqrt(a * a + 4.0 * b * stored);
    const double whole = shv_smaller(a > 0.0 ? 0.5 * (a + root) / b : 2.0 * stored / (root - a), 1.0);
    const double scale = whole * (1.0 - limit_margin);
    for (int32_t i = 0; i < cluster->count; i++) {
        cluster->points[i].pull = shv_scale(cluster->solves[i].change, scale);
        apply_force(cluster, i, cluster->points[i].pull);
    }
    budget->left = 0.0;
    return true;
}

/* Of the pulls of a cluster. */
static void leave_couples(const Cluster *cluster)
{
    ShvVec3 *couple = cluster->pull->cohesive->couple;
    for (int32_t i = 0; i < cluster->count; i++) {
        const ShvCohesivePoint *point = &cluster->points[i];
        couple[3 * (int64_t)point->rotation + point->point % 3] = shv_cross(point->opening, point->pull);
    }
}

/* Sweeps settle soonest from the forces of the last step. Where that leads to more than the cluster stores, they begin anew
   without any: that way fewer clusters have to be limited. */
static int32_t pull_cluster(const Cluster *cluster, ShvClusterBudget *budget)
{
    double stored;
    make_pairs(cluster);
    int32_t sweeps = settle(cluster);
    find_budget(cluster, budget, &stored);
    if (budget->left < 0.0) {
        let_go(cluster);
        sweeps += settle(cluster);
        limit_given(cluster, budget);
    }
    leave_couples(cluster);
    return sweeps;
}

/* ---- couples ---- */

static double push(const Pull *pull, int32_t node, ShvVec3 force)
{
    const ShvVec3 change = shv_scale(force, pull->kick / pull->state->mass[node]);
    shv_add_to3(pull->state->velocity + 3 * (int64_t)node, change);
    shv_add_to3(pull->state->force + 3 * (int64_t)node, force);
    return fabs(change.x) + fabs(change.y) + fabs(change.z);
}

static void push_cluster(const Pull *pull, int32_t cluster)
{
    const ShvCohesive *cohesive = pull->cohesive;
    double shift = 0.0;
    for (int32_t i = cohesive->cluster_corner[cluster]; i < cohesive->cluster_corner[cluster + 1]; i++) {
        const ShvCohesiveCorner *corner = &cohesive->corners[i];
        const ShvFacetRotation *rotation = &cohesive->rotations[corner->slot / 3];
        if (!rotation->answers) continue;
        const ShvVec3 half = shv_cross(rotation->answer, rotation->arm[corner->slot % 3]);
        shift += push(pull, corner->first, half);
        shift += push(pull, corner->second, half);
    }
    cohesive->budget[cluster].shift = shift;
}

static double change_of(ShvVec3 rate, ShvVec3 before)
{
    return fabs(rate.x - before.x) + fabs(rate.y - before.y) + fabs(rate.z - before.z);
}

/* Finds the rate of turn anew; returns by how much it is another. */
static double turn(const Pull *pull, ShvFacetRotation *rotation)
{
    const ShvVec3 before = rotation->rate;
    rotation->rate = shv_facet_rotation_rate(rotation, pull->state);
    return change_of(rotation->rate, before);
}

/* What the pulls' couples have become since they were last answered. Nodes of a cluster are in no other. Returns the largest
   change of a rate of turn, negative without answers. */
static double answer_couples(const Pull *pull)
{
    ShvCohesive *cohesive = pull->cohesive;
    const int32_t rotations = cohesive->rotation_count, count = cohesive->cluster_count,
                  threads = cohesive->model->threads;
    bool any = false;
    double spin = 0.0;
#pragma omp parallel for schedule(static) num_threads(threads) if (shv_cohesive_in_parallel(cohesive, rotations))      \
    reduction(||                                                                                                       \
              : any)
    for (int32_t k = 0; k < rotations; k++) {
        if (cohesive->rotations[k].carries)
            shv_facet_rotation_answer(&cohesive->rotations[k], cohesive->couple + 3 * (int64_t)k);
        any = any || cohesive->rotations[k].answers;
    }
    if (!any) return -1.0;
#pragma omp parallel for schedule(static) num_threads(threads) if (shv_cohesive_in_parallel(cohesive, count))
    for (int32_t c = 0; c < count; c++) push_cluster(pull, c);
#pragma omp parallel for schedule(static) num_threads(threads) if (shv_cohesive_in_parallel(cohesive, rotations))      \
    reduction(max                                                                                                      \
              : spin)
    for (int32_t k = 0; k < rotations; k++)
        if (cohesive->rotations[k].carries) spin = shv_larger(spin, turn(pull, &cohesive->rotations[k]));
    return spin;
}

/* Whether the change of rates may have led a cluster beyond what it stores, and it was limited. */
static bool check_limit(const Pull *pull, int32_t cluster, double spin, int thread)
{
    ShvClusterBudget *budget = &pull->cohesive->budget[cluster];
    budget->left -= 0.5 * pull->step * (budget->force * budget->shift + budget->couple * spin);
    budget->shift = 0.0;
    budget->limited = false;
    if (budget->left >= 0.0) return false;
    const Cluster begun = begin_cluster(pull, cluster, thread);
    budget->limited = limit_given(&begun, budget);
    if (budget->limited) leave_couples(&begun);
    return budget->limited;
}

static bool check_limits(const Pull *pull, double spin)
{
    const ShvCohesive *cohesive = pull->cohesive;
    const int32_t count = cohesive->cluster_count, threads = cohesive->model->threads;
    bool limited = false;
#pragma omp parallel for schedule(static) num_threads(threads) if (shv_cohesive_in_parallel(cohesive, count))          \
    reduction(||                                                                                                       \
              : limited)
    for (int32_t c = 0; c < count; c++) limited = check_limit(pull, c, spin, omp_get_thread_num()) || limited;
    return limited;
}

/* ---- couples of few clusters ---- */

static void note_kick(ShvCohesive *cohesive, int32_t cluster)
{
    if (cohesive->budget[cluster].kicked) return;
    cohesive->budget[cluster].kicked = true;
    cohesive->kicked_clusters[cohesive->kicked_count++] = cluster;
}

static void note_rotated(ShvCohesive *cohesive, int32_t cluster)
{
    if (cohesive->budget[cluster].rotated) return;
    cohesive->budget[cluster].rotated = true;
    cohesive->rotated_clusters[cohesive->rotated_count++] = cluster;
}

static void push_facet(const Pull *pull, ShvFacetRotation *rotation)
{
    for (int i = 0; i < 3; i++) {
        const ShvVec3 half = shv_cross(rotation->answer, rotation->arm[i]);
        const double shift = push(pull, rotation->first[i], half) + push(pull, rotation->second[i], half);
        pull->cohesive->budget[rotation->cluster[i]].shift += shift;
        note_kick(pull->cohesive, rotation->cluster[i]);
    }
}

/* As answer_couples, where the couples of a few clusters alone are new: those in `rotated_clusters` that were limited. Finds there the
   clusters of whose facets some turn otherwise now. */
static double answer_limited(const Pull *pull)
{
    ShvCohesive *cohesive = pull->cohesive;
    double spin = 0.0;
    cohesive->kicked_count = 0;
    for (int32_t n = 0; n < cohesive->rotated_count; n++) {
        const int32_t c = cohesive->rotated_clusters[n];
        note_kick(cohesive, c);
        for (int32_t i = cohesive->cluster[c]; i < cohesive->cluster[c + 1]; i++) {
            const int32_t k = cohesive->points[i].rotation;
            shv_facet_rotation_answer(&cohesive->rotations[k], cohesive->couple + 3 * (int64_t)k);
            if (cohesive->rotations[k].answers) push_facet(pull, &cohesive->rotations[k]);
        }
    }
    cohesive->rotated_count = 0;
    for (int32_t n = 0; n < cohesive->kicked_count; n++) {
        const int32_t c = cohesive->kicked_clusters[n];
        cohesive->budget[c].kicked = false;
        for (int32_t i = cohesive->cluster_corner[c]; i < cohesive->cluster_corner[c + 1]; i++) {
            ShvFacetRotation *rotation = &cohesive->rotations[cohesive->corners[i].slot / 3];
            spin = shv_larger(spin, turn(pull, rotation));
            for (int corner = 0; corner < 3; corner++) note_rotated(cohesive, rotation->cluster[corner]);
        }
    }
    return spin;
}

/* Leaves those of the rotated clusters that were limited. */
static void check_rotated(const Pull *pull, double spin)
{
    ShvCohesive *cohesive = pull->cohesive;
    const int32_t count = cohesive->rotated_count;
    cohesive->rotated_count = 0;
    for (int32_t n = 0; n < count; n++) {
        const int32_t c = cohesive->rotated_clusters[n];
        cohesive->budget[c].rotated = false;
        if (check_limit(pull, c, spin, 0)) cohesive->rotated_clusters[cohesive->rotated_count++] = c;
    }
}

/* Answers move the openings of other facets, a little, and clusters that give all they store would give more than that: few, round
   which alone answers and limits go on. */
static bool answer_within_limits(const Pull *pull)
{
    ShvCohesive *cohesive = pull->cohesive;
    double spin = answer_couples(pull);
    if (!(spin >= 0.0)) return false;
    if (!check_limits(pull, spin)) return true;
    cohesive->rotated_count = 0;
    for (int32_t c = 0; c < cohesive->cluster_count; c++)
        if (cohesive->budget[c].limited) cohesive->rotated_clusters[cohesive->rotated_count++] = c;
    for (int round = 1; round < MOST_ROUNDS && cohesive->rotated_count > 0; round++) {
        spin = answer_limited(pull);
        check_rotated(pull, spin);
    }
    if (cohesive->rotated_count > 0) answer_limited(pull);
    for (int32_t n = 0; n < cohesive->rotated_count; n++)
        cohesive->budget[cohesive->rotated_clusters[n]].rotated = false;
    return true;
}

/* ---- news ---- */

static bool has_news(const ShvCohesive *cohesive, int32_t cluster)
{
    for (int32_t i = cohesive->cluster_corner[cluster]; i < cohesive->cluster_corner[cluster + 1]; i++)
        if (cohesive->rotations[cohesive->corners[i].slot / 3].news) return true;
    return false;
}

static bool compare_node(const ShvCohesive *cohesive, const ShvState *state, int64_t node)
{
    const double *now = state->velocity + 3 * node, *then = cohesive->pulled_velocity + 3 * node;
    const bool news = now[0] != then[0] || now[1] != then[1] || now[2] != then[2];
    cohesive->node_news[node] = news;
    return news;
}

/* Of velocities, since the last pull. Returns whether there are any. */
static bool find_changed_velocities(const Pull *pull)
{
    ShvCohesive *cohesive = pull->cohesive;
    const int32_t nodes = cohesive->corner_node_count, rotations = cohesive->rotation_count,
                  threads = cohesive->model->threads;
    bool any = false;
#pragma omp parallel for schedule(static) num_threads(threads) if (shv_cohesive_in_parallel(cohesive, nodes))          \
    reduction(||                                                                                                       \
              : any)
    for (int32_t i = 0; i < nodes; i++) any = compare_node(cohesive, pull->state, cohesive->corner_nodes[i]) || any;
    if (!any) return false;
#pragma omp parallel for schedule(static) num_threads(threads) if (shv_cohesive_in_parallel(cohesive, rotations))
    for (int32_t k = 0; k < rotations; k++) {
        ShvFacetRotation *rotation = &cohesive->rotations[k];
        rotation->news = false;
        for (int i = 0; rotation->carries && i < 3; i++)
            rotation->news =
                rotation->news || cohesive->node_news[rotation->first[i]] || cohesive->node_news[rotation->second[i]];
        if (rotation->news) rotation->rate = shv_facet_rotation_rate(rotation, pull->state);
    }
    return true;
}

/* ---- all ---- */

void shv_cohesive_pull(ShvCohesive *cohesive, ShvState *state, double kick, double step)
{
    cohesive->sweeps = 0;
    if (!(step > 0.0 && kick > 0.0) || cohesive->point_count == 0) return;
    const Pull pull = {cohesive, state, kick, step};
    const int32_t count = cohesive->cluster_count, threads = cohesive->model->threads;
    const bool first = cohesive->pull_kick == 0.0, again = cohesive->pull_kick == kick && cohesive->pull_step == step;
    int64_t sweeps = 0;
    if (!first && !find_changed_velocities(&pull) && again) return;
#pragma omp parallel for schedule(static) num_threads(threads) if (shv_cohesive_in_parallel(cohesive, count))          \
    reduction(+ : sweeps)
    for (int32_t c = 0; c < count; c++) {
        if (cohesive->cluster[c] == cohesive->cluster[c + 1] || (again && !has_news(cohesive, c))) continue;
        const Cluster cluster = begin_cluster(&pull, c, omp_get_thread_num());
        if (first) repeat_last(&cluster);
        sweeps += pull_cluster(&cluster, &cohesive->budget[c]);
    }
    answer_within_limits(&pull);
    const int32_t nodes = cohesive->corner_node_count;
#pragma omp parallel for schedule(static) num_threads(threads) if (shv_cohesive_in_parallel(cohesive, nodes))
    for (int32_t i = 0; i < nodes; i++) {
        const int64_t node = 3 * (int64_t)cohesive->corner_nodes[i];
        shv_store3(cohesive->pulled_velocity + node, shv_load3(state->velocity + node));
    }
    cohesive->pull_kick = kick;
    cohesive->pull_step = step;
    cohesive->sweeps = sweeps;
}
