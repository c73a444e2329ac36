/* Random shifts of nodes, so that a regular mesh does not steer cracks. The body keeps its shape exactly: a node of a
   flat surface stays in its plane, one where two planes meet slides along their line, corners and nodes of curved
   surfaces stay where they are. */
#include "base/deterministic.h"
#include "base/random.h"
#include "mesh/adjacency.h"
#include "mesh/generate.h"
#include "mesh/tet.h"

#include <stdbool.h>
#include <string.h>

typedef enum Freedom { FREE, IN_PLANE, ON_LINE, FIXED } Freedom;

typedef struct Jitter {
    ShvMesh *mesh;
    double *original; /* positions, 3 a node */
    double *shifts;   /* 3 a node */
    double *shortest; /* incident edge of a node */
    double *normals;  /* 6 a node: of the planes met so far */
    double *aspects;  /* of the elements before */
    uint8_t *freedom; /* a Freedom a node: FREE before the first boundary facet */
    uint8_t *spoiled; /* nodes of elements whose shape the shifts would spoil */
} Jitter;

/* Normals that differ by less than this are those of one plane: above the rounding of coordinates (1e-9 of a facet's
   size), below the turn from facet to facet of any curved surface that a mesh resolves. */
static const double same_plane = 1e-6;

/* Shifts that leave an element less than this share of its shape are halved. */
static const double kept_shape = 0.5;

static bool is_same(ShvVec3 a, ShvVec3 b)
{
    return shv_norm(shv_sub(a, b)) < same_plane;
}

/* Takes in the plane of one more facet at a node. Opposite normals fix it: they meet at the front of a notch, which must
   not move, and have no line in common. */
static void restrict_node(Jitter *j, int32_t node, ShvVec3 normal)
{
    double *known = j->normals + 6 * (int64_t)node;
    const int planes = j->freedom[node];
    for (int p = 0; p < planes && p < 2; p++)
        if (is_same(shv_load3(known + 3 * p), normal)) return;
    if (planes == 1 && is_same(shv_load3(known), shv_scale(normal, -1.0))) j->freedom[node] = FIXED;
    if (planes < 2) shv_store3(known + 3 * planes, normal);
    if (j->freedom[node] < FIXED) j->freedom[node]++;
}

static ShvStatus restrict_boundary(Jitter *j, ShvError *error)
{
    int32_t *triangles = NULL, count = 0;
    SHV_TRY(shv_mesh_boundary(j->mesh, SHV_PART_GENERAL, &triangles, &count, error));
    for (int32_t t = 0; t < count; t++) {
        const int32_t *n = triangles + 3 * (int64_t)t;
        const ShvVec3 a = shv_mesh_position(j->mesh, n[0]);
        const ShvVec3 b = shv_sub(shv_mesh_position(j->mesh, n[1]), a),
                      c = shv_sub(shv_mesh_position(j->mesh, n[2]), a);
        const ShvVec3 normal = shv_unit(shv_cross(b, c));
        for (int i = 0; i < 3; i++) restrict_node(j, n[i], normal);
    }
    shv_release(triangles);
    return SHV_OK;
}

static ShvTet tet_of(const ShvMesh *mesh, int32_t element)
{
    return shv_tet_of_nodes(mesh, mesh->elements + 4 * (int64_t)element);
}

static void measure_elements(Jitter *j)
{
    for (int32_t n = 0; n < j->mesh->node_count; n++) j->shortest[n] = HUGE_VAL;
    for (int32_t e = 0; e < j->mesh->element_count; e++) {
        const int32_t *n = j->mesh->elements + 4 * (int64_t)e;
        const ShvTet tet = tet_of(j->mesh, e);
        j->aspects[e] = shv_tet_aspect(&tet);
        for (int a = 0; a < 4; a++)
            for (int b = 0; b < 4; b++) {
                if (a == b) continue;
                const double length = shv_norm(shv_sub(tet.corners[a], tet.corners[b]));
                j->shortest[n[a]] = fmin(j->shortest[n[a]], length);
            }
    }
}

/* A direction uniform on the sphere (its height is uniform, by Archimedes' theorem) and a length uniform in (0, 1). */
static ShvVec3 draw(uint64_t seed, int32_t node)
{
    const uint64_t first = 3 * (uint64_t)node;
    const double height = 2.0 * shv_random_uniform(seed, first) - 1.0, ring = sqrt(1.0 - height * height);
    const double angle = 2.0 * SHV_PI * shv_random_uniform(seed, first + 1);
    const ShvVec3 direction = shv_vec3(ring * shv_cos(angle), ring * shv_sin(angle), height);
    return shv_scale(direction, shv_random_uniform(seed, first + 2));
}

