/* Numbers of the scene and of its meshes as lists of an outcome, by the names that docs/scene.md and `shiver plan` give them. */
#include <string.h>

#include "base/text.h"
#include "evaluate/sampler.h"

typedef struct Field {
    const char *name;
    size_t offset;
    bool vector; /* three numbers: name.x, name.y, name.z */
} Field;
#define COUNT(array) (sizeof(array) / sizeof *(array))

#define NUMBER(type, name, member)                                                                                     \
    {                                                                                                                  \
        name, offsetof(type, member), false                                                                            \
    }
#define VECTOR(type, name, member)                                                                                     \
    {                                                                                                                  \
        name, offsetof(type, member), true                                                                             \
    }
static const Field material_fields[] = {
    NUMBER(ShvMaterialDefinition, "density", density),
    NUMBER(ShvMaterialDefinition, "youngs_modulus", youngs_modulus),
    NUMBER(ShvMaterialDefinition, "poissons_ratio", poissons_ratio),
    NUMBER(ShvMaterialDefinition, "fracture_energy", fracture_energy),
    NUMBER(ShvMaterialDefinition, "cohesive_strength", cohesive_strength),
    NUMBER(ShvMaterialDefinition, "fracture_energy_shear", fracture_energy_shear),
    NUMBER(ShvMaterialDefinition, "cohesive_strength_shear", cohesive_strength_shear),
    NUMBER(ShvMaterialDefinition, "ppr_shape", ppr_shape),
    NUMBER(ShvMaterialDefinition, "ppr_shape_shear", ppr_shape_shear),
    NUMBER(ShvMaterialDefinition, "weibull_modulus", weibull_modulus),
    NUMBER(ShvMaterialDefinition, "weibull_volume", weibull_volume),
    NUMBER(ShvMaterialDefinition, "weibull_area", weibull_area),
    NUMBER(ShvMaterialDefinition, "friction_angle", friction_angle_degrees)};
static const Field object_fields[] = {VECTOR(ShvObjectDefinition, "size", mesh.size),
                                      NUMBER(ShvObjectDefinition, "radius", mesh.radius),
                                      NUMBER(ShvObjectDefinition, "inner_radius", mesh.inner_radius),
                                      NUMBER(ShvObjectDefinition, "height", mesh.height),
                                      NUMBER(ShvObjectDefinition, "edge", mesh.edge),
                                      NUMBER(ShvObjectDefinition, "notch_depth", mesh.notch_depth),
                                      NUMBER(ShvObjectDefinition, "notch_offset", mesh.notch_offset),
                                      VECTOR(ShvObjectDefinition, "position", placement.position),
                                      NUMBER(ShvObjectDefinition, "rotation_degrees", placement.rotation_degrees),
                                      VECTOR(ShvObjectDefinition, "velocity", placement.velocity),
                                      VECTOR(ShvObjectDefinition, "angular_velocity", placement.angular_velocity),
                                      VECTOR(ShvObjectDefinition, "stretch_rate", placement.stretch_rate)};
static const Field preflight_fields[] = {NUMBER(ShvPreflight, "mass", mass),
                                         NUMBER(ShvPreflight, "volume", volume),
                                         NUMBER(ShvPreflight, "mean_edge", mean_edge),
                                         NUMBER(ShvPreflight, "shortest_edge", shortest_edge),
                                         NUMBER(ShvPreflight, "longest_edge", longest_edge),
                                         NUMBER(ShvPreflight, "smallest_altitude", smallest_altitude),
                                         NUMBER(ShvPreflight, "stable_step", stable_step),
                                         NUMBER(ShvPreflight, "bar_speed", bar_speed),
                                         NUMBER(ShvPreflight, "cohesive_zone", cohesive_zone),
                                         NUMBER(ShvPreflight, "snap_back", snap_back),
                                         NUMBER(ShvPreflight, "dilatational_speed", dilatational_speed),
                                         NUMBER(ShvPreflight, "effective_strength", cohesion.strength),
                                         NUMBER(ShvPreflight, "effective_energy", cohesion.energy),
                                         NUMBER(ShvPreflight, "tip_toughness", cohesion.tip_toughness)};
