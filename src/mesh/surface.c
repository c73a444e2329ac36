#include "mesh/surface.h"

#include <stdio.h>

#include "mesh/edge_table.h"

void shv_surface_release(ShvSurface *surface)
{
    shv_release(surface->positions);
    shv_release(surface->triangles);
    *surface = (ShvSurface){0};
}

static ShvStatus fail_at_triangle(const ShvSurface *surface, const char *what, int32_t triangle, const char *trouble,
                                  ShvError *error)
{
    const int32_t *corners = surface->triangles + 3 * (int64_t)triangle;
    const ShvVec3 a = shv_surface_position(surface, corners[0]), b = shv_surface_position(surface, corners[1]),
                  c = shv_surface_position(surface, corners[2]);
    return shv_fail(error, SHV_BAD_INPUT,
                    "%s: triangle %d with corners (%.9g, %.9g, %.9g), (%.9g, %.9g, %.9g), "
                    "(%.9g, %.9g, %.9g) %s",
                    what, (int)triangle, a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, trouble);
}

static double longest_edge_squared(ShvVec3 a, ShvVec3 b, ShvVec3 c)
{
    const ShvVec3 ab = shv_sub(b, a), bc = shv_sub(c, b), ca = shv_sub(a, c);
    return fmax(shv_dot(ab, ab), fmax(shv_dot(bc, bc), shv_dot(ca, ca)));
}

static ShvStatus refuse_degenerate(const ShvSurface *surface, const char *what, ShvError *error)
{
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        const int32_t *corners = surface->triangles + 3 * (int64_t)t;
        for (int k = 0; k < 3; k++)
            if (corners[k] < 0 || corners[k] >= surface->node_count)
                return shv_fail(error, SHV_BAD_INPUT, "%s: triangle %d uses node %d, but there are %d nodes", what,
                                (int)t, (int)corners[k], (int)surface->node_count);
        const ShvVec3 a = shv_surface_position(surface, corners[0]), b = shv_surface_position(surface, corners[1]),
                      c = shv_surface_position(surface, corners[2]);
        if (!shv_finite3(a) || !shv_finite3(b) || !shv_finite3(c))
            return fail_at_triangle(surface, what, t, "has a coordinate that is not finite", error);
        const double twice_area = shv_norm(shv_cross(shv_sub(b, a), shv_sub(c, a)));
        /* Rounding leaves about 1e-16 of the squared edge in the area of three points on a line. */
        if (!(twice_area > 1e-14 * longest_edge_squared(a, b, c)))
            return fail_at_triangle(surface, what, t, "has no area: remove or merge it", error);
    }
    return SHV_OK;
}

static ShvStatus refuse_open(const ShvSurface *surface, const char *what, ShvError *error)
{
    const int64_t half_edges = 3 * (int64_t)surface->triangle_count;
    if (half_edges > INT32_MAX)
        return shv_fail(error, SHV_BAD_INPUT, "%s: more than %d triangles; use a coarser surface", what, INT32_MAX / 3);
    ShvEdgeTable table;
    SHV_TRY(shv_edge_table_create(&table, surface->memory, surface->triangles, half_edges, error));
    ShvStatus status = SHV_OK;
    for (int32_t h = 0; h < half_edges && status == SHV_OK; h++) {
        const int32_t twice = shv_edge_table_insert(&table, h);
        if (twice >= 0) {
            char trouble[160];
            snprintf(trouble, sizeof trouble,
                     "has an edge in the same direction as triangle %d: more than two triangles "
                     "meet there, or one of them is turned inside out",
                     (int)(twice / 3));
            status = fail_at_triangle(surface, what, h / 3, trouble, error);
        }
    }
    for (int32_t h = 0; h < half_edges && status == SHV_OK; h++)
        if (shv_edge_table_find(&table, shv_half_edge_end(surface->triangles, h),
                                shv_half_edge_start(surface->triangles, h)) < 0)
            status =
                fail_at_triangle(surface, what, h / 3,
                                 "has an edge without a neighbour: the surface is not closed; fill the hole", error);
    shv_edge_table_release(&table);
    return status;
}

