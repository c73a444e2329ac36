/* Nearest points of two convex cores: GJK (Gilbert, Johnson and Keerthi 1988) on vertices alone, which gives up as soon as a
   plane shows that the two are farther apart than matters. (btGjkPairDetector takes five times as long: it asks every
   support through transforms and virtual calls.) */
#ifndef BULLET_BRIDGE_RIGID_GJK_HPP
#define BULLET_BRIDGE_RIGID_GJK_HPP

#include <vector>

#include <LinearMath/btMatrix3x3.h>
#include <LinearMath/btVector3.h>

// The hull of vertices, shrunk towards a centre; in its own frame.
struct ShvCore {
    const std::vector<btVector3> &vertices; // at least one
    btVector3 centre;
    btScalar share;
    btScalar radius; // about the centre, of the vertices; 0: a point
};

struct ShvNearest {
    bool apart = false; // and within `far` of each other; else nothing below is set
    bool far = false;
    btVector3 normal{0, 0, 0}; // unit, from the second to the first
    btVector3 middle{0, 0, 0}; // of the nearest points
};

// All in the first's frame: `axes` and `origin` are the second's there, `guess` is a direction from the second to the first.
ShvNearest shv_nearest(const ShvCore &first, const ShvCore &second, const btMatrix3x3 &axes, const btVector3 &origin,
                       const btVector3 &guess, btScalar far);

#endif
