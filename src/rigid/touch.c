#include "rigid/touch.h"

enum { MOST_SWEEPS = 400 };

static ShvVec3 point_velocity(const ShvRigidMotion *motion, const ShvTouch *touch)
{
    return shv_velocity_at(motion->velocity, motion->angular_velocity, touch->arm);
}

ShvVec3 shv_touch_velocity(const ShvRigidMotion *motion, const ShvTouch *touch)
{
    return shv_sub(point_velocity(motion, touch), shv_obstacle_velocity(touch->other, touch->point));
}

double shv_touch_normal_speed(const ShvRigidMotion *motion, const ShvTouch *touch)
{
    return shv_dot(touch->normal, shv_touch_velocity(motion, touch));
}

/* ---- choice of points ---- */

static void swap(ShvTouch *a, ShvTouch *b)
{
    const ShvTouch kept = *a;
    *a = *b;
    *b = kept;
}

static double distance_to_chosen(const ShvTouch *touches, int32_t chosen, ShvVec3 point)
{
    double nearest = (double)INFINITY;
    for (int32_t i = 0; i < chosen; i++) {
        const ShvVec3 between = shv_sub(point, touches[i].point);
        nearest = fmin(nearest, shv_dot(between, between));
    }
    return nearest;
}

int32_t shv_touches_reduce(ShvTouch *touches, int32_t count, const ShvRigidMotion *motion)
{
    if (count <= SHV_TOUCHES_AN_OBSTACLE) return count;
    int32_t fastest = 0;
    for (int32_t i = 1; i < count; i++)
        if (shv_touch_normal_speed(motion, &touches[i]) < shv_touch_normal_speed(motion, &touches[fastest]))
            fastest = i;
    swap(&touches[0], &touches[fastest]);
    for (int32_t chosen = 1; chosen < SHV_TOUCHES_AN_OBSTACLE; chosen++) {
        int32_t farthest = chosen;
        double largest = -1.0;
        for (int32_t i = chosen; i < count; i++) {
            const double distance = distance_to_chosen(touches, chosen, touches[i].point);
            if (distance > largest) {
                largest = distance;
                farthest = i;
            }
        }
        swap(&touches[chosen], &touches[farthest]);
    }
    return SHV_TOUCHES_AN_OBSTACLE;
}

/* ---- impulses ---- */

static void push(const ShvTouch *touch, ShvRigidMotion *motion, ShvVec3 impulse)
{
    motion->velocity = shv_madd(motion->velocity, motion->inverse_mass, impulse);
    motion->angular_velocity =
        shv_add(motion->angular_velocity, shv_apply(&motion->inverse_inertia, shv_cross(touch->arm, impulse)));
    shv_obstacle_impulse(touch->other, touch->point, shv_scale(impulse, -1.0));
}

/* Change of the relative velocity along `direction` per unit impulse along it, 1/kg. */
static double mobility(const ShvTouch *touch, const ShvRigidMotion *motion, ShvVec3 direction)
{
    const ShvVec3 lever = shv_cross(touch->arm, direction);
    return motion->inverse_mass + shv_dot(lever, shv_apply(&motion->inverse_inertia, lever)) +
           shv_obstacle_inverse_mass(touch->other, touch->point, direction);
}

/* Largest mobility in the tangent plane: one number for both directions, so that friction comes out exactly opposite to
   the sliding, and large enough for the sweeps to converge. */
static double tangent_mobility(const ShvTouch *touch, const ShvRigidMotion *motion)
{
    const ShvVec3 n = touch->normal;
    const ShvVec3 axis = fabs(n.x) < 0.6 ? shv_vec3(1.0, 0.0, 0.0) : shv_vec3(0.0, 1.0, 0.0);
    const ShvVec3 a = shv_unit(shv_cross(n, axis)), b = shv_cross(n, a);
    const double aa = mobility(touch, motion, a), bb = mobility(touch, motion, b);
    const double diagonal = mobility(touch, motion, shv_scale(shv_add(a, b), sqrt(0.5)));
    const double half = 0.5 * (aa - bb), ab = diagonal - 0.5 * (aa + bb);
    return 0.5 * (aa + bb) + sqrt(half * half + ab * ab);
}

/* One touch: normal impulse, then friction within its cone. Returns the change of velocity it made. */
static double answer(ShvTouch *touch, ShvRigidMotion *motion)
{
    const double missing = touch->wanted - shv_touch_normal_speed(motion, touch);
    const double normal = fmax(0.0, touch->normal_impulse + missing / touch->mobility);
    double change = fabs(normal - touch->normal_impulse) * touch->mobility;
    push(touch, motion, shv_scale(touch->normal, normal - touch->normal_impulse));
    touch->normal_impulse = normal;
    if (touch->other->friction <= 0.0) return change;
    const ShvVec3 velocity = shv_touch_velocity(motion, touch);
    const ShvVec3 sliding = shv_madd(velocity, -shv_dot(velocity, touch->normal), touch->normal);
    ShvVec3 friction = shv_madd(touch->friction_impulse, -1.0 / touch->tangent_mobility, sliding);
    const double size = shv_norm(friction), most = touch->other->friction * normal;
    if (size > most) friction = shv_scale(friction, most / size);
    const ShvVec3 more = shv_sub(friction, touch->friction_impulse);
    change = fmax(change, shv_norm(more) * touch->tangent_mobility);
    push(touch, motion, more);
    touch->friction_impulse = friction;
    return change;
}

/* Of the speeds at hand: a change of velocity that is round-off ends the sweeps. */
static const double settled_of_speed = 1e-14;

void shv_touches_solve(ShvTouch *touches, int32_t count, ShvRigidMotion *motion)
{
    double scale = 0.0;
    for (int32_t i = 0; i < count; i++) {
        touches[i].normal_impulse = 0.0;
        touches[i].friction_impulse = shv_vec3(0.0, 0.0, 0.0);
        touches[i].mobility = mobility(&touches[i], motion, touches[i].normal);
        touches[i].tangent_mobility = tangent_mobility(&touches[i], motion);
        touches[i].other_velocity = shv_obstacle_velocity(touches[i].other, touches[i].point);
        scale = fmax(scale, shv_norm(shv_touch_velocity(motion, &touches[i])) + fabs(touches[i].wanted));
    }
    for (int sweep = 0; sweep < MOST_SWEEPS; sweep++) {
        double change = 0.0;
        for (int32_t i = 0; i < count; i++) change = fmax(change, answer(&touches[i], motion));
        if (!(change > settled_of_speed * scale)) break;
    }
}

/* ---- work ---- */

static ShvVec3 interpolate(ShvVec3 before, ShvVec3 after, double share)
{
    return shv_madd(before, 0.5 * share, shv_sub(after, before));
}

ShvTouchWork shv_touches_work(const ShvTouch *touches, int32_t count, const ShvRigidMotion *before,
                              const ShvRigidMotion *after, double share)
{
    ShvTouchWork work = {0.0, 0.0};
    for (int32_t i = 0; i < count; i++) {
        const ShvTouch *touch = &touches[i];
        ShvVec3 mean = interpolate(point_velocity(before, touch), point_velocity(after, touch), share);
        if (touch->other->motion == SHV_OBSTACLE_FREE)
            mean = shv_sub(
                mean, interpolate(touch->other_velocity, shv_obstacle_velocity(touch->other, touch->point), share));
        work.normal += share * touch->normal_impulse * shv_dot(touch->normal, mean);
        work.friction += share * shv_dot(touch->friction_impulse, mean);
    }
    return work;
}
