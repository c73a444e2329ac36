#include "bullet_bridge/rigid_convex.hpp"

#include <algorithm>

#include <LinearMath/btConvexHullComputer.h>

static const btScalar hull_core_share = 0.995, hull_kernel_share = 0.8;
// Faces of one plane: the hull computer's grid tears them apart.
static const btScalar same_normal = 1 - 1e-8, same_plane = 1e-6;

btScalar ShvConvex::highest(const btVector3 &direction) const
{
    btScalar most = -BT_LARGE_FLOAT;
    for (const btVector3 &vertex : vertices) most = btMax(most, direction.dot(vertex));
    return most;
}

void ShvConvex::finish(btScalar core_share, btScalar kernel_share)
{
    centre.setZero();
    btVector3 low = vertices[0], high = low;
    for (const btVector3 &vertex : vertices) {
        centre += vertex;
        low.setMin(vertex);
        high.setMax(vertex);
    }
    centre /= btScalar(vertices.size());
    middle = (low + high) / 2;
    half = (high - low) / 2;
    radius = 0;
    for (const btVector3 &vertex : vertices) radius = btMax(radius, (vertex - centre).length());
    core = core_share;
    kernel = kernel_share;
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

// The corners' convex outline in the face's plane, counter-clockwise from outside (Andrew's monotone chain).
void ShvConvex::outline(ShvConvexFace *face) const
{
    btVector3 x, y;
    btPlaneSpace1(face->normal, x, y);
    if (x.cross(y).dot(face->normal) < 0) y = -y;
    std::vector<int> sorted = face->corners;
    const auto at = [&](int corner) {
        const btVector3 &vertex = vertices[size_t(corner)];
        return std::pair<btScalar, btScalar>(x.dot(vertex), y.dot(vertex));
    };
    std::sort(sorted.begin(), sorted.end(), [&](int a, int b) { return at(a) != at(b) ? at(a) < at(b) : a < b; });
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
    const auto turns_left = [&](int a, int b, int c) {
        const auto p = at(a), q = at(b), r = at(c);
        return (q.first - p.first) * (r.second - p.second) - (q.second - p.second) * (r.first - p.first) >
               btScalar(1e-9) * radius * radius;
    };
    std::vector<int> chain;
    for (int pass = 0; pass < 2; pass++) {
        const size_t begin = chain.size();
        for (int corner : sorted) {
            while (chain.size() >= begin + 2 && !turns_left(chain[chain.size() - 2], chain.back(), corner))
                chain.pop_back();
            chain.push_back(corner);
        }
        chain.pop_back();
        std::reverse(sorted.begin(), sorted.end());
    }
    if (chain.size() >= 3) face->corners = chain;
}

void ShvConvex::merge_faces()
{
    std::vector<ShvConvexFace> merged;
    for (const ShvConvexFace &face : faces) {
        ShvConvexFace *own = nullptr;
        for (ShvConvexFace &other : merged)
            if (other.normal.dot(face.normal) > same_normal && btFabs(other.offset - face.offset) < same_plane * radius)
                own = &other;
        if (own)
            own->corners.insert(own->corners.end(), face.corners.begin(), face.corners.end());
        else
            merged.push_back(face);
    }
    for (ShvConvexFace &face : merged) outline(&face);
    faces.swap(merged);
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
    merge_faces();
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
