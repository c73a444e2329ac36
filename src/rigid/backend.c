#include "rigid/backend.h"

#include "fragment/free_rotation.h"

ShvStatus shv_rigid_check_motion(const char *kind, int32_t number, ShvVec3 position, ShvVec3 velocity, ShvVec3 spin,
                                 double turn, ShvError *error)
{
    if (!shv_finite3(position) || !shv_finite3(velocity) || !shv_finite3(spin))
        return shv_fail(error, SHV_DIVERGED,
                        "The motion of %s %d is not finite any more: use a smaller rigid.time_step or check its "
                        "velocities.",
                        kind, (int)number);
    if (!(turn <= SHV_LARGEST_ROTATION))
        return shv_fail(error, SHV_DIVERGED,
                        "The %s %d turns by %.3g rad in one rigid step: use a smaller rigid.time_step.", kind,
                        (int)number, turn);
    return SHV_OK;
}

ShvStatus shv_rigid_check_mass(const ShvFragment *fragment, ShvError *error)
{
    if (fragment->mass > 0.0 && isfinite(fragment->mass)) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT, "fragment %d has the mass %g kg and cannot fly: check the density",
                    (int)fragment->id, fragment->mass);
}
