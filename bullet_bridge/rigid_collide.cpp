// Contacts of two bodies in the poses they have. The direction comes from the distance of the parts' cores (GJK) or, where
// those overlap, from the faces' normals; gaps are measured along it on the exact hulls, and where faces lie on each other
// their overlap is clipped out, so that a contact has its whole area from the first time on.
#include <algorithm>

#include <BulletCollision/CollisionShapes/btConcaveShape.h>

#include "bullet_bridge/rigid_body.hpp"
#include "bullet_bridge/rigid_gjk.hpp"

static const size_t most_points = 4;
static const btScalar beside_a_face = 0.9; // cosine: faces farther from the contact's normal cannot be what touches
// Of the smaller radius: a face that parts the bodies this nearly as well is what touches; and this much deeper than over the
// face an overhanging corner may lie.
static const btScalar on_a_face = 1e-4, beyond_a_face = 1e-3;

// Keeps the part of the incident face that lies over the reference face.
bool ShvCollider::clip(const Placed &reference, size_t face_index, const Placed &incident, const btVector3 &outward)
{
    const ShvConvexFace &face = reference.convex->faces[face_index];
    const ShvConvexFace *other = nullptr;
    btScalar least = BT_LARGE_FLOAT;
    const btVector3 local = outward * *incident.axes;
    for (const ShvConvexFace &candidate : incident.convex->faces) {
        const btScalar along = candidate.normal.dot(local);
        if (along < least) {
            least = along;
            other = &candidate;
        }
    }
    if (!other) return false;
    polygon.clear();
    for (int corner : other->corners) polygon.push_back(incident.at(size_t(corner)));
    for (size_t i = 0; i < face.corners.size() && !polygon.empty(); i++) {
        const btVector3 from = reference.at(size_t(face.corners[i]));
        const btVector3 to = reference.at(size_t(face.corners[(i + 1) % face.corners.size()]));
        const btVector3 side = (to - from).cross(outward);
        clipped.clear();
        for (size_t k = 0; k < polygon.size(); k++) {
            const btVector3 &p = polygon[k], &q = polygon[(k + 1) % polygon.size()];
            const btScalar dp = side.dot(p - from), dq = side.dot(q - from);
            if (dp <= 0) clipped.push_back(p);
            if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0)) clipped.push_back(p + (q - p) * (dp / (dp - dq)));
        }
        polygon.swap(clipped);
    }
    const btScalar height = face.offset + outward.dot(reference.origin);
    points.clear();
    for (const btVector3 &p : polygon) {
        const btScalar gap = outward.dot(p) - height;
        if (gap <= limit) points.push_back({p - outward * (gap / 2), gap});
    }
    return !points.empty();
}

// Four points that span the contact: the deepest, the farthest from it, the farthest from their line on either side.
void ShvCollider::reduce()
{
    if (points.size() <= most_points) return;
    Point kept[most_points];
    size_t best = 0;
    for (size_t i = 1; i < points.size(); i++)
        if (points[i].gap < points[best].gap) best = i;
    kept[0] = points[best];
    btScalar most = -1;
    for (size_t i = 0; i < points.size(); i++) {
        const btScalar distance = (points[i].place - kept[0].place).length2();
        if (distance > most) {
            most = distance;
            best = i;
        }
    }
    kept[1] = points[best];
    const btVector3 line = kept[1].place - kept[0].place;
    most = -1;
    for (size_t i = 0; i < points.size(); i++) {
        const btScalar distance = line.cross(points[i].place - kept[0].place).length2();
        if (distance > most) {
            most = distance;
            best = i;
        }
    }
    kept[2] = points[best];
    const btVector3 side = line.cross(kept[2].place - kept[0].place);
    btScalar least = 0;
    bool fourth = false;
    for (size_t i = 0; i < points.size(); i++) {
        const btScalar across = side.dot(line.cross(points[i].place - kept[0].place));
        if (across < least) {
            least = across;
            best = i;
            fourth = true;
        }
    }
    kept[3] = points[best];
    points.assign(kept, kept + (fourth ? 4 : 3));
}

