/* A small scene for the tests of the model: two boxes of two materials, the second turned, moved and spinning. */
#ifndef SHV_TESTS_MODEL_SCENE_H
#define SHV_TESTS_MODEL_SCENE_H

#include "check.h"

#include "model/state.h"

typedef struct Scene {
    ShvMaterialDefinition materials[2];
    ShvObjectDefinition objects[2];
    ShvSceneDefinition definition;
} Scene;

static inline ShvMaterialDefinition scene_material(const char *name, double density)
{
    ShvMaterialDefinition material = shv_material_default();
    material.name = name;
    material.density = density;
    material.youngs_modulus = 70e9;
    material.poissons_ratio = 0.2;
    material.fracture_energy = 8.0;
    material.cohesive_strength = 40e6;
    return material;
}

static inline ShvObjectDefinition scene_box(const char *name, const char *material, double x, double y, double z)
{
    ShvObjectDefinition object = shv_object_default();
    object.name = name;
    object.material = material;
    object.mesh.kind = SHV_MESH_BOX;
    object.mesh.size[0] = x;
    object.mesh.size[1] = y;
    object.mesh.size[2] = z;
    object.mesh.edge = 0.5;
    return object;
}

static inline void scene_make(Scene *scene)
{
    scene->materials[0] = scene_material("glass", 2500.0);
    scene->materials[1] = scene_material("steel", 8000.0);
    scene->materials[1].breakable = false;
    scene->objects[0] = scene_box("plate", "glass", 2.0, 2.0, 1.0);
    scene->objects[1] = scene_box("block", "steel", 1.0, 2.0, 1.0);
    ShvPlacement *placement = &scene->objects[1].placement;
    *placement = (ShvPlacement){.position = {10.0, 20.0, 30.0},
                                .rotation_axis = {0.0, 0.0, 5.0},
                                .rotation_degrees = 90.0,
                                .velocity = {1.0, 2.0, 3.0},
                                .angular_velocity = {0.0, 0.0, 4.0},
                                .stretch_rate = {0.5, -1.0, 2.0}};
    scene->definition = shv_scene_default();
    scene->definition.materials = scene->materials;
    scene->definition.material_count = 2;
    scene->definition.objects = scene->objects;
    scene->definition.object_count = 2;
    scene->definition.seed = 99;
}

#endif
