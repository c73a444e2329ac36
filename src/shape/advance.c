#include "shape/collide.h"
#include "shape/obstacle.h"
#include "shape/rotation.h"

enum { MOST_EVENTS = 256 };
/* Share of the smaller bounding radius within which surfaces touch: rounding of an impact's time leaves less. */
static const double TOUCHING = 1e-9;

typedef struct Flight {
    ShvObstacles *obstacles;
    ShvVec3 gravity;
    double threshold; /* m/s: contacts that close slower are held, faster ones rebound */
    double work;
} Flight;

static bool any_free(const ShvObstacles *obstacles)
{
    for (int32_t i = 0; i < obstacles->count; i++)
        if (obstacles->items[i].motion == SHV_OBSTACLE_FREE) return true;
    return false;
}

static void kick(const Flight *flight, double step)
{
    for (int32_t i = 0; i < flight->obstacles->count; i++) {
        ShvObstacle *obstacle = &flight->obstacles->items[i];
        if (obstacle->motion == SHV_OBSTACLE_FREE)
            obstacle->velocity = shv_madd(obstacle->velocity, step, flight->gravity);
    }
}

/* Scripted obstacles go along with their velocity, so that gaps close as they were predicted. */
static void drift(const Flight *flight, double step)
{
    for (int32_t i = 0; i < flight->obstacles->count; i++) {
        ShvObstacle *obstacle = &flight->obstacles->items[i];
        if (obstacle->motion == SHV_OBSTACLE_FIXED) continue;
        obstacle->position = shv_madd(obstacle->position, step, obstacle->velocity);
        if (obstacle->motion == SHV_OBSTACLE_FREE && obstacle->shape != SHV_OBSTACLE_SPHERE)
            shv_rotate_free(obstacle->principal_moments, obstacle->principal_axes, &obstacle->orientation,
                            &obstacle->angular_velocity, step);
        else
            obstacle->orientation = shv_quat_unit(shv_quat_multiply(
                shv_quat_exponential(shv_scale(obstacle->angular_velocity, step)), obstacle->orientation));
    }
}

/* Farthest that two surfaces can approach each other within a time, and what counts as touching. */
static double reach(const Flight *flight, double time)
{
    double fastest = 0.0, largest = 0.0;
    for (int32_t i = 0; i < flight->obstacles->count; i++) {
        const ShvObstacle *obstacle = &flight->obstacles->items[i];
        if (obstacle->shape == SHV_OBSTACLE_PLANE) continue;
        fastest = fmax(fastest,
                       shv_norm(obstacle->velocity) + shv_norm(obstacle->angular_velocity) * obstacle->bounding_radius);
        largest = fmax(largest, obstacle->bounding_radius);
    }
    return 2.0 * (fastest * time + shv_norm(flight->gravity) * time * time) + TOUCHING * largest;
}

static double touching_gap(const ShvObstacles *obstacles, const ShvBodyContact *contact)
{
    return TOUCHING *
           fmin(obstacles->items[contact->first].bounding_radius, obstacles->items[contact->second].bounding_radius);
}

static double closing_speed(const ShvObstacles *obstacles, const ShvBodyContact *contact)
{
    return -shv_dot(shv_collide_velocity(obstacles, contact), contact->normal);
}

static ShvVec3 acceleration(const Flight *flight, const ShvObstacle *obstacle, ShvVec3 point)
{
    if (obstacle->motion != SHV_OBSTACLE_FREE) return shv_vec3(0.0, 0.0, 0.0);
    if (obstacle->shape == SHV_OBSTACLE_SPHERE) return flight->gravity;
    const ShvVec3 arm = shv_sub(point, obstacle->position), spin = obstacle->angular_velocity;
    return shv_add(flight->gravity, shv_cross(spin, shv_cross(spin, arm)));
}

