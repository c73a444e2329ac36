#include "scene/assemble.h"

#include <math.h>
#include <string.h>

#include "base/deterministic.h"
#include "base/random.h"
#include "base/text.h"
#include "base/vector.h"

/* A unit vector of the same direction. Divided by its largest component first: the squares of a tiny or huge vector would
   leave the range of doubles, and it would count as zero. */
static void make_unit(double *vector)
{
    const double largest = fmax(fabs(vector[0]), fmax(fabs(vector[1]), fabs(vector[2])));
    if (largest == 0.0) return;
    for (int axis = 0; axis < 3; axis++) vector[axis] /= largest;
    shv_store3(vector, shv_unit(shv_load3(vector)));
}

static void assemble_materials(ShvSceneDefinition *definition, const ShvSceneItem *scene, ShvPool *pool)
{
    const ShvMaterialItem *items = scene->materials.data;
    const int32_t count = scene->materials.count;
    ShvMaterialDefinition *materials = shv_pool_take(pool, (size_t)count, sizeof *materials);
    if (!materials) return;
    for (int32_t i = 0; i < count; i++) {
        materials[i] = items[i].definition;
        materials[i].name = items[i].head.name;
    }
    definition->materials = materials;
    definition->material_count = count;
}

/* The wall of a hollow ball is given by its thickness, which in the definition belongs to shells alone. */
static ShvObjectDefinition finished_object(const ShvObjectItem *item)
{
    ShvObjectDefinition object = item->definition;
    object.name = item->head.name;
    make_unit(object.placement.rotation_axis);
    if (object.mesh.kind == SHV_MESH_HOLLOW_BALL) {
        object.mesh.inner_radius = object.mesh.radius - object.mesh.thickness;
        object.mesh.thickness = 0.0;
    }
    return object;
}

static void assemble_groups(ShvObjectDefinition *object, const ShvItems *items, ShvPool *pool)
{
    const ShvGroupItem *from = items->data;
    ShvGroupDefinition *groups = items->count > 0 ? shv_pool_take(pool, (size_t)items->count, sizeof *groups) : NULL;
    if (!groups) return;
    for (int32_t i = 0; i < items->count; i++) groups[i] = from[i].definition;
    object->groups = groups;
    object->group_count = items->count;
}

static void assemble_cracks(ShvObjectDefinition *object, const ShvItems *items, ShvPool *pool)
{
    const ShvCrackItem *from = items->data;
    ShvCrackDefinition *cracks = shv_pool_take(pool, (size_t)items->count, sizeof *cracks);
    if (!cracks) return;
    for (int32_t i = 0; i < items->count; i++) {
        cracks[i] = from[i].definition;
        make_unit(cracks[i].plane.plane_normal);
    }
    object->cracks = cracks;
    object->crack_count = items->count;
}

static const char *copy_name(ShvPool *pool, const char *name, int32_t number)
{
    char text[96];
    const int length = shv_format(text, sizeof text, "%.63s_%d", name, (int)number);
    return shv_pool_text(pool, text, (size_t)length);
}

/* All orientations alike (K. Shoemake's quaternion of three numbers), after the object's own rotation. */
static void turn_at_random(ShvPlacement *placement, uint64_t seed, uint64_t index)
{
    const double full = 6.283185307179586, degrees = 360.0 / full;
    const double u = shv_random_uniform(seed, index), v = full * shv_random_uniform(seed, index + 1),
                 w = full * shv_random_uniform(seed, index + 2);
    const double s = sqrt(1.0 - u), c = sqrt(u);
    const ShvQuat turn = {s * shv_sin(v), s * shv_cos(v), c * shv_sin(w), c * shv_cos(w)};
    const ShvQuat own =
        shv_quat_from_axis_angle(shv_load3(placement->rotation_axis), placement->rotation_degrees / degrees);
    const ShvQuat both = shv_quat_multiply(turn, own);
    const ShvVec3 axis = {both.x, both.y, both.z};
    placement->rotation_degrees = degrees * 2.0 * shv_acos(fmin(1.0, fmax(-1.0, both.w)));
    shv_store3(placement->rotation_axis, axis);
    make_unit(placement->rotation_axis);
}

