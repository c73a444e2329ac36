#include <math.h>
#include <string.h>

#include "cohesive/cohesive.h"
#include "cohesive/inspection.h"
#include "cohesive/storage.h"
#include "cohesive/traction.h"

static bool awake_elements(const ShvState *state, const int32_t *elements, const uint8_t *awake)
{
    return !awake || (awake[state->element_fragment[elements[0]]] && awake[state->element_fragment[elements[1]]]);
}

static ShvVec3 current_normal(const ShvCohesive *cohesive, const ShvState *state, int32_t facet)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    const int32_t element = adjacency->facet_elements[2 * (int64_t)facet];
    const uint8_t *corners = shv_face_corners[adjacency->facet_faces[2 * (int64_t)facet]];
    const ShvVec3 start = shv_state_position(state, shv_state_node(state, element, corners[0]));
    const ShvVec3 second = shv_state_position(state, shv_state_node(state, element, corners[1]));
    const ShvVec3 third = shv_state_position(state, shv_state_node(state, element, corners[2]));
    return shv_unit(shv_cross(shv_sub(second, start), shv_sub(third, start)));
}

/* Whether shear counts less than tension by a known factor; traction bounds need it. */
static double shear_weight(const ShvMaterial *material)
{
    const double normal = material->strength[SHV_NORMAL], shear = material->strength[SHV_SHEAR];
    return shear < normal ? normal / shear : 1.0;
}

static bool judged(const ShvCohesive *cohesive, int32_t facet)
{
    return cohesive->facet_cohesive[facet] < 0;
}

/* Least of the values of a facet's nodes against its strength; of each node's two values the one at `offset`. */
static double principal_value(const ShvCohesive *cohesive, const ShvState *state, int32_t facet, int offset)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    const int32_t element = adjacency->facet_elements[2 * (int64_t)facet];
    const uint8_t *corners = shv_face_corners[adjacency->facet_faces[2 * (int64_t)facet]];
    double least = (double)INFINITY;
    for (int i = 0; i < 3; i++) {
        const int64_t node = shv_state_node(state, element, corners[i]);
        least = shv_smaller(least, cohesive->node_value[2 * node + offset]);
    }
    return least > 0.0 ? least / cohesive->facet_strength[facet] : 0.0;
}

/* All elements of a node are in one fragment: groups that are not joined have copies of their own. */
static bool awake_node(const ShvState *state, int32_t node, const uint8_t *awake)
{
    return !awake || awake[state->element_fragment[state->corners[state->corner_start[node]] / 4]];
}

/* The largest principal stress lies between mean + |deviator|/√6 and mean + √(2/3) |deviator|; a margin covers round-off. */
static void bound_principal(const double *voigt, double bounds[2])
{
    const double mean = (voigt[0] + voigt[1] + voigt[2]) / 3.0;
    const double d[3] = {voigt[0] - mean, voigt[1] - mean, voigt[2] - mean};
    const double normal = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    const double shear = voigt[3] * voigt[3] + voigt[4] * voigt[4] + voigt[5] * voigt[5];
    const double part = sqrt((normal + 2.0 * shear) / 6.0), margin = 1e-12 * (fabs(mean) + part);
    bounds[0] = mean + 2.0 * part + margin;
    bounds[1] = mean + part - margin;
}

static void bound_nodes(const ShvCohesive *cohesive, const double *nodal)
{
    const int32_t threads = cohesive->model->threads;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (int32_t i = 0; i < cohesive->watched_node_count; i++) {
        const int64_t node = cohesive->watched_nodes[i];
        bound_principal(nodal + 6 * node, cohesive->node_value + 2 * node);
    }
}

/* The stress below which a node decides nothing: facets that need it are neither candidates nor the largest. */
static double idle_stress(const ShvCohesive *cohesive, const ShvState *state)
{
    const int32_t threads = cohesive->model->threads;
    double largest = 0.0, weakest = (double)INFINITY;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1) reduction(max                          \
                                                                                          : largest)                   \
    reduction(min                                                                                                      \
              : weakest)
    for (int32_t i = 0; i < cohesive->watched_count; i++) {
        const int32_t facet = cohesive->watched[i];
        if (!judged(cohesive, facet)) continue;
        largest = shv_larger(largest, principal_value(cohesive, state, facet, 1));
        weakest = shv_smaller(weakest, cohesive->facet_strength[facet]);
    }
    return fmin(largest, cohesive->settings->threshold) * weakest;
}

/* Eigenvalues of the nodes that matter; the others keep their bounds. */
static void principal_nodes(const ShvCohesive *cohesive, const ShvState *state, const double *nodal)
{
    const int32_t threads = cohesive->model->threads;
    bound_nodes(cohesive, nodal);
    const double idle = idle_stress(cohesive, state);
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (int32_t i = 0; i < cohesive->watched_node_count; i++) {
        const int64_t node = cohesive->watched_nodes[i];
        double *value = cohesive->node_value + 2 * node;
        if (!(*value < idle)) *value = shv_largest_principal(nodal + 6 * node);
    }
}

