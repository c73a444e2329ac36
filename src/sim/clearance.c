/* What is nearest to an object at the start, by true surfaces, and how fast it would meet something on the way it goes. */
#include <stdlib.h>

#include "bullet_bridge/surface_distance.h"
#include "contact/box.h"
#include "sim/internal.h"
#include "sim/overlap_measure.h"

/* What another thing is to the object: where their surfaces are nearest, and how the object moves to it. */
typedef struct Approach {
    double gap;        /* m */
    ShvVec3 point;     /* of the object */
    ShvVec3 direction; /* of unit length, from there to the other; zero where they touch and no surface tells it */
    ShvVec3 velocity;  /* m/s: of the other, there */
    bool falls;        /* the other, too */
} Approach;

static ShvStatus make_surface(ShvDistanceSurface **surface, const ShvModel *model, int32_t object, ShvError *error)
{
    const ShvMesh part = shv_object_part(model, &model->objects[object]);
    int32_t *triangles, count;
    SHV_TRY(shv_mesh_boundary(&part, SHV_PART_GENERAL, &triangles, &count, error));
    const ShvStatus status = shv_distance_surface_create(surface, part.positions, triangles, count, error);
    shv_release(triangles);
    return status;
}

static const ShvFragment *fragment_of(const ShvHybrid *hybrid, int32_t object)
{
    for (int32_t i = 0; i < hybrid->fragments.count; i++)
        if (hybrid->fragments.items[i].object == object) return &hybrid->fragments.items[i];
    return NULL;
}

static Approach between(const ShvSurfaceDistance *nearest)
{
    const ShvVec3 direction = shv_sub(shv_load3(nearest->second), shv_load3(nearest->first));
    return (Approach){.gap = nearest->distance,
                      .point = shv_load3(nearest->first),
                      .direction = nearest->distance > 0.0 ? shv_unit(direction) : shv_vec3(0.0, 0.0, 0.0)};
}

/* ---- obstacles ---- */

static Approach approach_plane(const ShvModel *model, const ShvObject *object, const ShvObstacle *plane)
{
    Approach approach = {.gap = HUGE_VAL};
    for (int32_t i = object->node_begin; i < object->node_end; i++) {
        const ShvVec3 x = shv_mesh_position(&model->mesh, i);
        const double gap = shv_dot(plane->normal, x) - plane->offset;
        if (!(gap < approach.gap)) continue;
        approach.gap = gap;
        approach.point = x;
    }
    approach.gap = fmax(0.0, approach.gap);
    return approach;
}

static ShvStatus measure_triangles(const ShvDistanceSurface *surface, const ShvObstacle *obstacle,
                                   ShvSurfaceDistance *nearest, ShvError *error)
{
    double corners[24];
    const ShvSurface local = shv_obstacle_surface(obstacle, corners);
    double *positions = shv_allocate(NULL, SHV_PART_GENERAL, 3 * (size_t)local.node_count, sizeof *positions);
    if (!positions) return shv_fail_memory(error, "the surface of an obstacle", 24 * (size_t)local.node_count);
    for (int32_t i = 0; i < local.node_count; i++)
        shv_store3(positions + 3 * (int64_t)i,
                   shv_add(obstacle->position, shv_rotate(obstacle->orientation, shv_surface_position(&local, i))));
    ShvDistanceSurface *other;
    ShvStatus status = shv_distance_surface_create(&other, positions, local.triangles, local.triangle_count, error);
    if (status == SHV_OK) {
        status = shv_surface_distance(surface, other, nearest, error);
        shv_distance_surface_destroy(other);
    }
    shv_release(positions);
    return status;
}

static ShvStatus approach_obstacle(const ShvModel *model, int32_t object, const ShvDistanceSurface *surface,
                                   const ShvObstacle *obstacle, Approach *approach, ShvError *error)
{
    if (obstacle->shape == SHV_OBSTACLE_PLANE) {
        *approach = approach_plane(model, &model->objects[object], obstacle);
    } else {
        ShvSurfaceDistance nearest;
        double centre[3];
        shv_store3(centre, obstacle->position);
        SHV_TRY(obstacle->shape == SHV_OBSTACLE_SPHERE
                    ? shv_surface_distance_to_sphere(surface, centre, obstacle->radius, &nearest, error)
                    : measure_triangles(surface, obstacle, &nearest, error));
        *approach = between(&nearest);
    }
    const ShvSurfacePoint there = shv_obstacle_closest(obstacle, approach->point, HUGE_VAL);
    if (!(approach->gap > 0.0) || obstacle->shape == SHV_OBSTACLE_PLANE)
        approach->direction = shv_scale(there.normal, -1.0);
    approach->velocity = shv_obstacle_velocity(obstacle, there.point);
    approach->falls = obstacle->motion == SHV_OBSTACLE_FREE;
    return SHV_OK;
}

