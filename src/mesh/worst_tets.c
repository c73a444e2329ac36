/* Meshes that come from elsewhere or were shifted (jitter.c): their worst tets are bettered, group by group, so that every group keeps its
   shape. */
#include <stdlib.h>
#include <string.h>

#include "mesh/improve.h"

/* The share of tets that is worked on. */
static const double worst_share = 0.1;
/* Normals of one smooth surface at a node, as far from each other as this (29°): edges and corners of a body turn by more, facets of a
   curved surface that the mesh resolves by less. */
static const double same_surface = 0.5;

typedef struct Rework {
    ShvMesh *mesh;
    ShvImprove improve;
    int32_t *tets, *groups; /* of the new mesh */
    int32_t count;
} Rework;

static int by_size(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static ShvStatus find_wanted(const ShvMesh *mesh, double *wanted, ShvError *error)
{
    const size_t count = (size_t)mesh->element_count;
    double *measures = shv_allocate(mesh->memory, SHV_PART_GENERAL, count, sizeof *measures);
    if (!measures) return shv_fail_memory(error, "measures of tets", 8 * count);
    for (size_t t = 0; t < count; t++) measures[t] = shv_improve_measure(mesh->positions, mesh->elements + 4 * t);
    qsort(measures, count, sizeof *measures, by_size);
    *wanted = measures[(size_t)(worst_share * (double)(count - 1))];
    shv_release(measures);
    return SHV_OK;
}

static int32_t group_of(const ShvMesh *mesh, int32_t tet)
{
    return mesh->element_groups ? mesh->element_groups[tet] : 0;
}

static ShvStatus fix_common_nodes(const ShvMesh *mesh, ShvFreedom *freedom, ShvError *error)
{
    const size_t nodes = (size_t)mesh->node_count;
    int32_t *first = shv_allocate(mesh->memory, SHV_PART_GENERAL, nodes, sizeof *first); /* tet at each, −1: none yet */
    if (!first) return shv_fail_memory(error, "groups at nodes", 4 * nodes);
    memset(first, 0xff, nodes * sizeof *first);
    for (int32_t corner = 0; corner < 4 * mesh->element_count; corner++) {
        const int32_t node = mesh->elements[corner], tet = corner / 4;
        if (first[node] < 0) first[node] = tet;
        if (group_of(mesh, first[node]) != group_of(mesh, tet)) freedom->kind[node] = SHV_FIXED;
    }
    shv_release(first);
    return SHV_OK;
}

/* The smallest group above `last`, which is below every tag at first; `last` when there is none. */
static int64_t next_group(const ShvMesh *mesh, int64_t last)
{
    int64_t next = last;
    for (int32_t t = 0; t < mesh->element_count; t++) {
        const int32_t group = group_of(mesh, t);
        if (group > last && (next == last || group < next)) next = group;
    }
    return next;
}

static ShvStatus copy_group(Rework *rework, int32_t group, ShvError *error)
{
    const ShvMesh *mesh = rework->mesh;
    ShvImprove *improve = &rework->improve;
    int32_t count = 0;
    for (int32_t t = 0; t < mesh->element_count; t++) count += group_of(mesh, t) == group;
    improve->tets = shv_allocate(mesh->memory, SHV_PART_GENERAL, 4 * (size_t)count, sizeof *improve->tets);
    if (!improve->tets) return shv_fail_memory(error, "tets of a group", 16 * (size_t)count);
    improve->tet_count = 0;
    for (int32_t t = 0; t < mesh->element_count; t++)
        if (group_of(mesh, t) == group)
            memcpy(improve->tets + 4 * (int64_t)improve->tet_count++, mesh->elements + 4 * (int64_t)t,
                   4 * sizeof *mesh->elements);
    return SHV_OK;
}

static ShvStatus append(Rework *rework, int32_t group, ShvError *error)
{
    const ShvImprove *improve = &rework->improve;
    const size_t count = (size_t)rework->count + (size_t)improve->tet_count;
    SHV_RESIZE(rework->mesh->memory, SHV_PART_MESH, rework->tets, 4 * count, "better tets", 16 * count, error);
    memcpy(rework->tets + 4 * (int64_t)rework->count, improve->tets,
           4 * (size_t)improve->tet_count * sizeof *rework->tets);
    if (rework->mesh->element_groups) {
        SHV_RESIZE(rework->mesh->memory, SHV_PART_MESH, rework->groups, count, "groups of better tets", 4 * count,
                   error);
        for (size_t t = (size_t)rework->count; t < count; t++) rework->groups[t] = group;
    }
    rework->count = (int32_t)count;
    return SHV_OK;
}

static ShvStatus improve_groups(Rework *rework, ShvError *error)
{
    ShvImprove *improve = &rework->improve;
    int64_t last = (int64_t)INT32_MIN - 1;
    for (int64_t next = next_group(rework->mesh, last); next != last; next = next_group(rework->mesh, last)) {
        last = next;
        ShvStatus status = copy_group(rework, (int32_t)next, error);
        if (status == SHV_OK) status = shv_improve(improve, error);
        if (status == SHV_OK) status = append(rework, (int32_t)next, error);
        shv_release(improve->tets);
        if (status != SHV_OK) return status;
    }
    return SHV_OK;
}

static void take(Rework *rework)
{
    ShvMesh *mesh = rework->mesh;
    shv_release(mesh->elements);
    shv_release(mesh->element_groups);
    mesh->elements = rework->tets;
    mesh->element_groups = rework->groups;
    mesh->element_count = rework->count;
    rework->tets = rework->groups = NULL;
}

static ShvStatus prepare(Rework *rework, bool curved, double *original, ShvError *error)
{
    const ShvMesh *mesh = rework->mesh;
    ShvImprove *improve = &rework->improve;
    memcpy(original, mesh->positions, 3 * (size_t)mesh->node_count * sizeof *original);
    improve->original = original;
    SHV_TRY(find_wanted(mesh, &improve->wanted, error));
    SHV_TRY(shv_freedom_find(&improve->freedom, mesh, curved ? same_surface : shv_same_plane, true, error));
    return fix_common_nodes(mesh, &improve->freedom, error);
}

ShvStatus shv_mesh_improve(ShvMesh *mesh, bool curved, uint64_t seed, ShvError *error)
{
    const size_t nodes = (size_t)mesh->node_count;
    double *original = shv_allocate(mesh->memory, SHV_PART_GENERAL, 3 * nodes, sizeof *original);
    if (!original) return shv_fail_memory(error, "places of nodes", 24 * nodes);
    Rework rework = {
        .mesh = mesh,
        .improve = {
            .memory = mesh->memory, .positions = mesh->positions, .node_count = mesh->node_count, .seed = seed}};
    ShvStatus status = prepare(&rework, curved, original, error);
    if (status == SHV_OK) status = improve_groups(&rework, error);
    if (status == SHV_OK) take(&rework);
    shv_freedom_release(&rework.improve.freedom);
    shv_release(rework.tets);
    shv_release(rework.groups);
    shv_release(original);
    return status;
}
