#include "shape/triangle.h"

static ShvTrianglePoint on_corner(const ShvVec3 corners[3], int corner)
{
    ShvTrianglePoint at = {corners[corner], {0.0, 0.0, 0.0}, corner};
    at.weights[corner] = 1.0;
    return at;
}

static ShvTrianglePoint on_edge(const ShvVec3 corners[3], int from, int to, double share)
{
    const ShvVec3 way = shv_sub(corners[to], corners[from]);
    ShvTrianglePoint at = {
        shv_madd(corners[from], share, way), {0.0, 0.0, 0.0}, SHV_TRIANGLE_EDGES + (to == (from + 1) % 3 ? from : to)};
    at.weights[from] = 1.0 - share;
    at.weights[to] = share;
    return at;
}

/* By the Voronoi regions of the triangle's corners, edges and face (C. Ericson, Real-Time Collision Detection, §5.1.5). */
ShvTrianglePoint shv_triangle_closest(ShvVec3 p, const ShvVec3 corners[3])
{
    const ShvVec3 a = corners[0], b = corners[1], c = corners[2];
    const ShvVec3 ab = shv_sub(b, a), ac = shv_sub(c, a);
    const ShvVec3 ap = shv_sub(p, a), bp = shv_sub(p, b), cp = shv_sub(p, c);
    const double d1 = shv_dot(ab, ap), d2 = shv_dot(ac, ap), d3 = shv_dot(ab, bp), d4 = shv_dot(ac, bp),
                 d5 = shv_dot(ab, cp), d6 = shv_dot(ac, cp);
    if (d1 <= 0.0 && d2 <= 0.0) return on_corner(corners, 0);
    if (d3 >= 0.0 && d4 <= d3) return on_corner(corners, 1);
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return on_edge(corners, 0, 1, d1 / (d1 - d3));
    if (d6 >= 0.0 && d5 <= d6) return on_corner(corners, 2);
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return on_edge(corners, 0, 2, d2 / (d2 - d6));
    const double va = d3 * d6 - d5 * d4;
    if (va <= 0.0 && d4 >= d3 && d5 >= d6) return on_edge(corners, 1, 2, (d4 - d3) / ((d4 - d3) + (d5 - d6)));
    const double scale = 1.0 / (va + vb + vc);
    return (ShvTrianglePoint){shv_madd(shv_madd(a, vb * scale, ab), vc * scale, ac),
                              {1.0 - vb * scale - vc * scale, vb * scale, vc * scale},
                              SHV_TRIANGLE_FACE};
}
