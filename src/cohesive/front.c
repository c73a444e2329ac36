#include "cohesive/front.h"

#include <math.h>

#include "cohesive/cohesive.h"
#include "cohesive/frame.h"
#include "cohesive/storage.h"

/* What a facet of a crack still counts with at a node that it does not split: the crack goes on along facets that are there rather
   than along others beside them. With all of it strips grow at 1.1 to 1.5 times Griffith's load; with all of it as long as they have not
   opened, islands are cut out between two sheets. */
static const double strength_share_behind = 0.3;
/* A slit: the solid goes all the way round an edge but for less than ten degrees. */
static const double slit_angle = 6.1086523819801535;
/* Of the normal strength: a facet with a point that has less left has opened. */
static const double opened_share = 0.9;
/* Of the speed of shear waves: cracks in glass run no faster. */
static const double limit_speed = 0.5;
/* Of the time in which a front crosses a facet: checks are no rarer. */
static const double check_share = 0.25;
/* Facets less than 60° from where the crack came from are not ahead, */
static const double ahead_cosine = 0.5;
/* unless they go on from an opened one over an edge of both, turning by less than a right angle: where the front runs along
   the edge, both may lie on one side of the node. */
static const double straight_cosine = 0.0;
/* Between the pull and a crack's normal: cracks kink by 45° at most. */
static const double across_cosine = 0.7;
/* Of the solid angle round a node: what is left there when a crack has only cut an island out, whose two sides are not its flanks. */
static const double blunt_share = 0.75;

/* ---- strengths ---- */

static double mean_edge(const ShvModel *model, int32_t facet)
{
    const int32_t element = model->adjacency.facet_elements[2 * (int64_t)facet];
    const uint8_t *corners = shv_face_corners[model->adjacency.facet_faces[2 * (int64_t)facet]];
    const int32_t *nodes = model->mesh.elements + 4 * (int64_t)element;
    double sum = 0.0;
    for (int i = 0; i < 3; i++)
        sum += shv_norm(shv_sub(shv_mesh_position(&model->mesh, nodes[corners[(i + 1) % 3]]),
                                shv_mesh_position(&model->mesh, nodes[corners[i]])));
    return sum / 3.0;
}

double shv_front_tip_strength(const ShvModel *model, int32_t facet)
{
    const ShvMaterial *material = shv_cohesive_material(model, facet);
    if (!material || material->unresolved != SHV_UNRESOLVED_TIP_STRENGTH) return (double)INFINITY;
    return shv_material_tip_strength(material, mean_edge(model, facet));
}

static int32_t node_of(const ShvCohesive *cohesive, const ShvState *state, int32_t facet, int corner)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    const uint8_t *corners = shv_face_corners[adjacency->facet_faces[2 * (int64_t)facet]];
    return shv_state_node(state, adjacency->facet_elements[2 * (int64_t)facet], corners[corner]);
}

static int corner_of(const ShvCohesive *cohesive, const ShvState *state, int32_t facet, int32_t node)
{
    for (int i = 0; i < 3; i++)
        if (node_of(cohesive, state, facet, i) == node) return i;
    return -1;
}

double shv_front_strength(const ShvCohesive *cohesive, int32_t facet)
{
    const double strength = cohesive->facet_strength[facet];
    const bool ahead = cohesive->front.any && cohesive->front.ahead[facet] != 0;
    return ahead && cohesive->facet_cohesive[facet] < 0 ? fmin(strength, shv_front_tip_strength(cohesive->model, facet))
                                                        : strength;
}

ShvTip shv_front_tip(const ShvCohesive *cohesive, const ShvState *state, int32_t facet, int32_t node)
{
    ShvTip tip = {.strength = cohesive->facet_strength[facet]};
    if (!cohesive->front.any) return tip;
    const int32_t index = cohesive->facet_cohesive[facet];
    const uint8_t bits = cohesive->front.ahead[facet];
    if (index >= 0) {
        tip.behind = cohesive->opened[index];
        tip.lowered = tip.behind || (bits & SHV_FRONT_LOWERED);
        if (tip.lowered)
            tip.strength = strength_share_behind * fmin(tip.strength, shv_front_tip_strength(cohesive->model, facet));
        return tip;
    }
    const int corner = corner_of(cohesive, state, facet, node);
    tip.lowered = corner >= 0 && (bits >> corner & 1);
    if (tip.lowered) tip.strength = fmin(tip.strength, shv_front_tip_strength(cohesive->model, facet));
    return tip;
}

