#include "pbd/response.h"

#include "rigid/time_of_impact.h"

/* ---- touches ---- */

static int32_t find_touch(const ShvRelax *relax, int32_t node, int32_t obstacle)
{
    int32_t t = relax->first_touch[node];
    while (t >= 0 && relax->touches[t].obstacle != obstacle) t = relax->touches[t].next;
    return t;
}

/* Velocity by which the prediction moved a node, against the obstacle's material at a point. */
static ShvVec3 approach(const ShvRelax *relax, const ShvState *state, int32_t node, int32_t obstacle, ShvVec3 point,
                        double step)
{
    const int64_t k = 3 * (int64_t)node;
    const ShvVec3 displacement = shv_sub(shv_load3(relax->predicted + k), shv_load3(state->displacement + k));
    return shv_sub(shv_scale(displacement, 1.0 / step), shv_obstacle_velocity(&relax->later[obstacle], point));
}

static ShvStatus add_touch(ShvRelax *relax, const ShvState *state, int32_t node, int32_t obstacle, ShvVec3 point,
                           ShvVec3 normal, double step, ShvError *error)
{
    if (relax->touch_count == relax->touch_room) {
        const int32_t room = relax->touch_room < 64 ? 128 : 2 * relax->touch_room;
        ShvRelaxTouch *touches =
            shv_reallocate(relax->memory, SHV_PART_BARS, relax->touches, (size_t)room, sizeof *touches);
        if (!touches) return shv_fail_memory(error, "touches of nodes", (size_t)room * sizeof *touches);
        relax->touches = touches;
        relax->touch_room = room;
    }
    relax->touches[relax->touch_count] =
        (ShvRelaxTouch){.node = node,
                        .obstacle = obstacle,
                        .next = relax->first_touch[node],
                        .fresh = !relax->touched[node],
                        .closing_speed = -shv_dot(approach(relax, state, node, obstacle, point, step), normal),
                        .point = point,
                        .normal = normal};
    relax->first_touch[node] = relax->touch_count++;
    return SHV_OK;
}

/* ---- detection ---- */

static void place_obstacles(ShvRelax *relax, const ShvObstacles *obstacles, const ShvRelaxStep *step)
{
    for (int32_t o = 0; o < obstacles->count; o++) {
        ShvObstacle start = obstacles->items[o];
        if (start.motion == SHV_OBSTACLE_FREE)
            start.velocity = shv_madd(start.velocity, 0.5 * step->step, shv_load3(step->gravity));
        relax->later[o] = shv_obstacle_later(&start, step->step);
        relax->unmoved[2 * o] = start.velocity;
        relax->unmoved[2 * o + 1] = start.angular_velocity;
        relax->yielded[o] = 0.0;
    }
}

/* Bound of the way of an obstacle's surface in the step. */
static double obstacle_displacement(const ShvRelax *relax, int32_t obstacle, double step)
{
    const ShvObstacle *later = &relax->later[obstacle];
    if (later->motion == SHV_OBSTACLE_FIXED) return 0.0;
    return step * (shv_norm(later->velocity) + shv_norm(later->angular_velocity) * later->bounding_radius);
}

static double node_displacement(const ShvRelax *relax, const ShvState *state, int64_t node)
{
    return shv_norm(shv_sub(shv_load3(relax->predicted + 3 * node), shv_load3(state->displacement + 3 * node)));
}

static ShvVec3 predicted_position(const ShvRelax *relax, const ShvState *state, int64_t node)
{
    return shv_add(shv_load3(state->reference + 3 * node), shv_load3(relax->predicted + 3 * node));
}

/* Gaps beyond a few ways are not worth their exact value. */
static void find_clearances(ShvRelax *relax, const ShvState *state, const int32_t *nodes, int32_t count, double step)
{
    double displacement = 0.0;
    for (int32_t o = 0; o < relax->obstacle_count; o++)
        displacement = fmax(displacement, obstacle_displacement(relax, o, step));
#pragma omp parallel for num_threads(relax->threads) if (relax->threads > 1)
    for (int32_t i = 0; i < count; i++) {
        const double limit = 8.0 * (node_displacement(relax, state, nodes[i]) + displacement);
        const ShvVec3 position = predicted_position(relax, state, nodes[i]);
        double clear = (double)INFINITY;
        for (int32_t o = 0; o < relax->obstacle_count; o++)
            clear = fmin(clear, shv_obstacle_closest(&relax->later[o], position, limit).gap);
        relax->clear[nodes[i]] = clear;
    }
}

/* Where a node that stood still on the obstacle's material at the start of the step would be at its end. */
static ShvVec3 carried_along(const ShvObstacle *now, const ShvObstacle *later, ShvVec3 point)
{
    const ShvVec3 local = shv_rotate(shv_quat_conjugate(now->orientation), shv_sub(point, now->position));
    return shv_add(later->position, shv_rotate(later->orientation, local));
}