static void place_copy(ShvPlacement *placement, const ShvObjectItem *item, int32_t number)
{
    enum { NUMBERS_A_COPY = 6 };
    const uint64_t first = NUMBERS_A_COPY * (uint64_t)number;
    for (int axis = 0; axis < 3; axis++)
        placement->position[axis] +=
            (double)number * item->repeat_offset[axis] +
            item->repeat_spread[axis] * (shv_random_uniform(item->repeat_seed, first + (uint64_t)axis) - 0.5);
    if (item->repeat_turn) turn_at_random(placement, item->repeat_seed, first + 3);
}

static int64_t count_objects(const ShvSceneItem *scene)
{
    const ShvObjectItem *items = scene->objects.data;
    int64_t count = 0;
    for (int32_t i = 0; i < scene->objects.count; i++) count += items[i].repeat_count > 0 ? items[i].repeat_count : 1;
    return count;
}

static const double *finished_profile(const ShvItems *corners, ShvPool *pool)
{
    const ShvCornerItem *from = corners->data;
    double *profile = corners->count > 0 ? shv_pool_take(pool, 2 * (size_t)corners->count, sizeof *profile) : NULL;
    for (int32_t i = 0; profile && i < corners->count; i++) {
        profile[2 * (int64_t)i] = from[i].radius;
        profile[2 * (int64_t)i + 1] = from[i].height;
    }
    return profile;
}

static void assemble_objects(ShvAssembly *assembly, const ShvSceneItem *scene, ShvPool *pool, ShvPool *work,
                             ShvDiagnostics *diagnostics)
{
    const ShvObjectItem *items = scene->objects.data;
    const int64_t total = count_objects(scene);
    if (total > SHV_SCENE_LARGEST_OBJECTS) {
        shv_error(diagnostics, items[0].head.key->place, "%lld objects with all repeats; at most %d are possible",
                  (long long)total, (int)SHV_SCENE_LARGEST_OBJECTS);
        return;
    }
    ShvObjectDefinition *objects = shv_pool_take(pool, (size_t)total, sizeof *objects);
    const ShvObjectItem **sources = shv_pool_take(work, (size_t)total, sizeof *sources);
    if (!objects || !sources) return;
    int32_t count = 0;
    for (int32_t i = 0; i < scene->objects.count; i++) {
        const ShvObjectItem *item = &items[i];
        const int32_t copies = item->repeat_count;
        const double *profile = finished_profile(&item->profile, pool);
        for (int32_t k = 0; k < (copies > 0 ? copies : 1); k++) {
            ShvObjectDefinition *object = &objects[count];
            sources[count++] = item;
            *object = finished_object(item);
            object->mesh.profile = profile;
            object->mesh.profile_count = item->profile.count;
            assemble_groups(object, &item->groups, pool);
            if (item->cracks.count > 0) assemble_cracks(object, &item->cracks, pool);
            if (copies == 0) continue;
            object->name = copy_name(pool, item->head.name, k + 1);
            place_copy(&object->placement, item, k);
        }
    }
    assembly->object_sources = sources;
    assembly->objects = objects;
    assembly->definition.objects = objects;
    assembly->definition.object_count = count;
}

/* A slice is held along one axis, all of it. */
static void hold_slices(ShvAssembly *assembly, ShvConditionDefinition *conditions, ShvPool *pool)
{
    static const char ending[] = ".plane_strain";
    ShvSceneDefinition *definition = &assembly->definition;
    for (int32_t i = 0; i < definition->object_count; i++) {
        const int axis = assembly->object_sources[i]->plane_strain;
        const char *object = definition->objects[i].name;
        if (axis == 0) continue;
        char *name = shv_pool_take(pool, strlen(object) + sizeof ending, 1);
        if (!name) return;
        ShvConditionDefinition *condition = &conditions[definition->condition_count++];
        *condition = shv_condition_default();
        condition->name = strcat(strcpy(name, object), ending);
        condition->object = object;
        condition->kind = SHV_CONDITION_SUPPORT;
        for (int k = 0; k < 3; k++) condition->axes[k] = k == axis - 1;
    }
}