/* Values of all watched facets; returns the largest. */
static double evaluate_principal(const ShvCohesive *cohesive, const ShvState *state)
{
    const int32_t threads = cohesive->model->threads;
    double largest = 0.0;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1) reduction(max : largest)
    for (int32_t i = 0; i < cohesive->watched_count; i++) {
        const int32_t facet = cohesive->watched[i];
        const double value = judged(cohesive, facet) ? principal_value(cohesive, state, facet, 0) : 0.0;
        cohesive->facet_value[facet] = value;
        largest = shv_larger(largest, value);
    }
    return largest;
}

/* ---- traction ---- */

static int32_t batch_count(const ShvCohesive *cohesive)
{
    return (cohesive->model->mesh.element_count + SHV_LANES - 1) / SHV_LANES;
}

/* What makes a value of a traction's length, at most; any traction exceeds a strength of zero. Its square is finite. */
static double facet_weight(const ShvCohesive *cohesive, int32_t facet)
{
    const double largest = 1e150, weight = shear_weight(shv_cohesive_material(cohesive->model, facet));
    return shv_smaller(weight / shv_front_strength(cohesive, facet), largest);
}

void shv_cohesive_weigh(const ShvCohesive *cohesive, int32_t facet)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    const bool counts = cohesive->facet_watch[facet] && judged(cohesive, facet);
    const double weight = counts ? facet_weight(cohesive, facet) : 0.0;
    for (int side = 0; side < 2; side++) {
        const int32_t element = adjacency->facet_elements[2 * (int64_t)facet + side];
        const int face = adjacency->facet_faces[2 * (int64_t)facet + side];
        cohesive->face_weight[shv_corner_slot(element, face)] = weight;
    }
}

static void want_stress(ShvInspection *check, int32_t facet)
{
    const int32_t *elements = check->cohesive->model->adjacency.facet_elements + 2 * (int64_t)facet;
    for (int side = 0; side < 2; side++) shv_inspection_want(check, elements[side]);
}

static double traction_value(const ShvInspection *check, int32_t facet)
{
    const ShvCohesive *cohesive = check->cohesive;
    const int32_t *elements = cohesive->model->adjacency.facet_elements + 2 * (int64_t)facet;
    const ShvVec3 normal = current_normal(cohesive, check->state, facet);
    const ShvFacetTraction traction = shv_facet_traction(check->stress, elements[0], elements[1], normal);
    const double strength =
        traction.normal > traction.shear ? shv_front_strength(cohesive, facet) : cohesive->facet_strength[facet];
    return shv_facet_overstress(shv_cohesive_material(cohesive->model, facet), strength, traction);
}

static bool is_watched(const ShvCohesive *cohesive, int32_t facet)
{
    return cohesive->facet_watch[facet] == SHV_FACET_WATCHED && judged(cohesive, facet);
}

/* The largest value is no less than those that were largest at the last check have now. */
double shv_cohesive_floor(ShvCohesive *cohesive, const ShvState *state, const double *stress, ShvStressSource source)
{
    ShvInspection check = {cohesive, state, stress, source, 0};
    double floor = 0.0;
    for (int32_t k = 0; k < cohesive->nearest_count; k++)
        if (is_watched(cohesive, cohesive->nearest[k])) want_stress(&check, cohesive->nearest[k]);
    shv_inspection_get(&check);
    for (int32_t k = 0; k < cohesive->nearest_count; k++)
        if (is_watched(cohesive, cohesive->nearest[k]))
            floor = shv_larger(floor, traction_value(&check, cohesive->nearest[k]));
    return shv_smaller(floor, shv_inspection_level(cohesive));
}

/* The facets on which faces count. */
static void list_facets(ShvInspection *check)
{
    ShvCohesive *cohesive = check->cohesive;
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    cohesive->watched_count = 0;
    for (int32_t batch = 0; batch < batch_count(cohesive); batch++) {
        const uint32_t bits = cohesive->faces[batch];
        for (int bit = 0; bit < 4 * SHV_LANES && bits >> bit; bit++) {
            const int32_t element = batch * SHV_LANES + bit % SHV_LANES;
            if (!(bits >> bit & 1u) || element >= cohesive->model->mesh.element_count) continue;
            const int32_t facet = adjacency->element_facets[4 * (int64_t)element + bit / SHV_LANES];
            if (facet >= adjacency->interior_count || !is_watched(cohesive, facet)) continue;
            cohesive->facet_watch[facet] = SHV_FACET_LISTED;
            cohesive->watched[cohesive->watched_count++] = facet;
            want_stress(check, facet);
        }
    }
}