void ShvCollider::emit(const btVector3 &normal)
{
    reduce();
    for (const Point &point : points) {
        ShvBulletContact contact = {};
        contact.first = a->number;
        contact.second = b->number;
        for (int k = 0; k < 3; k++) {
            contact.arm_first[k] = point.place[k] / scale;
            contact.arm_second[k] = (point.place[k] - shift[k]) / scale;
            contact.normal[k] = normal[k];
        }
        contact.gap = point.gap / scale;
        contacts.push_back(contact);
    }
    points.clear();
}

// `side` 1: the plane is the second body.
void ShvCollider::plane_body(const ShvBulletBody &plane, const ShvBulletBody &body, btScalar side)
{
    const btVector3 origin = side > 0 ? btVector3(0, 0, 0) : shift;
    const btScalar height = plane.offset - plane.normal.dot(body.position * scale);
    if (body.kind == SHV_BULLET_SPHERE) {
        const btScalar gap = -height - body.radius;
        if (gap <= limit) points.push_back({origin - plane.normal * (body.radius + gap / 2), gap});
        emit(plane.normal * side);
        return;
    }
    const btVector3 local = plane.normal * body.axes; // in the body's frame
    for (const ShvConvex &part : body.shapes.parts) {
        if (local.dot(part.centre) - part.radius - height > limit) continue;
        for (const btVector3 &vertex : part.vertices) {
            const btScalar gap = local.dot(vertex) - height;
            if (gap <= limit) points.push_back({origin + body.axes * vertex - plane.normal * (gap / 2), gap});
        }
        emit(plane.normal * side);
    }
}

void ShvCollider::sphere_sphere()
{
    const btScalar distance = shift.length();
    const btVector3 normal = distance > 0 ? -shift / distance : btVector3(0, 0, 1);
    const btScalar gap = distance - a->radius - b->radius;
    if (gap <= limit) points.push_back({-normal * (a->radius + gap / 2), gap});
    emit(normal);
}

static btVector3 closest_on_segment(const btVector3 &from, const btVector3 &to, const btVector3 &point)
{
    const btVector3 way = to - from;
    const btScalar share = way.dot(point - from) / way.length2();
    return from + way * btMax(btScalar(0), btMin(btScalar(1), share));
}

// `side` 1: the sphere is the first body.
void ShvCollider::sphere_part(const ShvBulletBody &sphere, const Placed &part, bool surface, const btVector3 &centre,
                              btScalar side)
{
    if ((centre - part.origin - *part.axes * part.convex->centre).length() >
        sphere.radius + part.convex->radius + limit)
        return;
    btVector3 normal(0, 0, 1), witness(0, 0, 1);
    btScalar height = -BT_LARGE_FLOAT; // of the centre over the part
    for (const ShvConvexFace &face : part.convex->faces) {
        const btVector3 outward = *part.axes * face.normal;
        const btScalar above = outward.dot(centre - part.origin) - face.offset;
        if (above > height) {
            height = above;
            normal = outward;
        }
    }
    if (surface) {
        if (height < -sphere.radius) return;
        bool inside = true;
        btScalar nearest = BT_LARGE_FLOAT;
        for (size_t i = 0; i < 3; i++) {
            const btVector3 from = part.at(i), to = part.at((i + 1) % 3);
            if ((to - from).cross(normal).dot(centre - from) <= 0) continue;
            inside = false;
            const btVector3 way = centre - closest_on_segment(from, to, centre);
            const btScalar length = way.length();
            if (length < nearest && length > 0) {
                nearest = length;
                witness = way / length;
            }
        }
        if (!inside) {
            if (height < 0) return; // the neighbour's face knows better
            normal = witness;
            height = nearest;
        }
    } else if (height > 0) {
        static const std::vector<btVector3> point(1, btVector3(0, 0, 0));
        const ShvCore core = {part.convex->vertices, part.convex->centre, part.convex->core, part.convex->radius};
        const ShvNearest nearest =
            shv_nearest({point, point[0], 1, 0}, core, *part.axes, part.origin - centre, normal, BT_LARGE_FLOAT);
        if (nearest.apart) {
            normal = nearest.normal;
            height = normal.dot(centre - part.origin) - part.highest(normal);
        }
    }
    const btScalar gap = height - sphere.radius;
    if (gap <= limit) points.push_back({centre - normal * (sphere.radius + gap / 2), gap});
    emit(normal * side);
}

