/* Small scenes for the tests of whole runs: a soft brittle material (strain at strength 0.1 %, bar speed 204 m/s), whose
   stable steps are long enough for a test to be short. */
#ifndef SHV_TESTS_HYBRID_STAGE_H
#define SHV_TESTS_HYBRID_STAGE_H

#include "check.h"

#include "shiver/definition.h"

typedef struct Stage {
    ShvMaterialDefinition material;
    ShvObjectDefinition objects[3];
    ShvObstacleDefinition obstacles[2];
    ShvConditionDefinition conditions[2];
    ShvEventDefinition events[6];
    ShvSceneDefinition scene;
} Stage;

static inline void stage_make(Stage *stage)
{
    *stage = (Stage){.material = shv_material_default(), .scene = shv_scene_default()};
    stage->material.name = "chalk";
    stage->material.density = 1200.0;
    stage->material.youngs_modulus = 50e6;
    stage->material.poissons_ratio = 0.2;
    stage->material.fracture_energy = 0.5;
    stage->material.cohesive_strength = 50e3;
    stage->scene.name = "stage";
    stage->scene.materials = &stage->material;
    stage->scene.material_count = 1;
    stage->scene.objects = stage->objects;
    stage->scene.obstacles = stage->obstacles;
    stage->scene.conditions = stage->conditions;
    stage->scene.events = stage->events;
    stage->scene.duration = 0.1;
    stage->scene.output.rate = 100.0;
    stage->scene.threads = 1;
}

/* A box with its centre at `height` above the floor's plane z = 0. */
static inline ShvObjectDefinition *stage_box(Stage *stage, const char *name, const double size[3], double edge,
                                             double height)
{
    ShvObjectDefinition *object = &stage->objects[stage->scene.object_count++];
    *object = shv_object_default();
    object->name = name;
    object->material = "chalk";
    object->mesh.kind = SHV_MESH_BOX;
    memcpy(object->mesh.size, size, sizeof object->mesh.size);
    object->mesh.edge = edge;
    object->placement.position[2] = height;
    return object;
}

static inline ShvObstacleDefinition *stage_floor(Stage *stage)
{
    ShvObstacleDefinition *floor = &stage->obstacles[stage->scene.obstacle_count++];
    *floor = shv_obstacle_default();
    floor->name = "floor";
    floor->plane_normal[2] = 1.0;
    return floor;
}

/* A free ball about the origin. */
static inline ShvObstacleDefinition *stage_free_ball(Stage *stage, const char *name, double radius, double mass)
{
    ShvObstacleDefinition *ball = &stage->obstacles[stage->scene.obstacle_count++];
    *ball = shv_obstacle_default();
    ball->name = name;
    ball->shape = SHV_OBSTACLE_SPHERE;
    ball->radius = radius;
    ball->motion = SHV_OBSTACLE_FREE;
    ball->mass = mass;
    return ball;
}

static inline ShvConditionDefinition *stage_support(Stage *stage, const char *name, const char *object)
{
    ShvConditionDefinition *condition = &stage->conditions[stage->scene.condition_count++];
    *condition = shv_condition_default();
    condition->name = name;
    condition->object = object;
    condition->selection.kind = SHV_SELECT_ALL;
    for (int k = 0; k < 3; k++) condition->axes[k] = true;
    return condition;
}

static inline ShvEventDefinition *stage_event(Stage *stage, double time, ShvEventKind kind, const char *target)
{
    ShvEventDefinition *event = &stage->events[stage->scene.event_count++];
    *event = shv_event_default();
    event->time = time;
    event->kind = kind;
    event->target = target;
    return event;
}

/* A bar that falls on its end and breaks into a few pieces. */
static inline void stage_make_breaking_bar(Stage *stage)
{
    stage_make(stage);
    stage_box(stage, "bar", (const double[3]){0.02, 0.02, 0.1}, 0.01, 0.051)->placement.velocity[2] = -1.0;
    stage_floor(stage)->friction = 0.3;
    stage->scene.duration = 0.02;
    stage->scene.output.rate = 1000.0;
}

#endif
