#include <math.h>
#include <stdlib.h>

#include "cohesive/cohesive.h"
#include "cohesive/frame.h"
#include "cohesive/storage.h"
#include "cohesive/topology.h"
#include "cohesive/traction.h"

static int by_number(const void *a, const void *b)
{
    const int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

/* Sorted, so that what follows does not depend on the order given. */
static ShvStatus sort_facets(const ShvCohesive *cohesive, const int32_t *facets, int32_t count, int32_t *sorted,
                             ShvError *error)
{
    for (int32_t i = 0; i < count; i++) sorted[i] = facets[i];
    qsort(sorted, (size_t)count, sizeof *sorted, by_number);
    for (int32_t i = 0; i < count; i++) {
        const int32_t facet = sorted[i];
        if (facet < 0 || facet >= cohesive->model->adjacency.interior_count || cohesive->facet_cohesive[facet] >= 0 ||
            (i > 0 && sorted[i - 1] == facet))
            return shv_fail(error, SHV_BAD_INPUT,
                            "facet %d cannot be made cohesive; give interior facets that are still intact, each once",
                            (int)facet);
    }
    return SHV_OK;
}

/* Both elements of an intact facet share their copies of its nodes. */
static int32_t touched_nodes(const ShvCohesive *cohesive, const ShvState *state, const int32_t *facets, int32_t count,
                             int32_t *nodes)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    for (int32_t i = 0; i < count; i++) {
        const int64_t facet = facets[i];
        const uint8_t *corners = shv_face_corners[adjacency->facet_faces[2 * facet]];
        for (int k = 0; k < 3; k++)
            nodes[3 * (int64_t)i + k] = shv_state_node(state, adjacency->facet_elements[2 * facet], corners[k]);
    }
    qsort(nodes, 3 * (size_t)count, sizeof *nodes, by_number);
    int32_t unique = 0;
    for (int64_t i = 0; i < 3 * (int64_t)count; i++)
        if (unique == 0 || nodes[unique - 1] != nodes[i]) nodes[unique++] = nodes[i];
    return unique;
}

static ShvStatus reserve_copies(ShvCohesive *cohesive, ShvState *state, const int32_t *nodes, int32_t count,
                                ShvError *error)
{
    int64_t needed = state->node_count;
    for (int32_t i = 0; i < count; i++) needed += shv_topology_groups(cohesive, state, nodes[i]) - 1;
    SHV_TRY(shv_state_reserve(state, needed, error));
    return shv_cohesive_reserve_nodes(cohesive, state->node_capacity, error);
}

static void match_corners(const ShvModel *model, int32_t facet, uint8_t partner[3])
{
    const int32_t *elements = model->adjacency.facet_elements + 2 * (int64_t)facet;
    const uint8_t *faces = model->adjacency.facet_faces + 2 * (int64_t)facet;
    const int32_t *first = model->mesh.elements + 4 * (int64_t)elements[0];
    const int32_t *second = model->mesh.elements + 4 * (int64_t)elements[1];
    for (int i = 0; i < 3; i++)
        for (uint8_t k = 0; k < 3; k++)
            if (second[shv_face_corners[faces[1]][k]] == first[shv_face_corners[faces[0]][i]]) partner[i] = k;
}

/* Scale of the strengths such that the larger component's peak is what the facet carries, raised to the criterion's
   limit where it is below (see cohesive.h). */
static double activation(const ShvCohesive *cohesive, const ShvState *state, const double *stress, int32_t index)
{
    if (!stress || cohesive->settings->activation != SHV_ACTIVATION_TRACTION) return 1.0;
    const int32_t facet = cohesive->facet[index];
    const int32_t *elements = cohesive->model->adjacency.facet_elements + 2 * (int64_t)facet;
    const ShvMaterial *material = shv_cohesive_material(cohesive->model, facet);
    const ShvVec3 normal = shv_cohesive_frame(cohesive, state, index).normal;
    ShvFacetTraction traction = shv_facet_traction(stress, elements[0], elements[1], normal);
    const double strength = cohesive->facet_strength[facet];
    traction.shear =
        fmax(traction.shear - material->friction * fmax(-traction.normal, 0.0), 0.0); /* friction bears the rest */
    const double whole = shv_facet_overstress(material, strength, traction);
    traction.normal = fmax(traction.normal, 0.0);
    const double tension = shv_facet_overstress(material, strength, (ShvFacetTraction){traction.normal, 0.0});
    const double shear = shv_facet_overstress(material, strength, (ShvFacetTraction){0.0, traction.shear});
    if (!(whole > 0.0 && isfinite(whole))) return 1.0;
    return fmax(tension, shear) / fmin(whole, 1.0);
}

