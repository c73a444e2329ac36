#include "bullet_bridge/rigid_convex.hpp"

#include <LinearMath/btConvexHullComputer.h>

static const btScalar hull_core_share = 0.995, hull_kernel_share = 0.8;

btScalar ShvConvex::highest(const btVector3 &direction, const btMatrix3x3 &axes) const
{
    const btVector3 local = direction * axes;
    btScalar most = -BT_LARGE_FLOAT;
    for (const btVector3 &vertex : vertices) most = btMax(most, local.dot(vertex));
    return most;
}

std::unique_ptr<btConvexHullShape> ShvConvex::shrunk(btScalar share) const
{
    auto shape = std::make_unique<btConvexHullShape>();
    for (const btVector3 &vertex : vertices) shape->addPoint(centre + share * (vertex - centre), false);
    shape->setMargin(0);
    shape->recalcLocalAabb();
    return shape;
}

void ShvConvex::finish(btScalar core_share, btScalar kernel_share)
{
    centre.setZero();
    for (const btVector3 &vertex : vertices) centre += vertex;
    centre /= btScalar(vertices.size());
    radius = 0;
    for (const btVector3 &vertex : vertices) radius = btMax(radius, (vertex - centre).length());
    core = shrunk(core_share);
    kernel = shrunk(kernel_share);
}

// Newell's normal of a polygon; twice its area.
static btVector3 area_of(const std::vector<btVector3> &vertices, const std::vector<int> &corners)
{
    btVector3 sum(0, 0, 0);
    const btVector3 &origin = vertices[size_t(corners[0])];
    for (size_t i = 2; i < corners.size(); i++)
        sum += (vertices[size_t(corners[i - 1])] - origin).cross(vertices[size_t(corners[i])] - origin);
    return sum;
}

bool ShvConvex::make_hull(const std::vector<btVector3> &points)
{
    btConvexHullComputer computer;
    std::vector<double> coordinates;
    coordinates.reserve(3 * points.size());
    for (const btVector3 &p : points)
        for (int k = 0; k < 3; k++) coordinates.push_back(p[k]);
    computer.compute(coordinates.data(), 3 * int(sizeof(double)), int(points.size()), 0, 0);
    // The computer works on a grid of integers: its vertices are rounded, the numbers of the original ones are not.
    for (int i = 0; i < computer.original_vertex_index.size(); i++)
        vertices.push_back(points[size_t(computer.original_vertex_index[i])]);
    if (vertices.size() < 4) return false;
    finish(hull_core_share, hull_kernel_share);
    btScalar volume = 0;
    for (int f = 0; f < computer.faces.size(); f++) {
        ShvConvexFace face;
        const btConvexHullComputer::Edge *begin = &computer.edges[computer.faces[f]], *edge = begin;
        do {
            face.corners.push_back(edge->getSourceVertex());
            edge = edge->getNextEdgeOfFace();
        } while (edge != begin);
        btVector3 area = area_of(vertices, face.corners);
        const btScalar length = area.length();
        if (!(length > btScalar(1e-12) * radius * radius)) continue;
        face.normal = area / length;
        face.offset = -BT_LARGE_FLOAT;
        for (const btVector3 &vertex : vertices) face.offset = btMax(face.offset, face.normal.dot(vertex));
        volume += (face.offset - face.normal.dot(centre)) * length / 6;
        faces.push_back(face);
    }
    return volume > btScalar(1e-12) * radius * radius * radius;
}

bool ShvConvex::make_triangle(const btVector3 &a, const btVector3 &b, const btVector3 &c)
{
    vertices = {a, b, c};
    finish(1, 1);
    ShvConvexFace face;
    face.corners = {0, 1, 2};
    btVector3 area = area_of(vertices, face.corners);
    const btScalar length = area.length();
    if (!(length > btScalar(1e-12) * radius * radius)) return false;
    face.normal = area / length;
    face.offset = face.normal.dot(a);
    faces.push_back(face);
    return true;
}
