#include <math.h>

#include "base/deterministic.h"
#include "base/random.h"
#include "cohesive/cohesive.h"
#include "cohesive/frame.h"

const ShvMaterial *shv_cohesive_material(const ShvModel *model, int32_t facet)
{
    const int32_t *elements = model->adjacency.facet_elements + 2 * (int64_t)facet;
    const ShvMaterial *first = shv_model_material(model, elements[0]), *second = shv_model_material(model, elements[1]);
    if (!first->breakable || !second->breakable) return NULL;
    return second->strength[SHV_NORMAL] < first->strength[SHV_NORMAL] ? second : first;
}

/* Of flaws in so much of a material and its surface. */
static double weakest_link(const ShvModel *model, const ShvMaterial *material, uint64_t index, double volume,
                           double area)
{
    double scale = -shv_log(shv_random_uniform(model->seed, index));
    if (material->weibull_volume > 0.0) scale *= material->weibull_volume / volume;
    if (material->weibull_area > 0.0) scale *= material->weibull_area / area;
    return shv_power(scale, 1.0 / material->weibull_modulus);
}

double shv_cohesive_strength_scale(const ShvModel *model, int32_t facet)
{
    const ShvMaterial *material = shv_cohesive_material(model, facet);
    if (!material || !(material->weibull_modulus > 0.0)) return 1.0;
    const int32_t *elements = model->adjacency.facet_elements + 2 * (int64_t)facet;
    const double both =
        shv_mesh_element_volume(&model->mesh, elements[0]) + shv_mesh_element_volume(&model->mesh, elements[1]);
    return weakest_link(model, material, (uint64_t)facet, 0.25 * both,
                        shv_norm(shv_cohesive_reference_area(model, facet)));
}

double shv_cohesive_node_strength(const ShvModel *model, int32_t node)
{
    const ShvAdjacency *adjacency = &model->adjacency;
    const int32_t first = adjacency->corner_start[node], end = adjacency->corner_start[node + 1];
    const ShvMaterial *material = shv_model_material(model, adjacency->corners[first] / 4);
    double volume = 0.0, area = 0.0;
    if (!(material->weibull_modulus > 0.0)) return material->strength[SHV_NORMAL];
    for (int32_t i = first; i < end; i++) {
        const int32_t corner = adjacency->corners[i];
        volume += 0.25 * shv_mesh_element_volume(&model->mesh, corner / 4);
        for (int face = 0; face < 4; face++) {
            const int32_t facet = adjacency->element_facets[4 * (int64_t)(corner / 4) + face];
            if (face != corner % 4 && facet >= adjacency->interior_count)
                area += shv_norm(shv_cohesive_reference_area(model, facet)) / 3.0;
        }
    }
    const uint64_t index = (uint64_t)adjacency->facet_count + (uint64_t)node;
    return material->strength[SHV_NORMAL] * weakest_link(model, material, index, volume, area);
}

double shv_cohesive_weakest(const ShvCohesive *cohesive, const int32_t *elements, int32_t count)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    double weakest = (double)INFINITY;
    if (!elements) {
        for (int32_t i = 0; i < adjacency->interior_count; i++)
            if (cohesive->facet_cohesive[i] < 0) weakest = fmin(weakest, cohesive->facet_strength[i]);
        return weakest;
    }
    for (int32_t k = 0; k < count; k++)
        for (int corner = 0; corner < 4; corner++) {
            const int32_t facet = adjacency->element_facets[4 * (int64_t)elements[k] + corner];
            if (facet < adjacency->interior_count && cohesive->facet_cohesive[facet] < 0)
                weakest = fmin(weakest, cohesive->facet_strength[facet]);
        }
    return weakest;
}