// How far the first lies above the second along an axis.
btScalar ShvCollider::gap_along(const Placed &first, const Placed &second, const btVector3 &normal) const
{
    return normal.dot(first.origin - second.origin) - first.highest(-normal) - second.highest(normal);
}

// The direction in which two cores are nearest, if it parts the bodies better than what is known; false when the bodies are out
// of reach.
bool ShvCollider::try_nearest(const Placed &first, const Placed &second, btScalar share_first, btScalar share_second,
                              const btVector3 &guess, Axis *axis) const
{
    const ShvConvex &a_part = *first.convex, &b_part = *second.convex;
    const btScalar far = limit + (1 - share_first) * a_part.radius + (1 - share_second) * b_part.radius;
    const btVector3 start = guess.fuzzyZero() ? btVector3(0, 1, 0) : guess * *first.axes;
    const ShvNearest nearest =
        shv_nearest({a_part.vertices, a_part.centre, share_first, a_part.radius},
                    {b_part.vertices, b_part.centre, share_second, b_part.radius},
                    first.axes->transposeTimes(*second.axes), (second.origin - first.origin) * *first.axes, start, far);
    if (nearest.far) return false;
    if (!nearest.apart) return true;
    const btVector3 normal = *first.axes * nearest.normal;
    const btScalar gap = gap_along(first, second, normal);
    if (gap <= axis->gap) return true;
    axis->normal = normal;
    axis->gap = gap;
    axis->witnessed = true;
    axis->witness = first.origin + *first.axes * nearest.middle;
    return true;
}

void ShvCollider::try_faces(const Placed &first, const Placed &second, const btVector3 &outward_first,
                            const btVector3 &outward_second, Axis *axis) const
{
    for (int side = 0; side < 2; side++) {
        const Placed &own = side ? second : first, &other = side ? first : second;
        const btVector3 against = (side ? outward_first : outward_second) * *own.axes;
        const btMatrix3x3 turn = other.axes->transposeTimes(*own.axes); // to the other's frame
        const btVector3 away = (other.origin - own.origin) * *own.axes;
        const btVector3 centre = (other.origin + *other.axes * other.convex->centre - own.origin) * *own.axes;
        for (const ShvConvexFace &face : own.convex->faces) {
            if (against.dot(face.normal) > 0) continue;
            if (face.normal.dot(centre) - face.offset <= axis->gap) continue; // a vertex lies lower than the centre
            const btScalar gap = face.normal.dot(away) - other.convex->highest(-(turn * face.normal)) - face.offset;
            if (gap <= axis->gap) continue;
            const btVector3 outward = *own.axes * face.normal;
            axis->normal = side ? outward : -outward;
            axis->gap = gap;
            axis->witnessed = false;
        }
    }
}

ShvCollider::Face ShvCollider::nearest_face(const Placed &first, const Placed &second, const btVector3 &normal) const
{
    Face nearest = {0, false, -1};
    const btVector3 local_second = normal * *second.axes, local_first = -normal * *first.axes;
    for (size_t f = 0; f < second.convex->faces.size(); f++) {
        const btScalar along = second.convex->faces[f].normal.dot(local_second);
        if (along > nearest.along) nearest = {f, false, along};
    }
    for (size_t f = 0; f < first.convex->faces.size(); f++) {
        const btScalar along = first.convex->faces[f].normal.dot(local_first);
        if (along > nearest.along) nearest = {f, true, along};
    }
    return nearest;
}

