#include "bullet_bridge/impact_shape.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "bullet_bridge/guarded.hpp"
#include "bullet_bridge/numbers.hpp"

namespace
{

using shiver::ImpactPiece;

// The points from `begin` to the end as one more piece.
void add_piece(ShvImpactShape &shape, int32_t begin)
{
    ImpactPiece piece = {};
    piece.begin = begin;
    piece.count = static_cast<int32_t>(shape.points.size() / 3) - begin;
    const double *points = shape.points.data() + 3 * static_cast<size_t>(begin);
    for (int axis = 0; axis < 3; axis++) {
        piece.box.low[axis] = HUGE_VAL;
        piece.box.high[axis] = -HUGE_VAL;
    }
    for (int32_t i = 0; i < piece.count; i++) {
        const double *p = points + 3 * static_cast<size_t>(i);
        piece.arm = std::max(piece.arm, std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]));
        for (int axis = 0; axis < 3; axis++) {
            piece.box.low[axis] = std::min(piece.box.low[axis], p[axis] - shape.radius);
            piece.box.high[axis] = std::max(piece.box.high[axis], p[axis] + shape.radius);
        }
    }
    for (int axis = 0; axis < 3; axis++) piece.size = std::max(piece.size, piece.box.high[axis] - piece.box.low[axis]);
    shape.pieces.push_back(piece);
    shape.most_points = std::max(shape.most_points, piece.count);
    shape.arm = std::max(shape.arm, piece.arm);
    shape.size = std::max(shape.size, piece.size);
}

void finish(ShvImpactShape &shape)
{
    for (size_t i = 0; i < shape.pieces.size(); i++) {
        const double *low = shape.pieces[i].box.low, *high = shape.pieces[i].box.high;
        const auto volume =
            btDbvtVolume::FromMM(btVector3(low[0], low[1], low[2]), btVector3(high[0], high[1], high[2]));
        shape.tree.insert(volume, nullptr)->dataAsInt = static_cast<int>(i);
    }
}

// Fills a new shape; no exception gets out.
template <typename Fill> ShvStatus create(ShvImpactShape **out, ShvError *error, Fill fill)
{
    return shiver::guarded(error, [&] {
        auto shape = std::make_unique<ShvImpactShape>();
        fill(*shape);
        if (!shape->plane()) finish(*shape);
        *out = shape.release();
        return SHV_OK;
    });
}

} // namespace

ShvStatus shv_impact_hulls_create(ShvImpactShape **shape, const double *vertices, const int32_t *vertex_begin,
                                  int32_t hulls, ShvError *error)
{
    *shape = nullptr;
    bool good = hulls > 0 && vertex_begin[0] >= 0;
    for (int32_t i = 0; good && i < hulls; i++) good = vertex_begin[i + 1] > vertex_begin[i];
    if (!good)
        return shv_fail(error, SHV_BAD_INPUT, "a body needs at least one hull, and each hull at least one vertex");
    const int64_t begin = vertex_begin[0], end = vertex_begin[hulls];
    if (!shiver::finite(vertices + 3 * begin, 3 * (end - begin)))
        return shv_fail(error, SHV_BAD_INPUT, "a hull has a vertex that is not finite: give finite coordinates");
    return create(shape, error, [=](ShvImpactShape &made) {
        for (int32_t i = 0; i < hulls; i++) {
            const int32_t first = static_cast<int32_t>(made.points.size() / 3);
            made.points.insert(made.points.end(), vertices + 3 * static_cast<int64_t>(vertex_begin[i]),
                               vertices + 3 * static_cast<int64_t>(vertex_begin[i + 1]));
            add_piece(made, first);
        }
    });
}

// Of a unit normal: how far off 1 its length may be.
static const double unit_length = 1e-6;

ShvStatus shv_impact_plane_create(ShvImpactShape **shape, const double normal[3], double offset, ShvError *error)
{
    *shape = nullptr;
    const double length = std::sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    if (!(std::fabs(length - 1.0) < unit_length) || !std::isfinite(offset))
        return shv_fail(error, SHV_BAD_INPUT,
                        "a plane needs a normal of length 1 (this one has %g) and a finite offset", length);
    return create(shape, error, [=](ShvImpactShape &made) {
        made.normal = btVector3(normal[0], normal[1], normal[2]) / length;
        made.offset = offset;
    });
}

ShvStatus shv_impact_sphere_create(ShvImpactShape **shape, double radius, ShvError *error)
{
    *shape = nullptr;
    if (!(radius > 0.0) || !std::isfinite(radius))
        return shv_fail(error, SHV_BAD_INPUT, "a sphere needs a positive, finite radius, not %g", radius);
    return create(shape, error, [=](ShvImpactShape &made) {
        made.radius = radius;
        made.points.assign(3, 0.0);
        add_piece(made, 0);
    });
}

ShvStatus shv_impact_box_create(ShvImpactShape **shape, const double half[3], ShvError *error)
{
    *shape = nullptr;
    if (!(half[0] > 0.0 && half[1] > 0.0 && half[2] > 0.0) || !shiver::finite(half, 3))
        return shv_fail(error, SHV_BAD_INPUT, "a box needs positive, finite half sizes, not %g, %g, %g", half[0],
                        half[1], half[2]);
    return create(shape, error, [=](ShvImpactShape &made) {
        for (int corner = 0; corner < 8; corner++)
            for (int axis = 0; axis < 3; axis++) made.points.push_back((corner >> axis) & 1 ? half[axis] : -half[axis]);
        add_piece(made, 0);
    });
}

ShvStatus shv_impact_mesh_create(ShvImpactShape **shape, const double *vertices, int32_t vertex_count,
                                 const int32_t *triangles, int32_t triangle_count, ShvError *error)
{
    *shape = nullptr;
    const int64_t corners = 3 * static_cast<int64_t>(triangle_count);
    const bool inside =
        triangle_count > 0 && vertex_count > 0 &&
        std::all_of(triangles, triangles + corners, [=](int32_t i) { return i >= 0 && i < vertex_count; });
    if (!inside || corners > INT32_MAX || !shiver::finite(vertices, 3 * static_cast<int64_t>(vertex_count)))
        return shv_fail(error, SHV_BAD_INPUT,
                        "a surface needs at least one triangle, triangles of vertices it has, and "
                        "finite coordinates");
    return create(shape, error, [=](ShvImpactShape &made) {
        for (int64_t i = 0; i < corners; i++) {
            const double *p = vertices + 3 * static_cast<int64_t>(triangles[i]);
            made.points.insert(made.points.end(), p, p + 3);
            if (i % 3 == 2) add_piece(made, static_cast<int32_t>(i - 2));
        }
    });
}

void shv_impact_shape_release(ShvImpactShape *shape)
{
    delete shape;
}
