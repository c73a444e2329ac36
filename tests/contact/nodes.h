/* Nodes without elements, moved as the solver moves them. */
#ifndef SHV_TESTS_CONTACT_NODES_H
#define SHV_TESTS_CONTACT_NODES_H

#include "check.h"

#include "contact/node_contact.h"
#include "shape/scene.h"

typedef struct Nodes {
    ShvState state;
    ShvObstacles obstacles;
    ShvNodeContact contact;
    int32_t *list;
    double gravity[3];
    ShvError error;
} Nodes;

static inline void nodes_create(Nodes *nodes, const ShvObstacleDefinition *definitions, int32_t obstacle_count,
                                int32_t count)
{
    *nodes = (Nodes){.gravity = {0.0, 0.0, 0.0}};
    nodes->obstacles = make_obstacles(definitions, obstacle_count);
    check_ok(shv_state_reserve(&nodes->state, count, &nodes->error), nodes->error);
    nodes->state.node_count = count;
    nodes->list = shv_allocate(NULL, SHV_PART_GENERAL, (size_t)count, sizeof(int32_t));
    assert_non_null(nodes->list);
    for (int32_t i = 0; i < count; i++) {
        nodes->state.mass[i] = 1.0;
        nodes->state.origin[i] = nodes->list[i] = i;
    }
    shv_node_contact_create(&nodes->contact, NULL);
}

static inline void nodes_release(Nodes *nodes)
{
    shv_node_contact_release(&nodes->contact);
    shv_obstacles_release(&nodes->obstacles);
    shv_state_release(&nodes->state);
    shv_release(nodes->list);
}

static inline void place_node(Nodes *nodes, int32_t node, ShvVec3 position, ShvVec3 velocity)
{
    shv_store3(nodes->state.reference + 3 * node, position);
    shv_store3(nodes->state.velocity + 3 * node, velocity);
}
static inline ShvVec3 node_velocity(const Nodes *nodes, int32_t node)
{
    return shv_load3(nodes->state.velocity + 3 * node);
}

static inline void nodes_begin(Nodes *nodes, double step)
{
    check_ok(shv_node_contact_begin(&nodes->contact, &nodes->state, &nodes->obstacles, nodes->list,
                                    nodes->state.node_count, step, nodes->gravity, &nodes->error),
             nodes->error);
}
static inline void nodes_kick(Nodes *nodes, double kick)
{
    for (int32_t i = 0; i < nodes->state.node_count; i++) {
        const ShvVec3 a = shv_madd(shv_load3(nodes->gravity), 1.0 / nodes->state.mass[i],
                                   shv_load3(nodes->state.force + 3 * (int64_t)i));
        shv_add_to3(nodes->state.velocity + 3 * (int64_t)i, shv_scale(a, kick));
    }
}
static inline void nodes_answer(Nodes *nodes, double step)
{
    check_ok(
        shv_node_contact_apply(&nodes->contact, &nodes->state, &nodes->obstacles, step, nodes->gravity, &nodes->error),
        nodes->error);
}
static inline void nodes_drift(Nodes *nodes, double step)
{
    for (int64_t i = 0; i < 3 * (int64_t)nodes->state.node_count; i++)
        nodes->state.displacement[i] += step * nodes->state.velocity[i];
    shv_obstacles_advance(&nodes->obstacles, step, nodes->gravity);
    nodes->state.time += step;
    shv_obstacles_script(&nodes->obstacles, nodes->state.time);
    nodes->state.last_step = step;
}
static inline void nodes_step(Nodes *nodes, double step)
{
    const double kick = 0.5 * (nodes->state.last_step + step);
    nodes_begin(nodes, step);
    nodes_kick(nodes, kick);
    nodes_answer(nodes, step);
    nodes_drift(nodes, step);
}

/* Kinetic energy of nodes and free obstacles; obstacles half a kick on, where the nodes are. */
static inline double nodes_kinetic(const Nodes *nodes, double half_kick)
{
    double energy = 0.0;
    for (int32_t i = 0; i < nodes->state.node_count; i++) {
        const ShvVec3 v = node_velocity(nodes, i);
        energy += 0.5 * nodes->state.mass[i] * shv_dot(v, v);
    }
    for (int32_t i = 0; i < nodes->obstacles.count; i++) {
        ShvObstacle obstacle = nodes->obstacles.items[i];
        obstacle.velocity = shv_madd(obstacle.velocity, half_kick, shv_load3(nodes->gravity));
        energy += shv_obstacle_kinetic(&obstacle);
    }
    return energy;
}

#endif
