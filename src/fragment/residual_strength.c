#include "fragment/residual_strength.h"

#include <stdlib.h>

#include "base/disjoint_sets.h"
#include "base/sorted.h"
#include "cohesive/frame.h"

/* Sections smaller than this share of the largest are ends of the body, a tet or two thick, and no cuts of it. */
static const double least_section = 0.1;

typedef struct Cut {
    double force, area;  /* N, m² */
    double energy;       /* J */
    int32_t unbreakable; /* facets in it without a finite strength, whose force is not counted, */
    int32_t endless;     /* and without a finite energy */
} Cut;

/* An interior facet of the fragment. */
typedef struct Joint {
    int32_t sides[2]; /* places of its tets among the fragment's */
    ShvVec3 area;     /* m² */
    double strength;  /* Pa: that of the facet without cracks, */
    double residual;  /* and what is left of it */
    double energy;    /* J: work to open it from closed */
    bool inserted;
} Joint;

typedef struct Station {
    double at; /* m: of a tet's centroid along an axis */
    int32_t place;
} Station;

typedef struct Search {
    const ShvCohesive *cohesive;
    const ShvState *state;
    int32_t object;
    const int32_t *elements; /* of the fragment, increasing */
    int32_t count;
    Joint *joints;
    int32_t joint_count;
    int32_t *root; /* per tet of the fragment, as all below */
    Cut *cuts;
    Station *stations;
    int32_t *rank;
    ShvResidual least; /* so far */
} Search;

static void offer(Search *search, Cut cut)
{
    if (!(cut.area > 0.0) || cut.unbreakable > 0) return;
    search->least.strength = shv_smaller(search->least.strength, shv_larger(cut.force, 0.0) / cut.area);
    if (cut.endless == 0) search->least.energy = shv_smaller(search->least.energy, shv_larger(cut.energy, 0.0));
}

/* `sign`: −1 takes it out again. */
static void add(Cut *cut, const Joint *joint, double area, int sign)
{
    cut->area += sign * area;
    if (isfinite(joint->residual))
        cut->force += sign * area * joint->residual;
    else
        cut->unbreakable += sign;
    if (isfinite(joint->energy))
        cut->energy += sign * area / shv_norm(joint->area) * joint->energy;
    else
        cut->endless += sign;
}

/* Mean residual normal strength over the points of a cohesive facet, Pa. */
static double residual(const ShvCohesive *cohesive, int32_t index)
{
    double sum = 0.0;
    if (!cohesive->bonded[index]) return 0.0;
    for (int64_t k = 3 * (int64_t)index; k < 3 * (int64_t)index + 3; k++)
        sum += shv_law_residual(&cohesive->law[index], cohesive->internal[k].history);
    return cohesive->law[index].strength[SHV_NORMAL] * sum / 3.0;
}

/* Work to open a facet from closed, J; an inserted one as its points are, one without cracks with the whole of its energy. */
static double opening_work(const ShvCohesive *cohesive, int32_t facet, double area)
{
    const int32_t index = cohesive->facet_cohesive[facet];
    if (index < 0) {
        const ShvMaterial *material = shv_cohesive_material(cohesive->model, facet);
        return material ? area * material->fracture_energy[SHV_NORMAL] : (double)INFINITY;
    }
    double sum = 0.0;
    for (int64_t k = 3 * (int64_t)index; cohesive->bonded[index] && k < 3 * (int64_t)index + 3; k++)
        sum += shv_law_remaining(&cohesive->law[index], cohesive->internal[k].history);
    return area * sum / 3.0;
}

/* Each facet once, from the tet of lower number. */
static void list_joints(Search *search)
{
    const ShvCohesive *cohesive = search->cohesive;
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    const int32_t *owner = search->state->element_fragment;
    for (int32_t i = 0; i < 4 * search->count; i++) {
        const int32_t element = search->elements[i / 4];
        const int32_t facet = adjacency->element_facets[4 * (int64_t)element + i % 4];
        if (facet >= adjacency->interior_count) continue;
        const int32_t *sides = adjacency->facet_elements + 2 * (int64_t)facet;
        const int32_t other = sides[0] == element ? sides[1] : sides[0], index = cohesive->facet_cohesive[facet];
        if (other < element || owner[other] != owner[element]) continue;
        const double strength = cohesive->facet_strength[facet];
        const ShvVec3 area = shv_cohesive_reference_area(cohesive->model, facet);
        search->joints[search->joint_count++] =
            (Joint){.sides = {i / 4, shv_sorted_place(search->elements, search->count, other)},
                    .area = area,
                    .strength = strength,
                    .residual = index < 0 ? strength : residual(cohesive, index),
                    .energy = opening_work(cohesive, facet, shv_norm(area)),
                    .inserted = index >= 0};
    }
}

/* The cuts round the parts that intact facets, and bonds with at least a share of their strength, hold together. */
static void cut_round_parts(Search *search, double share)
{
    for (int32_t i = 0; i < search->count; i++) search->root[i] = i;
    for (int32_t i = 0; i < search->count; i++) search->cuts[i] = (Cut){0};
    for (int32_t k = 0; k < search->joint_count; k++) {
        const Joint *joint = &search->joints[k];
        if (!joint->inserted || joint->residual >= share * joint->strength)
            shv_set_join(search->root, joint->sides[0], joint->sides[1]);
    }
    for (int32_t k = 0; k < search->joint_count; k++) {
        const Joint *joint = &search->joints[k];
        const int32_t parts[2] = {shv_set_root(search->root, joint->sides[0]),
                                  shv_set_root(search->root, joint->sides[1])};
        const double area = shv_norm(joint->area);
        for (int side = 0; side < 2 && parts[0] != parts[1]; side++) add(&search->cuts[parts[side]], joint, area, 1);
    }
    for (int32_t i = 0; i < search->count; i++) offer(search, search->cuts[i]);
}

