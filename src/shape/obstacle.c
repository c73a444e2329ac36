#include "shape/obstacle.h"

#include "base/deterministic.h"
#include "base/file.h"
#include "shape/bounding_tree.h"
#include "shape/collide.h"
#include "shape/feature.h"

/* ---- validation: every message begins with the obstacle's name ---- */

static bool all_finite(const double *values, int count)
{
    for (int k = 0; k < count; k++)
        if (!isfinite(values[k])) return false;
    return true;
}

static bool all_zero(const double values[3])
{
    return values[0] == 0.0 && values[1] == 0.0 && values[2] == 0.0;
}

static ShvStatus check_shape(const ShvObstacleDefinition *definition, ShvError *error)
{
    switch (definition->shape) {
    case SHV_OBSTACLE_PLANE:
        if (!all_finite(definition->plane_normal, 3) || all_zero(definition->plane_normal))
            return shv_fail(error, SHV_BAD_INPUT, "the plane's normal must be finite and not zero");
        if (!isfinite(definition->plane_offset))
            return shv_fail(error, SHV_BAD_INPUT, "the plane's offset must be finite");
        if (definition->motion != SHV_OBSTACLE_FIXED)
            return shv_fail(error, SHV_BAD_INPUT, "a plane must be fixed; use a box for a wall that moves");
        return SHV_OK;
    case SHV_OBSTACLE_SPHERE:
        if (!(definition->radius > 0.0) || !isfinite(definition->radius))
            return shv_fail(error, SHV_BAD_INPUT, "the radius must be > 0, but is %g m", definition->radius);
        return SHV_OK;
    case SHV_OBSTACLE_BOX:
        for (int k = 0; k < 3; k++)
            if (!(definition->size[k] > 0.0) || !isfinite(definition->size[k]))
                return shv_fail(error, SHV_BAD_INPUT, "the box's three edge lengths must be > 0, but one is %g m",
                                definition->size[k]);
        return SHV_OK;
    case SHV_OBSTACLE_MESH:
        if (!definition->file || definition->file[0] == '\0')
            return shv_fail(error, SHV_BAD_INPUT, "a mesh needs a file with a closed triangle surface");
        if (!(definition->scale > 0.0) || !isfinite(definition->scale))
            return shv_fail(error, SHV_BAD_INPUT, "the scale must be > 0, but is %g", definition->scale);
        return SHV_OK;
    }
    return shv_fail(error, SHV_BAD_INPUT, "the shape must be a plane, sphere, box or mesh");
}

static ShvStatus check_placement(const ShvObstacleDefinition *definition, ShvError *error)
{
    const ShvPlacement *placement = &definition->placement;
    if (!all_finite(placement->position, 3) || !all_finite(placement->rotation_axis, 3) ||
        !isfinite(placement->rotation_degrees) || !all_finite(placement->velocity, 3) ||
        !all_finite(placement->angular_velocity, 3))
        return shv_fail(error, SHV_BAD_INPUT, "position, rotation and velocities must be finite");
    if (placement->rotation_degrees != 0.0 && all_zero(placement->rotation_axis))
        return shv_fail(error, SHV_BAD_INPUT, "the rotation's axis must not be zero");
    if (definition->motion != SHV_OBSTACLE_FREE &&
        (!all_zero(placement->velocity) || !all_zero(placement->angular_velocity)))
        return shv_fail(error, SHV_BAD_INPUT,
                        "only a free obstacle has a velocity at the start; give it a mass and make "
                        "it free, or let keyframes move it");
    return SHV_OK;
}

static ShvStatus check_keyframes(const ShvObstacleDefinition *definition, ShvError *error)
{
    if (definition->keyframe_count < 1 || !definition->keyframes)
        return shv_fail(error, SHV_BAD_INPUT, "a scripted obstacle needs keyframes");
    for (int32_t k = 0; k < definition->keyframe_count; k++) {
        const ShvKeyframe *keyframe = &definition->keyframes[k];
        if (!isfinite(keyframe->time) || !all_finite(keyframe->position, 3) ||
            !all_finite(keyframe->rotation_axis, 3) || !isfinite(keyframe->rotation_degrees))
            return shv_fail(error, SHV_BAD_INPUT, "keyframe %d has a value that is not finite", (int)k);
        if (keyframe->rotation_degrees != 0.0 && all_zero(keyframe->rotation_axis))
            return shv_fail(error, SHV_BAD_INPUT, "the rotation axis of keyframe %d must not be zero", (int)k);
        if (k > 0 && !(keyframe->time > keyframe[-1].time))
            return shv_fail(error, SHV_BAD_INPUT, "keyframe times must increase, but %g s follows %g s", keyframe->time,
                            keyframe[-1].time);
    }
    return SHV_OK;
}

