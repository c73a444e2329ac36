/* Definitions of one body of each generator, and what must hold for every mesh. */
#ifndef SHV_TESTS_MESH_BODIES_H
#define SHV_TESTS_MESH_BODIES_H

#include "check.h"

#include <stdlib.h>

#include "mesh/adjacency.h"
#include "mesh/generate.h"

static inline ShvMeshDefinition body(ShvMeshKind kind, double edge)
{
    ShvMeshDefinition d = shv_mesh_default();
    d.kind = kind;
    d.edge = edge;
    d.radius = 0.05;
    d.inner_radius = kind == SHV_MESH_HOLLOW_BALL ? 0.03 : 0.0;
    d.height = 0.08;
    d.size[0] = 0.09;
    d.size[1] = 0.05;
    d.size[2] = 0.06;
    if (kind == SHV_MESH_NOTCHED_BEAM) {
        d.notch_depth = 0.0173;
        d.notch_offset = 0.0117;
        d.notch_edge = 0.4 * edge;
    }
    return d;
}

static inline ShvMeshDefinition tube(double edge)
{
    ShvMeshDefinition d = body(SHV_MESH_CYLINDER, edge);
    d.inner_radius = 0.02;
    return d;
}

static inline ShvMeshDefinition brick_beam(double edge)
{
    ShvMeshDefinition d = body(SHV_MESH_NOTCHED_BEAM, edge);
    d.pattern = SHV_PATTERN_BRICKS;
    return d;
}

static inline ShvMeshDefinition brick_box(double edge)
{
    ShvMeshDefinition d = body(SHV_MESH_BOX, edge);
    d.pattern = SHV_PATTERN_BRICKS;
    return d;
}

enum { BODY_COUNT = 8 };
static inline ShvMeshDefinition any_body(int i, double edge)
{
    static const ShvMeshKind kinds[5] = {SHV_MESH_BOX, SHV_MESH_BALL, SHV_MESH_HOLLOW_BALL, SHV_MESH_CYLINDER,
                                         SHV_MESH_NOTCHED_BEAM};
    return i < 5 ? body(kinds[i], edge) : i < 6 ? tube(edge) : i < 7 ? brick_beam(edge) : brick_box(edge);
}

static inline ShvStatus make(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *d, ShvError *error)
{
    switch (d->kind) {
    case SHV_MESH_BALL:
        return shv_mesh_ball(mesh, memory, d, error);
    case SHV_MESH_HOLLOW_BALL:
        return shv_mesh_hollow_ball(mesh, memory, d, error);
    case SHV_MESH_CYLINDER:
        return shv_mesh_cylinder(mesh, memory, d, error);
    case SHV_MESH_NOTCHED_BEAM:
        return shv_mesh_notched_beam(mesh, memory, d, error);
    default:
        return shv_mesh_box(mesh, memory, d, error);
    }
}

static inline int compare_pairs(const void *a, const void *b)
{
    const int32_t *p = a, *q = b;
    if (p[0] != q[0]) return p[0] < q[0] ? -1 : 1;
    return (p[1] > q[1]) - (p[1] < q[1]);
}

/* Nodes − edges + facets − tets, with edges counted by sorting. */
static inline int64_t euler_characteristic(const ShvMesh *mesh, int32_t facets)
{
    static const int pairs[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
    const size_t count = 6 * (size_t)mesh->element_count;
    int32_t *edges = calloc(2 * count, sizeof *edges);
    assert_non_null(edges);
    for (size_t i = 0; i < count; i++) {
        const int32_t a = mesh->elements[4 * (i / 6) + (size_t)pairs[i % 6][0]];
        const int32_t b = mesh->elements[4 * (i / 6) + (size_t)pairs[i % 6][1]];
        edges[2 * i] = a < b ? a : b;
        edges[2 * i + 1] = a < b ? b : a;
    }
    qsort(edges, count, 2 * sizeof *edges, compare_pairs);
    int64_t different = 0;
    for (size_t i = 0; i < count; i++) different += i == 0 || compare_pairs(edges + 2 * i - 2, edges + 2 * i) != 0;
    free(edges);
    return mesh->node_count - different + facets - mesh->element_count;
}

/* Every directed edge of the boundary triangles is met by exactly one opposite one: the boundary is closed. */
static inline void check_boundary_closed(const int32_t *triangles, int32_t count)
{
    const size_t length = 3 * (size_t)count;
    int32_t *forward = calloc(2 * length, sizeof *forward), *backward = calloc(2 * length, sizeof *backward);
    assert_non_null(forward);
    assert_non_null(backward);
    for (size_t i = 0; i < length; i++) {
        const int32_t from = triangles[i], to = triangles[i % 3 == 2 ? i - 2 : i + 1];
        forward[2 * i] = backward[2 * i + 1] = from;
        forward[2 * i + 1] = backward[2 * i] = to;
    }
    qsort(forward, length, 2 * sizeof *forward, compare_pairs);
    qsort(backward, length, 2 * sizeof *backward, compare_pairs);
    assert_memory_equal(forward, backward, 2 * length * sizeof *forward);
    free(forward);
    free(backward);
}

/* Volume enclosed by the boundary triangles (divergence theorem). */
static inline double enclosed_volume(const ShvMesh *mesh, const int32_t *triangles, int32_t count)
{
    double volume = 0.0;
    for (int32_t t = 0; t < count; t++) {
        const ShvVec3 a = shv_mesh_position(mesh, triangles[3 * t]), b = shv_mesh_position(mesh, triangles[3 * t + 1]);
        volume += shv_dot(shv_cross(a, b), shv_mesh_position(mesh, triangles[3 * t + 2])) / 6.0;
    }
    return volume;
}

/* Nodes of a notch that keep to it: the lips stay in its plane, the front where it is. */
typedef struct NotchNodes {
    int32_t front, slid; /* nodes of the front, of the lips that moved */
} NotchNodes;

static inline NotchNodes check_notch_stays(const ShvMeshDefinition *d, const ShvMesh *before, const ShvMesh *mesh)
{
    const double tip = -0.5 * d->size[2] + d->notch_depth;
    NotchNodes nodes = {0, 0};
    for (int32_t n = 0; n < mesh->node_count; n++) {
        const ShvVec3 old = shv_mesh_position(before, n), x = shv_mesh_position(mesh, n);
        if (old.x != d->notch_offset || old.z > tip) continue;
        check_near(x.x, d->notch_offset, 1e-15);
        if (old.z == tip) assert_true(x.z == tip && x.y == old.y);
        nodes.front += old.z == tip;
        nodes.slid += x.z != old.z;
    }
    return nodes;
}

#endif
