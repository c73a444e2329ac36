// What an ShvImpactShape holds.
#ifndef BULLET_BRIDGE_IMPACT_SHAPE_HPP
#define BULLET_BRIDGE_IMPACT_SHAPE_HPP

#include <cstdint>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btDbvt.h>
#include <LinearMath/btVector3.h>

#include "bullet_bridge/impact_time.h"

namespace shiver
{

struct Box {
    double low[3], high[3];
};

// A convex part: points from the body's position, in its axes, grown by the shape's radius.
struct ImpactPiece {
    int32_t begin, count; // points
    double arm;           // farthest point from the body's position
    double size;          // largest extent, radius included
    Box box;              // radius included
};

} // namespace shiver

struct ShvImpactShape {
    std::vector<double> points;
    std::vector<shiver::ImpactPiece> pieces; // none: a plane
    btDbvt tree;                             // of the pieces
    double radius = 0.0;
    btVector3 normal = btVector3(0, 0, 0); // plane
    double offset = 0.0;
    int32_t most_points = 0; // of a piece
    double arm = 0.0;        // of any piece
    double size = 0.0;       // of the largest piece
    bool plane() const { return pieces.empty(); }
};

#endif
