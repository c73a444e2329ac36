#include "bullet_bridge/precision.h"

#include <LinearMath/btScalar.h>

#ifndef BT_USE_DOUBLE_PRECISION
#error "the bridge needs Bullet in double precision: compile and link with the package bullet-float64"
#endif

int shv_bullet_version(void)
{
    return btGetVersion();
}
