/* The stiffness of bars if none fought its neighbours. A bar of reduced mass m that n projections by k leave r = (1 − k)^n of its
   error, stretches under a steady relative acceleration g by g Δt² r/(1 − r): it acts as a spring m (1 − r)/(r Δt²).
   In a stretch ε along the axis, with the lateral contraction ν ε, an edge at the angle θ to it changes its length by
   h (cos²θ − ν sin²θ) ε. Springs beside the solid then make it stiffer by 1 + Σ K h² (cos²θ − ν sin²θ)²/(E V). */
#include <stdlib.h>

#include "stability/stability.h"

typedef struct Edge {
    int32_t ends[2];
} Edge;

static int compare_edges(const void *a, const void *b)
{
    const Edge *p = a, *q = b;
    for (int i = 0; i < 2; i++)
        if (p->ends[i] != q->ends[i]) return p->ends[i] < q->ends[i] ? -1 : 1;
    return 0;
}

static int64_t list_edges(const ShvProbe *probe, Edge *edges)
{
    const ShvObject *object = &probe->hybrid.model.objects[0];
    int64_t count = 0;
    for (int32_t e = object->element_begin; e < object->element_end; e++)
        for (int a = 0; a < 4; a++)
            for (int b = a + 1; b < 4; b++) {
                const int32_t i = shv_state_node(&probe->hybrid.state, e, a);
                const int32_t k = shv_state_node(&probe->hybrid.state, e, b);
                edges[count++] = (Edge){{i < k ? i : k, i < k ? k : i}};
            }
    qsort(edges, (size_t)count, sizeof *edges, compare_edges);
    return count;
}

static double weight_of(const ShvProbe *probe, const Edge *edge)
{
    const ShvHybrid *hybrid = &probe->hybrid;
    const ShvMaterial *material = &hybrid->model.materials[hybrid->model.objects[0].material];
    const int64_t a = edge->ends[0], b = edge->ends[1];
    const ShvVec3 d = shv_sub(shv_load3(hybrid->state.reference + 3 * b), shv_load3(hybrid->state.reference + 3 * a));
    const double square = shv_dot(d, d), along = shv_dot(d, probe->axis), cosine2 = along * along / square;
    const double change = cosine2 - material->poissons_ratio * (1.0 - cosine2);
    const double mass = 1.0 / (1.0 / hybrid->state.mass[a] + 1.0 / hybrid->state.mass[b]);
    return mass * square * change * change / (material->youngs_modulus * hybrid->fragments.items[0].volume);
}

ShvStatus shv_bars_alone(ShvProbe *probe, ShvError *error)
{
    const ShvObject *object = &probe->hybrid.model.objects[0];
    ShvBarsAlone *bars = &probe->bars;
    const size_t most = 6 * (size_t)(object->element_end - object->element_begin);
    Edge *edges = shv_pool_take(&probe->pool, most, sizeof *edges);
    bars->weight = shv_pool_take(&probe->pool, most, sizeof *bars->weight);
    bars->visits = shv_pool_take(&probe->pool, most, sizeof *bars->visits);
    if (probe->pool.failed) return shv_fail_memory(error, "edges", most * (sizeof *edges + 12));
    const int64_t count = list_edges(probe, edges);
    for (int64_t i = 0; i < count; i++) {
        if (i == 0 || compare_edges(&edges[i], &edges[i - 1]) != 0)
            bars->weight[bars->count++] = weight_of(probe, &edges[i]);
        bars->visits[bars->count - 1]++;
    }
    if (probe->scene.pbd.form == SHV_BARS_EDGE)
        for (int32_t i = 0; i < bars->count; i++) bars->visits[i] = 1;
    return SHV_OK;
}

double shv_bars_alone_stiffness(const ShvBarsAlone *bars, double stiffness, int32_t iterations, double step)
{
    double sum = 0.0;
    for (int32_t i = 0; i < bars->count && iterations > 0; i++) {
        const double left = pow(1.0 - stiffness, (double)iterations * bars->visits[i]);
        sum += bars->weight[i] * (1.0 - left) / (left * step * step);
    }
    return 1.0 + sum;
}
