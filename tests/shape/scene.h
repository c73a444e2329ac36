/* Obstacles for tests, without a scene file. */
#ifndef SHV_TESTS_SHAPE_SCENE_H
#define SHV_TESTS_SHAPE_SCENE_H

#include "check.h"

#include <stdlib.h>
#include <unistd.h>

#include "base/random.h"
#include "shape/obstacle.h"

/* Uniform in (low, high). */
static inline double draw(uint64_t seed, uint64_t *index, double low, double high)
{
    return low + (high - low) * shv_random_uniform(seed, (*index)++);
}
static inline ShvVec3 draw_vector(uint64_t seed, uint64_t *index, double size)
{
    const double x = draw(seed, index, -size, size), y = draw(seed, index, -size, size);
    return shv_vec3(x, y, draw(seed, index, -size, size));
}

static inline ShvObstacleDefinition plane_definition(const char *name, ShvVec3 normal, double offset)
{
    ShvObstacleDefinition definition = shv_obstacle_default();
    definition.name = name;
    definition.shape = SHV_OBSTACLE_PLANE;
    shv_store3(definition.plane_normal, normal);
    definition.plane_offset = offset;
    return definition;
}
static inline ShvObstacleDefinition sphere_definition(const char *name, double radius, ShvVec3 position)
{
    ShvObstacleDefinition definition = shv_obstacle_default();
    definition.name = name;
    definition.shape = SHV_OBSTACLE_SPHERE;
    definition.radius = radius;
    shv_store3(definition.placement.position, position);
    return definition;
}
static inline ShvObstacleDefinition box_definition(const char *name, ShvVec3 size, ShvVec3 position)
{
    ShvObstacleDefinition definition = shv_obstacle_default();
    definition.name = name;
    definition.shape = SHV_OBSTACLE_BOX;
    shv_store3(definition.size, size);
    shv_store3(definition.placement.position, position);
    return definition;
}
static inline ShvObstacleDefinition mesh_definition(const char *name, const char *file, ShvVec3 position)
{
    ShvObstacleDefinition definition = shv_obstacle_default();
    definition.name = name;
    definition.shape = SHV_OBSTACLE_MESH;
    definition.file = file;
    shv_store3(definition.placement.position, position);
    return definition;
}
static inline void make_free(ShvObstacleDefinition *definition, double mass)
{
    definition->motion = SHV_OBSTACLE_FREE;
    definition->mass = mass;
}
static inline void turn(ShvObstacleDefinition *definition, ShvVec3 axis, double degrees)
{
    shv_store3(definition->placement.rotation_axis, axis);
    definition->placement.rotation_degrees = degrees;
}

static inline ShvObstacles make_obstacles(const ShvObstacleDefinition *definitions, int32_t count)
{
    ShvSceneDefinition scene = shv_scene_default();
    ShvObstacles obstacles;
    ShvError error;
    scene.obstacles = definitions;
    scene.obstacle_count = count;
    check_ok(shv_obstacles_create(&obstacles, NULL, &scene, NULL, &error), error);
    return obstacles;
}

/* A temporary OBJ file in a folder of its own; the caller removes both with remove_surface_file. */
typedef struct SurfaceFile {
    char folder[64], path[80];
} SurfaceFile;

static inline SurfaceFile surface_file(const char *text)
{
    SurfaceFile file;
    strcpy(file.folder, "/tmp/shiver_surface_XXXXXX");
    assert_non_null(mkdtemp(file.folder));
    snprintf(file.path, sizeof file.path, "%s/surface.obj", file.folder);
    FILE *out = fopen(file.path, "w");
    assert_non_null(out);
    assert_true(fputs(text, out) >= 0);
    assert_int_equal(fclose(out), 0);
    return file;
}
static inline void remove_surface_file(const SurfaceFile *file)
{
    unlink(file->path);
    rmdir(file->folder);
}

/* A box of edges 2, 1, 0.5 with one corner at the file's origin. */
static const char box_text[] = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nv 0 0 .5\nv 2 0 .5\nv 2 1 .5\nv 0 1 .5\n"
                               "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

/* An L: [0,2]×[0,1] and [0,1]×[0,2] joined, 0 < z < 1. Its re-entrant edge is (1, 1, z). */
static const char angle_text[] = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n"
                                 "v 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\n"
                                 "f 4 3 2 1\nf 6 5 4 1\nf 7 8 9 10\nf 7 10 11 12\n"
                                 "f 1 2 8 7\nf 2 3 9 8\nf 3 4 10 9\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\n";

/* A narrow spike: a pyramid of base 0.2 × 0.2 and height 2, whose edges and top are far sharper than a right angle. */
static const char spike_text[] = "v -.1 -.1 0\nv .1 -.1 0\nv .1 .1 0\nv -.1 .1 0\nv 0 0 2\n"
                                 "f 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";

#endif