// Contacts over the area where a face lies on the other body, if it is a face that touches.
bool ShvCollider::emit_faces(const Placed &first, const Placed &second, const Axis &axis)
{
    const Face face = nearest_face(first, second, axis.normal);
    if (face.along < beside_a_face) return false;
    const Placed &reference = face.of_first ? first : second, &incident = face.of_first ? second : first;
    const btVector3 outward = *reference.axes * reference.convex->faces[face.index].normal;
    const btVector3 normal = face.of_first ? -outward : outward;
    const btScalar size = btMin(first.convex->radius, second.convex->radius);
    if (gap_along(first, second, normal) < axis.gap - on_a_face * size) return false;
    if (!clip(reference, face.index, incident, outward)) return false;
    // Else an edge or corner beside the face touches.
    btScalar deepest = BT_LARGE_FLOAT;
    for (const Point &point : points) deepest = btMin(deepest, point.gap);
    if (deepest > axis.gap + beyond_a_face * size) {
        points.clear();
        return false;
    }
    emit(normal);
    return true;
}

void ShvCollider::part_part(const Placed &first, const Placed &second, bool surface_first, bool surface_second)
{
    const btVector3 between =
        first.origin + *first.axes * first.convex->centre - second.origin - *second.axes * second.convex->centre;
    const btScalar distance = between.length();
    if (distance > first.convex->radius + second.convex->radius + limit) return;
    if (distance > 0 && gap_along(first, second, between / distance) > limit) return;
    Axis axis;
    if (!try_nearest(first, second, first.convex->core, second.convex->core, between, &axis)) return;
    const btVector3 none(0, 0, 0);
    const btVector3 outward_first = surface_first ? *first.axes * first.convex->faces[0].normal : none;
    const btVector3 outward_second = surface_second ? *second.axes * second.convex->faces[0].normal : none;
    if (axis.gap > 0 && (outward_first.dot(axis.normal) > 0 || outward_second.dot(axis.normal) < 0))
        return; // behind a surface
    if (axis.gap > limit) return;
    if (!axis.witnessed) try_nearest(first, second, first.convex->kernel, second.convex->kernel, between, &axis);
    if (axis.gap < 0) try_faces(first, second, outward_first, outward_second, &axis);
    if (axis.gap > limit) return;
    const btScalar size = surface_first    ? second.convex->radius
                          : surface_second ? first.convex->radius
                                           : BT_LARGE_FLOAT;
    if (axis.gap < -size / 2) return;
    if (emit_faces(first, second, axis)) return;
    if (!axis.witnessed) { // the corner of the first that lies deepest in the second
        size_t lowest = 0;
        for (size_t i = 1; i < first.convex->vertices.size(); i++)
            if (first.at(i).dot(axis.normal) < first.at(lowest).dot(axis.normal)) lowest = i;
        axis.witness = first.at(lowest) - axis.normal * (axis.gap / 2);
    }
    points.assign(1, {axis.witness, axis.gap});
    emit(axis.normal);
}

// Triangles of a surface near a place, in its frame, in order.
const std::vector<int> &ShvCollider::near_triangles(const ShvBulletBody &surface, const btVector3 &local,
                                                    btScalar reach)
{
    struct Visit final : btTriangleCallback {
        std::vector<int> *found;
        void processTriangle(btVector3 *, int, int triangle) override { found->push_back(triangle); }
    } visit;
    visit.found = &triangles;
    triangles.clear();
    const btVector3 half(reach, reach, reach);
    static_cast<const btConcaveShape *>(surface.shapes.shape)->processAllTriangles(&visit, local - half, local + half);
    std::sort(triangles.begin(), triangles.end());
    return triangles;
}