bool shv_front_is_across(ShvVec3 normal, ShvVec3 direction)
{
    return fabs(shv_dot(normal, direction)) > across_cosine * shv_norm(normal);
}

/* ---- fronts ---- */

/* Of the mesh, counted from a corner on. */
static int32_t mesh_node_of(const ShvCohesive *cohesive, int32_t facet, int corner)
{
    const ShvModel *model = cohesive->model;
    const int32_t element = model->adjacency.facet_elements[2 * (int64_t)facet];
    const uint8_t *corners = shv_face_corners[model->adjacency.facet_faces[2 * (int64_t)facet]];
    return model->mesh.elements[4 * (int64_t)element + corners[corner % 3]];
}

static ShvVec3 reference_of(const ShvCohesive *cohesive, int32_t facet, int corner)
{
    return shv_mesh_position(&cohesive->model->mesh, mesh_node_of(cohesive, facet, corner));
}

/* From a corner to the middle of the facet, at reference positions. */
static ShvVec3 flank(const ShvCohesive *cohesive, int32_t facet, int corner)
{
    const ShvVec3 middle =
        shv_scale(shv_add(reference_of(cohesive, facet, corner + 1), reference_of(cohesive, facet, corner + 2)), 0.5);
    return shv_unit(shv_sub(middle, reference_of(cohesive, facet, corner)));
}

/* From the edge between a corner and the one `turn` on, into the facet, square to the edge. */
static ShvVec3 into(const ShvCohesive *cohesive, int32_t facet, int corner, int turn)
{
    const ShvVec3 start = reference_of(cohesive, facet, corner);
    const ShvVec3 along = shv_unit(shv_sub(reference_of(cohesive, facet, corner + turn), start));
    const ShvVec3 side = shv_sub(reference_of(cohesive, facet, corner + 3 - turn), start);
    return shv_unit(shv_madd(side, -shv_dot(side, along), along));
}

/* Facets of a star, each once, whether or not both of their sides are in it. */
typedef void Visit(const ShvCohesive *cohesive, int32_t facet, int corner, void *context);

static int mesh_corner_of(const ShvCohesive *cohesive, int32_t facet, int32_t mesh_node)
{
    for (int i = 0; i < 2; i++)
        if (mesh_node_of(cohesive, facet, i) == mesh_node) return i;
    return 2;
}

static void visit_star(const ShvCohesive *cohesive, const ShvState *state, int32_t node, Visit *visit, void *context)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    for (int32_t i = 0; i < state->corner_count[node]; i++) {
        const int32_t at = state->corners[state->corner_start[node] + i], element = at / 4;
        for (int k = 0; k < 4; k++) {
            const int32_t facet = adjacency->element_facets[4 * (int64_t)element + k];
            if (k == at % 4 || facet >= adjacency->interior_count) continue;
            const int corner = mesh_corner_of(cohesive, facet, cohesive->model->mesh.elements[at]);
            const bool first = adjacency->facet_elements[2 * (int64_t)facet] == element;
            if (first || node_of(cohesive, state, facet, corner) != node) visit(cohesive, facet, corner, context);
        }
    }
}

/* Of a tet at one of its corners (van Oosterom and Strackee). */
static double solid_angle(const ShvMesh *mesh, int32_t corner)
{
    const int32_t *nodes = mesh->elements + 4 * (int64_t)(corner / 4);
    const ShvVec3 apex = shv_mesh_position(mesh, nodes[corner % 4]);
    ShvVec3 to[3];
    for (int i = 0; i < 3; i++)
        to[i] = shv_unit(shv_sub(shv_mesh_position(mesh, nodes[shv_face_corners[corner % 4][i]]), apex));
    const double cosines = shv_dot(to[0], to[1]) + shv_dot(to[1], to[2]) + shv_dot(to[2], to[0]);
    return 2.0 * atan2(fabs(shv_dot(to[0], shv_cross(to[1], to[2]))), 1.0 + cosines);
}

