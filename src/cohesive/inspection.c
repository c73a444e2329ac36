#include "cohesive/inspection.h"

#include <math.h>
#include <omp.h>

/* Where nothing has cracked yet, this much more is asked of the force: of many nodes that reach their strength together, one that
   begins relieves the others first. Where the tension of the surface decides, waiting beside a young crack does that (is_waiting). */
static const double nucleation_margin = 0.03;

/* Of the threshold: at the fronts of cracks intact facets reach this much before their disks part. */
static const double front_share = 0.8;

double shv_inspection_level(const ShvCohesive *cohesive)
{
    const ShvFractureDefinition *settings = cohesive->settings;
    return settings->threshold * (settings->criterion == SHV_CRITERION_FORCE ? front_share : 1.0);
}

void shv_inspection_want(ShvInspection *inspection, int32_t element)
{
    ShvCohesive *cohesive = inspection->cohesive;
    const int32_t batch = element / SHV_LANES;
    if (cohesive->stress_known[batch]) return;
    cohesive->stress_known[batch] = 1;
    cohesive->asked[inspection->asked++] = batch;
}

void shv_inspection_get(ShvInspection *inspection)
{
    const ShvCohesive *cohesive = inspection->cohesive;
    const ShvStressSource source = inspection->source;
    if (inspection->asked > 0) source.fill(source.context, cohesive->asked, inspection->asked);
    for (int32_t k = 0; k < inspection->asked; k++) cohesive->stress_known[cohesive->asked[k]] = 0;
    inspection->asked = 0;
}

/* Times in which a front crosses a facet: so long a crack that has just begun takes to unload what is beside it. */
static const double unloading_crossings = 3.0;

/* ---- nodes ---- */

/* A node that held is looked at again when its largest facet has grown or fallen by these shares: forces round it follow. Where no facet
   passes on half of what would part it, by so much more of what is left to the half: fronts that run are nearer than that, and a crack
   that waited for them branched 12 µs late. */
static const double grown = 0.005, fallen = 0.02, of_what_is_left = 0.2;

static void suspect(ShvStarSearch *search, int32_t node, double value, int32_t *count)
{
    if (search->value[node] == 0.0) search->nodes[(*count)++] = node;
    search->value[node] = shv_larger(search->value[node], value);
}

static bool needs_evaluation(const ShvStarSearch *search, int32_t node)
{
    const double value = search->value[node], held = search->held[node], more = of_what_is_left * search->left[node];
    return value > (1.0 + grown + more) * held || value < (1.0 - fallen - more) * held;
}

static void want_star(ShvInspection *inspection, int32_t node)
{
    const ShvState *state = inspection->state;
    for (int32_t k = 0; k < state->corner_count[node]; k++)
        shv_inspection_want(inspection, state->corners[state->corner_start[node] + k] / 4);
}

static int32_t list_nodes(ShvInspection *inspection)
{
    const ShvState *state = inspection->state;
    ShvCohesive *cohesive = inspection->cohesive;
    ShvStarSearch *search = &cohesive->search;
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    const double level = shv_inspection_level(cohesive);
    int32_t count = 0, kept = 0;
    for (int32_t i = 0; i < cohesive->watched_count; i++) {
        const int64_t facet = cohesive->watched[i];
        const double value = cohesive->facet_value[facet];
        if (value < level) continue;
        const int32_t element = adjacency->facet_elements[2 * facet];
        const uint8_t *corners = shv_face_corners[adjacency->facet_faces[2 * facet]];
        for (int k = 0; k < 3; k++) suspect(search, shv_state_node(state, element, corners[k]), value, &count);
    }
    for (int32_t i = 0; i < count; i++) {
        const int32_t node = search->nodes[i];
        const bool looked_at = needs_evaluation(search, node);
        if (looked_at) search->held[node] = search->value[node];
        search->value[node] = 0.0;
        if (!looked_at) continue;
        search->nodes[kept++] = node;
        want_star(inspection, node);
    }
    return kept;
}

