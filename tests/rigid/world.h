/* Small worlds for the tests of the rigid modules: boxes or hand-made tets, obstacles, fragments, backend. */
#ifndef SHV_TESTS_RIGID_WORLD_H
#define SHV_TESTS_RIGID_WORLD_H

#include <stdlib.h>

#include "base/random.h"
#include "rigid/backend.h"

#include "check.h"

enum { MOST_OBJECTS = 4, MOST_OBSTACLES = 8 };

typedef struct World {
    ShvMemory *memory;
    ShvSceneDefinition scene;
    ShvMaterialDefinition material;
    ShvObjectDefinition objects[MOST_OBJECTS];
    ShvObstacleDefinition definitions[MOST_OBSTACLES];
    ShvModel model;
    ShvState state;
    ShvObstacles obstacles;
    ShvFragments fragments;
    ShvRigidBackend *backend;
} World;

/* A scene without objects and obstacles yet: glass-like material that can break. */
static inline void world_begin(World *world)
{
    *world = (World){.memory = shv_memory_create(), .scene = shv_scene_default(), .material = shv_material_default()};
    world->material.name = "glass";
    world->material.density = 2500.0;
    world->material.youngs_modulus = 70e9;
    world->material.poissons_ratio = 0.22;
    world->material.fracture_energy = 8.0;
    world->material.cohesive_strength = 40e6;
    world->material.breakable = true;
    world->scene.name = "test";
    world->scene.materials = &world->material;
    world->scene.material_count = 1;
    world->scene.objects = world->objects;
    world->scene.obstacles = world->definitions;
    world->scene.fracture.enabled = true;
    world->scene.duration = 1.0;
    world->scene.threads = 1;
}

static inline ShvObjectDefinition *world_box(World *world, double x, double y, double z, double edge)
{
    static const char *const names[MOST_OBJECTS] = {"first", "second", "third", "fourth"};
    ShvObjectDefinition *object = &world->objects[world->scene.object_count];
    *object = shv_object_default();
    object->name = names[world->scene.object_count++];
    object->material = "glass";
    object->mesh.kind = SHV_MESH_BOX;
    object->mesh.size[0] = x;
    object->mesh.size[1] = y;
    object->mesh.size[2] = z;
    object->mesh.edge = edge;
    return object;
}

static inline ShvObstacleDefinition *world_obstacle(World *world, ShvObstacleShape shape)
{
    static const char *const names[MOST_OBSTACLES] = {"floor", "wall", "stone", "anvil",
                                                      "roof",  "door", "ball",  "bead"};
    ShvObstacleDefinition *obstacle = &world->definitions[world->scene.obstacle_count];
    *obstacle = shv_obstacle_default();
    obstacle->name = names[world->scene.obstacle_count++];
    obstacle->shape = shape;
    obstacle->motion = SHV_OBSTACLE_FIXED;
    obstacle->friction = 0.0;
    obstacle->restitution = 0.0;
    return obstacle;
}

static inline void world_floor(World *world, double friction, double restitution)
{
    ShvObstacleDefinition *floor = world_obstacle(world, SHV_OBSTACLE_PLANE);
    floor->plane_normal[0] = floor->plane_normal[1] = 0.0;
    floor->plane_normal[2] = 1.0;
    floor->plane_offset = 0.0;
    floor->friction = friction;
    floor->restitution = restitution;
}

static inline void world_build(World *world)
{
    ShvError error = {0};
    check_ok(shv_model_build(&world->model, world->memory, &world->scene, NULL, &error), error);
    check_ok(shv_state_create(&world->state, &world->model, &world->scene, &error), error);
    check_ok(shv_obstacles_create(&world->obstacles, world->memory, &world->scene, NULL, &error), error);
    check_ok(shv_fragments_create(&world->fragments, &world->model, &world->state, &error), error);
}

/* All fragments that live, in flight under a backend. */
static inline void world_fly_under(World *world, ShvStatus (*create)(ShvRigidBackend **backend,
                                                                     const ShvRigidWorld *world, ShvError *error))
{
    ShvError error = {0};
    const ShvRigidWorld rigid = {&world->model, &world->state, &world->fragments, &world->obstacles,
                                 &world->scene.rigid};
    check_ok(create(&world->backend, &rigid, &error), error);
    for (int32_t i = 0; i < world->fragments.count; i++) {
        if (world->fragments.items[i].mode == SHV_MODE_DEAD) continue;
        shv_fragment_fit(&world->fragments.items[i], &world->fragments, &world->state);
        check_ok(world->backend->functions->add(world->backend, i, &error), error);
    }
}

static inline void world_fly(World *world)
{
    world_fly_under(world, shv_analytic_create);
}

/* Number of wakes; `wakes` NULL: they do not matter. */
static inline int32_t world_advance(World *world, double time, double step, const double gravity[3], ShvWakeJudge judge,
                                    void *data, ShvRigidContact *wakes)
{
    ShvError error = {0};
    int32_t count = 0;
    ShvRigidContact none[64];
    check_ok(world->backend->functions->advance(world->backend, time, step, gravity, judge, data, wakes ? wakes : none,
                                                &count, &error),
             error);
    return count;
}

