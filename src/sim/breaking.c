/* Where an object is expected to break, and how long the edges are there: on the plane that cracks keep to, else at the tips of its
   notches and cracks, else anywhere. */
#include "mesh/edge_table.h"
#include "model/selection.h"
#include "sim/internal.h"

/* rad: a notch is as sharp as a crack, for the stresses at its tip, where the body goes round it by more than this: with flanks
   at less than 60°. The corner of a mug's floor is none. */
static const double sharp = 5.235987755982989;
/* rad: lips of a crack lie on each other; no tet is as thin. */
static const double closed = 1e-6;

/* Angle through the body from one boundary triangle to its neighbour across the half-edge of the first. */
static double angle_at(const ShvMesh *mesh, const int32_t *triangles, int32_t half_edge, int32_t other)
{
    const int32_t *own = triangles + half_edge / 3 * 3, *next = triangles + other / 3 * 3;
    const ShvVec3 from = shv_mesh_position(mesh, shv_half_edge_start(triangles, half_edge));
    const ShvVec3 edge = shv_unit(shv_sub(shv_mesh_position(mesh, shv_half_edge_end(triangles, half_edge)), from));
    ShvVec3 normal[2];
    for (int k = 0; k < 2; k++) {
        const int32_t *corners = k ? next : own;
        const ShvVec3 a = shv_mesh_position(mesh, corners[0]);
        normal[k] = shv_unit(shv_cross(shv_sub(shv_mesh_position(mesh, corners[1]), a),
                                       shv_sub(shv_mesh_position(mesh, corners[2]), a)));
    }
    const ShvVec3 along = shv_cross(normal[0], edge), beside = shv_cross(edge, normal[1]);
    const double angle = atan2(-shv_dot(beside, normal[0]), shv_dot(beside, along));
    return angle < closed ? angle + 6.283185307179586 : angle;
}

/* Marks the nodes of all sharp edges; returns whether there are any. */
static bool mark_tips(const ShvMesh *mesh, const ShvEdgeTable *table, const int32_t *triangles, int32_t half_edges,
                      uint8_t *marks)
{
    bool any = false;
    for (int32_t i = 0; i < half_edges; i++) {
        const int32_t from = shv_half_edge_start(triangles, i), to = shv_half_edge_end(triangles, i);
        const int32_t other = shv_edge_table_find(table, to, from);
        if (other < 0 || angle_at(mesh, triangles, i, other) < sharp) continue;
        marks[from] = marks[to] = 1;
        any = true;
    }
    return any;
}

static ShvStatus find_tips(const ShvMesh *part, uint8_t *marks, bool *any, ShvError *error)
{
    ShvEdgeTable table;
    int32_t *triangles, count;
    SHV_TRY(shv_mesh_boundary(part, SHV_PART_GENERAL, &triangles, &count, error));
    ShvStatus status = shv_edge_table_create(&table, part->memory, triangles, 3 * (int64_t)count, error);
    if (status == SHV_OK) {
        for (int32_t i = 0; i < 3 * count; i++) (void)shv_edge_table_insert(&table, i);
        *any = mark_tips(part, &table, triangles, 3 * count, marks);
        shv_edge_table_release(&table);
    }
    shv_release(triangles);
    return status;
}

static bool mark_plane(const ShvSelection *plane, const ShvMesh *part, int32_t begin, uint8_t *marks)
{
    bool any = false;
    for (int32_t i = begin; i < part->node_count; i++) {
        marks[i] = shv_selection_contains(plane, shv_mesh_position(part, i));
        any |= marks[i] != 0;
    }
    return any;
}

/* Over the tets of which at least so many corners are marked; the figures of the object where there are none. */
static void measure_edges(ShvPreflight *preflight, const ShvMesh *part, const uint8_t *marks, int least)
{
    double sum = 0.0, longest = 0.0;
    int32_t tets = 0;
    for (int32_t e = 0; e < part->element_count; e++) {
        const int32_t *nodes = part->elements + 4 * (int64_t)e;
        if (marks[nodes[0]] + marks[nodes[1]] + marks[nodes[2]] + marks[nodes[3]] < least) continue;
        tets++;
        for (int i = 0; i < 4; i++)
            for (int k = i + 1; k < 4; k++) {
                const double edge =
                    shv_norm(shv_sub(shv_mesh_position(part, nodes[i]), shv_mesh_position(part, nodes[k])));
                sum += edge;
                longest = fmax(longest, edge);
            }
    }
    if (tets == 0) {
        preflight->breaking = SHV_BREAKING_ANYWHERE;
        return;
    }
    preflight->breaking_tets = tets;
    preflight->breaking_mean_edge = sum / (6.0 * tets);
    /* From a tip a crack runs on, nobody knows where to. */
    if (preflight->breaking == SHV_BREAKING_PLANE) preflight->breaking_longest_edge = longest;
}

ShvStatus shv_find_breaking(ShvPreflight *preflight, const ShvHybrid *hybrid, const ShvMesh *part, int32_t node_begin,
                            ShvError *error)
{
    const ShvSelection *plane = &hybrid->scene->fracture.on;
    preflight->breaking = SHV_BREAKING_ANYWHERE;
    preflight->breaking_tets = preflight->tets;
    preflight->breaking_mean_edge = preflight->mean_edge;
    preflight->breaking_longest_edge = preflight->longest_edge;
    if (!preflight->breakable) return SHV_OK;
    uint8_t *marks = shv_allocate(part->memory, SHV_PART_GENERAL, (size_t)part->node_count, 1);
    if (!marks) return shv_fail_memory(error, "marks of nodes", (size_t)part->node_count);
    ShvStatus status = SHV_OK;
    bool any = false;
    const bool confined = plane->kind != SHV_SELECT_ALL;
    if (confined)
        any = mark_plane(plane, part, node_begin, marks);
    else
        status = find_tips(part, marks, &any, error);
    if (any) {
        preflight->breaking = confined ? SHV_BREAKING_PLANE : SHV_BREAKING_TIPS;
        measure_edges(preflight, part, marks, confined ? 3 : 1);
    }
    shv_release(marks);
    return status;
}