/* What lies farther outside than it has come cannot have crossed the surface. */
static ShvStatus meet(ShvRelax *relax, const ShvState *state, const ShvObstacles *obstacles, int32_t node, int32_t o,
                      const ShvRelaxStep *step, ShvError *error)
{
    const ShvObstacle *later = &relax->later[o];
    const ShvVec3 position = predicted_position(relax, state, node);
    const double displacement = node_displacement(relax, state, node) + obstacle_displacement(relax, o, step->step);
    const ShvSurfacePoint surface = shv_obstacle_closest(later, position, displacement);
    if (surface.gap >= displacement && surface.gap >= 0.0) return SHV_OK;
    ShvCrossing crossing;
    const bool crossed =
        later->shape != SHV_OBSTACLE_PLANE &&
        shv_obstacle_sweep(later, carried_along(&obstacles->items[o], later, shv_state_position(state, node)), position,
                           &crossing);
    const bool inside = surface.gap < 0.0;
    if (crossed && !(inside && shv_dot(surface.normal, crossing.normal) > 0.0)) {
        SHV_TRY(add_touch(relax, state, node, o, crossing.point, crossing.normal, step->step, error));
        relax->touches[relax->touch_count - 1].held = true;
        relax->clear[node] = fmin(relax->clear[node], 0.0);
        return SHV_OK;
    }
    return inside ? add_touch(relax, state, node, o, surface.point, surface.normal, step->step, error) : SHV_OK;
}

ShvStatus shv_relax_detect(ShvRelax *relax, const ShvState *state, const ShvObstacles *obstacles, const int32_t *nodes,
                           int32_t count, const ShvRelaxStep *step, ShvError *error)
{
    for (int32_t t = 0; t < relax->touch_count; t++) relax->first_touch[relax->touches[t].node] = -1;
    relax->touch_count = 0;
    place_obstacles(relax, obstacles, step);
    find_clearances(relax, state, nodes, count, step->step);
    double displacement = 0.0;
    for (int32_t o = 0; o < relax->obstacle_count; o++)
        displacement = fmax(displacement, obstacle_displacement(relax, o, step->step));
    for (int32_t i = 0; i < count; i++) {
        if (relax->clear[nodes[i]] >= 0.0 &&
            relax->clear[nodes[i]] >= displacement + node_displacement(relax, state, nodes[i]))
            continue;
        for (int32_t o = 0; o < relax->obstacle_count; o++)
            SHV_TRY(meet(relax, state, obstacles, nodes[i], o, step, error));
    }
    return SHV_OK;
}

/* ---- projection ---- */

/* A free obstacle takes an impulse at a point of its pose at the end of the step, and has had it since the start. */
static void give_way(ShvRelax *relax, int32_t index, ShvVec3 point, ShvVec3 impulse, double step)
{
    ShvObstacle *later = &relax->later[index];
    if (later->motion != SHV_OBSTACLE_FREE) return;
    ShvObstacle start = shv_obstacle_later(later, -step);
    const ShvVec3 velocity = later->velocity, spin = later->angular_velocity;
    shv_obstacle_impulse(later, point, impulse);
    start.velocity = later->velocity;
    start.angular_velocity = later->angular_velocity;
    *later = shv_obstacle_later(&start, step);
    relax->yielded[index] += step * (shv_norm(shv_sub(later->velocity, velocity)) +
                                     shv_norm(shv_sub(later->angular_velocity, spin)) * later->bounding_radius);
}

/* Coulomb friction against the way along the obstacle's material since the start of the step. */
static void drag_back(ShvRelax *relax, const ShvState *state, ShvRelaxTouch *touch, const ShvRelaxStep *step)
{
    const ShvObstacle *later = &relax->later[touch->obstacle];
    const double most = later->friction * touch->push;
    if (!(most > 0.0)) return;
    double *shift = relax->shifts + 4 * (int64_t)touch->node;
    const double w = relax->anchors[4 * (int64_t)touch->node + 3];
    const ShvVec3 displacement = shv_sub(shv_load3(shift), shv_load3(state->displacement + 3 * (int64_t)touch->node));
    const ShvVec3 relative = shv_madd(displacement, -step->step, shv_obstacle_velocity(later, touch->point));
    const ShvVec3 slip = shv_madd(relative, -shv_dot(relative, touch->normal), touch->normal);
    const double mobility = w + shv_obstacle_inverse_mass(later, touch->point, shv_unit(slip));
    ShvVec3 drag = shv_madd(touch->drag, -1.0 / mobility, slip);
    const double size = shv_norm(drag);
    if (size > most) drag = shv_scale(drag, most / size);
    const ShvVec3 change = shv_sub(drag, touch->drag);
    shv_add_to3(shift, shv_scale(change, w));
    touch->drag = drag;
    give_way(relax, touch->obstacle, touch->point, shv_scale(change, -1.0 / step->step), step->step);
}

