#include "cohesive/initiation.h"

#include <math.h>

#include "cohesive/cohesive.h"
#include "cohesive/traction.h"

/* Cosine between the normals of two faces of one smooth surface. */
static const double smooth_cosine = 0.70710678118654752;

/* ---- a face ---- */

typedef struct Face {
    ShvVec3 area;    /* outward, m² */
    double tension;  /* largest principal stress in its plane, Pa */
    double plane[3]; /* stress in its own axes: xx, yy, xy */
    ShvVec3 axes[2];
} Face;

/* Plane stress in the face's own axes (xx, yy, xy) from the change of its metric, and those axes as they stand now. */
static void plane_stress(const ShvMaterial *material, const ShvVec3 reference[2], const ShvVec3 change[2],
                         double stress[3], ShvVec3 axes[2])
{
    const double length = shv_norm(reference[0]);
    const ShvVec3 along = shv_scale(reference[0], 1.0 / length);
    const double skew = shv_dot(reference[1], along);
    const double height = shv_norm(shv_madd(reference[1], -skew, along));
    double metric[3]; /* of 2 E: 00, 11, 01 */
    for (int i = 0; i < 2; i++) metric[i] = 2.0 * shv_dot(reference[i], change[i]) + shv_dot(change[i], change[i]);
    metric[2] = shv_dot(reference[0], change[1]) + shv_dot(reference[1], change[0]) + shv_dot(change[0], change[1]);
    /* inverse of the edges: (a, b; 0, c) */
    const double a = 1.0 / length, b = -skew / (length * height), c = 1.0 / height;
    const double xx = 0.5 * a * a * metric[0];
    const double yy = 0.5 * (b * b * metric[0] + 2.0 * b * c * metric[2] + c * c * metric[1]);
    const double xy = 0.5 * a * (b * metric[0] + c * metric[2]);
    const double ratio = material->poissons_ratio, modulus = material->youngs_modulus / (1.0 - ratio * ratio);
    stress[0] = modulus * (xx + ratio * yy);
    stress[1] = modulus * (yy + ratio * xx);
    stress[2] = modulus * (1.0 - ratio) * xy;
    const ShvVec3 first = shv_add(reference[0], change[0]), second = shv_add(reference[1], change[1]);
    axes[0] = shv_scale(first, a);
    axes[1] = shv_madd(shv_scale(first, b), c, second);
}

static inline Face evaluate_face(const ShvCohesive *cohesive, const ShvState *state, int32_t element, int face)
{
    const uint8_t *corners = shv_face_corners[face];
    ShvVec3 place[3], moved[3], reference[2], change[2];
    Face result;
    double *s = result.plane;
    for (int i = 0; i < 3; i++) {
        const int64_t node = 3 * (int64_t)shv_state_node(state, element, corners[i]);
        place[i] = shv_load3(state->reference + node);
        moved[i] = shv_load3(state->displacement + node);
    }
    for (int i = 0; i < 2; i++) {
        reference[i] = shv_sub(place[i + 1], place[0]);
        change[i] = shv_sub(moved[i + 1], moved[0]);
    }
    plane_stress(shv_model_material(cohesive->model, element), reference, change, s, result.axes);
    result.area = shv_scale(shv_cross(reference[0], reference[1]), 0.5);
    result.tension = 0.5 * (s[0] + s[1]) + sqrt(0.25 * (s[0] - s[1]) * (s[0] - s[1]) + s[2] * s[2]);
    return result;
}

/* In space, Voigt. */
static void face_stress(const Face *face, double stress[6])
{
    static const int rows[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
    const double p[3] = {face->axes[0].x, face->axes[0].y, face->axes[0].z}, *s = face->plane;
    const double q[3] = {face->axes[1].x, face->axes[1].y, face->axes[1].z};
    for (int k = 0; k < 6; k++) {
        const int i = rows[k][0], j = rows[k][1];
        stress[k] = s[0] * p[i] * p[j] + s[1] * q[i] * q[j] + s[2] * (p[i] * q[j] + q[i] * p[j]);
    }
}

/* ---- a node ---- */

/* Boundary faces at a corner of an element: those opposite its other corners. */
static bool is_outside(const ShvCohesive *cohesive, int32_t corner, int face)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    return face != corner % 4 &&
           adjacency->element_facets[4 * (int64_t)(corner / 4) + face] >= adjacency->interior_count;
}

/* The smooth part of the surface that bears most at a node: of its edge only one side counts. */
typedef struct Patch {
    Face tensest;
    double area;      /* m² */
    double stress[6]; /* in the faces, N */
} Patch;

typedef void Visit(Patch *patch, const Face *face);

static void find_tensest(Patch *patch, const Face *face)
{
    if (face->tension > patch->tensest.tension) patch->tensest = *face;
}

static void add_face(Patch *patch, const Face *face)
{
    const double size = shv_norm(face->area);
    double own[6];
    if (shv_dot(face->area, patch->tensest.area) < smooth_cosine * size * shv_norm(patch->tensest.area)) return;
    face_stress(face, own);
    for (int k = 0; k < 6; k++) patch->stress[k] += size * own[k];
    patch->area += size;
}

static void visit_faces(const ShvCohesive *cohesive, const ShvState *state, int32_t node, Visit *visit, Patch *patch)
{
    for (int32_t i = 0; i < state->corner_count[node]; i++) {
        const int32_t corner = state->corners[state->corner_start[node] + i];
        for (int face = 0; face < 4; face++) {
            if (!is_outside(cohesive, corner, face)) continue;
            const Face here = evaluate_face(cohesive, state, corner / 4, face);
            visit(patch, &here);
        }
    }
}

