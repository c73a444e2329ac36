/* One convex part of a body, as its narrow phase needs it: exact vertices and faces, and a core for GJK. Lengths are scaled. */
#ifndef BULLET_BRIDGE_RIGID_CONVEX_HPP
#define BULLET_BRIDGE_RIGID_CONVEX_HPP

#include <vector>

#include <LinearMath/btMatrix3x3.h>
#include <LinearMath/btVector3.h>

struct ShvConvexFace {
    btVector3 normal;         // outward, unit
    btScalar offset;          // normal · x on the face
    std::vector<int> corners; // counter-clockwise from outside
};

struct ShvConvex {
    std::vector<btVector3> vertices;
    std::vector<ShvConvexFace> faces;
    btVector3 centre;
    btScalar radius = 0;    // about the centre
    btVector3 middle, half; // of the box
    // Smaller, with edges and faces of the same directions: as long as the true surfaces overlap by less than the difference,
    // the distance of two cores still tells the direction of contact. The second is for deep overlaps.
    btScalar core = 1, kernel = 1; // shares of the distance from the centre

    btScalar highest(const btVector3 &direction) const;

    // Hull of points; false when it has no volume.
    bool make_hull(const std::vector<btVector3> &points);
    // A triangle with one face; false when it has no area.
    bool make_triangle(const btVector3 &a, const btVector3 &b, const btVector3 &c);

  private:
    void merge_faces();
    void outline(ShvConvexFace *face) const;
    void finish(btScalar core_share, btScalar kernel_share);
};

#endif
