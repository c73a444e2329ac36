#include "shape/segment.h"

/* V. Lumelsky, On fast computation of distance between line segments, Information Processing Letters 21 (1985). */
ShvSegmentPoints shv_segments_closest(ShvVec3 a, ShvVec3 u, ShvVec3 b, ShvVec3 v)
{
    const double parallel = 1e-6; /* sin² of the angle; the nodes of such edges meet faces */
    const ShvVec3 w = shv_sub(b, a);
    const double uu = shv_dot(u, u), vv = shv_dot(v, v), uv = shv_dot(u, v), uw = shv_dot(u, w), vw = shv_dot(v, w);
    const double determinant = uu * vv - uv * uv;
    double s = determinant > parallel * uu * vv ? (uw * vv - vw * uv) / determinant : 0.0;
    const bool first_inside = determinant > parallel * uu * vv && s >= SHV_SEGMENT_RIM && s <= 1.0 - SHV_SEGMENT_RIM;
    s = uu > 0.0 ? shv_segment_share(s) : 0.0;
    double t = vv > 0.0 ? (s * uv - vw) / vv : 0.0;
    const bool inside = first_inside && t >= SHV_SEGMENT_RIM && t <= 1.0 - SHV_SEGMENT_RIM;
    if (t < 0.0 || t > 1.0) {
        t = shv_segment_share(t);
        s = uu > 0.0 ? shv_segment_share((t * uv + uw) / uu) : 0.0;
    }
    return (ShvSegmentPoints){{s, t}, shv_add(w, shv_sub(shv_scale(v, t), shv_scale(u, s))), inside};
}