static ShvStatus check(const ShvObstacleDefinition *definition, ShvError *error)
{
    if (definition->cookie != SHV_DEFINITION_COOKIE)
        return shv_fail(error, SHV_BAD_INPUT, "the definition did not start from shv_obstacle_default()");
    SHV_TRY(check_shape(definition, error));
    SHV_TRY(check_placement(definition, error));
    if (!(definition->friction >= 0.0) || !isfinite(definition->friction))
        return shv_fail(error, SHV_BAD_INPUT, "friction must be 0 or more, but is %g", definition->friction);
    if (!(definition->restitution >= 0.0 && definition->restitution <= 1.0))
        return shv_fail(error, SHV_BAD_INPUT, "restitution must lie between 0 and 1, but is %g",
                        definition->restitution);
    switch (definition->motion) {
    case SHV_OBSTACLE_FIXED:
        return SHV_OK;
    case SHV_OBSTACLE_SCRIPTED:
        return check_keyframes(definition, error);
    case SHV_OBSTACLE_FREE:
        if (definition->mass > 0.0 && isfinite(definition->mass)) return SHV_OK;
        return shv_fail(error, SHV_BAD_INPUT, "a free obstacle needs a mass > 0, but has %g kg", definition->mass);
    }
    return shv_fail(error, SHV_BAD_INPUT, "the motion must be fixed, scripted or free");
}

/* ---- making ---- */

static ShvMat3 diagonal(double x, double y, double z)
{
    return (ShvMat3){{{x, 0.0, 0.0}, {0.0, y, 0.0}, {0.0, 0.0, z}}};
}

/* Reads the surface and moves its origin to the centre of mass; *unit receives the inertia over the mass. */
static ShvStatus make_mesh(ShvObstacle *obstacle, ShvMemory *memory, const char *folder, ShvMat3 *unit, ShvError *error)
{
    const ShvObstacleDefinition *definition = obstacle->definition;
    char *path = NULL;
    SHV_TRY(shv_path_join(memory, SHV_PART_SHAPE, folder, definition->file, &path, error));
    ShvStatus status = shv_surface_read(&obstacle->surface, memory, SHV_PART_SHAPE, path, definition->scale, error);
    if (status == SHV_OK) status = shv_surface_require_closed(&obstacle->surface, path, error);
    shv_release(path);
    if (status != SHV_OK) return status;
    const ShvMassProperties mass = shv_surface_mass(&obstacle->surface);
    obstacle->centre = mass.centre;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) unit->m[i][j] = mass.inertia.m[i][j] / mass.mass;
    for (int32_t i = 0; i < obstacle->surface.node_count; i++) {
        const ShvVec3 local = shv_sub(shv_surface_position(&obstacle->surface, i), mass.centre);
        shv_store3(obstacle->surface.positions + 3 * (int64_t)i, local);
        obstacle->bounding_radius = fmax(obstacle->bounding_radius, shv_norm(local));
    }
    obstacle->tree = shv_bounding_tree_create(memory, &obstacle->surface);
    if (obstacle->tree) return SHV_OK;
    return shv_fail_memory(error, "a tree over a surface", (size_t)obstacle->surface.triangle_count * 256);
}

static ShvStatus make_shape(ShvObstacle *obstacle, ShvMemory *memory, const char *folder, ShvMat3 *unit,
                            ShvError *error)
{
    const ShvObstacleDefinition *definition = obstacle->definition;
    const double *size = definition->size, r = definition->radius;
    switch (obstacle->shape) {
    case SHV_OBSTACLE_PLANE: {
        const ShvVec3 normal = shv_load3(definition->plane_normal);
        obstacle->normal = shv_unit(normal);
        obstacle->offset = definition->plane_offset;
        obstacle->bounding_radius = (double)INFINITY;
        return SHV_OK;
    }
    case SHV_OBSTACLE_SPHERE:
        obstacle->radius = obstacle->bounding_radius = r;
        *unit = diagonal(0.4 * r * r, 0.4 * r * r, 0.4 * r * r);
        return SHV_OK;
    case SHV_OBSTACLE_BOX:
        obstacle->half = shv_scale(shv_load3(size), 0.5);
        obstacle->bounding_radius = shv_norm(obstacle->half);
        *unit = diagonal((size[1] * size[1] + size[2] * size[2]) / 12.0, (size[2] * size[2] + size[0] * size[0]) / 12.0,
                         (size[0] * size[0] + size[1] * size[1]) / 12.0);
        return SHV_OK;
    case SHV_OBSTACLE_MESH:
        break;
    }
    return make_mesh(obstacle, memory, folder, unit, error);
}

