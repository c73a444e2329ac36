/* A cylinder of prisms: rings of triangles, layer upon layer, three tets a prism.

   Ring k has 6 k nodes at equal angles, so triangles have one size everywhere; a tube leaves out the inner rings. As in
   the flat triangular lattice, nodes can be coloured with three colours such that every triangle has all of them: a
   prism is cut along the diagonals that rise from the lower to the higher colour, and next layer the other way round,
   so that neighbours agree and no direction around the axis is preferred. */
#include "base/deterministic.h"
#include "mesh/generate.h"
#include "mesh/parameters.h"
#include "mesh/tet.h"

#include <stdbool.h>

typedef struct Rings {
    int32_t first, last, layers; /* rings of nodes (0: the axis), layers of prisms */
    double inner_radius, outer_radius, height;
} Rings;

/* Mean edge over the distance of rings, with layers as thick as that distance (measured). */
static const double edge_over_ring = 1.25;

static int64_t nodes_below(int64_t ring)
{
    return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1);
}

static int64_t nodes_of_layer(const Rings *r)
{
    return nodes_below((int64_t)r->last + 1) - nodes_below(r->first);
}

static double count_tets(const Rings *r)
{
    const double outer = (double)r->last, inner = (double)r->first;
    return 3.0 * (double)r->layers * 6.0 * (outer * outer - inner * inner);
}

/* Node `step` of `ring` in one of six sectors, 0 ≤ step ≤ ring, of the lowest layer. */
static int64_t node_at(const Rings *r, int sector, int32_t ring, int32_t step)
{
    const int64_t base = nodes_below(ring) - nodes_below(r->first);
    return ring == 0 ? base : base + ((int64_t)sector * ring + step) % (6 * (int64_t)ring);
}

/* The sector's two directions add 1 and 2 in turn to the colour. */
static int colour_at(int sector, int32_t ring, int32_t step)
{
    const int along = sector % 2 == 0 ? 1 : 2;
    return (int)(((int64_t)(ring - step) * along + (int64_t)step * (3 - along)) % 3);
}

static void place_layer(ShvMesh *mesh, const Rings *r, int32_t layer)
{
    const double third_turn = 1.0471975511965977462; /* π/3, a sector */
    const double up = (double)layer / (double)r->layers, z = 0.5 * r->height * up - 0.5 * r->height * (1.0 - up);
    const int64_t offset = layer * nodes_of_layer(r);
    for (int32_t ring = r->first; ring <= r->last; ring++) {
        const double share = (double)(ring - r->first) / (double)(r->last - r->first);
        const double radius = r->inner_radius * (1.0 - share) + r->outer_radius * share;
        for (int sector = 0; sector < 6; sector++)
            for (int32_t step = 0; step < ring || (ring == 0 && step == 0); step++) {
                const double angle = third_turn * ((double)sector + (ring > 0 ? (double)step / (double)ring : 0.0));
                const ShvVec3 x = shv_vec3(radius * shv_cos(angle), radius * shv_sin(angle), z);
                shv_store3(mesh->positions + 3 * (offset + node_at(r, sector, ring, step)), x);
            }
    }
}

/* Corners of a triangle by colour. */
typedef struct Triangle {
    int64_t nodes[3];
} Triangle;

static void set_corner(Triangle *t, const Rings *r, int sector, int32_t ring, int32_t step)
{
    t->nodes[colour_at(sector, ring, step)] = node_at(r, sector, ring, step);
}

static void add_prism(ShvMesh *mesh, int64_t *count, const Rings *r, const Triangle *triangle, int32_t layer)
{
    const int64_t below = layer * nodes_of_layer(r), above = below + nodes_of_layer(r);
    int32_t b[3], t[3];
    for (int i = 0; i < 3; i++) {
        const int64_t node = triangle->nodes[layer % 2 == 0 ? i : 2 - i];
        b[i] = (int32_t)(node + below);
        t[i] = (int32_t)(node + above);
    }
    shv_tet_write(mesh, (*count)++, (const int32_t[4]){b[0], b[1], b[2], t[2]});
    shv_tet_write(mesh, (*count)++, (const int32_t[4]){b[0], b[1], t[1], t[2]});
    shv_tet_write(mesh, (*count)++, (const int32_t[4]){b[0], t[0], t[1], t[2]});
}

