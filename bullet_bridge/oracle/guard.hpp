// Oracles refuse bodies that are no hulls.
#ifndef BULLET_BRIDGE_ORACLE_GUARD_HPP
#define BULLET_BRIDGE_ORACLE_GUARD_HPP

#include "bullet_bridge/depth.h"
#include "bullet_bridge/guarded.hpp"

namespace shiver
{

inline bool is_hull(const ShvConvex *body)
{
    return body->count > 0 && !(body->radius > 0.0);
}

inline ShvStatus refuse(ShvError *error)
{
    return shv_fail(error, SHV_BAD_INPUT,
                    "the oracles know hulls of points only: give both bodies points and radius 0");
}

} // namespace shiver

#endif
