#include <math.h>
#include <string.h>

#include "cohesive/solve.h"

void shv_cohesive_keep_pulls(ShvCohesive *cohesive)
{
    const int32_t count = cohesive->point_count, threads = cohesive->model->threads;
#pragma omp parallel for schedule(static) num_threads(threads) if (shv_cohesive_in_parallel(cohesive, count))
    for (int32_t i = 0; i < count; i++) cohesive->force[cohesive->points[i].point] = cohesive->points[i].last;
}

void shv_cohesive_drop_lists(ShvCohesive *cohesive)
{
    for (int32_t k = 0; k < cohesive->rotation_count; k++)
        cohesive->apart[cohesive->rotations[k].index] = -(double)INFINITY;
    cohesive->rotation_count = cohesive->point_count = cohesive->pair_count = cohesive->cluster_count = 0;
    cohesive->unlisted = true;
}

void shv_cohesive_drop_separated(ShvCohesive *cohesive)
{
    int32_t live = 0;
    for (int32_t k = 0; k < cohesive->live_count; k++)
        if (cohesive->phase[cohesive->live[k]] != SHV_COHESIVE_SEPARATED) cohesive->live[live++] = cohesive->live[k];
    cohesive->live_count = live;
}

static bool is_wanted(const ShvCohesive *cohesive, const ShvState *state, int32_t index, const uint8_t *awake)
{
    return cohesive->sides[index].split && !shv_cohesive_rests(cohesive, state, index, awake);
}

static int32_t origin_of(const ShvCohesive *cohesive, const ShvState *state, int32_t index)
{
    return state->origin[cohesive->sides[index].first[0]];
}

void shv_cohesive_sum_up(int32_t *fill, int32_t count)
{
    int32_t start = 0;
    for (int32_t i = 0; i < count; i++) {
        const int32_t size = fill[i];
        fill[i] = start;
        start += size;
    }
}

static bool carries(const ShvCohesive *cohesive, int32_t index)
{
    const ShvInternalVariables *point = cohesive->internal + 3 * (int64_t)index;
    return point[0].peak > 0.0 || point[1].peak > 0.0 || point[2].peak > 0.0;
}

/* All but the place in the list; returns how many corners are split. */
static int32_t fill_rotation(const ShvCohesive *cohesive, ShvFacetRotation *rotation)
{
    const int32_t index = rotation->index;
    const ShvCohesiveSides *sides = &cohesive->sides[index];
    int32_t split = 0;
    rotation->answers = rotation->news = false;
    rotation->carries = carries(cohesive, index);
    rotation->area = cohesive->area[index];
    rotation->returned = sides->returned;
    rotation->friction = sides->friction;
    for (int i = 0; i < 2; i++) rotation->reference[i] = sides->arm[i];
    for (int i = 0; i < 3; i++) {
        rotation->first[i] = sides->first[i];
        rotation->second[i] = sides->second[i];
        split += sides->first[i] != sides->second[i];
    }
    return split;
}

/* In order of the nodes that their first corners stem from, as positions and velocities stand. */
static void order_rotations(ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake)
{
    int32_t *fill = cohesive->origin_fill;
    const int32_t nodes = cohesive->model->mesh.node_count;
    cohesive->rotation_count = 0;
    for (int32_t k = 0; k < cohesive->live_count; k++)
        if (is_wanted(cohesive, state, cohesive->live[k], awake)) {
            fill[origin_of(cohesive, state, cohesive->live[k])]++;
            cohesive->rotation_count++;
        }
    shv_cohesive_sum_up(fill, nodes);
    for (int32_t k = 0; k < cohesive->live_count; k++) {
        const int32_t index = cohesive->live[k];
        const bool wanted = is_wanted(cohesive, state, index, awake);
        if (!wanted || !(cohesive->apart[index] > 0.0)) cohesive->apart[index] = -(double)INFINITY;
        if (wanted) cohesive->rotations[fill[origin_of(cohesive, state, index)]++].index = index;
    }
    memset(fill, 0, (size_t)nodes * sizeof *fill);
}

static void list_rotations(ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake)
{
    order_rotations(cohesive, state, awake);
    const int32_t count = cohesive->rotation_count, threads = cohesive->model->threads;
    int32_t pairs = 0;
#pragma omp parallel for schedule(static) num_threads(threads) if (shv_cohesive_in_parallel(cohesive, count))          \
    reduction(+ : pairs)
    for (int32_t k = 0; k < count; k++) {
        pairs += fill_rotation(cohesive, &cohesive->rotations[k]);
        if (cohesive->apart[cohesive->rotations[k].index] > 0.0)
            cohesive->gaps[k] = (ShvFacetGaps){0}; /* others when the step begins */
    }
    cohesive->pair_count = pairs;
}

/* Those at copies of one node of the mesh make a cluster: no two clusters share a node. */
static void list_corners(ShvCohesive *cohesive, const ShvState *state)
{
    int32_t *fill = cohesive->origin_fill;
    const int32_t nodes = cohesive->model->mesh.node_count;
    for (int32_t k = 0; k < cohesive->rotation_count; k++)
        for (int i = 0; cohesive->rotations[k].carries && i < 3; i++)
            fill[state->origin[cohesive->rotations[k].first[i]]]++;
    cohesive->cluster_count = 0;
    int32_t start = 0;
    for (int32_t node = 0; node < nodes; node++) {
        if (fill[node] == 0) continue;
        cohesive->cluster_corner[cohesive->cluster_count++] = start;
        start += fill[node];
        fill[node] = start - fill[node];
    }
    cohesive->cluster_corner[cohesive->cluster_count] = start;
    for (int32_t k = 0; k < cohesive->rotation_count; k++)
        for (int i = 0; cohesive->rotations[k].carries && i < 3; i++) {
            const ShvFacetRotation *rotation = &cohesive->rotations[k];
            cohesive->corners[fill[state->origin[rotation->first[i]]]++] =
                (ShvCohesiveCorner){rotation->first[i], rotation->second[i], 3 * k + i};
        }
    memset(fill, 0, (size_t)nodes * sizeof *fill);
}

