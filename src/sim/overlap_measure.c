#include "sim/overlap_measure.h"

/* ---- bodies ---- */

void shv_start_body(ShvStartBody *body, const ShvModel *model, int32_t object)
{
    const ShvObject *own = &model->objects[object];
    *body = (ShvStartBody){.model = model, .object = own, .box = shv_box_empty()};
    body->surface.memory = model->memory;
    body->surface.part = SHV_PART_GENERAL;
    body->surface.positions = model->mesh.positions + 3 * (int64_t)own->node_begin;
    body->surface.node_count = own->node_end - own->node_begin;
    for (int32_t i = 0; i < body->surface.node_count; i++)
        shv_box_add(&body->box, shv_surface_position(&body->surface, i));
    body->centre = shv_scale(shv_add(body->box.low, body->box.high), 0.5);
    body->size = 0.5 * shv_norm(shv_sub(body->box.high, body->box.low));
    double square = 0.0;
    for (int32_t i = 0; i < body->surface.node_count; i++) {
        const ShvVec3 arm = shv_sub(shv_surface_position(&body->surface, i), body->centre);
        square = fmax(square, shv_dot(arm, arm));
    }
    body->radius = sqrt(square);
}

static ShvVec3 put(const ShvObstacle *obstacle, ShvVec3 local)
{
    return shv_add(obstacle->position, shv_rotate(obstacle->orientation, local));
}

static ShvVec3 corner_of_box(const ShvObstacle *obstacle, int k)
{
    const ShvVec3 half = obstacle->half;
    return shv_vec3(k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z);
}

void shv_start_obstacle(ShvStartObstacle *place, const ShvObstacle *obstacle)
{
    const ShvVec3 x = obstacle->position, r = shv_vec3(obstacle->radius, obstacle->radius, obstacle->radius);
    *place = (ShvStartObstacle){.obstacle = obstacle, .box = shv_box_empty()};
    switch (obstacle->shape) {
    case SHV_OBSTACLE_PLANE:
        place->box = (ShvBox){shv_box_empty().high, shv_box_empty().low};
        break;
    case SHV_OBSTACLE_SPHERE:
        place->box = (ShvBox){shv_sub(x, r), shv_add(x, r)};
        break;
    case SHV_OBSTACLE_BOX:
        for (int k = 0; k < 8; k++) shv_box_add(&place->box, put(obstacle, corner_of_box(obstacle, k)));
        break;
    case SHV_OBSTACLE_MESH:
        for (int32_t i = 0; i < obstacle->surface.node_count; i++)
            shv_box_add(&place->box, put(obstacle, shv_surface_position(&obstacle->surface, i)));
        break;
    }
}

/* ---- bounds: about a point at depth δ there is a ball of radius δ inside ---- */

static double bound_of_boxes(const ShvBox *a, const ShvBox *b)
{
    const double x = fmin(a->high.x, b->high.x) - fmax(a->low.x, b->low.x);
    const double y = fmin(a->high.y, b->high.y) - fmax(a->low.y, b->low.y);
    const double z = fmin(a->high.z, b->high.z) - fmax(a->low.z, b->low.z);
    return fmin(fmin(x, y), z);
}

double shv_bound_of_objects(const ShvStartBody *first, const ShvStartBody *second)
{
    const double of_spheres = first->radius + second->radius - shv_norm(shv_sub(first->centre, second->centre));
    return fmin(of_spheres, bound_of_boxes(&first->box, &second->box));
}

double shv_bound_of_obstacle(const ShvStartBody *body, const ShvStartObstacle *place)
{
    const ShvObstacle *obstacle = place->obstacle;
    const double distance = obstacle->shape == SHV_OBSTACLE_PLANE
                                ? shv_dot(obstacle->normal, body->centre) - obstacle->offset
                                : shv_norm(shv_sub(body->centre, obstacle->position)) - obstacle->bounding_radius;
    return fmin(body->radius - distance, bound_of_boxes(&body->box, &place->box));
}

/* ---- depths ---- */

/* What points are tried in, and with which sign the normal where they are nearest to leave is the first body's way. */
typedef struct Inside {
    const void *what;
    ShvTreePoint (*closest)(const void *what, ShvVec3 point);
    bool (*sweep)(const void *what, ShvVec3 from, ShvVec3 to, double *fraction);
    double sign;
} Inside;

/* Triangles to try: those of a surface, where it is put. */
typedef struct Skin {
    const ShvSurface *surface;
    ShvVec3 position;
    ShvQuat orientation;
} Skin;

static ShvTreePoint closest_on_body(const void *what, ShvVec3 point)
{
    const ShvStartBody *body = what;
    if (!shv_box_holds(&body->box, point)) return (ShvTreePoint){.gap = HUGE_VAL};
    return shv_bounding_tree_closest(body->tree, point, 0.0);
}