/* Nodes at the surface where cracks may begin, behind those that are listed already; returns how many there are then. */
static int32_t add_surface_nodes(ShvInspection *inspection, int32_t count, double *largest)
{
    ShvCohesive *cohesive = inspection->cohesive;
    ShvStarSearch *search = &cohesive->search;
    int32_t more = 0;
    if (!cohesive->front.any) return count;
    for (int32_t i = 0; i < count; i++) search->mark[search->nodes[i]] = 1;
    *largest = fmax(*largest, shv_initiation_list(cohesive, inspection->state, search->nodes + count, &more));
    for (int32_t i = count; i < count + more; i++) want_star(inspection, search->nodes[i]);
    for (int32_t i = 0; i < count + more; i++) search->mark[search->nodes[i]] = 0;
    return count + more;
}

static bool is_cracked(const ShvCohesive *cohesive, const ShvState *state, int32_t node)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    for (int32_t i = 0; i < state->corner_count[node]; i++) {
        const int32_t corner = state->corners[state->corner_start[node] + i];
        for (int k = 0; k < 4; k++) {
            const int32_t facet = adjacency->element_facets[4 * (int64_t)(corner / 4) + k];
            if (k != corner % 4 && facet < adjacency->interior_count && cohesive->facet_cohesive[facet] >= 0)
                return true;
        }
    }
    return false;
}

/* Near a crack that has just begun nothing else begins until it could have unloaded what is there. */
static bool is_waiting(const ShvCohesive *cohesive, const ShvState *state, int32_t node)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    for (int32_t i = 0; i < state->corner_count[node]; i++) {
        const int32_t element = state->corners[state->corner_start[node] + i] / 4;
        for (int k = 0; k < 4; k++) {
            const int32_t facet = adjacency->element_facets[4 * (int64_t)element + k];
            const int32_t index = facet < adjacency->interior_count ? cohesive->facet_cohesive[facet] : -1;
            if (index >= 0 && state->time - cohesive->born[index] < unloading_crossings * cohesive->front.crossing_time)
                return true;
        }
    }
    return false;
}

/* At the surface of a body, away from cracks, stress decides as well as force (initiation.h). */
static void find_surface_disk(const ShvInspection *inspection, ShvStar *star, int32_t node, double least)
{
    const ShvCohesive *cohesive = inspection->cohesive;
    const ShvState *state = inspection->state;
    if (!cohesive->front.any || node >= cohesive->model->mesh.node_count) return;
    if (isinf(cohesive->initiation.strength[node]) || is_waiting(cohesive, state, node)) return;
    const ShvVec3 slit = shv_front_normal(cohesive, state, node);
    const ShvSurfaceTension tension = shv_initiation_tension(cohesive, state, node);
    if (shv_dot(slit, slit) > 0.0 || tension.stress < least * cohesive->initiation.strength[node]) return;
    shv_star_begin(star, cohesive, state, inspection->stress, node, tension, least);
}

static void find_disk(const ShvInspection *inspection, ShvStar *star, int32_t node)
{
    const ShvCohesive *cohesive = inspection->cohesive;
    const double least = cohesive->settings->threshold;
    const bool cracked = is_cracked(cohesive, inspection->state, node);
    const double needed = cracked ? least : least * (1.0 + nucleation_margin);
    shv_star_evaluate(star, cohesive, inspection->state, inspection->stress, node, needed);
    if (!cracked && star->disk_count == 0) find_surface_disk(inspection, star, node, least);
}

/* What it shares tets with has other forces from now on. */
static void mark_star(const ShvInspection *inspection, int32_t node, uint8_t mark)
{
    const ShvState *state = inspection->state;
    for (int32_t i = 0; i < state->corner_count[node]; i++) {
        const int32_t element = state->corners[state->corner_start[node] + i] / 4;
        for (int corner = 0; corner < 4; corner++) {
            const int32_t other = shv_state_node(state, element, corner);
            inspection->cohesive->search.mark[other] = mark;
            inspection->cohesive->search.held[other] = 0.0;
        }
    }
}

