// What every oracle does around its library: refuses bodies that are no hulls, lets no exception out.
#ifndef BULLET_BRIDGE_ORACLE_GUARD_HPP
#define BULLET_BRIDGE_ORACLE_GUARD_HPP

#include <exception>
#include <new>

#include "bullet_bridge/depth.h"

namespace shiver
{

inline bool is_hull(const ShvConvex *body)
{
    return body->count > 0 && body->support == nullptr && !(body->radius > 0.0);
}

inline ShvStatus refuse(ShvError *error)
{
    return shv_fail(error, SHV_BAD_INPUT,
                    "the oracles know hulls of points only: give both bodies points and radius 0");
}

template <typename Work> ShvStatus guarded(ShvError *error, const Work &work)
{
    try {
        work();
    } catch (const std::bad_alloc &) {
        return shv_fail(error, SHV_NO_MEMORY, "out of memory for a second opinion");
    } catch (const std::exception &problem) {
        return shv_fail(error, SHV_UNSUPPORTED, "the oracle gave up: %s", problem.what());
    }
    return SHV_OK;
}

} // namespace shiver

#endif