ShvSurfaceTension shv_initiation_tension(const ShvCohesive *cohesive, const ShvState *state, int32_t node)
{
    Patch patch = {0};
    visit_faces(cohesive, state, node, find_tensest, &patch);
    if (!(patch.tensest.tension > 0.0)) return (ShvSurfaceTension){0};
    visit_faces(cohesive, state, node, add_face, &patch);
    const ShvMat3 mean = shv_from_voigt(patch.stress);
    double values[3];
    ShvMat3 axes;
    shv_symmetric_eigen(&mean, values, &axes);
    return (ShvSurfaceTension){fmax(values[2], 0.0) / patch.area, shv_vec3(axes.m[0][2], axes.m[1][2], axes.m[2][2])};
}

/* ---- all of them ---- */

static void find_tensions(const ShvCohesive *cohesive, const ShvState *state)
{
    const ShvInitiation *initiation = &cohesive->initiation;
    const int32_t threads = cohesive->model->threads;
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (int32_t i = 0; i < initiation->count; i++)
        initiation->tension[i] =
            evaluate_face(cohesive, state, initiation->faces[i] / 4, initiation->faces[i] % 4).tension;
}

double shv_initiation_list(ShvCohesive *cohesive, const ShvState *state, int32_t *nodes, int32_t *count)
{
    const ShvInitiation *initiation = &cohesive->initiation;
    ShvStarSearch *search = &cohesive->search;
    double largest = 0.0;
    find_tensions(cohesive, state);
    for (int32_t i = 0; i < initiation->count; i++) {
        const int32_t element = initiation->faces[i] / 4;
        if (!(initiation->tension[i] > 0.0)) continue;
        for (int k = 0; k < 3; k++) {
            const int32_t node = shv_state_node(state, element, shv_face_corners[initiation->faces[i] % 4][k]);
            if (node >= cohesive->model->mesh.node_count || search->mark[node]) continue;
            const double ratio = initiation->tension[i] / initiation->strength[node];
            largest = shv_larger(largest, ratio);
            if (ratio < 1.0) continue;
            search->mark[node] = 1;
            nodes[(*count)++] = node;
        }
    }
    return largest;
}

/* ---- what it is for ---- */

/* Infinite where no facet can open, or some facet is of another material or resolved. */
static double initiation_strength(const ShvCohesive *cohesive, int32_t node)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    bool opens = false;
    for (int32_t i = adjacency->corner_start[node]; i < adjacency->corner_start[node + 1]; i++) {
        const int32_t corner = adjacency->corners[i];
        for (int face = 0; face < 4; face++) {
            const int32_t facet = adjacency->element_facets[4 * (int64_t)(corner / 4) + face];
            if (face == corner % 4 || facet >= adjacency->interior_count) continue;
            const ShvMaterial *material = shv_cohesive_material(cohesive->model, facet);
            if (!material || shv_front_tip_strength(cohesive->model, facet) >= material->strength[SHV_NORMAL])
                return (double)INFINITY;
            opens = opens || isfinite(cohesive->facet_strength[facet]);
        }
    }
    return opens ? shv_cohesive_node_strength(cohesive->model, node) : (double)INFINITY;
}

ShvStatus shv_initiation_create(ShvCohesive *cohesive, ShvError *error)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    ShvInitiation *initiation = &cohesive->initiation;
    const size_t faces = (size_t)(adjacency->facet_count - adjacency->interior_count);
    const size_t nodes = (size_t)cohesive->model->mesh.node_count;
    *initiation = (ShvInitiation){0};
    if (!cohesive->front.any) return SHV_OK;
    initiation->faces = shv_allocate(cohesive->memory, SHV_PART_COHESIVE, faces, sizeof *initiation->faces);
    initiation->strength = shv_allocate(cohesive->memory, SHV_PART_COHESIVE, nodes, sizeof *initiation->strength);
    initiation->tension = shv_allocate(cohesive->memory, SHV_PART_STRESS, faces, sizeof *initiation->tension);
    if (!initiation->faces || !initiation->strength || !initiation->tension)
        return shv_fail_memory(error, "the surface where cracks begin", 12 * faces + 8 * nodes);
    for (int32_t node = 0; node < (int32_t)nodes; node++)
        initiation->strength[node] = initiation_strength(cohesive, node);
    return SHV_OK;
}

void shv_initiation_release(ShvInitiation *initiation)
{
    shv_release(initiation->faces);
    shv_release(initiation->strength);
    shv_release(initiation->tension);
    *initiation = (ShvInitiation){0};
}

void shv_initiation_watch(ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake)
{
    const ShvAdjacency *adjacency = &cohesive->model->adjacency;
    ShvInitiation *initiation = &cohesive->initiation;
    initiation->count = 0;
    if (!cohesive->front.any) return;
    for (int32_t facet = adjacency->interior_count; facet < adjacency->facet_count; facet++) {
        const int32_t element = adjacency->facet_elements[2 * (int64_t)facet];
        if (shv_model_material(cohesive->model, element)->unresolved != SHV_UNRESOLVED_TIP_STRENGTH) continue;
        if (awake && !awake[state->element_fragment[element]]) continue;
        initiation->faces[initiation->count++] = 4 * element + adjacency->facet_faces[2 * (int64_t)facet];
    }
}
