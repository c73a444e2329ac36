#include "model/model.h"

#include <omp.h>
#include <string.h>

#include "base/deterministic.h"
#include "base/text.h"
#include "mesh/generate.h"
#include "model/precrack.h"

/* A corner is numbered 4 × element + corner in 32 bits. */
static const int64_t element_limit = INT32_MAX / 4;
static const int32_t thread_limit = 1024;

static const char *start_from_default = "was not started from its default; start it there, then fill it in";

static ShvStatus check_scene(const ShvSceneDefinition *scene, ShvError *error)
{
    if (scene->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the scene %s", start_from_default);
    if (scene->object_count < 1 || !scene->objects)
        return shv_fail(error, SHV_BAD_INPUT, "the scene has no objects; give at least one");
    if (scene->material_count < 1 || !scene->materials)
        return shv_fail(error, SHV_BAD_INPUT, "the scene has no materials; give at least one");
    if (scene->object_count > INT16_MAX || scene->material_count > INT16_MAX)
        return shv_fail(error, SHV_BAD_INPUT, "the scene has %d objects and %d materials; at most %d of each fit",
                        (int)scene->object_count, (int)scene->material_count, INT16_MAX);
    if (scene->threads < 0 || scene->threads > thread_limit)
        return shv_fail(error, SHV_BAD_INPUT, "threads is %d; give 0 (all processors) to %d", (int)scene->threads,
                        (int)thread_limit);
    return SHV_OK;
}

static ShvStatus make_materials(ShvModel *model, const ShvSceneDefinition *scene, ShvError *error)
{
    const size_t count = (size_t)scene->material_count;
    model->materials = shv_allocate(model->memory, SHV_PART_GENERAL, count, sizeof *model->materials);
    if (!model->materials) return shv_fail_memory(error, "materials", count * sizeof *model->materials);
    model->material_count = scene->material_count;
    for (int32_t i = 0; i < scene->material_count; i++) {
        SHV_TRY(shv_material_make(&model->materials[i], &scene->materials[i], error));
        for (int32_t j = 0; j < i; j++)
            if (strcmp(model->materials[j].name, model->materials[i].name) == 0)
                return shv_fail(error, SHV_BAD_INPUT, "two materials are named '%s'; rename one",
                                model->materials[i].name);
    }
    return SHV_OK;
}

static int32_t find_material(const ShvModel *model, const char *name)
{
    for (int32_t i = 0; i < model->material_count; i++)
        if (strcmp(model->materials[i].name, name) == 0) return i;
    return -1;
}

static ShvStatus check_placement(const ShvObjectDefinition *object, ShvError *error)
{
    const ShvPlacement *placement = &object->placement;
    const ShvVec3 axis = shv_load3(placement->rotation_axis);
    const double squared_length = shv_dot(axis, axis);
    if (!shv_finite3(shv_load3(placement->position)) || !shv_finite3(shv_load3(placement->velocity)) ||
        !shv_finite3(shv_load3(placement->angular_velocity)) || !shv_finite3(shv_load3(placement->stretch_rate)) ||
        !isfinite(placement->rotation_degrees))
        return shv_fail(
            error, SHV_BAD_INPUT,
            "object '%s': position, rotation, velocity, angular velocity and stretch rate must be finite numbers",
            object->name);
    if (placement->rotation_degrees != 0.0 && !(squared_length > 0.0 && isfinite(squared_length)))
        return shv_fail(error, SHV_BAD_INPUT,
                        "object '%s': the axis of its rotation has no direction; give a vector of about unit length",
                        object->name);
    return SHV_OK;
}

static ShvStatus make_object(ShvModel *model, const ShvSceneDefinition *scene, int32_t index, ShvError *error)
{
    const ShvObjectDefinition *definition = &scene->objects[index];
    if (definition->cookie != SHV_DEFINITION_COOKIE || definition->mesh.cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "object %d or its mesh %s", (int)index, start_from_default);
    if (!definition->name || !definition->name[0])
        return shv_fail(error, SHV_BAD_INPUT, "object %d has no name; give it one", (int)index);
    for (int32_t i = 0; i < index; i++)
        if (strcmp(model->objects[i].name, definition->name) == 0)
            return shv_fail(error, SHV_BAD_INPUT, "two objects are named '%s'; rename one", definition->name);
    if (!definition->material)
        return shv_fail(error, SHV_BAD_INPUT, "object '%s' has no material; name one", definition->name);
    const int32_t material = find_material(model, definition->material);
    if (material < 0)
        return shv_fail(error, SHV_BAD_INPUT, "object '%s': there is no material '%s'; define it or name another",
                        definition->name, definition->material);
    model->objects[index] = (ShvObject){.name = definition->name, .material = material};
    return check_placement(definition, error);
}

static ShvStatus make_objects(ShvModel *model, const ShvSceneDefinition *scene, ShvError *error)
{
    const size_t count = (size_t)scene->object_count;
    model->objects = shv_allocate(model->memory, SHV_PART_GENERAL, count, sizeof *model->objects);
    if (!model->objects) return shv_fail_memory(error, "objects", count * sizeof *model->objects);
    model->object_count = scene->object_count;
    for (int32_t i = 0; i < scene->object_count; i++) SHV_TRY(make_object(model, scene, i, error));
    return SHV_OK;
}

/* Rotates about the mesh's origin, then shifts. Where there is neither, coordinates keep their bits. */
static void place(ShvMesh *mesh, const ShvPlacement *placement)
{
    const double radians = placement->rotation_degrees * SHV_DEGREE;
    const ShvQuat rotation = shv_quat_from_axis_angle(shv_load3(placement->rotation_axis), radians);
    const ShvVec3 position = shv_load3(placement->position);
    for (int32_t i = 0; i < mesh->node_count; i++) {
        ShvVec3 x = shv_mesh_position(mesh, i);
        if (placement->rotation_degrees != 0.0) x = shv_rotate(rotation, x);
        shv_store3(mesh->positions + 3 * (int64_t)i, shv_add(x, position));
    }
}

/* A mesh that was valid loses its digits when it is put too far from the origin. */
static ShvStatus check_placed(const ShvMesh *mesh, const char *name, ShvError *error)
{
    for (int32_t e = 0; e < mesh->element_count; e++) {
        const double volume = shv_mesh_element_volume(mesh, e);
        if (!(volume > 0.0 && isfinite(volume)))
            return shv_fail(error, SHV_BAD_INPUT,
                            "object '%s': at its position element %d has the volume %g in double precision; place it "
                            "nearer to the origin",
                            name, (int)e, volume);
    }
    return SHV_OK;
}

int32_t shv_threads_worth(int32_t tets)
{
    /* A thread that has slept takes some fifty microseconds to wake, and waits for others dozens of times a step: with fewer tets
       each, two take no less time than one. */
    enum { TETS_A_THREAD = 2048 };
    const int32_t useful = 1 + tets / TETS_A_THREAD;
    return useful < omp_get_num_procs() ? useful : omp_get_num_procs();
}

static ShvStatus make_part(ShvMesh *part, ShvMemory *memory, const ShvObjectDefinition *object, const char *folder,
                           ShvError *error)
{
    const ShvStatus status = shv_mesh_generate(part, memory, &object->mesh, folder, error);
    if (status != SHV_OK) return shv_fail_within(error, status, "object '%s'", object->name);
    place(part, &object->placement);
    SHV_TRY(check_placed(part, object->name, error));
    return shv_precrack_open(part, object, error);
}

/* Gives every object its ranges in the joint mesh. */
static ShvStatus count_parts(ShvModel *model, const ShvMesh *parts, int64_t *nodes, int64_t *elements, ShvError *error)
{
    *nodes = *elements = 0;
    for (int32_t i = 0; i < model->object_count; i++) {
        ShvObject *object = &model->objects[i];
        object->node_begin = (int32_t)*nodes;
        object->element_begin = (int32_t)*elements;
        *nodes += parts[i].node_count;
        *elements += parts[i].element_count;
        if (*elements > element_limit || *nodes > SHV_NODE_LIMIT)
            return shv_fail(error, SHV_BAD_INPUT,
                            "the objects up to '%s' have %lld tets and %lld nodes together; at most %lld tets fit: "
                            "mesh them more coarsely",
                            object->name, (long long)*elements, (long long)*nodes, (long long)element_limit);
        object->node_end = (int32_t)*nodes;
        object->element_end = (int32_t)*elements;
    }
    return SHV_OK;
}

static void join_part(ShvModel *model, const ShvObject *object, const ShvMesh *part)
{
    ShvMesh *mesh = &model->mesh;
    memcpy(mesh->positions + 3 * (int64_t)object->node_begin, part->positions,
           3 * (size_t)part->node_count * sizeof *part->positions);
    int32_t *elements = mesh->elements + 4 * (int64_t)object->element_begin;
    for (int64_t i = 0; i < 4 * (int64_t)part->element_count; i++) elements[i] = part->elements[i] + object->node_begin;
    for (int32_t e = object->element_begin; e < object->element_end; e++)
        model->element_material[e] = (uint16_t)object->material;
}

/* What a mesh calls its groups, for a message. */
static void list_groups(const ShvMesh *part, char *text, size_t size)
{
    text[0] = '\0';
    for (int32_t i = 0; i < part->group_count; i++) {
        const size_t length = strlen(text);
        shv_format(text + length, size - length, "%s'%s'", i ? ", " : "", part->groups[i].name);
    }
}

static ShvStatus find_group(const ShvObjectDefinition *object, const ShvGroupDefinition *group, const ShvMesh *part,
                            int32_t *tag, ShvError *error)
{
    char names[300];
    *tag = shv_mesh_find_group(part, group->name);
    if (*tag != 0) return SHV_OK;
    list_groups(part, names, sizeof names);
    return shv_fail(error, SHV_BAD_INPUT, "object '%s': its mesh has no physical volume '%s'; %s%s", object->name,
                    group->name,
                    names[0]               ? "it has "
                    : part->element_groups ? "name them by number: its volumes have no names"
                                           : "only gmsh files that define physical volumes have some",
                    names);
}

/* "glass + steel". */
static ShvStatus name_materials(const ShvModel *model, ShvObject *object, const ShvObjectDefinition *definition,
                                ShvError *error)
{
    size_t size = strlen(definition->material) + 1;
    for (int32_t i = 0; i < definition->group_count; i++) size += strlen(definition->groups[i].material) + 3;
    object->materials = shv_allocate(model->memory, SHV_PART_GENERAL, size, 1);
    if (!object->materials) return shv_fail_memory(error, "names of materials", size);
    size_t length = (size_t)shv_format(object->materials, size, "%s", definition->material);
    for (int32_t i = 0; i < definition->group_count; i++)
        length +=
            (size_t)shv_format(object->materials + length, size - length, " + %s", definition->groups[i].material);
    return SHV_OK;
}

static ShvStatus join_group(ShvModel *model, const ShvObject *object, const ShvObjectDefinition *definition,
                            const ShvGroupDefinition *group, const ShvMesh *part, ShvError *error)
{
    int32_t tag;
    const int32_t material = group->material ? find_material(model, group->material) : -1;
    if (!group->name || material < 0)
        return shv_fail(error, SHV_BAD_INPUT,
                        "object '%s', group '%s': there is no material '%s'; define it or name another",
                        definition->name, group->name ? group->name : "", group->material ? group->material : "");
    SHV_TRY(find_group(definition, group, part, &tag, error));
    for (int32_t e = 0; e < part->element_count; e++)
        if (part->element_groups[e] == tag) model->element_material[object->element_begin + e] = (uint16_t)material;
    return SHV_OK;
}

static ShvStatus join_groups(ShvModel *model, ShvObject *object, const ShvObjectDefinition *definition,
                             const ShvMesh *part, ShvError *error)
{
    for (int32_t i = 0; i < definition->group_count; i++)
        SHV_TRY(join_group(model, object, definition, &definition->groups[i], part, error));
    return definition->group_count > 0 ? name_materials(model, object, definition, error) : SHV_OK;
}

static ShvStatus join_parts(ShvModel *model, const ShvSceneDefinition *scene, const ShvMesh *parts, ShvError *error)
{
    int64_t nodes, elements;
    SHV_TRY(count_parts(model, parts, &nodes, &elements, error));
    SHV_TRY(shv_mesh_allocate(&model->mesh, model->memory, nodes, elements, error));
    const size_t size = sizeof *model->element_material;
    model->element_material = shv_allocate(model->memory, SHV_PART_MESH, (size_t)elements, size);
    if (!model->element_material) return shv_fail_memory(error, "the materials of elements", (size_t)elements * size);
    for (int32_t i = 0; i < model->object_count; i++) {
        join_part(model, &model->objects[i], &parts[i]);
        SHV_TRY(join_groups(model, &model->objects[i], &scene->objects[i], &parts[i], error));
    }
    return SHV_OK;
}

static ShvStatus make_mesh(ShvModel *model, const ShvSceneDefinition *scene, const char *folder, ShvError *error)
{
    const size_t count = (size_t)scene->object_count;
    ShvMesh *parts = shv_allocate(model->memory, SHV_PART_MESH, count, sizeof *parts);
    if (!parts) return shv_fail_memory(error, "the meshes of objects", count * sizeof *parts);
    ShvStatus status = SHV_OK;
    for (int32_t i = 0; i < scene->object_count && status == SHV_OK; i++)
        status = make_part(&parts[i], model->memory, &scene->objects[i], folder, error);
    if (status == SHV_OK) status = join_parts(model, scene, parts, error);
    for (int32_t i = 0; i < scene->object_count; i++) shv_mesh_release(&parts[i]);
    shv_release(parts);
    return status;
}

static double mean_edge(const ShvMesh *mesh, const ShvObject *object)
{
    double sum = 0.0;
    for (int32_t e = object->element_begin; e < object->element_end; e++)
        for (int i = 0; i < 4; i++)
            for (int j = i + 1; j < 4; j++) {
                const int32_t *nodes = mesh->elements + 4 * (int64_t)e;
                sum += shv_norm(shv_sub(shv_mesh_position(mesh, nodes[i]), shv_mesh_position(mesh, nodes[j])));
            }
    return sum / (6.0 * (object->element_end - object->element_begin));
}

/* Whether an object has a tet of a material. */
static bool is_of(const ShvModel *model, const ShvObject *object, int32_t material)
{
    bool found = object->material == material;
    for (int32_t e = object->element_begin; e < object->element_end && !found; e++)
        found = model->element_material[e] == material;
    return found;
}

/* Every material to the coarsest of its objects: it is one material in all of them. */
static void resolve_materials(ShvModel *model)
{
    for (int32_t m = 0; m < model->material_count; m++) {
        double coarsest = 0.0;
        for (int32_t i = 0; i < model->object_count; i++)
            if (is_of(model, &model->objects[i], m))
                coarsest = fmax(coarsest, mean_edge(&model->mesh, &model->objects[i]));
        if (coarsest > 0.0) shv_material_resolve(&model->materials[m], coarsest);
    }
}

static bool something_can_break(const ShvModel *model, const ShvSceneDefinition *scene)
{
    bool can = false;
    for (int32_t e = 0; scene->fracture.enabled && e < model->mesh.element_count && !can; e++)
        can = shv_material_can_open(shv_model_material(model, e));
    return can;
}

static ShvStatus build(ShvModel *model, const ShvSceneDefinition *scene, const char *folder, ShvError *error)
{
    SHV_TRY(check_scene(scene, error));
    model->seed = scene->seed;
    SHV_TRY(make_materials(model, scene, error));
    SHV_TRY(make_objects(model, scene, error));
    SHV_TRY(make_mesh(model, scene, folder, error));
    resolve_materials(model);
    model->most_threads = scene->threads > 0 ? scene->threads : shv_threads_worth(model->mesh.element_count);
    model->threads = model->most_threads;
    model->can_break = something_can_break(model, scene);
    if (model->can_break) SHV_TRY(shv_adjacency_build(&model->adjacency, &model->mesh, error));
    return SHV_OK;
}

ShvStatus shv_model_build(ShvModel *model, ShvMemory *memory, const ShvSceneDefinition *scene, const char *folder,
                          ShvError *error)
{
    *model = (ShvModel){.memory = memory};
    const ShvStatus status = build(model, scene, folder, error);
    if (status != SHV_OK) shv_model_release(model);
    return status;
}

void shv_model_release(ShvModel *model)
{
    shv_adjacency_release(&model->adjacency);
    shv_mesh_release(&model->mesh);
    shv_release(model->materials);
    for (int32_t i = 0; i < model->object_count; i++) shv_release(model->objects[i].materials);
    shv_release(model->objects);
    shv_release(model->element_material);
    *model = (ShvModel){0};
}
