#include <math.h>

#include "cohesive/cohesive.h"
#include "cohesive/frame.h"
#include "cohesive/solve.h"

typedef struct PointEnergy {
    double recoverable, dissipated; /* J/m² */
} PointEnergy;

ShvHistory shv_cohesive_present(const ShvCohesive *cohesive, const ShvState *state, int32_t index, int corner,
                                ShvOpening *now)
{
    const int64_t k = 3 * (int64_t)index + corner;
    const ShvCohesiveFrame frame = shv_cohesive_frame(cohesive, state, index);
    const ShvVec3 opening = shv_cohesive_opening(state, frame.first[corner], frame.second[corner]);
    const ShvOpening before = cohesive->internal[k].opening;
    *now = shv_cohesive_components(opening, frame.normal);
    return shv_law_advance(&cohesive->law[index], cohesive->internal[k].history, before, *now);
}

/* At the present opening. */
static PointEnergy point_energy(const ShvCohesive *cohesive, const ShvState *state, int32_t index, int corner)
{
    ShvOpening now;
    const ShvLaw *law = &cohesive->law[index];
    const ShvHistory history = shv_cohesive_present(cohesive, state, index, corner, &now);
    return (PointEnergy){shv_law_recoverable(law, history, now.normal, now.shear), history.dissipated};
}

static PointEnergy facet_energy(const ShvCohesive *cohesive, const ShvState *state, int32_t index)
{
    PointEnergy sum = {0.0, 0.0};
    const double weight = cohesive->area[index] / 3.0;
    if (cohesive->phase[index] != SHV_COHESIVE_CARRYING) {
        for (int64_t k = 3 * (int64_t)index; k < 3 * (int64_t)index + 3; k++)
            sum.dissipated += weight * cohesive->internal[k].history.dissipated;
        return sum;
    }
    for (int corner = 0; corner < 3; corner++) {
        const PointEnergy point = point_energy(cohesive, state, index, corner);
        sum.recoverable += weight * point.recoverable;
        sum.dissipated += weight * point.dissipated;
    }
    return sum;
}

/* ---- springs ---- */

static double secant(ShvLawBranch branch)
{
    return branch.limit > 0.0 ? branch.peak / branch.limit : (double)INFINITY;
}

/* Of the stiffer component, N/m. */
static double point_stiffness(const ShvCohesive *cohesive, const ShvCohesivePoint *point)
{
    const ShvLaw *law = &cohesive->law[point->point / 3];
    const ShvHistory history = cohesive->internal[point->point].history;
    const ShvOpening at = cohesive->internal[point->point].opening;
    const double normal = secant(shv_law_normal_branch(law, history, at.shear));
    const double shear = secant(shv_law_shear_branch(law, history, shv_larger(at.normal, 0.0)));
    return point->weight * shv_larger(normal, shear);
}

/* 2 Σ k A/3 / m of a node of a cluster. */
static double squared_frequency(const ShvCohesive *cohesive, const ShvState *state, int32_t cluster, int32_t node)
{
    double sum = 0.0;
    for (int32_t i = cohesive->cluster[cluster]; i < cohesive->cluster[cluster + 1]; i++) {
        const ShvCohesivePoint *point = &cohesive->points[i];
        if (point->first == node || point->second == node) sum += point_stiffness(cohesive, point);
    }
    return 2.0 * sum / state->mass[node];
}

static double spring_step(const ShvCohesive *cohesive, const ShvState *state)
{
    double largest = 0.0;
    for (int32_t c = 0; c < cohesive->cluster_count && !cohesive->unlisted; c++)
        for (int32_t i = cohesive->cluster[c]; i < cohesive->cluster[c + 1]; i++) {
            const ShvCohesivePoint *point = &cohesive->points[i];
            largest = shv_larger(largest, squared_frequency(cohesive, state, c, point->first));
            largest = shv_larger(largest, squared_frequency(cohesive, state, c, point->second));
        }
    return largest > 0.0 ? 2.0 / sqrt(largest) : (double)INFINITY;
}

/* ---- softening ---- */

