#include "mesh/generate.h"
#include "mesh/parameters.h"
#include "mesh/unstructured.h"

/* The mesh may have so much less or more volume than the body: curved walls are cut short by facets. */
static const double lost_volume = 0.1;

static double cross(const double *o, const double *a, const double *b)
{
    return (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
}

/* Whether stretch a-b and stretch c-d cross, other than in their ends. */
static bool meet(const double *a, const double *b, const double *c, const double *d)
{
    return (cross(a, b, c) > 0.0) != (cross(a, b, d) > 0.0) && (cross(c, d, a) > 0.0) != (cross(c, d, b) > 0.0);
}

/* Of an edge: a corner that is closer to the axis, but not on it, makes a hole that no tet goes round. */
static const double narrowest_hole = 0.01;

static ShvStatus check_profile(const double *profile, int32_t count, double edge, ShvError *error)
{
    if (!profile || count < 3)
        return shv_fail(error, SHV_BAD_INPUT, "turned body: its profile has %d corners; give 3 at least", (int)count);
    for (int32_t i = 0; i < count; i++) {
        const double *p = profile + 2 * (int64_t)i, *q = profile + 2 * (int64_t)((i + 1) % count);
        if (!(isfinite(p[0]) && isfinite(p[1]) && p[0] >= 0.0))
            return shv_fail(error, SHV_BAD_INPUT,
                            "turned body: corner %d of its profile has the radius %g and the height %g; give finite "
                            "numbers, and no negative radius",
                            (int)i + 1, p[0], p[1]);
        if (p[0] > 0.0 && p[0] < narrowest_hole * edge)
            return shv_fail(error, SHV_BAD_INPUT,
                            "turned body: corner %d of its profile is %g m off the axis, less than %g of an edge; give "
                            "0 for a place on the axis",
                            (int)i + 1, p[0], narrowest_hole);
        if (p[0] == q[0] && p[1] == q[1])
            return shv_fail(error, SHV_BAD_INPUT,
                            "turned body: corner %d of its profile is the next one, too; remove it", (int)i + 1);
        for (int32_t k = i + 2; k < count - (i == 0); k++)
            if (meet(p, q, profile + 2 * (int64_t)k, profile + 2 * (int64_t)((k + 1) % count)))
                return shv_fail(error, SHV_BAD_INPUT,
                                "turned body: its profile crosses itself after corners %d and %d; put them in order",
                                (int)i + 1, (int)k + 1);
    }
    return SHV_OK;
}

static ShvStatus check_volume(const ShvMesh *mesh, const ShvOutline *outline, double edge, ShvError *error)
{
    const double wanted = shv_outline_volume(outline);
    double found = 0.0;
    for (int32_t e = 0; e < mesh->element_count; e++) found += shv_mesh_element_volume(mesh, e);
    if (fabs(found - wanted) <= lost_volume * wanted) return SHV_OK;
    return shv_fail(
        error, SHV_BAD_INPUT,
        "turned body: with an edge of %g m its tets fill %.3g m³ of %.3g m³; choose an edge no longer than its "
        "thinnest wall",
        edge, found, wanted);
}

ShvStatus shv_mesh_turned(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error)
{
    const ShvOutline outline = {.profile = definition->profile, .count = definition->profile_count};
    const double edge = definition->edge;
    *mesh = (ShvMesh){0};
    SHV_TRY(shv_require_length(edge, "turned body", "edge", error));
    SHV_TRY(check_profile(outline.profile, outline.count, edge, error));
    const double volume = shv_outline_volume(&outline), tets = 6.0 * sqrt(2.0) * volume / (edge * edge * edge);
    if (!(tets >= 1.0))
        return shv_fail(error, SHV_BAD_INPUT, "turned body: an edge of %g m is too long for its volume of %.3g m³",
                        edge, volume);
    SHV_TRY(shv_require_count(tets, edge, "turned body", error));
    SHV_TRY(shv_mesh_unstructured(mesh, memory, &outline, edge, definition->seed, error));
    const ShvStatus status = check_volume(mesh, &outline, edge, error);
    if (status != SHV_OK) shv_mesh_release(mesh);
    return status;
}
