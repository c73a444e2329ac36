#include "rigid/flight_step.h"

/* Impacts and changes of support within one step. After the first few impacts do not bounce any more. What spins on a corner meets its
   support again whenever it has gone deeper by the slop, hundreds of times (most that was seen: 2,032, at 600 m/s); a fragment that
   needs more than the last waits where it is for the next step, and so does one between touches that face each other, which no motion
   answers, much sooner. */
enum { BOUNCING_EVENTS = 16, PRESSED_EVENTS = 64, MOST_EVENTS = 4096 };
/* Steps without motion after which a fragment is put to rest, and the speed that counts as none, against that gained by
   free fall in one step. */
enum { STILL_STEPS = 10 };
static const double still_share = 1e-3;
/* An overlap at the start of a step (a mode switch, a script) is undone by at most this share of the radius a step. */
static const double largest_shift = 0.1;

/* Impacts slower than free fall gains in one step do not bounce: their flights would be shorter than the step. */
static double rest_speed(const ShvFlightStep *step)
{
    return shv_norm(step->gravity) * step->step;
}

/* Of the speed below which nothing bounces, and of the speeds at hand: what is round-off. */
static const double rounding_of_rest = 1e-9, rounding_of_speed = 1e-12;

/* Round-off of velocities. */
static double no_speed(const ShvFlightStep *step)
{
    const ShvFragment *fragment = step->fragment;
    return rounding_of_rest * rest_speed(step) +
           rounding_of_speed * (shv_norm(fragment->velocity) + shv_norm(fragment->angular_velocity) * fragment->radius);
}

static ShvRigidMotion motion_of(const ShvFlightStep *step)
{
    return (ShvRigidMotion){.inverse_mass = 1.0 / step->fragment->mass,
                            .inverse_inertia =
                                shv_free_rotation_world_inverse(&step->body->rotation, step->fragment->orientation),
                            .velocity = step->fragment->velocity,
                            .angular_velocity = step->fragment->angular_velocity};
}

static void set_motion(ShvFlightStep *step, ShvVec3 velocity, ShvVec3 angular_momentum)
{
    step->fragment->velocity = velocity;
    step->body->angular_momentum = angular_momentum;
    shv_flight_body_write(step->body, step->fragment);
}

static ShvVec3 momentum_of(const ShvFlightStep *step, ShvVec3 angular_velocity)
{
    return shv_free_rotation_momentum(&step->body->rotation, step->fragment->orientation, angular_velocity);
}

/* ---- touches ---- */

static ShvTouch touch_at(const ShvFlightStep *step, int32_t index, ShvVec3 point, ShvVec3 normal, double gap)
{
    return (ShvTouch){.obstacle = index,
                      .other = &step->others[index],
                      .point = point,
                      .normal = normal,
                      .arm = shv_sub(point, step->fragment->position),
                      .gap = gap};
}

static bool has_corner(const ShvFacetShape *facet, ShvVec3 node)
{
    return shv_same3(facet->corners[0], node) || shv_same3(facet->corners[1], node) ||
           shv_same3(facet->corners[2], node);
}

/* Whether the facets at a node (at an edge, where `end` is its other node) are behind the plane through it that a push in a direction
   asks for; all in the body's axes. Next to an edge of an obstacle the way that seems shortest may be along a face that glides over
   that edge, which has nothing to do with it. */
static bool is_behind(const ShvArms *arms, ShvVec3 node, ShvVec3 end, ShvVec3 normal, double before)
{
    for (int32_t k = 0; k < arms->facet_count; k++) {
        const ShvFacetShape *facet = &arms->facets[k];
        if (!has_corner(facet, node) || !has_corner(facet, end)) continue;
        for (int c = 0; c < 3; c++)
            if (shv_is_before(normal, shv_sub(facet->corners[c], node), before)) return false;
    }
    return true;
}

/* Where a facet meets a feature on one of its edges. */
static bool is_edge_behind(const ShvArms *arms, const ShvFacetShape *facet, const ShvMat3 *turned,
                           const ShvFeaturePoint *point)
{
    const int edge = shv_feature_point_edge(point);
    return edge < 0 || is_behind(arms, facet->corners[edge], facet->corners[(edge + 1) % 3],
                                 shv_apply_transposed(turned, point->normal), SHV_BEFORE_EDGE);
}

