// Who is paired with whom, as Bullet's broadphase asks it.
#ifndef BULLET_BRIDGE_LAYERS_HPP
#define BULLET_BRIDGE_LAYERS_HPP

#include "bullet_bridge/rigid_world.h"

namespace shiver
{
enum Group { FRAGMENT = 1, FREE = 2, FIXED = 4, PARTICLE = 8 };

struct Filter {
    int group, mask;
};

// Particles meet obstacles alone, and what has no mass none of its kind.
inline Filter filter_of(ShvBulletLayer layer, bool has_mass)
{
    if (layer == SHV_BULLET_PARTICLE) return {PARTICLE, FREE | FIXED};
    if (layer == SHV_BULLET_BODY) return {FRAGMENT, FRAGMENT | FREE | FIXED};
    if (has_mass) return {FREE, FRAGMENT | FREE | FIXED | PARTICLE};
    return {FIXED, FRAGMENT | FREE | PARTICLE};
}
} // namespace shiver

#endif