static ShvStatus make_body(ShvObstacle *obstacle, const ShvMat3 *unit, ShvError *error)
{
    const ShvObstacleDefinition *definition = obstacle->definition;
    obstacle->mass = definition->mass;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) obstacle->inertia.m[i][j] = definition->mass * unit->m[i][j];
    if (!shv_invert(&obstacle->inertia, &obstacle->inverse_inertia))
        return shv_fail(error, SHV_BAD_INPUT, "its inertia cannot be inverted; give it a larger size or mass");
    double moments[3];
    ShvMat3 axes;
    shv_symmetric_eigen(&obstacle->inertia, moments, &axes);
    obstacle->principal_moments = shv_load3(moments);
    obstacle->principal_axes = shv_quat_from_matrix(&axes);
    obstacle->velocity = shv_load3(definition->placement.velocity);
    obstacle->angular_velocity = shv_load3(definition->placement.angular_velocity);
    return SHV_OK;
}

static ShvStatus make(ShvObstacle *obstacle, ShvMemory *memory, const ShvObstacleDefinition *definition,
                      const char *folder, ShvError *error)
{
    SHV_TRY(check(definition, error));
    *obstacle = (ShvObstacle){.definition = definition,
                              .name = definition->name ? definition->name : "",
                              .shape = definition->shape,
                              .motion = definition->motion,
                              .friction = definition->friction,
                              .restitution = definition->restitution,
                              .mass = (double)INFINITY,
                              .principal_axes = shv_quat_identity(),
                              .orientation = shv_quat_identity()};
    ShvMat3 unit = shv_identity();
    SHV_TRY(make_shape(obstacle, memory, folder, &unit, error));
    SHV_TRY(shv_features_create(obstacle, memory, error));
    if (obstacle->shape == SHV_OBSTACLE_PLANE) return SHV_OK;
    const ShvPlacement *placement = &definition->placement;
    obstacle->orientation =
        shv_quat_from_axis_angle(shv_load3(placement->rotation_axis), placement->rotation_degrees * SHV_DEGREE);
    obstacle->position = shv_add(shv_load3(placement->position), shv_rotate(obstacle->orientation, obstacle->centre));
    return obstacle->motion == SHV_OBSTACLE_FREE ? make_body(obstacle, &unit, error) : SHV_OK;
}

static ShvStatus make_all(ShvObstacles *obstacles, const ShvSceneDefinition *scene, const char *folder, ShvError *error)
{
    const size_t count = (size_t)scene->obstacle_count;
    obstacles->items = shv_allocate(obstacles->memory, SHV_PART_SHAPE, count, sizeof *obstacles->items);
    if (!obstacles->items) return shv_fail_memory(error, "the obstacles", count * sizeof *obstacles->items);
    for (int32_t i = 0; i < scene->obstacle_count; i++) {
        const ShvObstacleDefinition *definition = &scene->obstacles[i];
        obstacles->count = i + 1;
        const ShvStatus status = make(&obstacles->items[i], obstacles->memory, definition, folder, error);
        if (status == SHV_OK) continue;
        return shv_fail_within(error, status, "obstacle %s", definition->name ? definition->name : "without a name");
    }
    obstacles->contact_capacity = shv_collide_capacity(obstacles);
    const size_t contacts = (size_t)obstacles->contact_capacity;
    obstacles->contacts = shv_allocate(obstacles->memory, SHV_PART_SHAPE, contacts, sizeof *obstacles->contacts);
    if (!obstacles->contacts)
        return shv_fail_memory(error, "contacts of obstacles", contacts * sizeof *obstacles->contacts);
    shv_obstacles_script(obstacles, 0.0);
    return SHV_OK;
}

ShvSurface shv_obstacle_surface(const ShvObstacle *obstacle, double corners[24])
{
    static int32_t triangles[36] = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                                    2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    const ShvVec3 half = obstacle->half;
    if (obstacle->shape != SHV_OBSTACLE_BOX) return obstacle->surface;
    for (int k = 0; k < 8; k++)
        shv_store3(corners + 3 * k,
                   shv_vec3(k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z));
    return (ShvSurface){.node_count = 8, .triangle_count = 12, .positions = corners, .triangles = triangles};
}

ShvStatus shv_obstacles_create(ShvObstacles *obstacles, ShvMemory *memory, const ShvSceneDefinition *scene,
                               const char *folder, ShvError *error)
{
    *obstacles = (ShvObstacles){.memory = memory};
    const ShvStatus status = make_all(obstacles, scene, folder, error);
    if (status != SHV_OK) shv_obstacles_release(obstacles);
    return status;
}

void shv_obstacles_release(ShvObstacles *obstacles)
{
    for (int32_t i = 0; i < obstacles->count; i++) {
        shv_bounding_tree_release(obstacles->items[i].tree);
        shv_surface_release(&obstacles->items[i].surface);
        shv_release(obstacles->items[i].features);
    }
    shv_release(obstacles->items);
    shv_release(obstacles->contacts);
    *obstacles = (ShvObstacles){0};
}