static int32_t touches_of_nodes(const ShvFlightStep *step, int32_t index, const ShvMat3 *turned, ShvTouch *touches)
{
    const double slop = step->body->slop;
    int32_t count = 0;
    for (int32_t i = 0; i < step->body->arms.count; i++) {
        const ShvVec3 offset = shv_load3(step->body->arms.offsets + 3 * (int64_t)i), arm = shv_apply(turned, offset);
        const ShvVec3 point = shv_add(step->fragment->position, arm);
        const ShvSurfacePoint surface = shv_obstacle_closest(&step->others[index], point, 2.0 * slop);
        if (surface.gap > slop) continue;
        if (shv_obstacle_is_sharp(&step->others[index], &surface) &&
            !is_behind(&step->body->arms, offset, offset, shv_apply_transposed(turned, surface.normal),
                       SHV_BEFORE_NODE))
            continue;
        touches[count] = touch_at(step, index, point, surface.normal, surface.gap);
        touches[count++].arm = arm;
    }
    return count;
}

/* Goes on after the first `count` touches; where the room ends, those to be kept are chosen so far. */
static int32_t touches_of_facet(const ShvFlightStep *step, int32_t index, const ShvFacetShape *own,
                                const ShvMat3 *turned, ShvTouch *touches, int32_t count)
{
    const ShvFacetShape placed = shv_facet_placed(own, turned, step->fragment->position), *facet = &placed;
    const ShvObstacle *other = &step->others[index];
    const int32_t room = step->body->arms.count + SHV_TOUCHES_AN_OBSTACLE;
    const ShvRigidMotion motion = motion_of(step);
    ShvFeatureRange range;
    if (!shv_features_about(other, facet, 2.0 * step->body->slop, &range)) return count;
    for (int32_t k = range.first; k < range.end; k++) {
        ShvFeaturePoint points[3];
        const int found = shv_feature_meet(other, &other->features[k], facet, step->body->slop, points);
        for (int i = 0; i < found; i++) {
            if (!is_edge_behind(&step->body->arms, own, turned, &points[i])) continue;
            if (count == room) count = shv_touches_reduce(touches, count, &motion);
            const ShvVec3 point = shv_madd(points[i].point, points[i].gap, points[i].normal);
            touches[count++] = touch_at(step, index, point, points[i].normal, points[i].gap);
        }
    }
    return count;
}

static int32_t touches_of(const ShvFlightStep *step, int32_t index, ShvTouch *touches)
{
    ShvObstacle *other = &step->others[index];
    const ShvFragment *fragment = step->fragment;
    const ShvArms *arms = &step->body->arms;
    const double reach = fragment->radius + 2.0 * step->body->slop;
    *other = shv_obstacle_later(&step->world->obstacles->items[index], step->now);
    if (shv_obstacle_closest(other, fragment->position, reach).gap >= reach) return 0;
    const ShvMat3 turned = shv_quat_to_matrix(fragment->orientation);
    int32_t count = touches_of_nodes(step, index, &turned, touches);
    const bool facets =
        arms->facet_count > 0 && shv_features_matter(other, arms->facet_radius, fragment->position, reach);
    for (int32_t i = 0; facets && i < arms->facet_count; i++)
        count = touches_of_facet(step, index, &arms->facets[i], &turned, touches, count);
    if (count == 0) return 0;
    step->body->touching[index] = 1;
    const ShvRigidMotion motion = motion_of(step);
    return shv_touches_reduce(touches, count, &motion);
}

static int32_t find_touches(const ShvFlightStep *step)
{
    int32_t count = 0;
    for (int32_t o = 0; o < step->world->obstacles->count; o++) count += touches_of(step, o, step->touches + count);
    return count;
}

void shv_flight_step_greet(ShvFlightStep *step)
{
    find_touches(step);
    for (int32_t o = 0; o < step->world->obstacles->count; o++) {
        step->body->touched[o] = step->body->touching[o];
        step->body->touching[o] = 0;
    }
}

/* A free obstacle goes on from now as its copy; its record stays that of the step's start. */
static void keep_obstacle(const ShvFlightStep *step, int32_t index)
{
    ShvObstacle *kept = &step->world->obstacles->items[index];
    if (kept->motion != SHV_OBSTACLE_FREE) return;
    const ShvObstacle start = shv_obstacle_later(&step->others[index], -step->now);
    kept->position = start.position;
    kept->orientation = start.orientation;
    kept->velocity = start.velocity;
    kept->angular_velocity = start.angular_velocity;
}