/* The disk that `find_disk` has just found. */
static void take_disk(const ShvInspection *inspection, const ShvStar *star, int32_t *candidates, double *overstress,
                      int32_t *count)
{
    const ShvCohesive *cohesive = inspection->cohesive;
    for (int32_t k = 0; k < star->disk_count; k++) {
        const ShvStarFacet *facet = &star->facets[star->disk[k]];
        cohesive->search.facet_along[facet->facet] =
            shv_smaller(fabs(shv_dot(facet->area, star->direction)) / shv_norm(facet->area), 1.0);
        if (cohesive->front.any) {
            const bool lowered = star->goes_on && facet->tip.lowered;
            cohesive->front.ahead[facet->facet] = lowered ? SHV_FRONT_LOWERED : 0;
            if (lowered) cohesive->facet_strength[facet->facet] = star->projected_share * facet->tip.strength;
        }
        candidates[*count] = facet->facet;
        overstress[(*count)++] = star->ratio;
    }
}

/* With fewer suspects than so many threads do not pay. */
enum { FEWEST_PARALLEL = 64 };

/* Each by itself, and by none of what others find. Leaves ratios, 0 where nothing parts. */
static void judge_suspects(const ShvInspection *inspection, int32_t count)
{
    const ShvCohesive *cohesive = inspection->cohesive;
    const ShvStarSearch *search = &cohesive->search;
    const int32_t stars = search->stars.count;
    const int32_t threads = cohesive->model->threads < stars ? cohesive->model->threads : stars;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1 && count >= FEWEST_PARALLEL)
    for (int32_t i = 0; i < count; i++) {
        ShvStar *star = &search->stars.items[omp_get_thread_num()];
        find_disk(inspection, star, search->nodes[i]);
        search->left[search->nodes[i]] = shv_larger(1.0 - 2.0 * star->nearest, 0.0);
        search->ratio[i] = star->disk_count > 0 ? star->ratio : 0.0;
    }
}

/* Leaves those that part; returns how many. */
static int32_t keep_parting(ShvStarSearch *search, int32_t count)
{
    int32_t parting = 0;
    for (int32_t i = 0; i < count; i++) {
        if (!(search->ratio[i] > 0.0)) continue;
        search->held[search->nodes[i]] = 0.0;
        search->nodes[parting] = search->nodes[i];
        search->ratio[parting++] = search->ratio[i];
    }
    return parting;
}

void shv_inspection_find_disks(ShvInspection *inspection, int32_t *candidates, double *overstress, int32_t *count,
                               double *largest)
{
    ShvStarSearch *search = &inspection->cohesive->search;
    ShvStar *star = &search->stars.items[0];
    const int32_t suspects = add_surface_nodes(inspection, list_nodes(inspection), largest);
    *count = 0;
    shv_inspection_get(inspection);
    judge_suspects(inspection, suspects);
    const int32_t parting = keep_parting(search, suspects);
    shv_sort_descending(search->nodes, search->ratio, parting);
    for (int32_t i = 0; i < parting; i++) {
        if (search->mark[search->nodes[i]]) continue;
        find_disk(inspection, star, search->nodes[i]);
        take_disk(inspection, star, candidates, overstress, count);
        mark_star(inspection, search->nodes[i], 1);
    }
    for (int32_t i = 0; i < parting; i++) mark_star(inspection, search->nodes[i], 0);
}

/* ---- descending order, ties by number: heap sort with the last in order at the root ---- */

static bool after(const int32_t *numbers, const double *values, int32_t a, int32_t b)
{
    return values[a] < values[b] || (values[a] == values[b] && numbers[a] > numbers[b]);
}

static void swap(int32_t *numbers, double *values, int32_t a, int32_t b)
{
    const int32_t number = numbers[a];
    const double value = values[a];
    numbers[a] = numbers[b];
    values[a] = values[b];
    numbers[b] = number;
    values[b] = value;
}

static void sift(int32_t *numbers, double *values, int32_t root, int32_t count)
{
    for (int64_t child = 2 * (int64_t)root + 1; child < count; child = 2 * (int64_t)root + 1) {
        int32_t last = (int32_t)child;
        if (last + 1 < count && after(numbers, values, last + 1, last)) last++;
        if (!after(numbers, values, last, root)) return;
        swap(numbers, values, root, last);
        root = last;
    }
}

void shv_sort_descending(int32_t *numbers, double *values, int32_t count)
{
    for (int32_t root = count / 2 - 1; root >= 0; root--) sift(numbers, values, root, count);
    for (int32_t end = count - 1; end > 0; end--) {
        swap(numbers, values, 0, end);
        sift(numbers, values, 0, end);
    }
}