/* Of a strength or an energy, that a law starts with at least: with less strength, the final opening would outgrow the body. */
static const double least_share = 0.1;
/* Ahead of a front facets hold the same in any direction, and their energy counts by what they cover of the crack's plane: that a
   mesh makes a crack rough is nothing that the material pays for. */
static void judge_as_ahead(ShvMaterial *material, double along)
{
    material->strength[SHV_SHEAR] = material->strength[SHV_NORMAL];
    for (int i = 0; i < 2; i++) material->fracture_energy[i] *= fmax(along, least_share);
}

/* The components of the traction that the force criterion counted on. Camacho and Ortiz' law starts on that ellipse by itself. */
static ShvLaw judged_law(const ShvCohesive *cohesive, const ShvMaterial *material, int32_t facet, double scale)
{
    const double along = cohesive->search.facet_along[facet];
    ShvMaterial judged = *material;
    if (cohesive->front.any && cohesive->front.ahead[facet] & SHV_FRONT_LOWERED) judge_as_ahead(&judged, along);
    if (material->law == SHV_PPR) {
        const double beta = shv_shear_ratio(&judged);
        const double share = shv_strength_share(along, beta);
        judged.strength[SHV_NORMAL] *= fmax(along / share, least_share);
        if (isfinite(beta)) judged.strength[SHV_SHEAR] *= fmax(beta * sqrt(1.0 - along * along) / share, least_share);
    }
    return shv_law_make(&judged, scale);
}

static ShvLaw starting_law(const ShvCohesive *cohesive, const ShvState *state, const double *stress, int32_t index)
{
    const int32_t facet = cohesive->facet[index];
    const ShvMaterial *material = shv_cohesive_material(cohesive->model, facet);
    const double scale = material->unresolved == SHV_UNRESOLVED_TIP_STRENGTH && material->strength[SHV_NORMAL] > 0.0
                             ? cohesive->facet_strength[facet] / material->strength[SHV_NORMAL]
                             : shv_cohesive_strength_scale(cohesive->model, facet);
    const bool judged = stress && cohesive->settings->criterion == SHV_CRITERION_FORCE;
    ShvLaw law = judged ? judged_law(cohesive, material, facet, scale)
                        : shv_law_make(material, scale * activation(cohesive, state, stress, index));
    law.slip_share = cohesive->settings->regularisation;
    return law;
}

static void add_facet(ShvCohesive *cohesive, const ShvState *state, const double *stress, int32_t facet)
{
    const int32_t index = cohesive->count++;
    const int64_t point = 3 * (int64_t)index;
    const ShvModel *model = cohesive->model;
    const ShvMaterial *material = shv_cohesive_material(model, facet);
    cohesive->facet[index] = facet;
    match_corners(model, facet, cohesive->partner + point);
    shv_cohesive_find_sides(cohesive, state, index);
    cohesive->area[index] = shv_norm(shv_cohesive_reference_area(model, facet));
    cohesive->law[index] = starting_law(cohesive, state, stress, index);
    const double length = sqrt(cohesive->area[index]);
    const ShvHistory start = shv_law_start(&cohesive->law[index], length, material->youngs_modulus);
    cohesive->sides[index].start = start.normal;
    cohesive->sides[index].returned = material->face_restitution * material->face_restitution;
    cohesive->sides[index].friction = material->friction;
    for (int i = 0; i < 3; i++) {
        cohesive->internal[point + i] =
            (ShvInternalVariables){.history = start, .peak = shv_law_peak(&cohesive->law[index], start)};
        cohesive->force[point + i] = shv_vec3(0.0, 0.0, 0.0);
    }
    cohesive->phase[index] = SHV_COHESIVE_CARRYING;
    cohesive->bonded[index] = true;
    cohesive->opened[index] = false;
    cohesive->born[index] = state->time;
    cohesive->apart[index] = -(double)INFINITY;
    cohesive->live[cohesive->live_count++] = index;
}

