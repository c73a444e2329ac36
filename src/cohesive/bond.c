#include "cohesive/cohesive.h"
#include "cohesive/frame.h"

/* A corner that has opened or slipped beyond both has let go of what its neighbours may still hold: final openings, and edges of the
   facet. */
static const double torn_openings = 10.0, torn_edges = 0.05;

/* Of an equilateral triangle of the facet's area, m. */
static double edge_of(const ShvCohesive *cohesive, int32_t index)
{
    return sqrt(cohesive->area[index] * (4.0 / sqrt(3.0)));
}

double shv_cohesive_residual(const ShvCohesive *cohesive, int32_t index)
{
    double largest = 0.0;
    if (!cohesive->bonded[index]) return 0.0;
    for (int64_t k = 3 * (int64_t)index; k < 3 * (int64_t)index + 3; k++)
        largest = shv_larger(largest, shv_law_residual(&cohesive->law[index], cohesive->internal[k].history));
    return largest;
}

static bool holds(const ShvCohesive *cohesive, int32_t index)
{
    for (int64_t k = 3 * (int64_t)index; k < 3 * (int64_t)index + 3; k++)
        if (shv_law_residual(&cohesive->law[index], cohesive->internal[k].history) > SHV_BOND_SHARE) return true;
    return false;
}

static bool is_wide(const ShvCohesive *cohesive, int32_t index, int component, double opening)
{
    return opening > torn_openings * cohesive->law[index].final_opening[component] &&
           opening > torn_edges * edge_of(cohesive, index);
}

static bool is_torn(const ShvCohesive *cohesive, int32_t index)
{
    for (int64_t k = 3 * (int64_t)index; k < 3 * (int64_t)index + 3; k++) {
        const ShvOpening at = cohesive->internal[k].opening;
        if (is_wide(cohesive, index, SHV_NORMAL, at.normal) || is_wide(cohesive, index, SHV_SHEAR, at.shear))
            return true;
    }
    return false;
}

static void tear(ShvCohesive *cohesive, int32_t index, ShvLedger *ledger)
{
    const ShvLaw *law = &cohesive->law[index];
    for (int64_t k = 3 * (int64_t)index; k < 3 * (int64_t)index + 3; k++) {
        ShvInternalVariables *internal = &cohesive->internal[k];
        const ShvOpening at = internal->opening;
        ledger->released +=
            cohesive->area[index] / 3.0 * shv_law_recoverable(law, internal->history, at.normal, at.shear);
        internal->history = shv_law_tear(law, internal->history);
        internal->peak = 0.0;
    }
    cohesive->torn = true;
}

void shv_cohesive_find_failed(ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake, ShvLedger *ledger)
{
    cohesive->failed_count = 0;
    for (int32_t k = 0; k < cohesive->live_count; k++) {
        const int32_t index = cohesive->live[k];
        if (!cohesive->bonded[index] || !cohesive->sides[index].split ||
            shv_cohesive_rests(cohesive, state, index, awake))
            continue;
        if (cohesive->front.any && !cohesive->opened[index]) shv_front_open(cohesive, state, index);
        const bool torn = is_torn(cohesive, index);
        if (!torn && holds(cohesive, index)) continue;
        if (torn) tear(cohesive, index, ledger);
        cohesive->bonded[index] = false;
        cohesive->failed[cohesive->failed_count++] = index;
    }
}

/* Of a face of an element, −1: none. */
static int32_t cohesive_facet_of(const ShvCohesive *cohesive, int32_t element, int face)
{
    const int32_t facet = cohesive->model->adjacency.element_facets[4 * (int64_t)element + face];
    return facet < cohesive->model->adjacency.interior_count ? cohesive->facet_cohesive[facet] : -1;
}

bool shv_cohesive_is_failing(const ShvCohesive *cohesive, const ShvState *state, const int32_t *elements, int32_t count)
{
    for (int32_t i = 0; i < 4 * count; i++) {
        const int32_t index = cohesive_facet_of(cohesive, elements[i / 4], i % 4);
        if (index < 0 || !cohesive->bonded[index] || !cohesive->sides[index].split) continue;
        double largest = 0.0;
        for (int corner = 0; corner < 3; corner++) {
            ShvOpening now;
            const ShvHistory history = shv_cohesive_present(cohesive, state, index, corner, &now);
            largest = shv_larger(largest, shv_law_residual(&cohesive->law[index], history));
        }
        if (!(largest > SHV_BOND_SHARE)) return true;
    }
    return false;
}

bool shv_cohesive_holds_cracks(const ShvCohesive *cohesive, const int32_t *elements, int32_t count)
{
    for (int32_t i = 0; i < 4 * count; i++) {
        const int32_t index = cohesive_facet_of(cohesive, elements[i / 4], i % 4);
        if (index >= 0 && cohesive->bonded[index]) return true;
    }
    return false;
}

double shv_cohesive_dissipated(const ShvCohesive *cohesive, const int32_t *elements, int32_t count)
{
    double sum = 0.0;
    for (int32_t i = 0; i < 4 * count; i++) {
        const int32_t index = cohesive_facet_of(cohesive, elements[i / 4], i % 4);
        for (int64_t k = 3 * (int64_t)index; index >= 0 && k < 3 * (int64_t)index + 3; k++)
            sum += cohesive->area[index] / 6.0 * cohesive->internal[k].history.dissipated; /* once from either side */
    }
    return sum;
}

double shv_cohesive_widest(const ShvCohesive *cohesive, const ShvState *state, const int32_t *elements, int32_t count)
{
    double widest = 0.0;
    for (int32_t i = 0; i < 4 * count; i++) {
        const int32_t index = cohesive_facet_of(cohesive, elements[i / 4], i % 4);
        if (index < 0) continue;
        const ShvCohesiveSides *sides = &cohesive->sides[index];
        if (state->element_fragment[sides->elements[0]] != state->element_fragment[sides->elements[1]]) continue;
        const double edge = edge_of(cohesive, index);
        for (int c = 0; c < 3; c++)
            widest =
                shv_larger(widest, shv_norm(shv_cohesive_opening(state, sides->first[c], sides->second[c])) / edge);
    }
    return widest;
}