static void push_out(ShvRelax *relax, const ShvState *state, ShvRelaxTouch *touch, double gap, const ShvRelaxStep *step)
{
    const double w = relax->anchors[4 * (int64_t)touch->node + 3];
    const double other = shv_obstacle_inverse_mass(&relax->later[touch->obstacle], touch->point, touch->normal);
    const double push = -gap / (w + other);
    shv_add_to3(relax->shifts + 4 * (int64_t)touch->node, shv_scale(touch->normal, w * push));
    touch->push += push;
    touch->pushed = shv_madd(touch->pushed, push, touch->normal);
    give_way(relax, touch->obstacle, touch->point, shv_scale(touch->normal, -push / step->step), step->step);
    drag_back(relax, state, touch, step);
}

static ShvStatus project(ShvRelax *relax, const ShvState *state, int32_t node, int32_t o, const ShvRelaxStep *step,
                         ShvError *error)
{
    const ShvVec3 position =
        shv_add(shv_load3(state->reference + 3 * (int64_t)node), shv_load3(relax->shifts + 4 * (int64_t)node));
    int32_t t = find_touch(relax, node, o);
    if (t >= 0 && relax->touches[t].held) {
        const ShvRelaxTouch *held = &relax->touches[t];
        const double gap = shv_dot(shv_sub(position, held->point), held->normal);
        if (gap < 0.0) push_out(relax, state, &relax->touches[t], gap, step);
        return SHV_OK;
    }
    const ShvSurfacePoint surface = shv_obstacle_closest(&relax->later[o], position, 0.0);
    if (!(surface.gap < 0.0)) return SHV_OK;
    if (t < 0) {
        SHV_TRY(add_touch(relax, state, node, o, surface.point, surface.normal, step->step, error));
        t = relax->touch_count - 1;
    }
    relax->touches[t].point = surface.point;
    relax->touches[t].normal = surface.normal;
    push_out(relax, state, &relax->touches[t], surface.gap, step);
    return SHV_OK;
}

/* Gaps change no faster than their points move: a node that has not moved by its clearance is still outside. */
ShvStatus shv_response_project(ShvRelax *relax, const ShvState *state, const int32_t *nodes, int32_t count,
                               const ShvRelaxStep *step, ShvError *error)
{
    for (int32_t i = 0; i < count; i++) {
        const int64_t node = nodes[i];
        double clear = relax->clear[node];
        for (int32_t o = 0; o < relax->obstacle_count; o++) clear -= relax->yielded[o];
        const ShvVec3 moved = shv_sub(shv_load3(relax->shifts + 4 * node), shv_load3(relax->predicted + 3 * node));
        if (clear > 0.0 && shv_dot(moved, moved) < clear * clear) continue;
        if (!(relax->anchors[4 * node + 3] > 0.0) || (step->fixed && step->fixed[node])) continue;
        for (int32_t o = 0; o < relax->obstacle_count; o++) SHV_TRY(project(relax, state, nodes[i], o, step, error));
    }
    return SHV_OK;
}

/* ---- response ---- */

/* What gravity still gives a free obstacle until the end of the step, beyond its mean velocity. */
static ShvVec3 rest_of_gravity(const ShvRelax *relax, int32_t obstacle, const ShvRelaxStep *step)
{
    const bool falls = step->synchronous && relax->later[obstacle].motion == SHV_OBSTACLE_FREE;
    return shv_scale(shv_load3(step->gravity), falls ? 0.5 * step->step : 0.0);
}

static ShvVec3 obstacle_velocity(const ShvRelax *relax, int32_t obstacle, ShvVec3 point, const ShvRelaxStep *step)
{
    return shv_add(shv_obstacle_velocity(&relax->later[obstacle], point), rest_of_gravity(relax, obstacle, step));
}

/* Relative normal velocity that nothing but forces and gravity would have led to. */
static double undisturbed_speed(const ShvRelax *relax, const ShvState *state, const ShvRelaxTouch *touch,
                                const ShvRelaxStep *step)
{
    const int64_t node = touch->node;
    const ShvVec3 change = shv_sub(shv_load3(relax->shifts + 4 * node), shv_load3(relax->predicted + 3 * node));
    const ShvVec3 own = shv_madd(shv_load3(state->velocity + 3 * node), -1.0 / step->step, change);
    ShvObstacle other = relax->later[touch->obstacle];
    other.velocity = shv_add(relax->unmoved[2 * touch->obstacle], rest_of_gravity(relax, touch->obstacle, step));
    other.angular_velocity = relax->unmoved[2 * touch->obstacle + 1];
    return shv_dot(shv_sub(own, shv_obstacle_velocity(&other, touch->point)), touch->normal);
}

