#include <math.h>

#include "cohesive/cohesive.h"
#include "cohesive/traction.h"

/* No facet value is negative: marks facets that were left out because they are below both the threshold and the largest
   value found so far. */
static const double left_out = -1.0;

/* Of every stress tensor the Frobenius norm, which bounds the traction on any plane; a margin covers round-off. */
static void bound_elements(const ShvCohesive *cohesive, const double *stress)
{
    const int32_t count = cohesive->model->mesh.element_count, threads = cohesive->model->threads;
    double *bound = cohesive->element_bound;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (int32_t batch = 0; batch < (count + SHV_LANES - 1) / SHV_LANES; batch++) {
        const double *s = stress + (int64_t)batch * 6 * SHV_LANES;
        const int32_t lanes = count - batch * SHV_LANES < SHV_LANES ? count - batch * SHV_LANES : SHV_LANES;
        for (int32_t i = 0; i < lanes; i++) {
            const double normal =
                s[i] * s[i] + s[SHV_LANES + i] * s[SHV_LANES + i] + s[2 * SHV_LANES + i] * s[2 * SHV_LANES + i];
            const double shear = s[3 * SHV_LANES + i] * s[3 * SHV_LANES + i] +
                                 s[4 * SHV_LANES + i] * s[4 * SHV_LANES + i] +
                                 s[5 * SHV_LANES + i] * s[5 * SHV_LANES + i];
            bound[batch * SHV_LANES + i] = sqrt(normal + 2.0 * shear) * (1.0 + 1e-12);
        }
    }
}

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

static double traction_value(const ShvCohesive *cohesive, const ShvState *state, const double *stress, int32_t facet,
                             double floor)
{
    const int32_t *elements = cohesive->model->adjacency.facet_elements + 2 * (int64_t)facet;
    const ShvMaterial *material = shv_cohesive_material(cohesive->model, facet);
    const double strength = cohesive->facet_strength[facet];
    const double bound = 0.5 * (cohesive->element_bound[elements[0]] + cohesive->element_bound[elements[1]]);
    if (bound * shear_weight(material) < floor * strength) return left_out;
    const ShvVec3 normal = current_normal(cohesive, state, facet);
    return shv_facet_overstress(material, strength, shv_facet_traction(stress, elements[0], elements[1], normal));
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

/* Values of all watched facets; returns the largest. A facet is left out only when it can neither be a candidate nor the largest,
   so the result does not depend on what each thread has seen. */
static double evaluate(const ShvCohesive *cohesive, const ShvState *state, const double *stress)
{
    const bool principal = cohesive->settings->criterion == SHV_CRITERION_PRINCIPAL;
    const double threshold = cohesive->settings->threshold;
    const int32_t threads = cohesive->model->threads;
    double largest = 0.0;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1) reduction(max : largest)
    for (int32_t i = 0; i < cohesive->watched_count; i++) {
        const int32_t facet = cohesive->watched[i];
        double value = left_out;
        if (judged(cohesive, facet))
            value = principal ? principal_value(cohesive, state, facet, 0)
                              : traction_value(cohesive, state, stress, facet, fmin(largest, threshold));
        cohesive->facet_value[facet] = value;
        largest = shv_larger(largest, value);
    }
    return largest;
}

/* ---- descending order, ties by facet number: heap sort with the last in order at the root ---- */

static bool after(const int32_t *facets, const double *values, int32_t a, int32_t b)
{
    return values[a] < values[b] || (values[a] == values[b] && facets[a] > facets[b]);
}

static void swap(int32_t *facets, double *values, int32_t a, int32_t b)
{
    const int32_t facet = facets[a];
    const double value = values[a];
    facets[a] = facets[b];
    values[a] = values[b];
    facets[b] = facet;
    values[b] = value;
}

static void sift(int32_t *facets, double *values, int32_t root, int32_t count)
{
    for (int64_t child = 2 * (int64_t)root + 1; child < count; child = 2 * (int64_t)root + 1) {
        int32_t last = (int32_t)child;
        if (last + 1 < count && after(facets, values, last + 1, last)) last++;
        if (!after(facets, values, last, root)) return;
        swap(facets, values, root, last);
        root = last;
    }
}

static void sort(int32_t *facets, double *values, int32_t count)
{
    for (int32_t root = count / 2 - 1; root >= 0; root--) sift(facets, values, root, count);
    for (int32_t end = count - 1; end > 0; end--) {
        swap(facets, values, 0, end);
        sift(facets, values, 0, end);
    }
}

void shv_cohesive_watch(ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    cohesive->watched_count = cohesive->watched_node_count = 0;
    for (int32_t facet = 0; facet < adjacency->interior_count; facet++)
        if (judged(cohesive, facet) && !isinf(cohesive->facet_strength[facet]) &&
            awake_elements(state, adjacency->facet_elements + 2 * (int64_t)facet, awake))
            cohesive->watched[cohesive->watched_count++] = facet;
    if (cohesive->settings->criterion != SHV_CRITERION_PRINCIPAL) return;
    for (int32_t i = 0; i < state->node_count; i++)
        if (awake_node(state, i, awake)) cohesive->watched_nodes[cohesive->watched_node_count++] = i;
}

double shv_cohesive_candidates(ShvCohesive *cohesive, const ShvState *state, const double *stress, const double *nodal,
                               int32_t *candidates, double *overstress, int32_t *count)
{
    if (cohesive->settings->criterion == SHV_CRITERION_PRINCIPAL)
        principal_nodes(cohesive, state, nodal);
    else
        bound_elements(cohesive, stress);
    const double largest = evaluate(cohesive, state, stress);
    *count = 0;
    for (int32_t i = 0; i < cohesive->watched_count; i++) {
        const int32_t facet = cohesive->watched[i];
        if (cohesive->facet_value[facet] < cohesive->settings->threshold) continue;
        candidates[*count] = facet;
        overstress[(*count)++] = cohesive->facet_value[facet];
    }
    sort(candidates, overstress, *count);
    return largest;
}