static inline void world_end(World *world)
{
    if (world->backend) world->backend->functions->destroy(world->backend);
    shv_fragments_release(&world->fragments);
    shv_obstacles_release(&world->obstacles);
    shv_state_release(&world->state);
    shv_model_release(&world->model);
    assert_int_equal(shv_memory_bytes(world->memory, SHV_PART_COUNT), 0);
    shv_memory_destroy(world->memory);
}

/* The world of hand-made tets, one object: the model of a box whose mesh is replaced before the state is made. */
static inline void world_tets(World *world, const double *points, int32_t point_count, const int32_t *tets,
                              int32_t tet_count)
{
    ShvError error = {0};
    ShvModel *model = &world->model;
    world_box(world, 1.0, 1.0, 1.0, 1.0);
    check_ok(shv_model_build(model, world->memory, &world->scene, NULL, &error), error);
    shv_adjacency_release(&model->adjacency);
    shv_mesh_release(&model->mesh);
    check_ok(shv_mesh_allocate(&model->mesh, world->memory, point_count, tet_count, &error), error);
    memcpy(model->mesh.positions, points, 3 * (size_t)point_count * sizeof *points);
    memcpy(model->mesh.elements, tets, 4 * (size_t)tet_count * sizeof *tets);
    model->objects[0].element_end = tet_count;
    model->objects[0].node_end = point_count;
    uint16_t *materials =
        shv_reallocate(world->memory, SHV_PART_GENERAL, model->element_material, (size_t)tet_count, 2);
    assert_non_null(materials);
    memset(materials, 0, 2 * (size_t)tet_count);
    model->element_material = materials;
    check_ok(shv_adjacency_build(&model->adjacency, &model->mesh, &error), error);
    check_ok(shv_state_create(&world->state, model, &world->scene, &error), error);
    check_ok(shv_obstacles_create(&world->obstacles, world->memory, &world->scene, NULL, &error), error);
    check_ok(shv_fragments_create(&world->fragments, model, &world->state, &error), error);
}

/* Gives every group of elements its own copies of the nodes it shares with other groups; masses follow. */
static inline void world_separate(World *world, const int32_t *group)
{
    ShvState *state = &world->state;
    ShvError error = {0};
    const int32_t nodes = state->node_count, elements = state->element_count;
    int32_t groups = 0;
    for (int32_t e = 0; e < elements; e++) groups = group[e] >= groups ? group[e] + 1 : groups;
    int32_t *copy = malloc((size_t)nodes * sizeof *copy), *owner = malloc((size_t)nodes * sizeof *owner);
    for (int32_t n = 0; n < nodes; n++) owner[n] = -1;
    for (int32_t e = 0; e < elements; e++)
        for (int a = 0; a < 4; a++)
            if (owner[shv_state_node(state, e, a)] < 0) owner[shv_state_node(state, e, a)] = group[e];
    for (int32_t g = 0; g < groups; g++) {
        for (int32_t n = 0; n < nodes; n++) copy[n] = owner[n] == g ? n : -1;
        for (int32_t e = 0; e < elements; e++)
            for (int a = 0; a < 4 && group[e] == g; a++) {
                const int32_t node = shv_state_node(state, e, a);
                if (copy[node] < 0) {
                    check_ok(shv_state_reserve(state, (int64_t)state->node_count + 1, &error), error);
                    copy[node] = state->node_count++;
                    memcpy(state->reference + 3 * copy[node], state->reference + 3 * node, 3 * sizeof(double));
                    memcpy(state->displacement + 3 * copy[node], state->displacement + 3 * node, 3 * sizeof(double));
                    memcpy(state->velocity + 3 * copy[node], state->velocity + 3 * node, 3 * sizeof(double));
                    state->origin[copy[node]] = state->origin[node];
                }
                state->connectivity[shv_corner_slot(e, a)] = copy[node];
            }
    }
    free(copy);
    free(owner);
    for (int32_t n = 0; n < state->node_count; n++) state->mass[n] = 0.0;
    for (int32_t e = 0; e < elements; e++)
        for (int a = 0; a < 4; a++) state->mass[shv_state_node(state, e, a)] += 0.25 * state->element_mass[e];
}

/* Uniform in (low, high). */
static inline double draw(uint64_t *index, double low, double high)
{
    return low + (high - low) * shv_random_uniform(7, (*index)++);
}

static inline ShvVec3 draw3(uint64_t *index, double size)
{
    const double x = draw(index, -size, size), y = draw(index, -size, size), z = draw(index, -size, size);
    return shv_vec3(x, y, z);
}

static inline ShvQuat draw_rotation(uint64_t *index)
{
    return shv_quat_exponential(draw3(index, 2.0));
}

#endif
