// Nothing that Bullet or the C++ library throws may cross into C.
#ifndef BULLET_BRIDGE_GUARDED_HPP
#define BULLET_BRIDGE_GUARDED_HPP

#include <exception>
#include <new>

#include "shiver/status.h"

namespace shiver
{
template <class Work> ShvStatus guarded(ShvError *error, const Work &work)
{
    try {
        return work();
    } catch (const std::bad_alloc &) {
        return shv_fail(error, SHV_NO_MEMORY, "out of memory for Bullet; use a coarser mesh or fewer fragments");
    } catch (const std::exception &problem) {
        return shv_fail(error, SHV_UNSUPPORTED, "Bullet failed: %s; use rigid.engine analytic", problem.what());
    }
}
} // namespace shiver

#endif