static int by_place(const void *a, const void *b)
{
    const Station *first = a, *second = b;
    if (first->at != second->at) return first->at < second->at ? -1 : 1;
    return (first->place > second->place) - (first->place < second->place);
}

/* Ranks the tets by their centroids along an axis. */
static void rank_along(Search *search, ShvVec3 axis)
{
    const ShvMesh *mesh = &search->cohesive->model->mesh;
    for (int32_t i = 0; i < search->count; i++) {
        double at = 0.0;
        for (int a = 0; a < 4; a++)
            at += 0.25 * shv_dot(axis, shv_mesh_position(mesh, mesh->elements[4 * (int64_t)search->elements[i] + a]));
        search->stations[i] = (Station){at, i};
    }
    qsort(search->stations, (size_t)search->count, sizeof *search->stations, by_place);
    for (int32_t i = 0; i < search->count; i++) search->rank[search->stations[i].place] = i;
}

/* Section i lies between the tets of rank i and i + 1: a facet crosses all sections between the ranks of its tets. */
static void cut_across(Search *search, ShvVec3 axis)
{
    rank_along(search, axis);
    for (int32_t i = 0; i < search->count; i++) search->cuts[i] = (Cut){0};
    for (int32_t k = 0; k < search->joint_count; k++) {
        const Joint *joint = &search->joints[k];
        const double area = fabs(shv_dot(joint->area, axis));
        const int32_t a = search->rank[joint->sides[0]], b = search->rank[joint->sides[1]];
        add(&search->cuts[a < b ? a : b], joint, area, 1);
        add(&search->cuts[a < b ? b : a], joint, area, -1);
    }
    double largest = 0.0;
    for (int32_t i = 0; i < search->count; i++) {
        if (i > 0) search->cuts[i].area += search->cuts[i - 1].area;
        if (i > 0) search->cuts[i].force += search->cuts[i - 1].force;
        if (i > 0) search->cuts[i].energy += search->cuts[i - 1].energy;
        if (i > 0) search->cuts[i].unbreakable += search->cuts[i - 1].unbreakable;
        if (i > 0) search->cuts[i].endless += search->cuts[i - 1].endless;
        largest = shv_larger(largest, search->cuts[i].area);
    }
    for (int32_t i = 0; i < search->count; i++)
        if (search->cuts[i].area > least_section * largest) offer(search, search->cuts[i]);
}

static void search_cuts(Search *search, const ShvMat3 *inertia)
{
    static const double shares[] = {HUGE_VAL, 0.75, 0.5, 0.25, 0.1, 0.05};
    double values[3];
    ShvMat3 axes;
    list_joints(search);
    for (size_t i = 0; i < sizeof shares / sizeof shares[0]; i++) cut_round_parts(search, shares[i]);
    shv_symmetric_eigen(inertia, values, &axes);
    for (int k = 0; k < 3; k++) cut_across(search, shv_vec3(axes.m[0][k], axes.m[1][k], axes.m[2][k]));
}

static void release(Search *search)
{
    shv_release(search->joints);
    shv_release(search->root);
    shv_release(search->cuts);
    shv_release(search->stations);
    shv_release(search->rank);
}

ShvStatus shv_fragment_residual_strength(ShvFragments *fragments, const ShvCohesive *cohesive, const ShvState *state,
                                         int32_t index, ShvResidual *residual, ShvError *error)
{
    const ShvFragment *fragment = &fragments->items[index];
    const size_t count = (size_t)fragment->element_count;
    Search search = {.cohesive = cohesive,
                     .state = state,
                     .object = fragment->object,
                     .elements = fragments->elements + fragment->element_begin,
                     .count = fragment->element_count};
    search.least = (ShvResidual){shv_cohesive_weakest(cohesive, search.elements, search.count), (double)INFINITY};
    *residual = search.least;
    if (!fragment->cracked || !fragments->bonds) return SHV_OK;
    search.joints = shv_allocate(fragments->memory, SHV_PART_RIGID, 4 * count, sizeof *search.joints);
    search.root = shv_allocate(fragments->memory, SHV_PART_RIGID, count, sizeof *search.root);
    search.cuts = shv_allocate(fragments->memory, SHV_PART_RIGID, count, sizeof *search.cuts);
    search.stations = shv_allocate(fragments->memory, SHV_PART_RIGID, count, sizeof *search.stations);
    search.rank = shv_allocate(fragments->memory, SHV_PART_RIGID, count, sizeof *search.rank);
    const bool room = search.joints && search.root && search.cuts && search.stations && search.rank;
    if (room) search_cuts(&search, &fragment->inertia);
    if (room) *residual = search.least;
    release(&search);
    return room ? SHV_OK
                : shv_fail_memory(error, "the strength of a cracked body",
                                  count * (4 * sizeof(Joint) + sizeof(Cut) + sizeof(Station) + 8));
}