static void mark(ShvCohesive *cohesive, const int32_t *facets, int32_t count, int32_t first, int32_t stride)
{
    for (int32_t i = 0; i < count; i++) cohesive->facet_cohesive[facets[i]] = first + stride * i;
}

/* Of all cohesive facets at a node. */
static void find_sides_at(const ShvCohesive *cohesive, const ShvState *state, int32_t node)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    for (int32_t i = 0; i < state->corner_count[node]; i++) {
        const int32_t corner = state->corners[state->corner_start[node] + i];
        for (int k = 0; k < 4; k++) {
            const int32_t facet = adjacency->element_facets[4 * (int64_t)(corner / 4) + k];
            if (k != corner % 4 && facet < adjacency->interior_count && cohesive->facet_cohesive[facet] >= 0)
                shv_cohesive_find_sides(cohesive, state, cohesive->facet_cohesive[facet]);
        }
    }
}

static ShvStatus insert(ShvCohesive *cohesive, ShvState *state, const double *stress, const int32_t *facets,
                        int32_t count, int32_t *sorted, int32_t *nodes, ShvError *error)
{
    const int32_t before = state->node_count;
    SHV_TRY(sort_facets(cohesive, facets, count, sorted, error));
    for (int32_t i = 0; i < count; i++)
        if (!shv_cohesive_material(cohesive->model, sorted[i]))
            return shv_fail(error, SHV_BAD_INPUT, "facet %d belongs to an unbreakable material; leave it out",
                            (int)sorted[i]);
    SHV_TRY(shv_cohesive_reserve_facets(cohesive, count, error));
    const int32_t touched = touched_nodes(cohesive, state, sorted, count, nodes);
    mark(cohesive, sorted, count, cohesive->count, 1);
    const ShvStatus status = reserve_copies(cohesive, state, nodes, touched, error);
    if (status != SHV_OK) {
        mark(cohesive, sorted, count, -1, 0);
        return status;
    }
    for (int32_t i = 0; i < count; i++) add_facet(cohesive, state, stress, sorted[i]);
    for (int32_t i = 0; i < touched; i++) shv_topology_split(cohesive, state, nodes[i]);
    for (int32_t i = 0; i < touched; i++) find_sides_at(cohesive, state, nodes[i]);
    for (int32_t node = before; node < state->node_count; node++) find_sides_at(cohesive, state, node);
    for (int32_t i = 0; cohesive->front.any && i < touched; i++) shv_front_update(cohesive, state, nodes[i]);
    for (int32_t node = before; cohesive->front.any && node < state->node_count; node++)
        shv_front_update(cohesive, state, node);
    for (int32_t i = 0; i < count; i++) shv_cohesive_weigh(cohesive, sorted[i]);
    cohesive->unlisted = true;
    return SHV_OK;
}

ShvStatus shv_cohesive_insert(ShvCohesive *cohesive, ShvState *state, const double *stress, const int32_t *facets,
                              int32_t count, int32_t *duplicated, ShvError *error)
{
    const int32_t before = state->node_count;
    *duplicated = 0;
    if (count == 0) return SHV_OK;
    int32_t *sorted = shv_allocate(cohesive->memory, SHV_PART_COHESIVE, (size_t)count, sizeof *sorted);
    int32_t *nodes = shv_allocate(cohesive->memory, SHV_PART_COHESIVE, 3 * (size_t)count, sizeof *nodes);
    const ShvStatus status = sorted && nodes ? insert(cohesive, state, stress, facets, count, sorted, nodes, error)
                                             : shv_fail_memory(error, "an insertion", 16 * (size_t)count);
    shv_release(sorted);
    shv_release(nodes);
    *duplicated = state->node_count - before;
    return status;
}
