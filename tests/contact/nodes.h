/* Nodes that obstacles meet, moved as the solver moves them. Each is a corner of a tet that has all its mass; what has no mass feels no
   impulse, stands still and is far away. */
#ifndef SHV_TESTS_CONTACT_NODES_H
#define SHV_TESTS_CONTACT_NODES_H

#include "check.h"

#include "contact/surface_contact.h"
#include "shape/scene.h"

typedef struct Nodes {
    int32_t count; /* with mass */
    ShvModel model;
    ShvState state;
    ShvObstacles obstacles;
    ShvSurfaceContact contact;
    uint8_t awake[1];
    double gravity[3];
    ShvError error;
} Nodes;

static inline ShvSurfaceBodies nodes_bodies(Nodes *nodes)
{
    return (ShvSurfaceBodies){.state = &nodes->state,
                              .awake = nodes->awake,
                              .fragment_count = 1,
                              .obstacles = &nodes->obstacles,
                              .gravity = shv_load3(nodes->gravity)};
}

static inline void *nodes_block(size_t count, size_t size)
{
    void *block = shv_allocate(NULL, SHV_PART_GENERAL, count, size);
    assert_non_null(block);
    return block;
}

static inline void nodes_create(Nodes *nodes, const ShvObstacleDefinition *definitions, int32_t obstacle_count,
                                int32_t count)
{
    const double far = 100.0;
    *nodes = (Nodes){.count = count, .awake = {1}};
    ShvState *state = &nodes->state;
    ShvMesh *mesh = &nodes->model.mesh;
    nodes->obstacles = make_obstacles(definitions, obstacle_count);
    for (int32_t k = 0; k < obstacle_count; k++) nodes->obstacles.items[k].feature_count = 0; /* nodes alone */
    check_ok(shv_state_reserve(state, 4 * count, &nodes->error), nodes->error);
    state->node_count = mesh->node_count = 4 * count;
    state->element_count = mesh->element_count = count;
    state->batch_count = (count + SHV_LANES - 1) / SHV_LANES;
    state->connectivity = nodes_block(4 * SHV_LANES * (size_t)state->batch_count, sizeof(int32_t));
    state->element_fragment = nodes_block((size_t)count, sizeof(int32_t));
    mesh->elements = nodes_block(4 * (size_t)count, sizeof(int32_t));
    for (int32_t i = 0; i < 4 * count; i++) {
        const int32_t corner = i < count ? 0 : 1 + (i - count) % 3, element = i < count ? i : (i - count) / 3;
        state->mass[i] = i < count ? 1.0 : 0.0;
        state->origin[i] = i;
        state->connectivity[shv_corner_slot(element, corner)] = mesh->elements[4 * element + corner] = i;
        if (corner > 0) state->reference[3 * i + corner - 1] = far;
    }
    check_ok(shv_surface_contact_create(&nodes->contact, NULL, &nodes->model, 0.0, &nodes->error), nodes->error);
}

static inline void nodes_release(Nodes *nodes)
{
    shv_surface_contact_release(&nodes->contact);
    shv_obstacles_release(&nodes->obstacles);
    shv_state_release(&nodes->state);
    shv_release(nodes->model.mesh.elements);
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
    const ShvSurfaceBodies bodies = nodes_bodies(nodes);
    check_ok(shv_surface_contact_begin(&nodes->contact, &bodies, step, &nodes->error), nodes->error);
}
static inline void nodes_kick(Nodes *nodes, double kick)
{
    for (int32_t i = 0; i < nodes->count; i++) {
        const ShvVec3 a = shv_madd(shv_load3(nodes->gravity), 1.0 / nodes->state.mass[i],
                                   shv_load3(nodes->state.force + 3 * (int64_t)i));
        shv_add_to3(nodes->state.velocity + 3 * (int64_t)i, shv_scale(a, kick));
    }
}
static inline void nodes_answer(Nodes *nodes, double step)
{
    const ShvSurfaceBodies bodies = nodes_bodies(nodes);
    check_ok(shv_surface_contact_apply(&nodes->contact, &bodies, step, &nodes->error), nodes->error);
}
/* The first pair with an impulse. */
static inline const ShvFacetPair *nodes_touch(const Nodes *nodes)
{
    for (int32_t k = 0; k < nodes->contact.pair_count; k++)
        if (nodes->contact.pairs[k].normal_impulse > 0.0) return &nodes->contact.pairs[k];
    return NULL;
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
    for (int32_t i = 0; i < nodes->count; i++) {
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
