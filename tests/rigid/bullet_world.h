/* Worlds of Bullet for its tests: those of world.h, with other obstacles and bodies free to move. */
#ifndef SHV_TESTS_RIGID_BULLET_WORLD_H
#define SHV_TESTS_RIGID_BULLET_WORLD_H

#include "world.h"

static const double no_gravity[3] = {0.0, 0.0, 0.0}, earth[3] = {0.0, 0.0, -9.81};

static inline void bullet_fly(World *world)
{
    world_fly_under(world, shv_bullet_create);
}

static inline double bullet_energy(const World *world, const double gravity[3])
{
    double sum = 0.0;
    for (int32_t f = 0; f < world->fragments.count; f++) {
        const ShvFragment *fragment = &world->fragments.items[f];
        sum += shv_fragment_kinetic(fragment) - fragment->mass * shv_dot(shv_load3(gravity), fragment->position);
    }
    for (int32_t o = 0; o < world->obstacles.count; o++) {
        const ShvObstacle *obstacle = &world->obstacles.items[o];
        if (obstacle->motion != SHV_OBSTACLE_FREE) continue;
        sum += shv_obstacle_kinetic(obstacle) - obstacle->mass * shv_dot(shv_load3(gravity), obstacle->position);
    }
    return sum - world->backend->contact_work - world->backend->friction_work;
}

#endif