static void keep_obstacles(const ShvFlightStep *step, int32_t count)
{
    for (int32_t i = 0; i < count; i++)
        if (i == 0 || step->touches[i].obstacle != step->touches[i - 1].obstacle)
            keep_obstacle(step, step->touches[i].obstacle);
}

static void restore_obstacles(const ShvFlightStep *step, int32_t count)
{
    for (int32_t i = 0; i < count; i++) {
        const ShvObstacle *start = &step->world->obstacles->items[step->touches[i].obstacle];
        step->touches[i].other->velocity = start->velocity;
        step->touches[i].other->angular_velocity = start->angular_velocity;
    }
}

/* ---- impacts ---- */

/* Whether the fastest closing touch of some obstacle wakes the fragment. */
static bool wakes(const ShvFlightStep *step, int32_t count, ShvRigidContact *contact)
{
    if (count == 0 || !step->judge) return false;
    const ShvRigidMotion motion = motion_of(step);
    for (int32_t begin = 0, end; begin < count; begin = end) {
        int32_t fastest = begin;
        for (end = begin; end < count && step->touches[end].obstacle == step->touches[begin].obstacle; end++)
            if (shv_touch_normal_speed(&motion, &step->touches[end]) <
                shv_touch_normal_speed(&motion, &step->touches[fastest]))
                fastest = end;
        const ShvTouch *touch = &step->touches[fastest];
        const double closing = -shv_touch_normal_speed(&motion, touch);
        if (!(closing > no_speed(step))) continue;
        *contact = (ShvRigidContact){.fragment = step->body->fragment,
                                     .obstacle = touch->obstacle,
                                     .other = -1,
                                     .other_mass = touch->other->mass,
                                     .time = step->time + step->now,
                                     .point = touch->point,
                                     .normal = touch->normal,
                                     .closing_speed = closing,
                                     .fresh = !step->body->touched[touch->obstacle]};
        if (step->judge(step->judge_data, contact)) return true;
    }
    return false;
}

/* Newton's restitution at every closing touch; answers the works. */
static ShvTouchWork strike(ShvFlightStep *step, int32_t count, double restitution_share, ShvRigidMotion *after)
{
    const ShvRigidMotion before = motion_of(step);
    for (int32_t i = 0; i < count; i++) {
        ShvTouch *touch = &step->touches[i];
        const double closing = -shv_touch_normal_speed(&before, touch);
        touch->wanted = closing > rest_speed(step) ? restitution_share * touch->other->restitution * closing : 0.0;
    }
    *after = before;
    shv_touches_solve(step->touches, count, after);
    return shv_touches_work(step->touches, count, &before, after, 1.0);
}

static bool pushed_by_script(const ShvFlightStep *step, int32_t count)
{
    for (int32_t i = 0; i < count; i++)
        if (step->touches[i].other->motion == SHV_OBSTACLE_SCRIPTED) return true;
    return false;
}

/* Whether anything closed. */
static bool answer_impact(ShvFlightStep *step, int32_t count, double restitution_share)
{
    if (count == 0) return false;
    const ShvRigidMotion before = motion_of(step);
    bool closing = false;
    for (int32_t i = 0; i < count; i++) closing |= -shv_touch_normal_speed(&before, &step->touches[i]) > no_speed(step);
    if (!closing) return false;
    ShvRigidMotion after;
    ShvTouchWork work = strike(step, count, restitution_share, &after);
    /* Newton's restitution with friction can create energy (Kane 1984); the plastic solution cannot. */
    if (work.normal + work.friction > 0.0 && !pushed_by_script(step, count)) {
        restore_obstacles(step, count);
        work = strike(step, count, 0.0, &after);
    }
    keep_obstacles(step, count);
    set_motion(step, after.velocity, momentum_of(step, after.angular_velocity));
    step->work.normal += work.normal;
    step->work.friction += work.friction;
    return true;
}

/* An overlap that no motion explains: moved out along the deepest touch's normal, its potential energy booked. Answers
   whether anything moved. */
static bool undo_overlap(ShvFlightStep *step, int32_t count)
{
    const ShvTouch *deepest = NULL;
    for (int32_t i = 0; i < count; i++)
        if (!deepest || step->touches[i].gap < deepest->gap) deepest = &step->touches[i];
    if (!deepest || deepest->gap >= -2.0 * step->body->slop) return false;
    const double shift = fmin(-deepest->gap, largest_shift * step->fragment->radius);
    step->fragment->position = shv_madd(step->fragment->position, shift, deepest->normal);
    step->work.normal -= step->fragment->mass * shift * shv_dot(step->gravity, deepest->normal);
    return true;
}