/* Of those below the level, the largest first. */
static void keep_nearest(ShvCohesive *cohesive)
{
    const double *value = cohesive->facet_value;
    int32_t *nearest = cohesive->nearest, count = 0;
    for (int32_t i = 0; i < cohesive->watched_count; i++) {
        const int32_t facet = cohesive->watched[i];
        if (!(value[facet] < shv_inspection_level(cohesive))) continue;
        if (count == SHV_NEAREST_FACETS && !(value[facet] > value[nearest[count - 1]])) continue;
        int32_t k = count < SHV_NEAREST_FACETS ? count++ : count - 1;
        for (; k > 0 && value[facet] > value[nearest[k - 1]]; k--) nearest[k] = nearest[k - 1];
        nearest[k] = facet;
    }
    cohesive->nearest_count = count;
}

static double evaluate_traction(ShvInspection *check)
{
    ShvCohesive *cohesive = check->cohesive;
    const int32_t threads = cohesive->model->threads;
    double largest = 0.0;
    list_facets(check);
    shv_inspection_get(check);
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1) reduction(max : largest)
    for (int32_t i = 0; i < cohesive->watched_count; i++) {
        const int32_t facet = cohesive->watched[i];
        cohesive->facet_watch[facet] = SHV_FACET_WATCHED;
        cohesive->facet_value[facet] = traction_value(check, facet);
        largest = shv_larger(largest, cohesive->facet_value[facet]);
    }
    keep_nearest(cohesive);
    return largest;
}

static void watch_facets(ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    const bool principal = cohesive->settings->criterion == SHV_CRITERION_PRINCIPAL;
    cohesive->watched_count = 0;
    for (int32_t facet = 0; facet < adjacency->interior_count; facet++) {
        const bool looked_at = judged(cohesive, facet) && !isinf(cohesive->facet_strength[facet]) &&
                               awake_elements(state, adjacency->facet_elements + 2 * (int64_t)facet, awake);
        cohesive->facet_watch[facet] = looked_at ? SHV_FACET_WATCHED : SHV_FACET_IGNORED;
        if (looked_at && principal) cohesive->watched[cohesive->watched_count++] = facet;
    }
}

void shv_cohesive_watch(ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake)
{
    shv_front_start(cohesive, state);
    shv_initiation_watch(cohesive, state, awake);
    watch_facets(cohesive, state, awake);
    cohesive->unlisted = true;
    cohesive->watched_node_count = 0;
    if (cohesive->settings->criterion != SHV_CRITERION_PRINCIPAL) {
        memset(cohesive->faces, 0, (size_t)batch_count(cohesive) * sizeof *cohesive->faces);
        for (int32_t facet = 0; facet < cohesive->model->adjacency.interior_count; facet++)
            shv_cohesive_weigh(cohesive, facet);
        return;
    }
    for (int32_t i = 0; i < state->node_count; i++)
        if (awake_node(state, i, awake)) cohesive->watched_nodes[cohesive->watched_node_count++] = i;
}

static void collect(ShvCohesive *cohesive, int32_t *candidates, double *overstress, int32_t *count)
{
    *count = 0;
    for (int32_t i = 0; i < cohesive->watched_count; i++) {
        const int32_t facet = cohesive->watched[i];
        if (cohesive->facet_value[facet] < cohesive->settings->threshold) continue;
        candidates[*count] = facet;
        overstress[(*count)++] = cohesive->facet_value[facet];
    }
    shv_sort_descending(candidates, overstress, *count);
}

static void already_there(void *context, const int32_t *batches, int32_t count)
{
    (void)context;
    (void)batches;
    (void)count;
}

double shv_cohesive_face_candidates(ShvCohesive *cohesive, const ShvState *state, const double *stress,
                                    ShvStressSource source, int32_t *candidates, double *overstress, int32_t *count)
{
    ShvInspection check = {cohesive, state, stress, source, 0};
    double largest = evaluate_traction(&check);
    if (cohesive->settings->criterion == SHV_CRITERION_FORCE)
        shv_inspection_find_disks(&check, candidates, overstress, count, &largest);
    else
        collect(cohesive, candidates, overstress, count);
    return largest;
}

double shv_cohesive_candidates(ShvCohesive *cohesive, const ShvState *state, const double *stress, const double *nodal,
                               int32_t *candidates, double *overstress, int32_t *count)
{
    if (cohesive->settings->criterion != SHV_CRITERION_PRINCIPAL) {
        const ShvStressSource source = {already_there, NULL};
        memset(cohesive->faces, 0xff, (size_t)batch_count(cohesive) * sizeof *cohesive->faces);
        return shv_cohesive_face_candidates(cohesive, state, stress, source, candidates, overstress, count);
    }
    principal_nodes(cohesive, state, nodal);
    const double largest = evaluate_principal(cohesive, state);
    collect(cohesive, candidates, overstress, count);
    return largest;
}
