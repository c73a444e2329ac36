/* Random shifts of nodes, so that a regular mesh does not steer cracks. The body keeps its shape exactly: a node of a
   flat surface stays in its plane, one where two planes meet slides along their line, corners and nodes of curved
   surfaces stay where they are. */
#include "base/deterministic.h"
#include "base/random.h"
#include "mesh/freedom.h"
#include "mesh/generate.h"
#include "mesh/tet.h"

#include <stdbool.h>
#include <string.h>

typedef struct Jitter {
    ShvMesh *mesh;
    double *original; /* positions, 3 a node */
    double *shifts;   /* 3 a node */
    double *shortest; /* incident edge of a node */
    double *aspects;  /* of the elements before */
    ShvFreedom freedom;
    uint8_t *spoiled; /* nodes of elements whose shape the shifts would spoil */
} Jitter;

/* Shifts that leave an element less than this share of its shape are halved. */
static const double kept_shape = 0.5;

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
        const ShvVec3 shift = shv_scale(draw(seed, n), amount * j->shortest[n]);
        shv_store3(j->shifts + 3 * (int64_t)n, shv_freedom_shift(&j->freedom, n, shift));
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
    shv_release(j->aspects);
    shv_freedom_release(&j->freedom);
    shv_release(j->spoiled);
}

static ShvStatus allocate(Jitter *j, ShvError *error)
{
    const size_t nodes = (size_t)j->mesh->node_count, elements = (size_t)j->mesh->element_count;
    ShvMemory *memory = j->mesh->memory;
    j->original = shv_allocate(memory, SHV_PART_GENERAL, 3 * nodes, sizeof *j->original);
    j->shifts = shv_allocate(memory, SHV_PART_GENERAL, 3 * nodes, sizeof *j->shifts);
    j->shortest = shv_allocate(memory, SHV_PART_GENERAL, nodes, sizeof *j->shortest);
    j->aspects = shv_allocate(memory, SHV_PART_GENERAL, elements, sizeof *j->aspects);
    j->spoiled = shv_allocate(memory, SHV_PART_GENERAL, nodes, sizeof *j->spoiled);
    if (j->original && j->shifts && j->shortest && j->aspects && j->spoiled) return SHV_OK;
    return shv_fail_memory(error, "the jitter of a mesh", 57 * nodes + 8 * elements);
}

static ShvStatus jitter_nodes(Jitter *j, double amount, uint64_t seed, ShvError *error)
{
    SHV_TRY(allocate(j, error));
    SHV_TRY(shv_freedom_find(&j->freedom, j->mesh, shv_same_plane, false, error));
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