/* First t > 0 with gap − closing t + ½ a t² = 0, or infinity. */
static double closing_time(const Flight *flight, const ShvBodyContact *contact)
{
    const ShvObstacles *obstacles = flight->obstacles;
    const double closing = closing_speed(obstacles, contact);
    const ShvVec3 relative = shv_sub(acceleration(flight, &obstacles->items[contact->first], contact->point),
                                     acceleration(flight, &obstacles->items[contact->second], contact->point));
    const double discriminant = closing * closing - 2.0 * shv_dot(relative, contact->normal) * contact->gap;
    return discriminant < 0.0 ? (double)INFINITY : 2.0 * contact->gap / (closing + sqrt(discriminant));
}

/* Rebound of what touches now: restitution where it closes fast. True when something did. */
static bool answer_impacts(Flight *flight, int32_t count)
{
    ShvObstacles *obstacles = flight->obstacles;
    bool any = false;
    for (int32_t k = 0; k < count; k++) {
        ShvBodyContact *contact = &obstacles->contacts[k];
        const double closing = closing_speed(obstacles, contact);
        contact->active = contact->gap <= touching_gap(obstacles, contact);
        contact->target = closing > flight->threshold ? contact->restitution * closing : 0.0;
        if (contact->active && closing > flight->threshold) any = true;
    }
    if (!any) return false;
    ShvVec3 impulse;
    flight->work += shv_collide_solve(obstacles, count, &impulse);
    return true;
}

/* Time to the first fast impact, at most `left`. */
static double next_impact(const Flight *flight, int32_t count, double left)
{
    double first = left;
    for (int32_t k = 0; k < count; k++) {
        const ShvBodyContact *contact = &flight->obstacles->contacts[k];
        if (closing_speed(flight->obstacles, contact) > flight->threshold && contact->gap > 0.0)
            first = fmin(first, closing_time(flight, contact));
    }
    return first;
}

/* Holds slow contacts through a time: none may be inside at its end. Velocities are the mean ones of the time, half a kick
   of gravity later than those whose energy counts: the work of the impulses differs by −½ time gravity · impulse. */
static void hold_slow(Flight *flight, int32_t count, double time, bool all)
{
    ShvObstacles *obstacles = flight->obstacles;
    for (int32_t k = 0; k < count; k++) {
        ShvBodyContact *contact = &obstacles->contacts[k];
        contact->active = all || closing_speed(obstacles, contact) <= flight->threshold;
        contact->target = contact->gap > 0.0 ? -contact->gap / time : 0.0;
    }
    kick(flight, 0.5 * time);
    ShvVec3 impulse;
    flight->work += shv_collide_solve(obstacles, count, &impulse);
    flight->work -= 0.5 * time * shv_dot(flight->gravity, impulse);
}

/* Takes the last half kick away from what rests: velocities are then those of the time. */
static void settle(Flight *flight)
{
    ShvObstacles *obstacles = flight->obstacles;
    const int32_t count = shv_collide_detect(obstacles, reach(flight, 0.0));
    for (int32_t k = 0; k < count; k++) {
        ShvBodyContact *contact = &obstacles->contacts[k];
        contact->active =
            contact->gap <= touching_gap(obstacles, contact) && closing_speed(obstacles, contact) <= flight->threshold;
        contact->target = 0.0;
    }
    ShvVec3 impulse;
    flight->work += shv_collide_solve(obstacles, count, &impulse);
}

double shv_obstacles_advance(ShvObstacles *obstacles, double step, const double gravity[3])
{
    if (!(step > 0.0) || !any_free(obstacles)) return 0.0;
    Flight flight = {obstacles, shv_load3(gravity), 0.0, 0.0};
    flight.threshold = 2.0 * step * shv_norm(flight.gravity);
    double left = step;
    for (int event = 0; left > 0.0; event++) {
        const int32_t count = shv_collide_detect(obstacles, reach(&flight, left));
        const bool patient = event < MOST_EVENTS;
        if (patient && answer_impacts(&flight, count)) continue;
        const double time = patient ? next_impact(&flight, count, left) : left;
        hold_slow(&flight, count, time, !patient);
        drift(&flight, time);
        kick(&flight, 0.5 * time);
        left = time < left ? left - time : 0.0;
    }
    settle(&flight);
    return flight.work;
}