/* A crack has split the node, but left nearly all of the solid round it in one: it ends there, at an island that it cut out. */
static bool is_blunt(const ShvCohesive *cohesive, const ShvState *state, int32_t node)
{
    const ShvModel *model = cohesive->model;
    const int32_t *own = state->corners + state->corner_start[node], count = state->corner_count[node];
    const int32_t mesh_node = model->mesh.elements[own[0]];
    const int32_t *all = model->adjacency.corners + model->adjacency.corner_start[mesh_node];
    const int32_t all_count = model->adjacency.corner_start[mesh_node + 1] - model->adjacency.corner_start[mesh_node];
    double left = 0.0, whole = 0.0;
    if (count == all_count) return false;
    for (int32_t i = 0; i < count; i++) left += solid_angle(&model->mesh, own[i]);
    for (int32_t i = 0; i < all_count; i++) whole += solid_angle(&model->mesh, all[i]);
    return left > blunt_share * whole;
}

typedef struct Behind {
    const ShvState *state;
    int32_t node;
    bool blunt;
    ShvVec3 sum, normal; /* of the opened facets: of their flanks, and across them */
    int32_t count;
} Behind;

/* The crack reaches the node here, and ends. */
static bool has_opened(const ShvCohesive *cohesive, int32_t facet, int corner, bool blunt)
{
    const int32_t index = cohesive->facet_cohesive[facet];
    return index >= 0 && cohesive->opened[index] &&
           (blunt || cohesive->sides[index].first[corner] == cohesive->sides[index].second[corner]);
}

static void add_opened(const ShvCohesive *cohesive, int32_t facet, int corner, void *context)
{
    Behind *behind = context;
    if (!has_opened(cohesive, facet, corner, behind->blunt)) return;
    const ShvVec3 area = shv_cohesive_reference_area(cohesive->model, facet);
    const double sense = shv_dot(area, behind->normal) < 0.0 ? -1.0 : 1.0; /* either side counts */
    behind->normal = shv_madd(behind->normal, sense, area);
    behind->sum = shv_add(behind->sum, flank(cohesive, facet, corner));
    behind->count++;
}

typedef struct Continuation {
    int32_t facet;
    int corner;
    bool blunt, found;
} Continuation;

static void compare_opened(const ShvCohesive *cohesive, int32_t facet, int corner, void *context)
{
    Continuation *next = context;
    if (!has_opened(cohesive, facet, corner, next->blunt)) return;
    for (int i = 1; i < 3; i++)
        for (int k = 1; k < 3; k++)
            if (mesh_node_of(cohesive, facet, corner + i) == mesh_node_of(cohesive, next->facet, next->corner + k))
                next->found = next->found || shv_dot(into(cohesive, facet, corner, i),
                                                     into(cohesive, next->facet, next->corner, k)) < straight_cosine;
}

static bool is_ahead(const ShvCohesive *cohesive, int32_t facet, int corner, const Behind *behind)
{
    if (behind->count == 0) return false;
    if (shv_dot(flank(cohesive, facet, corner), behind->sum) < ahead_cosine * shv_norm(behind->sum)) return true;
    Continuation next = {facet, corner, behind->blunt, false};
    visit_star(cohesive, behind->state, behind->node, compare_opened, &next);
    return next.found;
}

static void lower(const ShvCohesive *cohesive, int32_t facet, int corner, void *context)
{
    if (cohesive->facet_cohesive[facet] >= 0) return;
    const bool ahead = is_ahead(cohesive, facet, corner, context);
    const uint8_t bit = (uint8_t)(1u << corner), now = cohesive->front.ahead[facet];
    const uint8_t then = (uint8_t)(ahead ? now | bit : now & ~bit);
    cohesive->front.ahead[facet] = then;
    if (then != now) shv_cohesive_weigh(cohesive, facet);
}

/* The end of a slit that has not been split. */
static bool is_slit(const ShvCohesive *cohesive, const ShvState *state, int32_t node)
{
    const int32_t *start = cohesive->model->adjacency.corner_start;
    if (node >= cohesive->model->mesh.node_count || state->corner_count[node] < start[node + 1] - start[node])
        return false;
    const ShvVec3 normal = cohesive->front.slit[node].normal;
    return shv_dot(normal, normal) > 0.0;
}