/* ---- motion ---- */

static bool is_pressed(const ShvFlightStep *step, int32_t count)
{
    for (int32_t i = 0; i < count; i++)
        for (int32_t k = i + 1; k < count; k++)
            if (shv_normals_face(step->touches[i].normal, step->touches[k].normal)) return true;
    return false;
}

static bool is_held(const ShvFlightStep *step, int32_t count, double left)
{
    if (count == 0) return false;
    const ShvRigidMotion motion = motion_of(step);
    for (int32_t i = 0; i < count; i++) {
        const double speed = shv_touch_normal_speed(&motion, &step->touches[i]);
        if (speed <= still_share * rest_speed(step) + no_speed(step) &&
            speed + shv_dot(step->touches[i].normal, step->gravity) * left < 0.0)
            return true;
    }
    return false;
}

/* Motion until `left`, with what the supports leave of gravity's velocity spread evenly over it: a sliding block gets its
   exact acceleration, a resting one none. */
static ShvFlight hold(ShvFlightStep *step, int32_t count, double left, const ShvRigidMotion *before,
                      ShvRigidMotion *after)
{
    *after = *before;
    after->velocity = shv_madd(before->velocity, left, step->gravity);
    for (int32_t i = 0; i < count; i++) step->touches[i].wanted = 0.0;
    shv_touches_solve(step->touches, count, after);
    const ShvVec3 mean = shv_scale(shv_add(before->angular_velocity, after->angular_velocity), 0.5);
    return (ShvFlight){.velocity = before->velocity,
                       .acceleration = shv_scale(shv_sub(after->velocity, before->velocity), 1.0 / left),
                       .angular_momentum = momentum_of(step, mean)};
}

/* The share of a hold that lasted: impulses on free obstacles and works in proportion. */
static void book_hold(ShvFlightStep *step, int32_t count, double share, const ShvRigidMotion *before,
                      const ShvRigidMotion *after)
{
    const ShvTouchWork work = shv_touches_work(step->touches, count, before, after, share);
    step->work.normal += work.normal;
    step->work.friction += work.friction;
    for (int32_t i = 0; i < count; i++) {
        if (i > 0 && step->touches[i].obstacle == step->touches[i - 1].obstacle) continue;
        ShvObstacle *other = step->touches[i].other;
        const ShvObstacle *start = &step->world->obstacles->items[step->touches[i].obstacle];
        other->velocity = shv_madd(start->velocity, share, shv_sub(other->velocity, start->velocity));
        other->angular_velocity =
            shv_madd(start->angular_velocity, share, shv_sub(other->angular_velocity, start->angular_velocity));
    }
    keep_obstacles(step, count);
}

/* Of the step: what does not count as getting on. A fragment that does not, and closes on nothing that it touches, is stopped by no
   impact but by a corner that counts as inside from one moment to the next, for good: it goes on for a share of what is left. */
static const double no_progress = 1e-12, skipped_share = 1.0 / 16.0;

/* To the next impact or the end of the step; `skips_impacts`: past what seems to be one now. */
static void move_on(ShvFlightStep *step, int32_t count, bool skips_impacts)
{
    const double left = step->step - step->now;
    const ShvRigidMotion before = motion_of(step);
    ShvRigidMotion after = before;
    ShvFragment *fragment = step->fragment;
    const ShvVec3 momentum = step->body->angular_momentum;
    step->held = is_held(step, count, left);
    ShvFlight flight = {.velocity = fragment->velocity, .acceleration = step->gravity, .angular_momentum = momentum};
    if (step->held) flight = hold(step, count, left, &before, &after);
    flight.position = fragment->position;
    flight.orientation = fragment->orientation;
    flight.rotation = &step->body->rotation;
    flight.fastest = shv_free_rotation_fastest(flight.rotation, flight.orientation, flight.angular_momentum);
    double duration = skips_impacts ? skipped_share * left : left;
    bool impact = skips_impacts;
    for (int32_t o = 0; o < step->world->obstacles->count && !skips_impacts; o++)
        impact |= shv_time_of_impact(&flight, &step->body->arms, &step->others[o], step->body->slop, &duration);
    const double share = duration / left;
    const ShvVec3 change =
        step->held ? shv_sub(momentum_of(step, after.angular_velocity), momentum) : shv_vec3(0.0, 0.0, 0.0);
    if (step->held) book_hold(step, count, share, &before, &after);
    fragment->position = shv_flight_position(&flight, duration);
    fragment->orientation = shv_flight_orientation(&flight, duration);
    set_motion(step, shv_madd(fragment->velocity, duration, flight.acceleration), shv_madd(momentum, share, change));
    step->now = impact ? step->now + duration : step->step;
}

