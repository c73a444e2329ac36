#include <stdbool.h>

#include "mesh/shell.h"

/* A tet keeps this share of the volume it has in a straight prism: a sliver would set the time step of the body. */
static const double least_share = 0.1;
/* Depth left to the corners of a bad prism, its largest slope along an edge, and the share of the thickness below
   which a shell is no shell of that thickness any more. */
static const double reduction = 0.85, steepest = 0.5, least_depth = 0.05;
/* Two opposite walls of 0.45 of their distance leave a tenth of it free. */
static const double share_of_room = 0.45;

static double tet_volume(ShvVec3 a, ShvVec3 b, ShvVec3 c, ShvVec3 d)
{
    return shv_dot(shv_cross(shv_sub(b, a), shv_sub(c, a)), shv_sub(d, a)) / 6.0;
}

static double triangle_area(const ShvShell *shell, const int32_t corners[3])
{
    const ShvVec3 a = shv_surface_position(&shell->surface, corners[0]);
    return 0.5 * shv_norm(shv_cross(shv_sub(shv_surface_position(&shell->surface, corners[1]), a),
                                    shv_sub(shv_surface_position(&shell->surface, corners[2]), a)));
}

/* Whether all tets under the triangle keep their share of volume. */
static bool prism_is_good(const ShvShell *shell, int32_t triangle)
{
    int32_t nodes[3];
    const int table = shv_shell_sort_corners(shv_shell_corners(shell, triangle), nodes);
    const double third = triangle_area(shell, nodes) / (3.0 * (double)shell->layers);
    for (int32_t layer = 0; layer < shell->layers; layer++) {
        ShvVec3 x[6];
        for (int k = 0; k < 6; k++) x[k] = shv_shell_point(shell, nodes[k % 3], layer + k / 3);
        for (int k = 0; k < 3; k++) {
            const uint8_t *c = shv_prism_tets[table][k];
            const double straight = third * shell->depths[nodes[k]];
            if (!(tet_volume(x[c[0]], x[c[1]], x[c[2]], x[c[3]]) > least_share * straight)) return false;
        }
    }
    return true;
}

/* Lowers depths until none is larger than a neighbour's by more than `steepest` × the edge between them. */
static void limit_slope(ShvShell *shell)
{
    for (bool changed = true; changed;) {
        changed = false;
        for (int32_t t = 0; t < shell->surface.triangle_count; t++) {
            const int32_t *corners = shv_shell_corners(shell, t);
            for (int k = 0; k < 3; k++) {
                const int32_t a = corners[k], b = corners[(k + 1) % 3];
                const double rise = steepest * shv_norm(shv_sub(shv_surface_position(&shell->surface, a),
                                                                shv_surface_position(&shell->surface, b)));
                /* Every edge is met from both sides, once in each direction. */
                if (shell->depths[a] > shell->depths[b] + rise) {
                    shell->depths[a] = shell->depths[b] + rise;
                    changed = true;
                }
            }
        }
    }
}

/* Marks (reduces once) the corners of every bad prism; gives the first bad triangle, or −1. */
static int32_t reduce_bad(ShvShell *shell, bool *reduced)
{
    int32_t first = -1;
    for (int32_t v = 0; v < shell->surface.node_count; v++) reduced[v] = false;
    for (int32_t t = 0; t < shell->surface.triangle_count; t++) {
        if (prism_is_good(shell, t)) continue;
        if (first < 0) first = t;
        for (int k = 0; k < 3; k++) reduced[shv_shell_corners(shell, t)[k]] = true;
    }
    for (int32_t v = 0; first >= 0 && v < shell->surface.node_count; v++)
        if (reduced[v]) shell->depths[v] *= reduction;
    return first;
}

static ShvStatus refuse_too_thin(const ShvShell *shell, double thickness, const char *what, ShvError *error)
{
    for (int32_t t = 0; t < shell->surface.triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            const int32_t v = shv_shell_corners(shell, t)[k];
            if (shell->depths[v] >= least_depth * thickness) continue;
            const ShvVec3 x = shv_surface_position(&shell->surface, v);
            return shv_fail(error, SHV_BAD_INPUT,
                            "%s: there is no room for a shell of %g m at triangle %d, corner "
                            "(%.9g, %.9g, %.9g): the surface is too sharp or the body too thin there; reduce the "
                            "thickness, or smooth or coarsen the surface",
                            what, thickness, (int)t, x.x, x.y, x.z);
        }
    return SHV_OK;
}

ShvStatus shv_shell_find_depths(ShvShell *shell, double thickness, const char *what, ShvError *error)
{
    for (int32_t v = 0; v < shell->surface.node_count; v++) shell->depths[v] = thickness;
    SHV_TRY(shv_shell_cap_by_room(shell, share_of_room, thickness / share_of_room, error));
    const size_t nodes = (size_t)shell->surface.node_count;
    bool *reduced = shv_allocate(shell->surface.memory, SHV_PART_GENERAL, nodes, sizeof *reduced);
    if (!reduced) return shv_fail_memory(error, "a shell", nodes);
    /* Every round lowers a depth by 15 %, and one below the least ends it. */
    ShvStatus status;
    do {
        limit_slope(shell);
        status = refuse_too_thin(shell, thickness, what, error);
    } while (status == SHV_OK && reduce_bad(shell, reduced) >= 0);
    shv_release(reduced);
    return status;
}