/* Of a crack that ends at the node, but for slits. */
static Behind find_behind(const ShvCohesive *cohesive, const ShvState *state, int32_t node, bool blunt)
{
    Behind behind = {.state = state, .node = node, .blunt = blunt};
    visit_star(cohesive, state, node, add_opened, &behind);
    return behind;
}

ShvVec3 shv_front_normal(const ShvCohesive *cohesive, const ShvState *state, int32_t node)
{
    if (is_slit(cohesive, state, node)) return cohesive->front.slit[node].normal;
    return is_blunt(cohesive, state, node) ? find_behind(cohesive, state, node, true).normal : shv_vec3(0.0, 0.0, 0.0);
}

static void update(ShvCohesive *cohesive, const ShvState *state, int32_t node, bool blunt)
{
    Behind behind = find_behind(cohesive, state, node, blunt);
    if (is_slit(cohesive, state, node)) {
        behind.count++;
        behind.sum = shv_add(behind.sum, cohesive->front.slit[node].flank);
    }
    visit_star(cohesive, state, node, lower, &behind);
    cohesive->search.held[node] = 0.0;
}

void shv_front_update(ShvCohesive *cohesive, const ShvState *state, int32_t node)
{
    update(cohesive, state, node, is_blunt(cohesive, state, node));
}

static double crossing_time(const ShvCohesive *cohesive, int32_t facet)
{
    const double speed = limit_speed * shv_cohesive_material(cohesive->model, facet)->shear_speed;
    return mean_edge(cohesive->model, facet) / speed;
}

static void find_speed_class(ShvCohesive *cohesive)
{
    double sum = 0.0;
    int64_t count = 0;
    for (int32_t facet = 0; facet < cohesive->model->adjacency.interior_count; facet++) {
        if (isinf(shv_front_tip_strength(cohesive->model, facet))) continue;
        sum += crossing_time(cohesive, facet);
        count++;
    }
    cohesive->front.crossing_time = count > 0 ? sum / (double)count : 0.0;
}

int32_t shv_front_steps(const ShvCohesive *cohesive, double step)
{
    if (!cohesive->front.any) return 1;
    return (int32_t)fmax(1.0, fmin(check_share * cohesive->front.crossing_time / step, INT16_MAX));
}

/* Where a crack may end: at a node that it has not split, or a blunt one. */
static void update_end(ShvCohesive *cohesive, const ShvState *state, int32_t node, bool whole)
{
    const bool blunt = is_blunt(cohesive, state, node);
    if (whole || blunt) update(cohesive, state, node, blunt);
}

void shv_front_open(ShvCohesive *cohesive, const ShvState *state, int32_t index)
{
    const ShvCohesiveSides *sides = &cohesive->sides[index];
    const int32_t facet = cohesive->facet[index];
    double least = 1.0;
    if (state->time - cohesive->born[index] < crossing_time(cohesive, facet)) return;
    for (int64_t k = 3 * (int64_t)index; k < 3 * (int64_t)index + 3; k++)
        least = fmin(least, shv_law_residual(&cohesive->law[index], cohesive->internal[k].history));
    if (least > opened_share) return;
    cohesive->opened[index] = true;
    for (int i = 0; i < 3; i++) {
        update_end(cohesive, state, sides->first[i], sides->first[i] == sides->second[i]);
        if (sides->first[i] != sides->second[i]) update_end(cohesive, state, sides->second[i], false);
    }
}

/* ---- slits ---- */

static double angle_at(const ShvMesh *mesh, const int32_t *nodes, int32_t a, int32_t b)
{
    ShvVec3 side[2];
    const ShvVec3 start = shv_mesh_position(mesh, a), along = shv_unit(shv_sub(shv_mesh_position(mesh, b), start));
    int count = 0;
    for (int i = 0; i < 4; i++) {
        if (nodes[i] == a || nodes[i] == b) continue;
        const ShvVec3 d = shv_sub(shv_mesh_position(mesh, nodes[i]), start);
        if (count < 2) side[count++] = shv_unit(shv_madd(d, -shv_dot(d, along), along));
    }
    return acos(fmax(-1.0, fmin(1.0, shv_dot(side[0], side[1]))));
}

static bool has_node(const int32_t *nodes, int32_t node)
{
    return nodes[0] == node || nodes[1] == node || nodes[2] == node || nodes[3] == node;
}