static void assemble_conditions(ShvAssembly *assembly, const ShvSceneItem *scene, ShvPool *pool)
{
    ShvSceneDefinition *definition = &assembly->definition;
    const ShvItems *groups[] = {&scene->supports, &scene->velocities, &scene->tractions};
    const size_t total = (size_t)scene->supports.count + (size_t)scene->velocities.count +
                         (size_t)scene->tractions.count + (size_t)definition->object_count;
    ShvConditionDefinition *conditions = shv_pool_take(pool, total, sizeof *conditions);
    if (!conditions) return;
    for (int g = 0; g < 3; g++) {
        const ShvConditionItem *items = groups[g]->data;
        for (int32_t i = 0; i < groups[g]->count; i++) {
            ShvConditionDefinition *condition = &conditions[definition->condition_count++];
            *condition = items[i].definition;
            condition->name = items[i].head.name;
            make_unit(condition->selection.plane_normal);
        }
    }
    hold_slices(assembly, conditions, pool);
    definition->conditions = conditions;
}

static void assemble_keyframes(ShvObstacleDefinition *obstacle, const ShvItems *items, ShvPool *pool)
{
    const ShvKeyframeItem *from = items->data;
    ShvKeyframe *keyframes = shv_pool_take(pool, (size_t)items->count, sizeof *keyframes);
    if (!keyframes) return;
    for (int32_t i = 0; i < items->count; i++) {
        keyframes[i] = from[i].keyframe;
        make_unit(keyframes[i].rotation_axis);
    }
    obstacle->keyframes = keyframes;
    obstacle->keyframe_count = items->count;
}

static void assemble_obstacles(ShvSceneDefinition *definition, const ShvSceneItem *scene, ShvPool *pool)
{
    const ShvObstacleItem *items = scene->obstacles.data;
    const int32_t count = scene->obstacles.count;
    ShvObstacleDefinition *obstacles = shv_pool_take(pool, (size_t)count, sizeof *obstacles);
    if (!obstacles) return;
    for (int32_t i = 0; i < count; i++) {
        ShvObstacleDefinition *obstacle = &obstacles[i];
        *obstacle = items[i].definition;
        obstacle->name = items[i].head.name;
        make_unit(obstacle->plane_normal);
        make_unit(obstacle->placement.rotation_axis);
        if (items[i].keyframes.count > 0) {
            obstacle->motion = SHV_OBSTACLE_SCRIPTED;
            assemble_keyframes(obstacle, &items[i].keyframes, pool);
        } else if (obstacle->mass > 0.0) {
            obstacle->motion = SHV_OBSTACLE_FREE;
        }
    }
    definition->obstacles = obstacles;
    definition->obstacle_count = count;
}

static void assemble_events(ShvSceneDefinition *definition, const ShvSceneItem *scene, ShvPool *pool)
{
    const ShvEventItem *items = scene->events.data;
    const int32_t count = scene->events.count;
    ShvEventDefinition *events = shv_pool_take(pool, (size_t)count, sizeof *events);
    if (!events) return;
    for (int32_t i = 0; i < count; i++) events[i] = items[i].definition;
    definition->events = events;
    definition->event_count = count;
}

static void assemble_probes(ShvSceneDefinition *definition, const ShvSceneItem *scene, ShvPool *pool)
{
    const ShvProbeItem *items = scene->probes.data;
    const int32_t count = scene->probes.count;
    ShvProbeDefinition *probes = shv_pool_take(pool, (size_t)count, sizeof *probes);
    if (!probes) return;
    for (int32_t i = 0; i < count; i++) {
        probes[i] = items[i].definition;
        probes[i].name = items[i].head.name;
        make_unit(probes[i].selection.plane_normal);
    }
    definition->probes = probes;
    definition->probe_count = count;
}

/* `fracture.plane` is the only way to choose, and has a normal where it is given. */
static void confine_fracture(ShvSelection *on)
{
    const double *normal = on->plane_normal;
    if (normal[0] == 0.0 && normal[1] == 0.0 && normal[2] == 0.0) return;
    on->kind = SHV_SELECT_PLANE;
    make_unit(on->plane_normal);
}

void shv_assemble(ShvAssembly *assembly, const ShvSceneItem *scene, ShvPool *pool, ShvPool *work,
                  ShvDiagnostics *diagnostics)
{
    *assembly = (ShvAssembly){.definition = scene->definition};
    confine_fracture(&assembly->definition.fracture.on);
    assemble_materials(&assembly->definition, scene, pool);
    assemble_objects(assembly, scene, pool, work, diagnostics);
    assemble_conditions(assembly, scene, pool);
    assemble_obstacles(&assembly->definition, scene, pool);
    assemble_events(&assembly->definition, scene, pool);
    assemble_probes(&assembly->definition, scene, pool);
}
