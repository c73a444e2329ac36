/* Worlds of Bullet for its tests: those of world.h, with other obstacles and bodies free to move. */
#ifndef SHV_TESTS_RIGID_BULLET_WORLD_H
#define SHV_TESTS_RIGID_BULLET_WORLD_H

#include "world.h"

static const double no_gravity[3] = {0.0, 0.0, 0.0}, earth[3] = {0.0, 0.0, -9.81};

static inline void bullet_fly(World *world)
{
    ShvError error = {0};
    const ShvRigidWorld rigid = {&world->model, &world->state, &world->fragments, &world->obstacles,
                                 &world->scene.rigid};
    check_ok(shv_bullet_create(&world->backend, &rigid, &error), error);
    for (int32_t i = 0; i < world->fragments.count; i++) {
        if (world->fragments.items[i].mode == SHV_MODE_DEAD) continue;
        shv_fragment_fit(&world->fragments.items[i], &world->fragments, &world->state);
        check_ok(world->backend->functions->add(world->backend, i, &error), error);
    }
}

static inline int32_t bullet_advance(World *world, double time, double step, const double gravity[3],
                                     ShvWakeJudge judge, void *data, ShvRigidContact *wakes)
{
    ShvError error = {0};
    int32_t count = 0;
    ShvRigidContact none[64];
    check_ok(world->backend->functions->advance(world->backend, time, step, gravity, judge, data, wakes ? wakes : none,
                                                &count, &error),
             error);
    return count;
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