/* Of the solid round an edge. */
static double angle_round(const ShvModel *model, int32_t a, int32_t b)
{
    const ShvAdjacency *adjacency = &model->adjacency;
    double sum = 0.0;
    for (int32_t k = adjacency->corner_start[a]; k < adjacency->corner_start[a + 1]; k++) {
        const int32_t *nodes = model->mesh.elements + 4 * (int64_t)(adjacency->corners[k] / 4);
        if (has_node(nodes, b)) sum += angle_at(&model->mesh, nodes, a, b);
    }
    return sum;
}

static void add_slit(ShvSlit *slit, ShvVec3 normal, ShvVec3 flank)
{
    const double sense = shv_dot(normal, slit->normal) < 0.0 ? -1.0 : 1.0; /* either lip counts */
    slit->normal = shv_madd(slit->normal, sense, normal);
    slit->flank = shv_add(slit->flank, flank);
}

static void find_slit(ShvCohesive *cohesive, int32_t element, int face)
{
    const ShvMesh *mesh = &cohesive->model->mesh;
    const int32_t *nodes = mesh->elements + 4 * (int64_t)element;
    for (int i = 0; i < 3; i++) {
        const int32_t a = nodes[shv_face_corners[face][i]], b = nodes[shv_face_corners[face][(i + 1) % 3]];
        if (angle_round(cohesive->model, a, b) < slit_angle) continue;
        const ShvVec3 start = shv_mesh_position(mesh, a), along = shv_unit(shv_sub(shv_mesh_position(mesh, b), start));
        const ShvVec3 side = shv_sub(shv_mesh_position(mesh, nodes[shv_face_corners[face][(i + 2) % 3]]), start);
        const ShvVec3 flank = shv_unit(shv_madd(side, -shv_dot(side, along), along)), normal = shv_cross(along, flank);
        add_slit(&cohesive->front.slit[a], normal, flank);
        add_slit(&cohesive->front.slit[b], normal, flank);
    }
}

static void find_slits(ShvCohesive *cohesive)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    for (int32_t i = 0; i < 4 * cohesive->model->mesh.element_count; i++)
        if (adjacency->element_facets[i] >= adjacency->interior_count) find_slit(cohesive, i / 4, i % 4);
}

static const ShvMaterial *wants_tips(const ShvModel *model)
{
    for (int32_t i = 0; i < model->material_count; i++)
        if (model->materials[i].breakable && model->materials[i].unresolved == SHV_UNRESOLVED_TIP_STRENGTH)
            return &model->materials[i];
    return NULL;
}

ShvStatus shv_front_create(ShvCohesive *cohesive, ShvError *error)
{
    ShvFront *front = &cohesive->front;
    const size_t facets = (size_t)cohesive->model->adjacency.interior_count;
    const size_t nodes = (size_t)cohesive->model->mesh.node_count;
    const ShvMaterial *material = wants_tips(cohesive->model);
    *front = (ShvFront){.any = material != NULL};
    if (!material) return SHV_OK;
    if (cohesive->settings->criterion != SHV_CRITERION_FORCE)
        return shv_fail(error, SHV_BAD_INPUT,
                        "material '%s' has 'unresolved: tip_strength' (as brittle ones of the library do, unless they "
                        "give it), which "
                        "needs 'fracture: {criterion: force}': cracks go on node by node; give that criterion, or "
                        "'unresolved: keep'",
                        material->name);
    front->ahead = shv_allocate(cohesive->memory, SHV_PART_COHESIVE, facets, sizeof *front->ahead);
    front->slit = shv_allocate(cohesive->memory, SHV_PART_COHESIVE, nodes, sizeof *front->slit);
    if (!front->ahead || !front->slit)
        return shv_fail_memory(error, "fronts of cracks", facets + nodes * sizeof *front->slit);
    find_slits(cohesive);
    find_speed_class(cohesive);
    return SHV_OK;
}

void shv_front_release(ShvFront *front)
{
    shv_release(front->ahead);
    shv_release(front->slit);
    *front = (ShvFront){0};
}

void shv_front_start(ShvCohesive *cohesive, const ShvState *state)
{
    for (int32_t node = 0; cohesive->front.any && node < cohesive->model->mesh.node_count; node++)
        if (is_slit(cohesive, state, node)) shv_front_update(cohesive, state, node);
}
