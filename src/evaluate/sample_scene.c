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

#define MATERIAL(member)                                                                                               \
    {                                                                                                                  \
#member, offsetof(ShvMaterialDefinition, member), false                                                        \
    }
static const Field material_fields[] = {
    MATERIAL(density),
    MATERIAL(youngs_modulus),
    MATERIAL(poissons_ratio),
    MATERIAL(fracture_energy),
    MATERIAL(cohesive_strength),
    MATERIAL(fracture_energy_shear),
    MATERIAL(cohesive_strength_shear),
    MATERIAL(ppr_shape),
    MATERIAL(ppr_shape_shear),
    MATERIAL(weibull_modulus),
    MATERIAL(weibull_volume),
    {"friction_angle", offsetof(ShvMaterialDefinition, friction_angle_degrees), false}};
#define OBJECT(name, member, vector)                                                                                   \
    {                                                                                                                  \
        name, offsetof(ShvObjectDefinition, member), vector                                                            \
    }
static const Field object_fields[] = {OBJECT("size", mesh.size, true),
                                      OBJECT("radius", mesh.radius, false),
                                      OBJECT("inner_radius", mesh.inner_radius, false),
                                      OBJECT("height", mesh.height, false),
                                      OBJECT("edge", mesh.edge, false),
                                      OBJECT("notch_depth", mesh.notch_depth, false),
                                      OBJECT("notch_offset", mesh.notch_offset, false),
                                      OBJECT("position", placement.position, true),
                                      OBJECT("rotation_degrees", placement.rotation_degrees, false),
                                      OBJECT("velocity", placement.velocity, true),
                                      OBJECT("angular_velocity", placement.angular_velocity, true),
                                      OBJECT("stretch_rate", placement.stretch_rate, true)};
#define PREFLIGHT(member)                                                                                              \
    {                                                                                                                  \
#member, offsetof(ShvPreflight, member), false                                                                 \
    }
static const Field preflight_fields[] = {PREFLIGHT(mass),
                                         PREFLIGHT(volume),
                                         PREFLIGHT(mean_edge),
                                         PREFLIGHT(shortest_edge),
                                         PREFLIGHT(longest_edge),
                                         PREFLIGHT(smallest_altitude),
                                         PREFLIGHT(stable_step),
                                         PREFLIGHT(bar_speed),
                                         PREFLIGHT(cohesive_zone),
                                         PREFLIGHT(snap_back),
                                         PREFLIGHT(dilatational_speed),
                                         {"effective_strength", offsetof(ShvPreflight, cohesion.strength), false},
                                         {"effective_energy", offsetof(ShvPreflight, cohesion.energy), false},
                                         {"tip_toughness", offsetof(ShvPreflight, cohesion.tip_toughness), false}};
#define OBSTACLE(name, member, vector)                                                                                 \
    {                                                                                                                  \
        name, offsetof(ShvObstacleDefinition, member), vector                                                          \
    }
static const Field obstacle_fields[] = {OBSTACLE("radius", radius, false),
                                        OBSTACLE("size", size, true),
                                        OBSTACLE("mass", mass, false),
                                        OBSTACLE("friction", friction, false),
                                        OBSTACLE("restitution", restitution, false),
                                        OBSTACLE("offset", plane_offset, false),
                                        OBSTACLE("normal", plane_normal, true),
                                        OBSTACLE("position", placement.position, true),
                                        OBSTACLE("velocity", placement.velocity, true)};
#define CONDITION(name, member, vector)                                                                                \
    {                                                                                                                  \
        name, offsetof(ShvConditionDefinition, member), vector                                                         \
    }
static const Field condition_fields[] = {CONDITION("value", value, true), CONDITION("ramp_time", ramp_time, false),
                                         CONDITION("start", start, false), CONDITION("end", end, false)};
static const Field scene_fields[] = {{"duration", offsetof(ShvSceneDefinition, duration), false},
                                     {"gravity", offsetof(ShvSceneDefinition, gravity), true},
                                     {"rigid_step", offsetof(ShvSceneDefinition, rigid.time_step), false},
                                     {"safety", offsetof(ShvSceneDefinition, fracture.safety), false},
                                     {"threshold", offsetof(ShvSceneDefinition, fracture.threshold), false},
                                     {"regularisation", offsetof(ShvSceneDefinition, fracture.regularisation), false}};

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

ShvStatus shv_sample_scene(ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error)
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