static void draw_shifts(Jitter *j, double amount, uint64_t seed)
{
    for (int32_t n = 0; n < j->mesh->node_count; n++) {
        const ShvVec3 first = shv_load3(j->normals + 6 * (int64_t)n),
                      second = shv_load3(j->normals + 6 * (int64_t)n + 3);
        ShvVec3 shift = shv_scale(draw(seed, n), amount * j->shortest[n]);
        if (j->freedom[n] == IN_PLANE) shift = shv_madd(shift, -shv_dot(shift, first), first);
        if (j->freedom[n] == ON_LINE) {
            const ShvVec3 line = shv_unit(shv_cross(first, second));
            shift = shv_scale(line, shv_dot(shift, line));
        }
        if (j->freedom[n] == FIXED) shift = shv_vec3(0.0, 0.0, 0.0);
        shv_store3(j->shifts + 3 * (int64_t)n, shift);
    }
}

static void move_nodes(const Jitter *j)
{
    for (int64_t i = 0; i < 3 * (int64_t)j->mesh->node_count; i++)
        j->mesh->positions[i] = j->original[i] + j->shifts[i];
}

/* Halves the shifts of all nodes of elements that lost too much of their shape; whether there were any. */
static bool halve_excessive(Jitter *j)
{
    bool any = false;
    for (int32_t n = 0; n < j->mesh->node_count; n++) j->spoiled[n] = 0;
    for (int32_t e = 0; e < j->mesh->element_count; e++) {
        const ShvTet tet = tet_of(j->mesh, e);
        if (shv_tet_aspect(&tet) >= kept_shape * j->aspects[e]) continue;
        any = true;
        for (int i = 0; i < 4; i++) j->spoiled[j->mesh->elements[4 * (int64_t)e + i]] = 1;
    }
    for (int64_t i = 0; any && i < 3 * (int64_t)j->mesh->node_count; i++)
        if (j->spoiled[i / 3]) j->shifts[i] *= 0.5;
    return any;
}

static void release(Jitter *j)
{
    shv_release(j->original);
    shv_release(j->shifts);
    shv_release(j->shortest);
    shv_release(j->normals);
    shv_release(j->aspects);
    shv_release(j->freedom);
    shv_release(j->spoiled);
}

static ShvStatus allocate(Jitter *j, ShvError *error)
{
    const size_t nodes = (size_t)j->mesh->node_count, elements = (size_t)j->mesh->element_count;
    ShvMemory *memory = j->mesh->memory;
    j->original = shv_allocate(memory, SHV_PART_GENERAL, 3 * nodes, sizeof *j->original);
    j->shifts = shv_allocate(memory, SHV_PART_GENERAL, 3 * nodes, sizeof *j->shifts);
    j->shortest = shv_allocate(memory, SHV_PART_GENERAL, nodes, sizeof *j->shortest);
    j->normals = shv_allocate(memory, SHV_PART_GENERAL, 6 * nodes, sizeof *j->normals);
    j->aspects = shv_allocate(memory, SHV_PART_GENERAL, elements, sizeof *j->aspects);
    j->freedom = shv_allocate(memory, SHV_PART_GENERAL, nodes, sizeof *j->freedom);
    j->spoiled = shv_allocate(memory, SHV_PART_GENERAL, nodes, sizeof *j->spoiled);
    if (j->original && j->shifts && j->shortest && j->normals && j->aspects && j->freedom && j->spoiled) return SHV_OK;
    return shv_fail_memory(error, "the jitter of a mesh", 106 * nodes + 8 * elements);
}

static ShvStatus jitter_nodes(Jitter *j, double amount, uint64_t seed, ShvError *error)
{
    SHV_TRY(allocate(j, error));
    SHV_TRY(restrict_boundary(j, error));
    measure_elements(j);
    memcpy(j->original, j->mesh->positions, 3 * (size_t)j->mesh->node_count * sizeof *j->original);
    draw_shifts(j, amount, seed);
    /* Ends: shifts that are halved often enough no longer change a coordinate. */
    do move_nodes(j);
    while (halve_excessive(j));
    return SHV_OK;
}

ShvStatus shv_mesh_jitter(ShvMesh *mesh, double amount, uint64_t seed, ShvError *error)
{
    if (!(amount >= 0.0 && amount <= 0.3))
        return shv_fail(error, SHV_BAD_INPUT, "jitter is %g, but must lie between 0 and 0.3", amount);
    if (amount == 0.0) return SHV_OK;
    Jitter jitter = {.mesh = mesh};
    const ShvStatus status = jitter_nodes(&jitter, amount, seed, error);
    release(&jitter);
    return status;
}