/* Prisms of one sector between two rings: `ring` + 1 triangles with an edge outside, `ring` with an edge inside. */
static void add_prisms(ShvMesh *mesh, int64_t *count, const Rings *r, int sector, int32_t ring, int32_t layer)
{
    for (int32_t step = 0; step <= ring; step++) {
        Triangle outside = {0}, inside = {0};
        set_corner(&outside, r, sector, ring, step);
        set_corner(&outside, r, sector, ring + 1, step);
        set_corner(&outside, r, sector, ring + 1, step + 1);
        add_prism(mesh, count, r, &outside, layer);
        if (step == ring) return;
        set_corner(&inside, r, sector, ring, step);
        set_corner(&inside, r, sector, ring, step + 1);
        set_corner(&inside, r, sector, ring + 1, step + 1);
        add_prism(mesh, count, r, &inside, layer);
    }
}

static ShvStatus check_parameters(const ShvMeshDefinition *d, ShvError *error)
{
    SHV_TRY(shv_require_length(d->radius, "cylinder", "radius", error));
    SHV_TRY(shv_require_length(d->height, "cylinder", "height", error));
    if (!(isfinite(d->inner_radius) && d->inner_radius >= 0.0))
        return shv_fail(error, SHV_BAD_INPUT, "cylinder: inner_radius is %g m, but must be 0 (solid) or positive",
                        d->inner_radius);
    if (d->inner_radius >= d->radius)
        return shv_fail(error, SHV_BAD_INPUT, "cylinder: inner_radius %g m must be less than radius %g m",
                        d->inner_radius, d->radius);
    SHV_TRY(shv_require_edge(d->edge, d->height, "cylinder", "height", error));
    SHV_TRY(shv_require_edge(d->edge, d->radius - d->inner_radius, "cylinder", "thickness of the wall", error));
    return d->inner_radius > 0.0 ? shv_require_edge(d->edge, d->inner_radius, "cylinder", "inner radius", error)
                                 : SHV_OK;
}

static ShvStatus choose_rings(Rings *r, const ShvMeshDefinition *d, ShvError *error)
{
    const bool hollow = d->inner_radius > 0.0;
    const double last = fmax(hollow ? 2.0 : 1.0, floor(edge_over_ring * d->radius / d->edge + 0.5));
    const double layers = fmax(1.0, floor(edge_over_ring * d->height / d->edge + 0.5));
    const double wall = fmax(1.0, floor(last * (1.0 - d->inner_radius / d->radius) + 0.5));
    /* Before they become integers. */
    SHV_TRY(shv_require_count(fmax(last, layers), d->edge, "cylinder", error));
    *r = (Rings){hollow ? (int32_t)(last - fmin(wall, last - 1.0)) : 0,
                 (int32_t)last,
                 (int32_t)layers,
                 d->inner_radius,
                 d->radius,
                 d->height};
    return shv_require_count(count_tets(r), d->edge, "cylinder", error);
}

ShvStatus shv_mesh_cylinder(ShvMesh *mesh, ShvMemory *memory, const ShvMeshDefinition *definition, ShvError *error)
{
    *mesh = (ShvMesh){0};
    Rings rings;
    SHV_TRY(check_parameters(definition, error));
    SHV_TRY(choose_rings(&rings, definition, error));
    const int64_t nodes = nodes_of_layer(&rings) * ((int64_t)rings.layers + 1);
    SHV_TRY(shv_mesh_allocate(mesh, memory, nodes, (int64_t)count_tets(&rings), error));
    for (int32_t layer = 0; layer <= rings.layers; layer++) place_layer(mesh, &rings, layer);
    int64_t count = 0;
    for (int32_t layer = 0; layer < rings.layers; layer++)
        for (int32_t ring = rings.first; ring < rings.last; ring++)
            for (int sector = 0; sector < 6; sector++) add_prisms(mesh, &count, &rings, sector, ring, layer);
    return SHV_OK;
}
