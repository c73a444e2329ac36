#include "bullet_bridge/depth.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>

#include "bullet_bridge/convex_pair.hpp"
#include "bullet_bridge/guarded.hpp"
#include "bullet_bridge/numbers.hpp"

namespace shiver
{

btVector3 support(const Core &core, const btVector3 &direction)
{
    const double x = direction.x(), y = direction.y(), z = direction.z();
    int32_t best = 0;
    double farthest = -HUGE_VAL;
    for (int32_t i = 0; i < core.count; i++) {
        const double *p = core.points + 3 * static_cast<int64_t>(i);
        const double along = x * p[0] + y * p[1] + z * p[2];
        if (along > farthest) {
            farthest = along;
            best = i;
        }
    }
    const double *p = core.points + 3 * static_cast<int64_t>(best);
    return btVector3(p[0], p[1], p[2]);
}

namespace
{

// A point of first − second and where it comes from.
struct Corner {
    btVector3 difference, first, second;
};

// The second body is moved by `shift`.
Corner corner_towards(const ConvexPair &pair, const btVector3 &normal, const btVector3 &shift)
{
    Corner corner;
    corner.first = support(pair.first, normal);
    corner.second = support(pair.second, -normal) + shift;
    corner.difference = corner.first - corner.second;
    return corner;
}

// Gap of the cores across a direction.
double gap_across(const ConvexPair &pair, const btVector3 &normal)
{
    return -normal.dot(corner_towards(pair, normal, btVector3(0, 0, 0)).difference);
}

// From the first core to the second: against the nearest point of the simplex, of which a triangle's plane has more digits.
btVector3 direction_of(const btVoronoiSimplexSolver &simplex, const btVector3 &nearest)
{
    const btVector3 *corner = simplex.m_simplexVectorW;
    const btVector3 across = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const double size = across.length(), side = across.dot(corner[0]);
    if (simplex.numVertices() != 3 || !(size > 0.0) || side == 0.0) return nearest / -nearest.length();
    return across / (side > 0.0 ? -size : size);
}

// Rounding of a support point, and of a gap from two of them, of the larger body; depth up to which cores count as touching; of the
// product of two edges, area below which a face is flat; of the smaller body, distance at which a refined gap is measured.
const double rounding_of_support = 1e-15, rounding_of_gap = 1e-14, touching_depth = 1e-12, flat_area = 1e-13,
             flat_size = 1e-13, measured_apart = 1e-2;
enum { REFINEMENTS = 8 };

enum { MOST_ROUNDS = 64 };

Corner scaled_corner(const ConvexPair &pair, const btVector3 &normal, const btVector3 &shift, double unit)
{
    const Corner corner = corner_towards(pair, normal, shift);
    return {corner.difference * unit, corner.first * unit, corner.second * unit};
}

// GJK (Gilbert, Johnson and Keerthi 1988) of the cores. The gap is the largest found across any direction tried (0 or less
// when they touch), which is a lower bound whether or not the iteration has converged.
Gap distance(const ConvexPair &pair, const btVector3 &guess, const btVector3 &shift)
{
    const double unit = simplex_unit(pair.small, pair.large), resolution = rounding_of_support * pair.large * unit;
    Gap best;
    best.gap = -HUGE_VAL;
    best.normal = guess.normalized();
    btVoronoiSimplexSolver simplex;
    simplex.reset();
    simplex.setEqualVertexThreshold(0);
    const Corner start = scaled_corner(pair, best.normal, shift, unit);
    simplex.addVertex(start.difference, start.first, start.second);
    btVector3 nearest = start.difference;
    double length = nearest.length();
    int stalls = 0;
    for (int round = 0; round < MOST_ROUNDS && length > resolution; round++) {
        const btVector3 normal = direction_of(simplex, nearest);
        const Corner corner = scaled_corner(pair, normal, shift, unit);
        const double gap = -normal.dot(corner.difference);
        if (gap > best.gap) {
            best.gap = gap;
            best.normal = normal;
        }
        if (length - gap <= resolution || simplex.inSimplex(corner.difference)) break;
        const btVoronoiSimplexSolver before = simplex;
        simplex.addVertex(corner.difference, corner.first, corner.second);
        btVector3 nearer;
        const bool found = simplex.closest(nearer) && !simplex.fullSimplex(); // else the origin is inside: they overlap
        // A direction off by ε costs a gap of order ε but a length of order ε²: the last rounds are lost in round-off.
        if (!found || (!(nearer.length() < length) && ++stalls > 4)) {
            simplex = before;
            break;
        }
        nearest = nearer;
        length = nearest.length();
    }
    simplex.compute_points(best.first, best.second);
    best.gap /= unit;
    best.first /= unit;
    best.second /= unit;
    return best;
}

// Improves the direction of bodies that touch or overlap: the second is moved until it is just clear along `normal`; the
// direction in which GJK then sees it is the better one. At the shortest way out this is a fixed point: the face of
// first − second that is crossed there.
Gap refine(const ConvexPair &pair, const btVector3 &start)
{
    Gap best;
    best.normal = start;
    best.gap = gap_across(pair, start);
    for (int round = 0; round < REFINEMENTS; round++) {
        const btVector3 shift = best.normal * (measured_apart * pair.small - best.gap);
        Gap seen = distance(pair, best.normal, shift);
        const double gap = gap_across(pair, seen.normal);
        best.first = seen.first;
        best.second = seen.second - shift;
        const bool better = gap > best.gap + rounding_of_gap * pair.large;
        if (gap > best.gap) {
            best.gap = gap;
            best.normal = seen.normal;
        }
        if (!better) break;
    }
    return best;
}

// A face of the polytope inside first − second; its plane is normal · x = distance, its corners turn about the normal.
struct Face {
    int corner[3];
    btVector3 normal;
    double distance;
};

// What the expanding polytope knows.
struct Polytope {
    std::vector<btVector3> corners;
    std::vector<Face> faces;
};

// Faces without area are kept, so that the surface stays closed, but are never seen nor chosen.
void add_face(Polytope &polytope, int a, int b, int c)
{
    const std::vector<btVector3> &p = polytope.corners;
    const btVector3 one = p[b] - p[a], other = p[c] - p[a];
    Face face = {{a, b, c}, one.cross(other), HUGE_VAL};
    const double area = face.normal.length();
    if (area > flat_area * one.length() * other.length()) {
        face.normal /= area;
        face.distance = face.normal.dot(p[a]);
    } else {
        face.normal.setZero();
    }
    polytope.faces.push_back(face);
}

btVector3 difference_towards(const ConvexPair &pair, const btVector3 &normal)
{
    return corner_towards(pair, normal, btVector3(0, 0, 0)).difference;
}

// The extreme corner of first − second across a line or plane through `through`, on whichever side it is farther away.
btVector3 farther(const ConvexPair &pair, const btVector3 &through, const btVector3 &direction, double &away)
{
    const btVector3 high = difference_towards(pair, direction), low = difference_towards(pair, -direction);
    const double above = direction.dot(high - through), below = direction.dot(through - low);
    away = std::max(above, below);
    return above >= below ? high : low;
}

// Four corners that span a volume; false when first − second is flat, with its normal in `normal`.
bool start_polytope(const ConvexPair &pair, Polytope &polytope, btVector3 &normal)
{
    const double flat = flat_size * pair.large;
    btVector3 directions[3] = {normal, btVector3(), btVector3()};
    btPlaneSpace1(directions[0], directions[1], directions[2]);
    std::vector<btVector3> &p = polytope.corners;
    double away, most = 0.0;
    p.assign({difference_towards(pair, normal), btVector3(), btVector3(), btVector3()});
    for (const btVector3 &direction : directions) {
        const btVector3 corner = farther(pair, p[0], direction, away);
        if (!(away > most)) continue;
        most = away;
        p[1] = corner;
    }
    if (!(most > flat)) return false; // a point: any direction is as good
    btVector3 across[2];
    btPlaneSpace1((p[1] - p[0]).normalized(), across[0], across[1]);
    most = 0.0;
    for (const btVector3 &direction : across) {
        const btVector3 corner = farther(pair, p[0], direction, away);
        if (!(away > most)) continue;
        most = away;
        p[2] = corner;
    }
    normal = across[0];
    if (!(most > flat)) return false; // a needle
    normal = (p[1] - p[0]).cross(p[2] - p[0]).normalized();
    p[3] = farther(pair, p[0], normal, away);
    if (!(away > flat)) return false;
    if (normal.dot(p[3] - p[0]) > 0.0) std::swap(p[1], p[2]);
    add_face(polytope, 0, 1, 2);
    add_face(polytope, 0, 3, 1);
    add_face(polytope, 1, 3, 2);
    add_face(polytope, 2, 3, 0);
    return true;
}

// Replaces the faces that see the last corner by a cone from their rim to it.
void add_last_corner(Polytope &polytope, double resolution)
{
    const int last = static_cast<int>(polytope.corners.size()) - 1;
    std::vector<std::pair<int, int>> rim;
    const auto sees = [&](const Face &face) {
        return face.normal.dot(polytope.corners[last]) - face.distance > resolution;
    };
    for (const Face &face : polytope.faces) {
        if (!sees(face)) continue;
        for (int i = 0; i < 3; i++) {
            const int from = face.corner[i], to = face.corner[(i + 1) % 3];
            const auto twin = std::find(rim.begin(), rim.end(), std::make_pair(to, from));
            if (twin != rim.end())
                rim.erase(twin);
            else
                rim.emplace_back(from, to);
        }
    }
    polytope.faces.erase(std::remove_if(polytope.faces.begin(), polytope.faces.end(), sees), polytope.faces.end());
    for (const auto &edge : rim) add_face(polytope, edge.first, edge.second, last);
}

enum { MOST_CORNERS = 256 };

// Expanding polytope (van den Bergen 2001) on signed distances, so that it does not matter whether the origin is inside the
// start, on its surface (bodies that touch) or just outside. Answers the best direction it has tried. (libccd's has no
// direction, or a wrong one, for all of 4,000 pairs of hulls that touch in a face, and a wrong one for 3 % of them when one
// hull is grown by a thousandth so that they overlap.)
btVector3 expand(const ConvexPair &pair, const btVector3 &guess)
{
    const double resolution = rounding_of_gap * pair.large;
    btVector3 best = guess;
    Polytope polytope;
    if (!start_polytope(pair, polytope, best)) return best;
    double best_gap = -HUGE_VAL;
    while (polytope.corners.size() < MOST_CORNERS) {
        const auto nearest = std::min_element(polytope.faces.begin(), polytope.faces.end(),
                                              [](const Face &a, const Face &b) { return a.distance < b.distance; });
        if (nearest == polytope.faces.end() || -nearest->distance <= best_gap + resolution) break;
        const btVector3 normal = nearest->normal;
        const btVector3 corner = difference_towards(pair, normal);
        const double gap = -normal.dot(corner), distance = nearest->distance;
        if (gap > best_gap) {
            best_gap = gap;
            best = normal;
        }
        if (-gap - distance <= resolution) break;
        polytope.corners.push_back(corner);
        add_last_corner(polytope, resolution);
    }
    return best;
}

// The cores overlap, touch or nearly so. A direction across which the gap is not negative settles it; otherwise the
// expanding polytope finds the shortest way out.
Gap overlap(const ConvexPair &pair, const btVector3 &guess)
{
    const Gap near_guess = refine(pair, guess);
    if (near_guess.gap >= -touching_depth * pair.large) return near_guess;
    const Gap found = refine(pair, expand(pair, guess));
    return found.gap > near_guess.gap ? found : near_guess;
}

} // namespace

Gap convex_gap(const ConvexPair &pair, const btVector3 &guess)
{
    Gap answer = distance(pair, guess, btVector3(0, 0, 0));
    if (answer.gap <= pair.close) answer = overlap(pair, answer.normal);
    answer.gap -= pair.first.radius + pair.second.radius;
    answer.first += answer.normal * pair.first.radius;
    answer.second -= answer.normal * pair.second.radius;
    return answer;
}

namespace
{

bool usable(const ShvConvex *body)
{
    if (!finite(body->position, 3) || !finite(body->rotation, 9) || !(body->radius >= 0.0)) return false;
    if (!std::isfinite(body->radius)) return false;
    return body->count > 0 && finite(body->points, 3 * static_cast<int64_t>(body->count));
}

// The body from `origin`; `moved` holds its points.
Core place(const ShvConvex *body, const btVector3 &origin, std::vector<double> &moved)
{
    Core core;
    core.radius = body->radius;
    const btMatrix3x3 rotation = matrix(body->rotation);
    const btVector3 offset = vector(body->position) - origin;
    moved.resize(3 * static_cast<size_t>(body->count));
    for (size_t i = 0; i < moved.size(); i += 3) store(rotation * vector(body->points + i) + offset, moved.data() + i);
    core.points = moved.data();
    core.count = body->count;
    return core;
}

// Largest extent along the axes; `middle` is that of the box.
double extent(const Core &core, btVector3 &middle)
{
    double largest = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        btVector3 direction(0, 0, 0);
        direction[axis] = 1.0;
        const double high = support(core, direction)[axis], low = support(core, -direction)[axis];
        largest = std::max(largest, high - low);
        middle[axis] = 0.5 * (high + low);
    }
    return largest + 2.0 * core.radius;
}

void measure(const ShvConvex *first, const ShvConvex *second, ShvConvexGap *gap)
{
    const btVector3 origin = vector(first->position);
    std::vector<double> points[2];
    ConvexPair pair;
    pair.first = place(first, origin, points[0]);
    pair.second = place(second, origin, points[1]);
    btVector3 middle[2];
    const double sizes[2] = {extent(pair.first, middle[0]), extent(pair.second, middle[1])};
    pair.large = std::max(sizes[0], sizes[1]);
    pair.small = std::min(sizes[0], sizes[1]);
    pair.close = measured_apart * pair.small;
    btVector3 guess = middle[1] - middle[0];
    if (!(guess.length2() > 0.0)) guess.setValue(1.0, 0.0, 0.0);
    const Gap answer = convex_gap(pair, guess);
    gap->gap = answer.gap;
    store(answer.normal, gap->normal);
    store(answer.first + origin, gap->first);
    store(answer.second + origin, gap->second);
}

} // namespace
} // namespace shiver

ShvStatus shv_convex_gap(const ShvConvex *first, const ShvConvex *second, ShvConvexGap *gap, ShvError *error)
{
    if (!shiver::usable(first) || !shiver::usable(second))
        return shv_fail(error, SHV_BAD_INPUT,
                        "a convex body needs at least one point, a radius that is not negative, and "
                        "finite numbers");
    return shiver::guarded(error, [&] {
        shiver::measure(first, second, gap);
        return SHV_OK;
    });
}