/* ---- all of them ---- */

/* On the straight way by the shortest distance; nothing where it does not get there. */
static double impact_speed(const ShvHybrid *hybrid, const ShvFragment *fragment, const Approach *approach)
{
    const ShvVec3 velocity = shv_sub(shv_fragment_velocity(fragment, approach->point), approach->velocity);
    const double start = shv_dot(velocity, approach->direction);
    const double fall = approach->falls ? 0.0 : shv_dot(shv_load3(hybrid->gravity), approach->direction);
    const double squared = start * start + 2.0 * fall * approach->gap;
    return squared > 0.0 && (start > 0.0 || fall > 0.0) ? sqrt(squared) : (double)NAN;
}

static void keep_nearest(ShvPreflight *preflight, const Approach *approach, const char *name, bool is_obstacle)
{
    if (preflight->nearest && !(approach->gap < preflight->clearance)) return;
    preflight->nearest = name;
    preflight->nearest_is_obstacle = is_obstacle;
    preflight->clearance = approach->gap;
}

static ShvStatus measure_obstacles(ShvPreflight *preflight, const ShvHybrid *hybrid, int32_t object,
                                   const ShvDistanceSurface *surface, ShvError *error)
{
    const ShvFragment *fragment = fragment_of(hybrid, object);
    for (int32_t i = 0; i < hybrid->obstacles.count; i++) {
        const ShvObstacle *obstacle = &hybrid->obstacles.items[i];
        Approach approach;
        if (obstacle->definition->waits) continue;
        SHV_TRY(approach_obstacle(&hybrid->model, object, surface, obstacle, &approach, error));
        keep_nearest(preflight, &approach, obstacle->name, true);
        if (fragment)
            preflight->impact_speed = fmax(preflight->impact_speed, impact_speed(hybrid, fragment, &approach));
    }
    return SHV_OK;
}

static ShvStatus measure_object(ShvPreflight *preflight, const ShvHybrid *hybrid, int32_t object, int32_t other,
                                const ShvDistanceSurface *surface, ShvError *error)
{
    const ShvFragment *fragment = fragment_of(hybrid, object), *second = fragment_of(hybrid, other);
    ShvDistanceSurface *there;
    ShvSurfaceDistance nearest;
    SHV_TRY(make_surface(&there, &hybrid->model, other, error));
    const ShvStatus status = shv_surface_distance(surface, there, &nearest, error);
    shv_distance_surface_destroy(there);
    if (status != SHV_OK) return status;
    Approach approach = between(&nearest);
    keep_nearest(preflight, &approach, hybrid->model.objects[other].name, false);
    if (!fragment || !second || approach.gap > preflight->clearance) return SHV_OK;
    approach.velocity = shv_fragment_velocity(second, shv_load3(nearest.second));
    approach.falls = true;
    preflight->impact_speed = fmax(preflight->impact_speed, impact_speed(hybrid, fragment, &approach));
    return SHV_OK;
}

static double gap_of_boxes(const ShvBox *a, const ShvBox *b)
{
    const double x = fmax(a->low.x - b->high.x, b->low.x - a->high.x);
    const double y = fmax(a->low.y - b->high.y, b->low.y - a->high.y);
    const double z = fmax(a->low.z - b->high.z, b->low.z - a->high.z);
    return shv_norm(shv_vec3(fmax(x, 0.0), fmax(y, 0.0), fmax(z, 0.0)));
}

/* Objects whose boxes are farther away than the nearest so far are passed over. */
static ShvStatus measure_objects(ShvPreflight *preflight, const ShvHybrid *hybrid, int32_t object,
                                 const ShvDistanceSurface *surface, ShvError *error)
{
    ShvStartBody own, body;
    shv_start_body(&own, &hybrid->model, object);
    for (int32_t i = 0; i < hybrid->model.object_count; i++) {
        if (i == object || hybrid->scene->objects[i].waits) continue;
        shv_start_body(&body, &hybrid->model, i);
        if (preflight->nearest && !(gap_of_boxes(&own.box, &body.box) < preflight->clearance)) continue;
        SHV_TRY(measure_object(preflight, hybrid, object, i, surface, error));
    }
    return SHV_OK;
}

ShvStatus shv_find_nearest(ShvPreflight *preflight, const ShvHybrid *hybrid, int32_t object, ShvError *error)
{
    ShvDistanceSurface *surface;
    preflight->clearance = (double)INFINITY;
    preflight->impact_speed = (double)NAN;
    SHV_TRY(make_surface(&surface, &hybrid->model, object, error));
    ShvStatus status = measure_obstacles(preflight, hybrid, object, surface, error);
    if (status == SHV_OK) status = measure_objects(preflight, hybrid, object, surface, error);
    shv_distance_surface_destroy(surface);
    return status;
}
