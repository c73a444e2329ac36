// Two convex bodies in common axes about a common origin: what depth.cpp and impact_time.cpp share.
#ifndef BULLET_BRIDGE_CONVEX_PAIR_HPP
#define BULLET_BRIDGE_CONVEX_PAIR_HPP

#include <cstdint>

#include <LinearMath/btVector3.h>

namespace shiver
{

// Points and a radius about them.
struct Core {
    const double *points = nullptr; // 3 a point, in the common axes
    int32_t count = 0;
    double radius = 0.0;
};

struct ConvexPair {
    Core first, second;
    double large = 0.0, small = 0.0; // sizes of the larger and of the smaller of the two, radius included
    // Cores closer than this are measured twice: round-off turns the direction between the closest points by
    // 1e-16 large/gap.
    double close = 0.0;
};

struct Gap {
    double gap = 0.0; // never above the true one
    btVector3 normal, first, second;
};

btVector3 support(const Core &core, const btVector3 &direction);
// `guess`: a direction from the first to the second; a good one saves time, any one but zero will do.
Gap convex_gap(const ConvexPair &pair, const btVector3 &guess);

} // namespace shiver

#endif