static bool sweep_body(const void *what, ShvVec3 from, ShvVec3 to, double *fraction)
{
    const ShvStartBody *body = what;
    ShvVec3 normal;
    return shv_bounding_tree_sweep(body->tree, from, to, fraction, &normal);
}

static ShvTreePoint closest_on_obstacle(const void *what, ShvVec3 point)
{
    const ShvSurfacePoint nearest = shv_obstacle_closest(what, point, 0.0);
    return (ShvTreePoint){.gap = nearest.gap, .point = nearest.point, .normal = nearest.normal};
}

static bool sweep_obstacle(const void *what, ShvVec3 from, ShvVec3 to, double *fraction)
{
    ShvCrossing crossing;
    if (!shv_obstacle_sweep(what, from, to, &crossing)) return false;
    *fraction = crossing.fraction;
    return true;
}

static void deepen(ShvDepth *deepest, double depth, ShvVec3 point, ShvVec3 direction)
{
    if (depth > deepest->depth) *deepest = (ShvDepth){depth, point, direction};
}

static void try_point(const Inside *inside, ShvVec3 point, ShvDepth *deepest)
{
    const ShvTreePoint nearest = inside->closest(inside->what, point);
    deepen(deepest, -nearest.gap, point, shv_scale(nearest.normal, inside->sign));
}

static void try_edge(const Inside *inside, ShvVec3 from, ShvVec3 to, ShvDepth *deepest)
{
    double in, out;
    if (!inside->sweep(inside->what, from, to, &in) || !inside->sweep(inside->what, to, from, &out)) return;
    const double middle = 0.5 * (in + 1.0 - out);
    if (in < 1.0 - out) try_point(inside, shv_madd(from, middle, shv_sub(to, from)), deepest);
}

/* Every edge is that of two triangles: it is tried where its corners rise. */
static void try_triangle(const Inside *inside, const int32_t nodes[3], const ShvVec3 corners[3], ShvDepth *deepest)
{
    ShvVec3 sum = {0.0, 0.0, 0.0};
    for (int k = 0; k < 3; k++) {
        const int next = (k + 1) % 3;
        try_point(inside, corners[k], deepest);
        if (nodes[k] < nodes[next]) try_edge(inside, corners[k], corners[next], deepest);
        sum = shv_add(sum, corners[k]);
    }
    try_point(inside, shv_scale(sum, 1.0 / 3.0), deepest);
}

static void try_skin(const Inside *inside, const ShvBox *near, const Skin *skin, ShvDepth *deepest)
{
    for (int32_t i = 0; i < skin->surface->triangle_count; i++) {
        const int32_t *nodes = skin->surface->triangles + 3 * (int64_t)i;
        ShvBox box = shv_box_empty();
        ShvVec3 corners[3];
        for (int k = 0; k < 3; k++) {
            const ShvVec3 local = shv_surface_position(skin->surface, nodes[k]);
            corners[k] = shv_add(skin->position, shv_rotate(skin->orientation, local));
            shv_box_add(&box, corners[k]);
        }
        if (shv_box_meets(&box, near)) try_triangle(inside, nodes, corners, deepest);
    }
}

/* Bodies whose surfaces lie in one another have no corner and no edge inside: their tets have. */
static void try_tets(const Inside *inside, const ShvBox *near, const ShvStartBody *body, ShvVec3 shift,
                     ShvDepth *deepest)
{
    const ShvMesh *mesh = &body->model->mesh;
    for (int32_t e = body->object->element_begin; e < body->object->element_end; e++) {
        ShvVec3 sum = {0.0, 0.0, 0.0};
        for (int k = 0; k < 4; k++) sum = shv_add(sum, shv_mesh_position(mesh, mesh->elements[4 * (int64_t)e + k]));
        const ShvVec3 centroid = shv_madd(shift, 0.25, sum);
        if (shv_box_holds(near, centroid)) try_point(inside, centroid, deepest);
    }
}

static int32_t tets_of(const ShvStartBody *body)
{
    return body->object->element_end - body->object->element_begin;
}

static ShvBox moved(ShvBox box, ShvVec3 by)
{
    return (ShvBox){shv_add(box.low, by), shv_add(box.high, by)};
}

/* Trees stay where they are: what is tried in the first body is moved the other way. */
ShvDepth shv_depth_of_objects(const ShvStartBody *first, const ShvStartBody *second, ShvVec3 shift, double allowance)
{
    const Inside in_first = {first, closest_on_body, sweep_body, -1.0};
    const Inside in_second = {second, closest_on_body, sweep_body, 1.0};
    const ShvVec3 back = shv_scale(shift, -1.0);
    const Skin skin = {&first->surface, shift, shv_quat_identity()};
    const Skin other = {&second->surface, back, shv_quat_identity()};
    ShvDepth deepest = {.depth = 0.0};
    try_skin(&in_second, &second->box, &skin, &deepest);
    try_skin(&in_first, &first->box, &other, &deepest);
    if (deepest.depth > allowance) return deepest;
    if (tets_of(first) < tets_of(second))
        try_tets(&in_second, &second->box, first, shift, &deepest);
    else
        try_tets(&in_first, &first->box, second, back, &deepest);
    return deepest;
}