static double surface_area(const ShvSurface *surface)
{
    double area = 0.0;
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        const int32_t *corners = surface->triangles + 3 * (int64_t)t;
        const ShvVec3 a = shv_surface_position(surface, corners[0]);
        area += 0.5 * shv_norm(shv_cross(shv_sub(shv_surface_position(surface, corners[1]), a),
                                         shv_sub(shv_surface_position(surface, corners[2]), a)));
    }
    return area;
}

ShvStatus shv_surface_require_closed(ShvSurface *surface, const char *what, ShvError *error)
{
    if (surface->triangle_count < 1) return shv_fail(error, SHV_BAD_INPUT, "%s: the surface has no triangles", what);
    SHV_TRY(refuse_degenerate(surface, what, error));
    SHV_TRY(refuse_open(surface, what, error));
    const double volume = shv_surface_mass(surface).mass, area = surface_area(surface);
    /* A ball has V² = A³ / 36π; a sheet of relative thickness 1e-12 is called flat. */
    if (!(fabs(volume) > 1e-12 * area * sqrt(area)))
        return shv_fail(error, SHV_BAD_INPUT, "%s: the surface encloses no volume; give it an inside", what);
    if (volume > 0.0) return SHV_OK;
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        int32_t *corners = surface->triangles + 3 * (int64_t)t;
        const int32_t kept = corners[1];
        corners[1] = corners[2];
        corners[2] = kept;
    }
    return SHV_OK;
}

/* Adds the integrals of 1, x and x xᵀ over the tet (0, a, b, c): V, V s / 4 and V (s sᵀ + a aᵀ + b bᵀ + c cᵀ) / 20 with
   s = a + b + c (exact integration of quadratics over a simplex). */
static void add_tet(ShvVec3 a, ShvVec3 b, ShvVec3 c, double *volume, double first[3], double second[3][3])
{
    const double v = shv_dot(a, shv_cross(b, c)) / 6.0;
    const double p[4][3] = {
        {a.x, a.y, a.z}, {b.x, b.y, b.z}, {c.x, c.y, c.z}, {a.x + b.x + c.x, a.y + b.y + c.y, a.z + b.z + c.z}};
    *volume += v;
    for (int i = 0; i < 3; i++) {
        first[i] += v * p[3][i] / 4.0;
        for (int j = 0; j < 3; j++)
            second[i][j] += v * (p[0][i] * p[0][j] + p[1][i] * p[1][j] + p[2][i] * p[2][j] + p[3][i] * p[3][j]) / 20.0;
    }
}

ShvMassProperties shv_surface_mass(const ShvSurface *surface)
{
    ShvMassProperties mass = {0};
    if (surface->triangle_count < 1) return mass;
    /* Seen from one of its own nodes a far-away surface loses no digits. */
    const ShvVec3 origin = shv_surface_position(surface, surface->triangles[0]);
    double volume = 0.0, first[3] = {0}, second[3][3] = {{0}};
    for (int32_t t = 0; t < surface->triangle_count; t++) {
        const int32_t *corners = surface->triangles + 3 * (int64_t)t;
        add_tet(shv_sub(shv_surface_position(surface, corners[0]), origin),
                shv_sub(shv_surface_position(surface, corners[1]), origin),
                shv_sub(shv_surface_position(surface, corners[2]), origin), &volume, first, second);
    }
    mass.mass = volume;
    if (volume == 0.0) return mass;
    const double centre[3] = {first[0] / volume, first[1] / volume, first[2] / volume};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) second[i][j] -= volume * centre[i] * centre[j];
    const double trace = second[0][0] + second[1][1] + second[2][2];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) mass.inertia.m[i][j] = (i == j ? trace : 0.0) - second[i][j];
    mass.centre = shv_add(origin, shv_load3(centre));
    return mass;
}