void ShvCollider::sphere_parts(const ShvBulletBody &sphere, const ShvBulletBody &other, const btVector3 &centre,
                               const btVector3 &origin, btScalar side)
{
    if (other.kind == SHV_BULLET_HULLS) {
        for (const ShvConvex &part : other.shapes.parts)
            sphere_part(sphere, {&part, &other.axes, origin}, false, centre, side);
        return;
    }
    const btVector3 local = (centre - origin) * other.axes;
    for (int i : near_triangles(other, local, sphere.radius + limit))
        sphere_part(sphere, {&other.shapes.parts[size_t(i)], &other.axes, origin}, true, centre, side);
}

void ShvCollider::parts_surface(const ShvBulletBody &parts, const ShvBulletBody &surface, const btVector3 &parts_origin,
                                const btVector3 &surface_origin, bool swapped)
{
    for (const ShvConvex &part : parts.shapes.parts) {
        const btVector3 local = (parts_origin + parts.axes * part.centre - surface_origin) * surface.axes;
        const Placed own = {&part, &parts.axes, parts_origin};
        for (int i : near_triangles(surface, local, part.radius + limit)) {
            const Placed triangle = {&surface.shapes.parts[size_t(i)], &surface.axes, surface_origin};
            if (swapped)
                part_part(triangle, own, true, false);
            else
                part_part(own, triangle, false, true);
        }
    }
}

// Parts of a body that may touch another one: their spheres reach its box. Their own boxes.
void ShvCollider::near_parts(const ShvBulletBody &own, const btVector3 &origin, const ShvBulletBody &other,
                             const btVector3 &other_origin, std::vector<Near> *list) const
{
    list->clear();
    const btMatrix3x3 turn = other.axes.transposeTimes(own.axes), spread = own.axes.absolute();
    const btVector3 middle = (other.low + other.high) / 2, half = (other.high - other.low) / 2;
    const btVector3 away = (origin - other_origin) * other.axes - middle;
    for (const ShvConvex &part : own.shapes.parts) {
        const btScalar reach = part.radius + limit;
        const btVector3 beyond = (turn * part.centre + away).absolute() - half;
        if (beyond.x() > reach || beyond.y() > reach || beyond.z() > reach) continue;
        list->push_back({{&part, &own.axes, origin}, origin + own.axes * part.middle, spread * part.half});
    }
}

void ShvCollider::parts_parts()
{
    const btVector3 zero(0, 0, 0);
    if (b->kind == SHV_BULLET_TRIANGLES) {
        parts_surface(*a, *b, zero, shift, false);
        return;
    }
    if (a->kind == SHV_BULLET_TRIANGLES) {
        parts_surface(*b, *a, shift, zero, true);
        return;
    }
    near_parts(*a, zero, *b, shift, &near_first);
    if (near_first.empty()) return;
    near_parts(*b, shift, *a, zero, &near_second);
    for (const Near &own : near_first)
        for (const Near &other : near_second) {
            const btVector3 beyond = (own.middle - other.middle).absolute() - own.half - other.half;
            if (beyond.x() <= limit && beyond.y() <= limit && beyond.z() <= limit)
                part_part(own.part, other.part, false, false);
        }
}

void ShvCollider::pair(const ShvBulletBody &first, const ShvBulletBody &second)
{
    const btVector3 zero(0, 0, 0);
    if (first.kind == SHV_BULLET_PLANE)
        plane_body(first, second, -1);
    else if (second.kind == SHV_BULLET_PLANE)
        plane_body(second, first, 1);
    else if (first.kind == SHV_BULLET_SPHERE && second.kind == SHV_BULLET_SPHERE)
        sphere_sphere();
    else if (first.kind == SHV_BULLET_SPHERE)
        sphere_parts(first, second, zero, shift, 1);
    else if (second.kind == SHV_BULLET_SPHERE)
        sphere_parts(second, first, shift, zero, -1);
    else
        parts_parts();
}

void ShvCollider::collide(const ShvBulletBody &first, const ShvBulletBody &second, btScalar reach)
{
    contacts.clear();
    points.clear();
    a = &first;
    b = &second;
    shift = (second.position - first.position) * scale;
    limit = reach * scale;
    pair(first, second);
}