/* A path to the share x of the final opening dissipates about x G (exactly, where the envelope is a line). */
static bool softened(const ShvCohesive *cohesive, int32_t index)
{
    const ShvLaw *law = &cohesive->law[index];
    double reached = 0.0, dissipated = 0.0;
    for (int64_t k = 3 * (int64_t)index; k < 3 * (int64_t)index + 3; k++) {
        const ShvHistory history = cohesive->internal[k].history;
        const double normal = history.normal / law->final_opening[SHV_NORMAL];
        const double share = shv_larger(normal, history.shear / law->final_opening[SHV_SHEAR]);
        reached += shv_smaller(share, 1.0) / 3.0;
        dissipated += history.dissipated / 3.0;
    }
    const double energy = shv_smaller(law->energy[SHV_NORMAL], law->energy[SHV_SHEAR]);
    return reached >= 0.5 && reached < 0.99 && dissipated < 0.5 * reached * energy;
}

/* ---- sums ---- */

/* J */
static double held_by(const ShvCohesive *cohesive, int32_t index)
{
    double sum = 0.0;
    for (int64_t k = 3 * (int64_t)index; k < 3 * (int64_t)index + 3; k++)
        sum += shv_larger(cohesive->internal[k].held, 0.0);
    return sum;
}

ShvCohesiveEnergy shv_cohesive_energy(const ShvCohesive *cohesive, const ShvState *state)
{
    ShvCohesiveEnergy energy = {.inserted = cohesive->count, .spring_step = spring_step(cohesive, state)};
    for (int32_t i = 0; i < cohesive->count; i++) {
        const PointEnergy facet = facet_energy(cohesive, state, i);
        energy.recoverable += facet.recoverable;
        energy.held += held_by(cohesive, i);
        energy.dissipated += facet.dissipated;
        energy.inserted_area += cohesive->area[i];
        energy.softened += softened(cohesive, i);
        if (cohesive->bonded[i]) continue;
        energy.failed++;
        energy.failed_area += cohesive->area[i];
        energy.failed_energy += cohesive->area[i] * cohesive->law[i].energy[SHV_NORMAL];
    }
    return energy;
}

/* How many of a facet's two elements belong to a fragment. */
static int share_of(const ShvCohesive *cohesive, const ShvState *state, int32_t index, int32_t fragment)
{
    const int32_t *elements = cohesive->model->adjacency.facet_elements + 2 * (int64_t)cohesive->facet[index];
    return (state->element_fragment[elements[0]] == fragment) + (state->element_fragment[elements[1]] == fragment);
}

double shv_cohesive_recoverable_of(const ShvCohesive *cohesive, const ShvState *state, int32_t fragment)
{
    double sum = 0.0;
    for (int32_t k = 0; k < cohesive->live_count; k++)
        if (share_of(cohesive, state, cohesive->live[k], fragment) > 0)
            sum += facet_energy(cohesive, state, cohesive->live[k]).recoverable;
    return sum;
}

/* Moves the histories of a facet to the present openings, as if the last step had ended here. */
static void settle_facet(ShvCohesive *cohesive, const ShvState *state, int32_t index)
{
    for (int corner = 0; corner < 3; corner++) {
        const int64_t k = 3 * (int64_t)index + corner;
        cohesive->internal[k].history =
            shv_cohesive_present(cohesive, state, index, corner, &cohesive->internal[k].opening);
    }
}

void shv_cohesive_settle(ShvCohesive *cohesive, const ShvState *state, int32_t fragment)
{
    shv_cohesive_drop_lists(cohesive);
    for (int32_t k = 0; k < cohesive->live_count; k++) {
        const int32_t index = cohesive->live[k];
        const int share = share_of(cohesive, state, index, fragment);
        if (share == 0) continue;
        if (cohesive->phase[index] == SHV_COHESIVE_CARRYING) settle_facet(cohesive, state, index);
        for (int64_t i = 3 * (int64_t)index; i < 3 * (int64_t)index + 3; i++) cohesive->internal[i].held = 0.0;
        if (share == 1) cohesive->phase[index] = SHV_COHESIVE_SEPARATED;
    }
}

double shv_cohesive_facet_damage(const ShvCohesive *cohesive, int32_t cohesive_facet)
{
    double sum = 0.0;
    for (int i = 0; i < 3; i++)
        sum +=
            shv_law_damage(&cohesive->law[cohesive_facet], cohesive->internal[3 * (int64_t)cohesive_facet + i].history);
    return sum / 3.0;
}