/* All of a body is above its lowest node. */
static ShvDepth depth_in_plane(const ShvStartBody *body, const ShvObstacle *plane, ShvVec3 shift)
{
    ShvDepth deepest = {.depth = 0.0, .direction = plane->normal};
    for (int32_t i = 0; i < body->surface.node_count; i++) {
        const ShvVec3 x = shv_add(shv_surface_position(&body->surface, i), shift);
        const double depth = plane->offset - shv_dot(plane->normal, x);
        if (!(depth > deepest.depth)) continue;
        deepest.depth = depth;
        deepest.point = x;
    }
    return deepest;
}

/* The far side of a sphere is deeper than its centre by the radius. */
static void try_sphere(const ShvStartBody *body, ShvVec3 centre, double radius, ShvDepth *deepest)
{
    const ShvTreePoint nearest = shv_bounding_tree_closest(body->tree, centre, radius);
    deepen(deepest, radius - nearest.gap, nearest.gap < 0.0 ? centre : nearest.point, shv_scale(nearest.normal, -1.0));
}

static void try_box(const Inside *inside, const ShvBox *near, const ShvObstacle *obstacle, ShvVec3 back,
                    ShvDepth *deepest)
{
    static int32_t triangles[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                    2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    double corners[24];
    for (int k = 0; k < 8; k++) shv_store3(corners + 3 * k, corner_of_box(obstacle, k));
    const ShvSurface surface = {.node_count = 8, .triangle_count = 12, .positions = corners, .triangles = triangles};
    try_skin(inside, near, &(Skin){&surface, shv_add(obstacle->position, back), obstacle->orientation}, deepest);
}

ShvDepth shv_depth_in_obstacle(const ShvStartBody *body, const ShvStartObstacle *place, ShvVec3 shift, double allowance)
{
    const ShvObstacle *obstacle = place->obstacle;
    const Inside in_obstacle = {obstacle, closest_on_obstacle, sweep_obstacle, 1.0};
    const Inside in_body = {body, closest_on_body, sweep_body, -1.0};
    const ShvVec3 back = shv_scale(shift, -1.0), position = shv_add(obstacle->position, back);
    const ShvBox near = moved(place->box, back);
    ShvDepth deepest = {.depth = 0.0};
    if (obstacle->shape == SHV_OBSTACLE_PLANE) return depth_in_plane(body, obstacle, shift);
    try_skin(&in_obstacle, &place->box, &(Skin){&body->surface, shift, shv_quat_identity()}, &deepest);
    if (shv_box_meets(&near, &body->box)) {
        if (obstacle->shape == SHV_OBSTACLE_SPHERE) try_sphere(body, position, obstacle->radius, &deepest);
        if (obstacle->shape == SHV_OBSTACLE_BOX) try_box(&in_body, &body->box, obstacle, back, &deepest);
        if (obstacle->shape == SHV_OBSTACLE_MESH)
            try_skin(&in_body, &body->box, &(Skin){&obstacle->surface, position, obstacle->orientation}, &deepest);
    }
    if (!(deepest.depth > allowance)) try_tets(&in_obstacle, &place->box, body, shift, &deepest);
    return deepest;
}

/* ---- ways out ---- */

static double least_along(const ShvStartBody *body, ShvVec3 direction)
{
    double least = HUGE_VAL;
    for (int32_t i = 0; i < body->surface.node_count; i++)
        least = fmin(least, shv_dot(direction, shv_surface_position(&body->surface, i)));
    return least;
}

double shv_depth_along_object(const ShvStartBody *first, const ShvStartBody *second, ShvVec3 direction)
{
    return -least_along(second, shv_scale(direction, -1.0)) - least_along(first, direction);
}

double shv_depth_along_obstacle(const ShvStartBody *body, const ShvStartObstacle *place, ShvVec3 direction,
                                double depth)
{
    const ShvObstacle *obstacle = place->obstacle;
    if (obstacle->shape == SHV_OBSTACLE_PLANE) return depth;
    double most = -HUGE_VAL;
    if (obstacle->shape == SHV_OBSTACLE_SPHERE) most = shv_dot(direction, obstacle->position) + obstacle->radius;
    for (int k = 0; k < 8 && obstacle->shape == SHV_OBSTACLE_BOX; k++)
        most = fmax(most, shv_dot(direction, put(obstacle, corner_of_box(obstacle, k))));
    for (int32_t i = 0; i < obstacle->surface.node_count && obstacle->shape == SHV_OBSTACLE_MESH; i++)
        most = fmax(most, shv_dot(direction, put(obstacle, shv_surface_position(&obstacle->surface, i))));
    return most - least_along(body, direction);
}
