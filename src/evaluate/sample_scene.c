/* Numbers of the scene and of its meshes as lists of an outcome: OWNER.KEY, by the scene's own keys, and what `shiver plan` says
   of meshes. */
#include <string.h>

#include "base/text.h"
#include "evaluate/sampler.h"
#include "export/output.h"
#include "scene/schema.h"

#define COUNT(array) (sizeof(array) / sizeof *(array))

#define NUMBER(name, member)                                                                                           \
    {                                                                                                                  \
        name, offsetof(ShvPreflight, member)                                                                           \
    }
static const ShvNumberField preflight_fields[] = {NUMBER("mass", mass),
                                                  NUMBER("volume", volume),
                                                  NUMBER("mean_edge", mean_edge),
                                                  NUMBER("shortest_edge", shortest_edge),
                                                  NUMBER("longest_edge", longest_edge),
                                                  NUMBER("smallest_altitude", smallest_altitude),
                                                  NUMBER("stable_step", stable_step),
                                                  NUMBER("bar_speed", bar_speed),
                                                  NUMBER("cohesive_zone", cohesive_zone),
                                                  NUMBER("snap_back", snap_back),
                                                  NUMBER("dilatational_speed", dilatational_speed),
                                                  NUMBER("effective_strength", cohesion.strength),
                                                  NUMBER("effective_energy", cohesion.energy),
                                                  NUMBER("tip_toughness", cohesion.tip_toughness)};

/* Where several things have one name, the first one has it. */
static void put_fact(ShvOutcome *outcome, const char *owner, const char *field, const char *axis, double value)
{
    char name[96];
    shv_format(name, sizeof name, "%.63s.%.24s%s", owner, field, axis);
    if (!shv_outcome_find(outcome, name)) shv_outcome_set(outcome, name, value);
}

/* Numbers and vectors of an item, those of the mappings within it, too; of the scene a mapping has its own name. */
static void put_keys(ShvOutcome *outcome, const char *owner, const ShvTable *table, const char *item)
{
    static const char *const axes[] = {".x", ".y", ".z"};
    for (int i = 0; i < table->key_count; i++) {
        const ShvKey *key = &table->keys[i];
        double values[3];
        if (key->type == SHV_KEY_MAPPING)
            put_keys(outcome, table == &shv_scene_table ? key->name : owner, key->table, item + key->offset);
        if (key->type != SHV_KEY_NUMBER && key->type != SHV_KEY_VECTOR) continue;
        const int count = key->type == SHV_KEY_VECTOR ? 3 : 1;
        memcpy(values, item + key->offset, (size_t)count * sizeof *values);
        for (int k = 0; k < count; k++) put_fact(outcome, owner, key->name, count > 1 ? axes[k] : "", values[k]);
    }
}

static const ShvTable *table_of(const char *key)
{
    return shv_table_find(&shv_scene_table, key)->table;
}

static void put_materials_and_objects(ShvOutcome *outcome, const ShvSceneDefinition *scene)
{
    for (int32_t i = 0; i < scene->material_count; i++) {
        const ShvMaterialItem item = {.definition = scene->materials[i]};
        put_keys(outcome, item.definition.name, table_of("materials"), (const char *)&item);
    }
    for (int32_t i = 0; i < scene->object_count; i++) {
        const ShvObjectItem item = {.definition = scene->objects[i]};
        put_keys(outcome, item.definition.name, table_of("objects"), (const char *)&item);
    }
}

static ShvStatus put_meshes(ShvOutcome *outcome, const ShvSimulation *simulation, ShvError *error)
{
    double stable = HUGE_VAL;
    for (int32_t i = 0; i < shv_simulation_object_count(simulation); i++) {
        ShvPreflight preflight;
        SHV_TRY(shv_simulation_preflight(simulation, i, &preflight, error));
        put_fact(outcome, preflight.object, "tets", "", preflight.tets);
        put_fact(outcome, preflight.object, "nodes", "", preflight.nodes);
        for (size_t k = 0; k < COUNT(preflight_fields); k++)
            put_fact(outcome, preflight.object, preflight_fields[k].name, "",
                     shv_number_of(&preflight, &preflight_fields[k]));
        stable = fmin(stable, preflight.stable_step);
    }
    shv_outcome_set(outcome, "run.stable_step", stable);
    return SHV_OK;
}

static void put_obstacles_and_conditions(ShvOutcome *outcome, const ShvSceneDefinition *scene)
{
    static const char *const kinds[] = {"supports", "imposed_velocities", "tractions"};
    for (int32_t i = 0; i < scene->obstacle_count; i++) {
        const ShvObstacleItem item = {.definition = scene->obstacles[i]};
        put_keys(outcome, item.definition.name, table_of("obstacles"), (const char *)&item);
    }
    for (int32_t i = 0; i < scene->condition_count; i++) {
        const ShvConditionItem item = {.definition = scene->conditions[i]};
        if (item.definition.name)
            put_keys(outcome, item.definition.name, table_of(kinds[item.definition.kind]), (const char *)&item);
    }
}

ShvStatus shv_sample_scene(const ShvSampler *sampler, const ShvSimulation *simulation, ShvError *error)
{
    const ShvSceneItem item = {.definition = *sampler->scene};
    ShvOutcome *outcome = sampler->outcome;
    put_materials_and_objects(outcome, sampler->scene);
    SHV_TRY(put_meshes(outcome, simulation, error));
    put_obstacles_and_conditions(outcome, sampler->scene);
    put_keys(outcome, "scene", &shv_scene_table, (const char *)&item);
    return outcome->failed ? shv_fail_memory(error, "numbers of the scene", 0) : SHV_OK;
}