static int64_t pair_key(const ShvCohesiveCorner *corner)
{
    const int32_t low = corner->first < corner->second ? corner->first : corner->second;
    const int32_t high = corner->first < corner->second ? corner->second : corner->first;
    return ((int64_t)low << 32) + high;
}

/* Pairs side by side, in order of facets; clusters are small. */
static void sort_pairs(ShvCohesiveCorner *corners, int32_t count)
{
    for (int32_t i = 1; i < count; i++) {
        const ShvCohesiveCorner corner = corners[i];
        const int64_t key = pair_key(&corner);
        int32_t k = i;
        for (; k > 0 && pair_key(&corners[k - 1]) > key; k--) corners[k] = corners[k - 1];
        corners[k] = corner;
    }
}

static void place_point(ShvCohesive *cohesive, const ShvCohesiveCorner *corner, ShvCohesivePoint *place)
{
    const int32_t rotation = corner->slot / 3, index = cohesive->rotations[rotation].index;
    const int32_t point = 3 * index + corner->slot % 3;
    const double weight = cohesive->area[index] / 3.0;
    *place = (ShvCohesivePoint){.first = corner->first,
                                .second = corner->second,
                                .point = point,
                                .rotation = rotation,
                                .weight = weight,
                                .start_energy =
                                    weight * cohesive->law[index].strength[SHV_NORMAL] * cohesive->sides[index].start,
                                .springs.history.normal = (double)NAN,
                                .last = cohesive->force[point]};
    cohesive->force[point] = shv_vec3(0.0, 0.0, 0.0);
}

static void count_blocks(ShvCohesivePoint *points, const ShvCohesiveCorner *corners, int32_t count)
{
    for (int32_t i = count - 1; i >= 0; i--)
        points[i].block =
            i + 1 < count && pair_key(&corners[i]) == pair_key(&corners[i + 1]) ? points[i + 1].block + 1 : 1;
}

/* Split corners come first in their cluster; returns how many. */
static int32_t split_first(ShvCohesive *cohesive, int32_t cluster)
{
    const int32_t start = cohesive->cluster_corner[cluster], end = cohesive->cluster_corner[cluster + 1];
    int32_t split = start;
    for (int32_t i = start; i < end; i++) {
        const ShvCohesiveCorner corner = cohesive->corners[i];
        cohesive->rotations[corner.slot / 3].cluster[corner.slot % 3] = cluster;
        if (corner.first == corner.second) continue;
        cohesive->corners[i] = cohesive->corners[split];
        cohesive->corners[split++] = corner;
    }
    sort_pairs(cohesive->corners + start, split - start);
    return split - start;
}

static void place_points(ShvCohesive *cohesive, int32_t cluster)
{
    const ShvCohesiveCorner *corners = cohesive->corners + cohesive->cluster_corner[cluster];
    ShvCohesivePoint *points = cohesive->points + cohesive->cluster[cluster];
    const int32_t count = cohesive->cluster[cluster + 1] - cohesive->cluster[cluster];
    for (int32_t i = 0; i < count; i++) place_point(cohesive, &corners[i], &points[i]);
    count_blocks(points, corners, count);
}

static void list_points(ShvCohesive *cohesive)
{
    const int32_t clusters = cohesive->cluster_count, threads = cohesive->model->threads;
#pragma omp parallel for schedule(static) num_threads(threads) if (shv_cohesive_in_parallel(cohesive, clusters))
    for (int32_t c = 0; c < clusters; c++) cohesive->cluster[c] = split_first(cohesive, c);
    cohesive->cluster[clusters] = 0;
    shv_cohesive_sum_up(cohesive->cluster, clusters + 1);
    cohesive->point_count = cohesive->cluster[clusters];
#pragma omp parallel for schedule(static) num_threads(threads) if (shv_cohesive_in_parallel(cohesive, clusters))
    for (int32_t c = 0; c < clusters; c++) place_points(cohesive, c);
}

static void list_node(ShvCohesive *cohesive, int32_t node)
{
    if (cohesive->node_news[node]) return;
    cohesive->node_news[node] = 1;
    cohesive->corner_nodes[cohesive->corner_node_count++] = node;
}

static void list_corner_nodes(ShvCohesive *cohesive, const ShvState *state)
{
    memset(cohesive->node_news, 0, (size_t)state->node_count);
    cohesive->corner_node_count = 0;
    for (int32_t i = 0; i < cohesive->cluster_corner[cohesive->cluster_count]; i++) {
        list_node(cohesive, cohesive->corners[i].first);
        list_node(cohesive, cohesive->corners[i].second);
    }
}

void shv_cohesive_list(ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake)
{
    shv_cohesive_drop_separated(cohesive);
    list_rotations(cohesive, state, awake);
    shv_cohesive_order_closing(cohesive, state);
    list_corners(cohesive, state);
    list_points(cohesive);
    list_corner_nodes(cohesive, state);
    for (int64_t i = 0; i < 3 * (int64_t)cohesive->rotation_count; i++) cohesive->couple[i] = shv_vec3(0.0, 0.0, 0.0);
    cohesive->list_awake = awake;
    cohesive->unlisted = false;
}