static const Field obstacle_fields[] = {NUMBER(ShvObstacleDefinition, "radius", radius),
                                        VECTOR(ShvObstacleDefinition, "size", size),
                                        NUMBER(ShvObstacleDefinition, "mass", mass),
                                        NUMBER(ShvObstacleDefinition, "friction", friction),
                                        NUMBER(ShvObstacleDefinition, "restitution", restitution),
                                        NUMBER(ShvObstacleDefinition, "offset", plane_offset),
                                        VECTOR(ShvObstacleDefinition, "normal", plane_normal),
                                        VECTOR(ShvObstacleDefinition, "position", placement.position),
                                        VECTOR(ShvObstacleDefinition, "velocity", placement.velocity)};
static const Field condition_fields[] = {
    VECTOR(ShvConditionDefinition, "value", value), NUMBER(ShvConditionDefinition, "ramp_time", ramp_time),
    NUMBER(ShvConditionDefinition, "start", start), NUMBER(ShvConditionDefinition, "end", end)};
static const Field scene_fields[] = {NUMBER(ShvSceneDefinition, "duration", duration),
                                     VECTOR(ShvSceneDefinition, "gravity", gravity),
                                     NUMBER(ShvSceneDefinition, "rigid_step", rigid.time_step),
                                     NUMBER(ShvSceneDefinition, "safety", fracture.safety),
                                     NUMBER(ShvSceneDefinition, "threshold", fracture.threshold),
                                     NUMBER(ShvSceneDefinition, "regularisation", fracture.regularisation)};

/* Where several things have one name, the first one has it. */
static void put_fact(ShvOutcome *outcome, const char *owner, const char *field, const char *axis, const void *at)
{
    char name[96];
    double value;
    memcpy(&value, at, sizeof value);
    shv_format(name, sizeof name, "%.63s.%.24s%s", owner, field, axis);
    if (!shv_outcome_find(outcome, name)) shv_outcome_set(outcome, name, value);
}

static void put_item(ShvOutcome *outcome, const char *owner, const void *item, const Field *fields, size_t count)
{
    static const char *const axes[] = {".x", ".y", ".z"};
    for (size_t i = 0; i < count && owner; i++)
        for (int k = 0; k < (fields[i].vector ? 3 : 1); k++)
            put_fact(outcome, owner, fields[i].name, fields[i].vector ? axes[k] : "",
                     (const char *)item + fields[i].offset + (size_t)k * sizeof(double));
}

static ShvStatus put_meshes(ShvOutcome *outcome, const ShvSimulation *simulation, ShvError *error)
{
    double stable = HUGE_VAL;
    for (int32_t i = 0; i < shv_simulation_object_count(simulation); i++) {
        ShvPreflight preflight;
        SHV_TRY(shv_simulation_preflight(simulation, i, &preflight, error));
        const double counts[] = {preflight.tets, preflight.nodes};
        put_fact(outcome, preflight.object, "tets", "", &counts[0]);
        put_fact(outcome, preflight.object, "nodes", "", &counts[1]);
        put_item(outcome, preflight.object, &preflight, preflight_fields, COUNT(preflight_fields));
        stable = fmin(stable, preflight.stable_step);
    }
    shv_outcome_set(outcome, "run.stable_step", stable);
    return SHV_OK;
}

ShvStatus shv_sample_scene(const ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error)
{
    const ShvSceneDefinition *scene = sampler->scene;
    ShvOutcome *outcome = sampler->outcome;
    for (int32_t i = 0; i < scene->material_count; i++)
        put_item(outcome, scene->materials[i].name, &scene->materials[i], material_fields, COUNT(material_fields));
    for (int32_t i = 0; i < scene->object_count; i++)
        put_item(outcome, scene->objects[i].name, &scene->objects[i], object_fields, COUNT(object_fields));
    SHV_TRY(put_meshes(outcome, simulation, error));
    for (int32_t i = 0; i < scene->obstacle_count; i++)
        put_item(outcome, scene->obstacles[i].name, &scene->obstacles[i], obstacle_fields, COUNT(obstacle_fields));
    for (int32_t i = 0; i < scene->condition_count; i++)
        put_item(outcome, scene->conditions[i].name, &scene->conditions[i], condition_fields, COUNT(condition_fields));
    put_item(outcome, "scene", scene, scene_fields, COUNT(scene_fields));
    return outcome->failed ? shv_fail_memory(error, "numbers of the scene", 0) : SHV_OK;
}