/* ---- rest ---- */

static bool supports_move(const ShvFlightStep *step)
{
    for (int32_t o = 0; o < step->world->obstacles->count; o++) {
        const ShvObstacle *obstacle = &step->world->obstacles->items[o];
        const double speed = shv_norm(obstacle->velocity), spin = shv_norm(obstacle->angular_velocity);
        if (speed == 0.0 && spin == 0.0) continue;
        const double radius = step->fragment->radius;
        const double distance = shv_norm(shv_sub(step->fragment->position, obstacle->position)) + radius;
        const double reach =
            radius + 2.0 * step->body->slop + (speed + spin * (distance + speed * step->step)) * step->step;
        if (shv_obstacle_closest(obstacle, step->fragment->position, reach).gap < reach) return true;
    }
    return false;
}

static double kinetic(const ShvFlightStep *step)
{
    const ShvFragment *fragment = step->fragment;
    return 0.5 * fragment->mass * shv_dot(fragment->velocity, fragment->velocity) +
           shv_free_rotation_energy(&step->body->rotation, fragment->orientation, step->body->angular_momentum);
}

/* After some steps without noticeable motion on supports that do not move, what is left of it is taken and booked. Whether it has now. */
static bool come_to_rest(ShvFlightStep *step)
{
    ShvFlightBody *body = step->body;
    const ShvFragment *fragment = step->fragment;
    const double speed = shv_norm(fragment->velocity) + shv_norm(fragment->angular_velocity) * fragment->radius;
    const bool still = step->held && speed <= still_share * rest_speed(step) && !supports_move(step);
    body->still = still ? body->still + 1 : 0;
    if (body->still < STILL_STEPS) return false;
    step->work.normal -= kinetic(step);
    set_motion(step, shv_vec3(0.0, 0.0, 0.0), shv_vec3(0.0, 0.0, 0.0));
    body->resting = true;
    body->resting_gravity = step->gravity;
    return true;
}

/* What supports bear of a body at rest is its weight. */
static bool wakes_by_weight(const ShvFlightStep *step, ShvRigidContact *contact)
{
    *contact = (ShvRigidContact){.fragment = step->body->fragment,
                                 .obstacle = -1,
                                 .other = -1,
                                 .other_mass = HUGE_VAL,
                                 .time = step->time + step->step,
                                 .load = step->fragment->mass * shv_norm(step->gravity)};
    return step->judge && step->judge(step->judge_data, contact);
}

static bool still_rests(const ShvFlightStep *step)
{
    const ShvFragment *fragment = step->fragment;
    const ShvVec3 change = shv_sub(step->gravity, step->body->resting_gravity);
    return shv_dot(change, change) == 0.0 && shv_dot(fragment->velocity, fragment->velocity) == 0.0 &&
           shv_dot(fragment->angular_velocity, fragment->angular_velocity) == 0.0 && !supports_move(step);
}

bool shv_flight_step_run(ShvFlightStep *step, ShvRigidContact *contact)
{
    ShvFlightBody *body = step->body;
    if (body->resting && still_rests(step)) return false;
    body->resting = false;
    bool stalled = false;
    for (int event = 0; event < MOST_EVENTS && step->now < step->step; event++) {
        int32_t count = find_touches(step);
        if (event == 0 && undo_overlap(step, count)) count = find_touches(step);
        if (event >= PRESSED_EVENTS && is_pressed(step, count)) break;
        if (wakes(step, count, contact)) return true;
        const bool answered = answer_impact(step, count, event < BOUNCING_EVENTS ? 1.0 : 0.0);
        const double before = step->now;
        move_on(step, count, stalled && !answered);
        stalled = !answered && step->now - before <= no_progress * step->step;
    }
    if (come_to_rest(step) && wakes_by_weight(step, contact)) return true;
    uint8_t *last = body->touched;
    body->touched = body->touching;
    body->touching = last;
    for (int32_t o = 0; o < step->world->obstacles->count; o++) last[o] = 0;
    return false;
}