static void exchange(ShvRelax *relax, ShvState *state, const ShvRelaxTouch *touch, ShvVec3 impulse)
{
    const double w = relax->anchors[4 * (int64_t)touch->node + 3];
    shv_add_to3(state->velocity + 3 * (int64_t)touch->node, shv_scale(impulse, w));
    shv_obstacle_impulse(&relax->later[touch->obstacle], touch->point, shv_scale(impulse, -1.0));
}

static ShvVec3 relative_velocity(const ShvRelax *relax, const ShvState *state, const ShvRelaxTouch *touch,
                                 const ShvRelaxStep *step)
{
    return shv_sub(shv_load3(state->velocity + 3 * (int64_t)touch->node),
                   obstacle_velocity(relax, touch->obstacle, touch->point, step));
}

static void restore(ShvRelax *relax, ShvState *state, ShvRelaxTouch *touch, double undisturbed,
                    const ShvRelaxStep *step)
{
    const ShvObstacle *later = &relax->later[touch->obstacle];
    const double now = shv_dot(relative_velocity(relax, state, touch, step), touch->normal);
    double wanted = fmin(fmax(now, 0.0), undisturbed);
    /* A node bounces when it arrives. One that is held there, and that its body presses on at each step, would be thrown back at
       each step and drive the body. */
    const bool bounces = touch->fresh && -undisturbed > step->rest_speed;
    if (undisturbed < 0.0) wanted = bounces ? -later->restitution * undisturbed : 0.0;
    const double mobility =
        relax->anchors[4 * (int64_t)touch->node + 3] + shv_obstacle_inverse_mass(later, touch->point, touch->normal);
    const double given = touch->push / step->step, impulse = fmax((wanted - now) / mobility, -given);
    exchange(relax, state, touch, shv_scale(touch->normal, impulse));
    touch->normal_impulse = given + impulse;
    touch->impulse = shv_madd(shv_scale(touch->pushed, 1.0 / step->step), impulse, touch->normal);
}

static void apply_friction(ShvRelax *relax, ShvState *state, ShvRelaxTouch *touch, const ShvRelaxStep *step)
{
    const ShvObstacle *later = &relax->later[touch->obstacle];
    const ShvVec3 given = shv_scale(touch->drag, 1.0 / step->step);
    const ShvVec3 relative = relative_velocity(relax, state, touch, step);
    const ShvVec3 slip = shv_madd(relative, -shv_dot(relative, touch->normal), touch->normal);
    const double mobility =
        relax->anchors[4 * (int64_t)touch->node + 3] + shv_obstacle_inverse_mass(later, touch->point, shv_unit(slip));
    const double most = later->friction * touch->normal_impulse;
    ShvVec3 friction = shv_madd(given, -1.0 / mobility, slip);
    const double size = shv_norm(friction);
    if (size > most) friction = shv_scale(friction, most / size);
    exchange(relax, state, touch, shv_sub(friction, given));
    touch->friction = friction;
}

static void release_obstacles(ShvRelax *relax, ShvObstacles *obstacles)
{
    relax->obstacle_work = 0.0;
    for (int32_t o = 0; o < relax->obstacle_count; o++) {
        ShvObstacle *obstacle = &obstacles->items[o];
        if (obstacle->motion != SHV_OBSTACLE_FREE) continue;
        const double before = shv_obstacle_kinetic(obstacle);
        const ShvObstacle *later = &relax->later[o];
        obstacle->velocity = shv_add(obstacle->velocity, shv_sub(later->velocity, relax->unmoved[2 * o]));
        obstacle->angular_velocity =
            shv_add(obstacle->angular_velocity, shv_sub(later->angular_velocity, relax->unmoved[2 * o + 1]));
        relax->obstacle_work += shv_obstacle_kinetic(obstacle) - before;
    }
}

void shv_response_apply(ShvRelax *relax, ShvState *state, ShvObstacles *obstacles, const ShvRelaxStep *step)
{
    for (int32_t t = 0; t < relax->touch_count; t++) {
        ShvRelaxTouch *touch = &relax->touches[t];
        if (!(touch->push > 0.0)) continue;
        restore(relax, state, touch, undisturbed_speed(relax, state, touch, step), step);
        apply_friction(relax, state, touch, step);
    }
    release_obstacles(relax, obstacles);
}

void shv_response_finish(ShvRelax *relax, const int32_t *nodes, int32_t count)
{
    for (int32_t i = 0; i < count; i++) relax->touched[nodes[i]] = 0;
    relax->touching = 0;
    for (int32_t t = 0; t < relax->touch_count; t++) {
        const ShvRelaxTouch *touch = &relax->touches[t];
        if (!(touch->push > 0.0)) continue;
        relax->touching += !relax->touched[touch->node];
        relax->touched[touch->node] = 1;
    }
}
