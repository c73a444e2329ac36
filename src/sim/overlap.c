/* Objects and free obstacles that overlap at the start, each other or obstacles: which, how deep, what parts them, and what the scene says about it. */
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "mesh/adjacency.h"
#include "shape/collide.h"
#include "sim/internal.h"
#include "sim/overlap_measure.h"

/* Of the smaller of two sizes: what touches may overlap by rounding. */
static const double touch_of_size = 1e-6;

typedef struct Finder {
    const ShvHybrid *hybrid;
    ShvStartBody *bodies;
    ShvStartObstacle *obstacles;
    int32_t *triangles; /* of all bodies' surfaces; NULL until two bodies come near each other */
    ShvOverlap *overlaps;
    int32_t room, count;
} Finder;

/* ---- surfaces, where something is near ---- */

/* Boundary triangles of each object are put together, in the order of objects. */
static int32_t object_of(const ShvModel *model, int32_t node)
{
    int32_t low = 0, high = model->object_count - 1;
    while (low < high) {
        const int32_t middle = (low + high) / 2;
        if (node < model->objects[middle].node_end)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

static void sort_triangles(Finder *finder, const int32_t *triangles, int32_t count)
{
    const ShvModel *model = &finder->hybrid->model;
    for (int32_t i = 0; i < count; i++)
        finder->bodies[object_of(model, triangles[3 * (int64_t)i])].surface.triangle_count++;
    int32_t *next = finder->triangles;
    for (int32_t i = 0; i < model->object_count; i++) {
        ShvSurface *surface = &finder->bodies[i].surface;
        surface->triangles = next;
        next += 3 * (int64_t)surface->triangle_count;
        surface->triangle_count = 0;
    }
    for (int32_t i = 0; i < count; i++) {
        const int32_t *nodes = triangles + 3 * (int64_t)i, object = object_of(model, nodes[0]);
        ShvSurface *surface = &finder->bodies[object].surface;
        int32_t *kept = surface->triangles + 3 * (int64_t)surface->triangle_count++;
        for (int k = 0; k < 3; k++) kept[k] = nodes[k] - model->objects[object].node_begin;
    }
}

static ShvStatus need_triangles(Finder *finder, ShvError *error)
{
    if (finder->triangles) return SHV_OK;
    int32_t *triangles, count;
    SHV_TRY(shv_mesh_boundary(&finder->hybrid->model.mesh, SHV_PART_GENERAL, &triangles, &count, error));
    finder->triangles =
        shv_allocate(finder->hybrid->memory, SHV_PART_GENERAL, 3 * (size_t)count, sizeof *finder->triangles);
    if (finder->triangles) sort_triangles(finder, triangles, count);
    shv_release(triangles);
    return finder->triangles ? SHV_OK : shv_fail_memory(error, "the surfaces of objects", 12 * (size_t)count);
}

static ShvStatus need_tree(Finder *finder, ShvStartBody *body, ShvError *error)
{
    SHV_TRY(need_triangles(finder, error));
    if (!body->tree) body->tree = shv_bounding_tree_create(finder->hybrid->memory, &body->surface);
    return body->tree ? SHV_OK : shv_fail_memory(error, "the surface of an object", 0);
}

/* ---- pairs ---- */

/* Two that are near: the object, and the other object or the obstacle. */
typedef struct Pair {
    const ShvStartBody *first, *second;
    const ShvStartObstacle *obstacle;
    double tolerance; /* m: depth that is rounding */
} Pair;

static ShvDepth depth_of(const Pair *pair, ShvVec3 shift)
{
    return pair->second ? shv_depth_of_objects(pair->first, pair->second, shift, pair->tolerance)
                        : shv_depth_in_obstacle(pair->first, pair->obstacle, shift, pair->tolerance);
}

/* Three digits, so that it is printed as it is; never less than it was, but for rounding. */
static double away_from_zero(double value, double least)
{
    double unit = 1.0;
    const double size = fabs(value);
    if (size < least) return 0.0;
    while (size < 100.0 * unit) unit /= 10.0;
    while (size >= 1000.0 * unit) unit *= 10.0;
    return copysign(ceil(size / unit - 1e-6) * unit, value);
}

static ShvVec3 along(ShvVec3 direction, double length)
{
    const double least = 1e-7 * length; /* what is left out counts by its square: 1e-14 of the length */
    const ShvVec3 v = shv_scale(direction, length);
    return shv_vec3(away_from_zero(v.x, least), away_from_zero(v.y, least), away_from_zero(v.z, least));
}

static double depth_along(const Pair *pair, ShvVec3 direction, double depth)
{
    return pair->second ? shv_depth_along_object(pair->first, pair->second, direction)
                        : shv_depth_along_obstacle(pair->first, pair->obstacle, direction, depth);
}

/* By the depth, where that does it; else past the whole of the other, on whichever side is nearer. */
static ShvVec3 separation(const Pair *pair, const ShvDepth *deepest)
{
    const ShvVec3 direction = deepest->direction, shortest = along(direction, deepest->depth);
    if (depth_of(pair, shortest).depth <= pair->tolerance) return shortest;
    const ShvVec3 back = shv_scale(direction, -1.0);
    const double ahead = depth_along(pair, direction, deepest->depth), behind = depth_along(pair, back, deepest->depth);
    return ahead <= behind ? along(direction, ahead) : along(back, behind);
}

/* Of two objects the one that need not go downwards, where something else may be. */
static void part(const Pair *pair, const ShvDepth *deepest, const double gravity[3], ShvOverlap *overlap)
{
    const ShvVec3 direction = separation(pair, deepest);
    const bool moves_second = pair->second && shv_dot(direction, shv_load3(gravity)) >= 0.0;
    overlap->mover = moves_second ? overlap->second : overlap->first;
    shv_store3(overlap->parting, moves_second ? shv_sub(shv_vec3(0.0, 0.0, 0.0), direction) : direction);
}

/* Deepest first; of equal ones that found first. */
static void keep(Finder *finder, const ShvOverlap *overlap)
{
    const int32_t held = finder->count < finder->room ? finder->count : finder->room;
    int32_t place = held;
    while (place > 0 && finder->overlaps[place - 1].depth < overlap->depth) place--;
    finder->count++;
    if (place == finder->room) return;
    const int32_t moved = (held < finder->room ? held : finder->room - 1) - place;
    memmove(finder->overlaps + place + 1, finder->overlaps + place, (size_t)moved * sizeof *overlap);
    finder->overlaps[place] = *overlap;
}

static void compare(Finder *finder, const Pair *pair)
{
    const ShvDepth deepest = depth_of(pair, shv_vec3(0.0, 0.0, 0.0));
    if (!(deepest.depth > pair->tolerance)) return;
    ShvOverlap overlap = {.first = pair->first->object->name,
                          .second = pair->second ? pair->second->object->name : pair->obstacle->obstacle->name,
                          .obstacle = !pair->second,
                          .depth = deepest.depth};
    shv_store3(overlap.point, deepest.point);
    part(pair, &deepest, finder->hybrid->gravity, &overlap);
    keep(finder, &overlap);
}

static ShvStatus compare_objects(Finder *finder, int32_t i, int32_t k, ShvError *error)
{
    const ShvObjectDefinition *objects = finder->hybrid->scene->objects;
    if (objects[i].waits || objects[k].waits) return SHV_OK;
    ShvStartBody *first = &finder->bodies[i < k ? i : k], *second = &finder->bodies[i < k ? k : i];
    const double tolerance = touch_of_size * fmin(first->size, second->size);
    if (!(shv_bound_of_objects(first, second) > tolerance)) return SHV_OK;
    SHV_TRY(need_tree(finder, first, error));
    SHV_TRY(need_tree(finder, second, error));
    compare(finder, &(Pair){.first = first, .second = second, .tolerance = tolerance});
    return SHV_OK;
}

static ShvStatus compare_obstacle(Finder *finder, ShvStartBody *body, const ShvStartObstacle *place, ShvError *error)
{
    const double tolerance = touch_of_size * fmin(body->size, place->obstacle->bounding_radius);
    if (!(shv_bound_of_obstacle(body, place) > tolerance)) return SHV_OK;
    if (place->obstacle->shape != SHV_OBSTACLE_PLANE) SHV_TRY(need_tree(finder, body, error));
    compare(finder, &(Pair){.first = body, .obstacle = place, .tolerance = tolerance});
    return SHV_OK;
}

/* What is free is to move. */
static void compare_obstacles(Finder *finder, int32_t i, int32_t k)
{
    const ShvObstacles *obstacles = &finder->hybrid->obstacles;
    const bool first_free = obstacles->items[i].motion == SHV_OBSTACLE_FREE;
    const ShvObstacle *mover = &obstacles->items[first_free ? i : k], *other = &obstacles->items[first_free ? k : i];
    ShvBodyContact deepest;
    if (mover->motion != SHV_OBSTACLE_FREE || shv_hybrid_waits(finder->hybrid, i) ||
        shv_hybrid_waits(finder->hybrid, k) ||
        !shv_collide_overlap(obstacles, mover, other, touch_of_size * mover->bounding_radius, &deepest))
        return;
    ShvOverlap overlap = {
        .first = mover->name, .second = other->name, .obstacle = true, .depth = -deepest.gap, .mover = mover->name};
    shv_store3(overlap.point, deepest.point);
    shv_store3(overlap.parting, along(shv_scale(deepest.normal, deepest.first == 0 ? 1.0 : -1.0), overlap.depth));
    keep(finder, &overlap);
}

/* ---- all of them ---- */

typedef struct Start {
    double low; /* m: along x */
    int32_t body;
} Start;

static int by_start(const void *a, const void *b)
{
    const Start *first = a, *second = b;
    if (first->low != second->low) return first->low < second->low ? -1 : 1;
    return first->body < second->body ? -1 : first->body > second->body;
}

/* Swept along x, so that many bodies far from each other cost little. */
static ShvStatus compare_all_objects(Finder *finder, ShvError *error)
{
    const int32_t count = finder->hybrid->model.object_count;
    Start *starts = shv_allocate(finder->hybrid->memory, SHV_PART_GENERAL, (size_t)count, sizeof *starts);
    if (!starts) return shv_fail_memory(error, "the order of objects", (size_t)count * sizeof *starts);
    for (int32_t i = 0; i < count; i++) starts[i] = (Start){finder->bodies[i].box.low.x, i};
    qsort(starts, (size_t)count, sizeof *starts, by_start);
    ShvStatus status = SHV_OK;
    for (int32_t i = 0; i < count && status == SHV_OK; i++) {
        const double end = finder->bodies[starts[i].body].box.high.x;
        for (int32_t k = i + 1; k < count && starts[k].low < end && status == SHV_OK; k++)
            status = compare_objects(finder, starts[i].body, starts[k].body, error);
    }
    shv_release(starts);
    return status;
}

static ShvStatus compare_all(Finder *finder, ShvError *error)
{
    const ShvHybrid *hybrid = finder->hybrid;
    for (int32_t i = 0; i < hybrid->model.object_count; i++) shv_start_body(&finder->bodies[i], &hybrid->model, i);
    for (int32_t i = 0; i < hybrid->obstacles.count; i++)
        shv_start_obstacle(&finder->obstacles[i], &hybrid->obstacles.items[i]);
    for (int32_t i = 0; i < hybrid->model.object_count; i++)
        for (int32_t k = 0; k < hybrid->obstacles.count && !hybrid->scene->objects[i].waits; k++)
            SHV_TRY(compare_obstacle(finder, &finder->bodies[i], &finder->obstacles[k], error));
    for (int32_t i = 0; i < hybrid->obstacles.count; i++)
        for (int32_t k = i + 1; k < hybrid->obstacles.count; k++) compare_obstacles(finder, i, k);
    return compare_all_objects(finder, error);
}

static ShvStatus find(const ShvHybrid *hybrid, ShvOverlap *overlaps, int32_t room, int32_t *count, ShvError *error)
{
    const size_t objects = (size_t)hybrid->model.object_count, obstacles = (size_t)hybrid->obstacles.count;
    Finder finder = {.hybrid = hybrid,
                     .bodies = shv_allocate(hybrid->memory, SHV_PART_GENERAL, objects, sizeof(ShvStartBody)),
                     .obstacles = shv_allocate(hybrid->memory, SHV_PART_GENERAL, obstacles, sizeof(ShvStartObstacle)),
                     .overlaps = overlaps,
                     .room = room};
    const ShvStatus status =
        finder.bodies && finder.obstacles
            ? compare_all(&finder, error)
            : shv_fail_memory(error, "where objects and obstacles are", objects * sizeof(ShvStartBody));
    for (size_t i = 0; finder.bodies && i < objects; i++) shv_bounding_tree_release(finder.bodies[i].tree);
    shv_release(finder.triangles);
    shv_release(finder.obstacles);
    shv_release(finder.bodies);
    *count = finder.count;
    return status;
}

ShvStatus shv_simulation_overlaps(const ShvSimulation *simulation, ShvOverlap *overlaps, int32_t room, int32_t *count,
                                  ShvError *error)
{
    *count = 0;
    if (simulation->started)
        return shv_fail(error, SHV_BAD_INPUT, "overlaps are those of the start; ask a new simulation");
    if (simulation->scene->overlaps != SHV_OVERLAPS_KEEP) return SHV_OK; /* or it had not been made */
    return find(&simulation->hybrid, overlaps, room, count, error);
}

/* ---- refusal ---- */

static int describe(char *text, size_t size, const ShvOverlap *o)
{
    return shv_format(text, size,
                      "'%s' and the %s '%s' overlap at the start, %.3g m deep at (%.4g, %.4g, %.4g): move '%s' by "
                      "(%.3g, %.3g, %.3g) m",
                      o->first, o->obstacle ? "obstacle" : "object", o->second, o->depth, o->point[0], o->point[1],
                      o->point[2], o->mover, o->parting[0], o->parting[1], o->parting[2]);
}

/* A body of a file that is larger than this, m, at scale 1, was most likely drawn in millimetres. */
static const double likely_metres = 5.0;

static double object_size(const ShvHybrid *hybrid, int32_t object)
{
    ShvStartBody body;
    shv_start_body(&body, &hybrid->model, object);
    const ShvVec3 size = shv_sub(body.box.high, body.box.low);
    return fmax(size.x, fmax(size.y, size.z));
}

static void hint_at_scale(const ShvHybrid *hybrid, const ShvOverlap *overlap, char *text, size_t size)
{
    for (int32_t i = 0; i < hybrid->model.object_count; i++) {
        const ShvObjectDefinition *object = &hybrid->scene->objects[i];
        const bool named = strcmp(object->name, overlap->first) == 0 || strcmp(object->name, overlap->second) == 0;
        if (!named || !object->mesh.file || object->mesh.scale != 1.0) continue;
        const double length = object_size(hybrid, i);
        if (length > likely_metres)
            shv_format(text, size,
                       ". '%.63s' is %.3g m long: if its file is in millimetres, give its mesh 'scale: 0.001'",
                       object->name, length);
    }
}

ShvStatus shv_simulation_refuse_overlaps(const ShvSimulation *simulation, ShvError *error)
{
    ShvOverlap deepest[3];
    const int32_t room = (int32_t)(sizeof deepest / sizeof deepest[0]);
    int32_t count;
    if (simulation->scene->overlaps == SHV_OVERLAPS_KEEP) return SHV_OK;
    SHV_TRY(find(&simulation->hybrid, deepest, room, &count, error));
    if (count == 0) return SHV_OK;
    char texts[3][384] = {"", "", ""}, more[48] = "", hint[200] = "";
    hint_at_scale(&simulation->hybrid, &deepest[0], hint, sizeof hint);
    for (int32_t i = 0; i < count && i < room; i++) describe(texts[i], sizeof texts[i], &deepest[i]);
    if (count > room) shv_format(more, sizeof more, "; and %d more", (int)(count - room));
    return shv_fail(error, SHV_BAD_INPUT, "%s, or give 'overlaps: keep', and %s%s%s%s%s%s%s", texts[0],
                    shv_simulation_overlap_course(simulation, &deepest[0]), count > 1 ? "; also " : "", texts[1],
                    count > 2 ? "; also " : "", texts[2], more, hint);
}

static bool is_obstacle(const ShvHybrid *hybrid, const char *name)
{
    for (int32_t i = 0; i < hybrid->obstacles.count; i++)
        if (strcmp(hybrid->obstacles.items[i].name, name) == 0) return true;
    return false;
}

/* What each engine does, in one sentence for check and run. */
const char *shv_simulation_overlap_course(const ShvSimulation *simulation, const ShvOverlap *overlap)
{
    const ShvHybrid *hybrid = &simulation->hybrid;
    for (int32_t i = 0; i < hybrid->fragments.count; i++) {
        const ShvFragment *fragment = &hybrid->fragments.items[i];
        const char *name = hybrid->model.objects[fragment->object].name;
        if (fragment->mode == SHV_MODE_FRACTURE && strcmp(name, overlap->first) == 0)
            return "in fracture mode, where it starts, nothing is pushed out, it only comes no deeper";
    }
    if (is_obstacle(hybrid, overlap->first) && hybrid->scene->rigid.engine != SHV_RIGID_BULLET_PLAIN)
        return "the run lets it be: neither is pushed out, it only comes no deeper";
    switch (hybrid->scene->rigid.engine) {
    case SHV_RIGID_BULLET:
        return hybrid->coupling.mutual ? "the run lets it be: neither is pushed out, and it goes as they part or slide"
                                       : "the run does not see it";
    case SHV_RIGID_BULLET_PLAIN:
        return hybrid->scene->bullet_plain.keep_overlaps
                   ? "the run lets it be: neither is pushed out, and it goes as they part"
                   : "the run pushes both out, by a fifth of the depth a rigid step, and may leave them the speed of "
                     "that";
    case SHV_RIGID_PBD:
        return overlap->obstacle
                   ? "the run moves the nodes out in the first step, with the energy that takes"
                   : "the run does not see it: objects do not meet each other in flight under this engine";
    case SHV_RIGID_ANALYTIC:
        break;
    }
    return overlap->obstacle
               ? "the run moves the object out, by at most a tenth of its radius a rigid step, and books the energy"
               : "the run does not see it: objects do not meet each other in flight under this engine";
}
