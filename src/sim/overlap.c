/* Objects that overlap at the start, each other or obstacles, by their true surfaces. */
#include <string.h>

#include "contact/box.h"
#include "mesh/adjacency.h"
#include "shape/bounding_tree.h"
#include "sim/internal.h"

/* Of the smaller of two sizes: what touches may overlap by rounding. */
static const double touch_of_size = 1e-6;

/* An object's boundary where it stands at the start; nodes are numbered from its first. */
typedef struct Body {
    ShvBox box;
    double size;        /* m: half its diagonal */
    ShvSurface surface; /* positions are the mesh's */
    ShvBoundingTree *tree;
} Body;

typedef struct Finder {
    const ShvHybrid *hybrid;
    Body *bodies;
    ShvOverlap *overlaps;
    int32_t room, count;
} Finder;

/* ---- bodies ---- */

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

static void sort_triangles(Finder *finder, const int32_t *triangles, int32_t count, int32_t *sorted)
{
    const ShvModel *model = &finder->hybrid->model;
    for (int32_t i = 0; i < count; i++)
        finder->bodies[object_of(model, triangles[3 * (int64_t)i])].surface.triangle_count++;
    int32_t *next = sorted;
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

static void measure_body(const ShvModel *model, int32_t object, Body *body)
{
    body->surface.memory = model->memory;
    body->surface.part = SHV_PART_GENERAL;
    const ShvObject *own = &model->objects[object];
    body->surface.positions = model->mesh.positions + 3 * (int64_t)own->node_begin;
    body->surface.node_count = own->node_end - own->node_begin;
    body->box = shv_box_empty();
    for (int32_t i = own->node_begin; i < own->node_end; i++)
        shv_box_add(&body->box, shv_mesh_position(&model->mesh, i));
    body->size = 0.5 * shv_norm(shv_sub(body->box.high, body->box.low));
}

/* ---- depths ---- */

/* Of one body's surface in what `closest` tells the signed distance to. Corners are tried, and edges that pass through between
   them: at the middle of what is inside. */
typedef struct Inside {
    const void *what;
    double (*gap)(const void *what, ShvVec3 point);
    bool (*sweep)(const void *what, ShvVec3 from, ShvVec3 to, double *fraction);
} Inside;

static double gap_to_body(const void *what, ShvVec3 point)
{
    const Body *body = what;
    const bool outside = point.x < body->box.low.x || point.y < body->box.low.y || point.z < body->box.low.z ||
                         point.x > body->box.high.x || point.y > body->box.high.y || point.z > body->box.high.z;
    return outside ? HUGE_VAL : shv_bounding_tree_closest(body->tree, point, 0.0).gap;
}

static bool sweep_body(const void *what, ShvVec3 from, ShvVec3 to, double *fraction)
{
    const Body *body = what;
    ShvVec3 normal;
    return shv_bounding_tree_sweep(body->tree, from, to, fraction, &normal);
}

static double gap_to_obstacle(const void *what, ShvVec3 point)
{
    return shv_obstacle_closest(what, point, 0.0).gap;
}

static bool sweep_obstacle(const void *what, ShvVec3 from, ShvVec3 to, double *fraction)
{
    ShvCrossing crossing;
    if (!shv_obstacle_sweep(what, from, to, &crossing)) return false;
    *fraction = crossing.fraction;
    return true;
}

static void try_point(const Inside *inside, ShvVec3 point, ShvOverlap *overlap)
{
    const double depth = -inside->gap(inside->what, point);
    if (!(depth > overlap->depth)) return;
    overlap->depth = depth;
    shv_store3(overlap->point, point);
}

static void try_edge(const Inside *inside, ShvVec3 from, ShvVec3 to, ShvOverlap *overlap)
{
    double in, out;
    if (!inside->sweep(inside->what, from, to, &in) || !inside->sweep(inside->what, to, from, &out)) return;
    const double middle = 0.5 * (in + 1.0 - out);
    if (in < 1.0 - out) try_point(inside, shv_madd(from, middle, shv_sub(to, from)), overlap);
}

/* Every edge is that of two triangles: it is tried where its corners rise. */
static void try_surface(const Inside *inside, const ShvBox *near, const ShvSurface *surface, ShvOverlap *overlap)
{
    for (int32_t i = 0; i < surface->triangle_count; i++) {
        const int32_t *nodes = surface->triangles + 3 * (int64_t)i;
        ShvBox box = shv_box_empty();
        ShvVec3 corners[3];
        for (int k = 0; k < 3; k++) {
            corners[k] = shv_surface_position(surface, nodes[k]);
            shv_box_add(&box, corners[k]);
        }
        if (near && !shv_box_meets(&box, near)) continue;
        for (int k = 0; k < 3; k++) {
            const int next = (k + 1) % 3;
            try_point(inside, corners[k], overlap);
            if (nodes[k] < nodes[next]) try_edge(inside, corners[k], corners[next], overlap);
        }
    }
}

/* An obstacle that is inside of a body, or whose corners are. */
static void try_obstacle_in_body(const ShvObstacle *obstacle, const Body *body, ShvOverlap *overlap)
{
    const Inside inside = {body, gap_to_body, sweep_body};
    if (obstacle->shape == SHV_OBSTACLE_SPHERE) {
        const double depth = obstacle->radius - gap_to_body(body, obstacle->position);
        if (depth > overlap->depth) {
            overlap->depth = depth;
            shv_store3(overlap->point, obstacle->position);
        }
    } else if (obstacle->shape == SHV_OBSTACLE_BOX) {
        for (int k = 0; k < 8; k++) {
            const ShvVec3 corner =
                shv_vec3(k & 1 ? obstacle->half.x : -obstacle->half.x, k & 2 ? obstacle->half.y : -obstacle->half.y,
                         k & 4 ? obstacle->half.z : -obstacle->half.z);
            try_point(&inside, shv_add(obstacle->position, shv_rotate(obstacle->orientation, corner)), overlap);
        }
    } else if (obstacle->shape == SHV_OBSTACLE_MESH) {
        for (int32_t i = 0; i < obstacle->surface.node_count; i++)
            try_point(&inside,
                      shv_add(obstacle->position,
                              shv_rotate(obstacle->orientation, shv_surface_position(&obstacle->surface, i))),
                      overlap);
    }
}

/* ---- pairs ---- */

static ShvStatus need_tree(const Finder *finder, Body *body, ShvError *error)
{
    if (!body->tree) body->tree = shv_bounding_tree_create(finder->hybrid->memory, &body->surface);
    return body->tree ? SHV_OK : shv_fail_memory(error, "the surface of an object", 0);
}

static void keep(Finder *finder, const ShvOverlap *overlap, double size)
{
    if (!(overlap->depth > touch_of_size * size)) return;
    if (finder->count < finder->room) finder->overlaps[finder->count] = *overlap;
    finder->count++;
}

static ShvStatus compare_objects(Finder *finder, int32_t i, int32_t k, ShvError *error)
{
    Body *a = &finder->bodies[i], *b = &finder->bodies[k];
    if (!shv_box_meets(&a->box, &b->box)) return SHV_OK;
    SHV_TRY(need_tree(finder, a, error));
    SHV_TRY(need_tree(finder, b, error));
    const ShvObject *objects = finder->hybrid->model.objects;
    ShvOverlap overlap = {.first = objects[i].name, .second = objects[k].name};
    const Inside in_a = {a, gap_to_body, sweep_body}, in_b = {b, gap_to_body, sweep_body};
    try_surface(&in_a, &a->box, &b->surface, &overlap);
    try_surface(&in_b, &b->box, &a->surface, &overlap);
    keep(finder, &overlap, fmin(a->size, b->size));
    return SHV_OK;
}

static ShvStatus compare_obstacle(Finder *finder, int32_t i, const ShvObstacle *obstacle, ShvError *error)
{
    Body *body = &finder->bodies[i];
    const ShvVec3 centre = shv_scale(shv_add(body->box.low, body->box.high), 0.5);
    if (shv_obstacle_closest(obstacle, centre, 2.0 * body->size).gap > body->size) return SHV_OK;
    ShvOverlap overlap = {
        .first = finder->hybrid->model.objects[i].name, .second = obstacle->definition->name, .obstacle = true};
    const Inside inside = {obstacle, gap_to_obstacle, sweep_obstacle};
    try_surface(&inside, NULL, &body->surface, &overlap);
    if (obstacle->shape != SHV_OBSTACLE_PLANE) {
        SHV_TRY(need_tree(finder, body, error));
        try_obstacle_in_body(obstacle, body, &overlap);
    }
    keep(finder, &overlap, fmin(body->size, obstacle->bounding_radius));
    return SHV_OK;
}

static ShvStatus compare_all(Finder *finder, ShvError *error)
{
    const ShvHybrid *hybrid = finder->hybrid;
    for (int32_t i = 0; i < hybrid->model.object_count; i++) {
        for (int32_t k = i + 1; k < hybrid->model.object_count; k++) SHV_TRY(compare_objects(finder, i, k, error));
        for (int32_t k = 0; k < hybrid->obstacles.count; k++)
            SHV_TRY(compare_obstacle(finder, i, &hybrid->obstacles.items[k], error));
    }
    return SHV_OK;
}

ShvStatus shv_simulation_overlaps(const ShvSimulation *simulation, ShvOverlap *overlaps, int32_t room, int32_t *count,
                                  ShvError *error)
{
    const ShvHybrid *hybrid = &simulation->hybrid;
    const ShvModel *model = &hybrid->model;
    const size_t objects = (size_t)model->object_count;
    *count = 0;
    if (simulation->started)
        return shv_fail(error, SHV_BAD_INPUT, "overlaps are those of the start; ask a new simulation");
    int32_t *triangles, boundary;
    SHV_TRY(shv_mesh_boundary(&model->mesh, SHV_PART_GENERAL, &triangles, &boundary, error));
    int32_t *sorted = shv_allocate(hybrid->memory, SHV_PART_GENERAL, 3 * (size_t)boundary, sizeof *sorted);
    Finder finder = {.hybrid = hybrid,
                     .bodies = shv_allocate(hybrid->memory, SHV_PART_GENERAL, objects, sizeof(Body)),
                     .overlaps = overlaps,
                     .room = room};
    ShvStatus status = SHV_OK;
    if (sorted && finder.bodies) {
        sort_triangles(&finder, triangles, boundary, sorted);
        for (int32_t i = 0; i < model->object_count; i++) measure_body(model, i, &finder.bodies[i]);
        status = compare_all(&finder, error);
        for (size_t i = 0; i < objects; i++) shv_bounding_tree_release(finder.bodies[i].tree);
    } else {
        status = shv_fail_memory(error, "the surfaces of objects", objects * sizeof(Body));
    }
    shv_release(finder.bodies);
    shv_release(sorted);
    shv_release(triangles);
    *count = finder.count;
    return status;
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
    switch (hybrid->scene->rigid.engine) {
    case SHV_RIGID_BULLET:
        return hybrid->mutual ? "the run lets it be: neither is pushed out, and it goes as they part or slide"
                              : "the run does not see it";
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
