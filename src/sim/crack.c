#include <string.h>

#include "shiver/simulation.h"
#include "sim/internal.h"

/* Union of inserted facets that share a node of the reference mesh: labels are the lowest insertion number reached. */
typedef struct Reach {
    uint8_t *node;  /* a reached facet has this node */
    uint8_t *facet; /* reached, per cohesive facet */
} Reach;

static void facet_nodes(const ShvModel *model, int32_t facet, int32_t nodes[3])
{
    const int32_t element = model->adjacency.facet_elements[2 * (int64_t)facet];
    const uint8_t face = model->adjacency.facet_faces[2 * (int64_t)facet];
    for (int i = 0; i < 3; i++) nodes[i] = model->mesh.elements[4 * (int64_t)element + shv_face_corners[face][i]];
}

static ShvVec3 centroid(const ShvModel *model, int32_t facet)
{
    int32_t nodes[3];
    facet_nodes(model, facet, nodes);
    const ShvVec3 sum =
        shv_add(shv_add(shv_mesh_position(&model->mesh, nodes[0]), shv_mesh_position(&model->mesh, nodes[1])),
                shv_mesh_position(&model->mesh, nodes[2]));
    return shv_scale(sum, 1.0 / 3.0);
}

/* Spreads from the first facet until a pass reaches nothing new; facets come in the order of insertion, so that a growing
   crack is mostly reached in one pass. */
static void spread(const ShvHybrid *hybrid, Reach *reach)
{
    const ShvCohesive *cohesive = &hybrid->cohesive;
    int32_t nodes[3];
    facet_nodes(&hybrid->model, cohesive->facet[0], nodes);
    for (int i = 0; i < 3; i++) reach->node[nodes[i]] = 1;
    for (bool again = true; again;) {
        again = false;
        for (int32_t k = 0; k < cohesive->count; k++) {
            if (reach->facet[k]) continue;
            facet_nodes(&hybrid->model, cohesive->facet[k], nodes);
            if (!reach->node[nodes[0]] && !reach->node[nodes[1]] && !reach->node[nodes[2]]) continue;
            for (int i = 0; i < 3; i++) reach->node[nodes[i]] = 1;
            reach->facet[k] = 1;
            again = true;
        }
    }
}

/* What a facet counts in the fit: a tough material opens a haze of facets by hair's breadths around the crack. */
static double weight(const ShvCohesive *cohesive, int32_t k)
{
    return cohesive->area[k] * shv_cohesive_facet_damage(cohesive, k);
}

/* Weighted mean of the reached facets' centroids; NaN where none is damaged. */
static ShvVec3 centre_of(const ShvHybrid *hybrid, const Reach *reach)
{
    const ShvCohesive *cohesive = &hybrid->cohesive;
    double sum = 0.0;
    ShvVec3 mean = shv_vec3(0.0, 0.0, 0.0);
    for (int32_t k = 0; k < cohesive->count; k++) {
        if (!reach->facet[k]) continue;
        sum += weight(cohesive, k);
        mean = shv_madd(mean, weight(cohesive, k), centroid(&hybrid->model, cohesive->facet[k]));
    }
    return sum > 0.0 ? shv_scale(mean, 1.0 / sum) : shv_vec3((double)NAN, (double)NAN, (double)NAN);
}

/* Normal of the plane that fits the reached facets best: the direction in which their centroids spread least. */
static ShvVec3 fitted_normal(const ShvHybrid *hybrid, const Reach *reach, ShvVec3 mean)
{
    const ShvCohesive *cohesive = &hybrid->cohesive;
    ShvMat3 spread_out = {{{0.0}}};
    for (int32_t k = 0; k < cohesive->count; k++) {
        if (!reach->facet[k]) continue;
        const ShvVec3 d = shv_sub(centroid(&hybrid->model, cohesive->facet[k]), mean);
        const double v[3] = {d.x, d.y, d.z};
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++) spread_out.m[i][j] += weight(cohesive, k) * v[i] * v[j];
    }
    if (!shv_finite3(mean)) return mean;
    double values[3];
    ShvMat3 vectors;
    shv_symmetric_eigen(&spread_out, values, &vectors);
    return shv_vec3(vectors.m[0][0], vectors.m[1][0], vectors.m[2][0]);
}

ShvStatus shv_simulation_crack(const ShvSimulation *simulation, ShvCrackView *crack, ShvError *error)
{
    const ShvHybrid *hybrid = &simulation->hybrid;
    *crack = (ShvCrackView){.origin = {(double)NAN, (double)NAN, (double)NAN},
                            .centre = {(double)NAN, (double)NAN, (double)NAN},
                            .normal = {(double)NAN, (double)NAN, (double)NAN}};
    if (!hybrid->model.can_break || hybrid->cohesive.count == 0) return SHV_OK;
    const size_t nodes = (size_t)hybrid->model.mesh.node_count, facets = (size_t)hybrid->cohesive.count;
    Reach reach = {.node = shv_allocate(simulation->memory, SHV_PART_GENERAL, nodes, 1),
                   .facet = shv_allocate(simulation->memory, SHV_PART_GENERAL, facets, 1)};
    ShvStatus status = SHV_OK;
    if (reach.node && reach.facet) {
        spread(hybrid, &reach);
        for (size_t k = 0; k < facets; k++) crack->facets += reach.facet[k];
        shv_store3(crack->origin, centroid(&hybrid->model, hybrid->cohesive.facet[0]));
        const ShvVec3 centre = centre_of(hybrid, &reach);
        shv_store3(crack->centre, centre);
        shv_store3(crack->normal, fitted_normal(hybrid, &reach, centre));
    } else {
        status = shv_fail_memory(error, "the first crack", nodes + facets);
    }
    shv_release(reach.node);
    shv_release(reach.facet);
    return status;
}
