#include "rigid/bullet_step.h"

/* Steps without motion after which what is held is put to rest, and the speed that counts as none, against that gained by free
   fall in one step. */
enum { STILL_STEPS = 30 };
static const double still_share = 0.1;

/* ---- where everything is at the end ---- */

/* What pushes a body beside its impact. */
static void find_holds(ShvBullet *bullet)
{
    for (int32_t i = 0; i < bullet->contact_pair_count; i++) {
        const ShvContactPair *contact_pair = &bullet->contact_pairs[i];
        if (contact_pair->contact_count == 0) continue;
        double sum = 0.0;
        for (int32_t k = 0; k < contact_pair->contact_count; k++) {
            const ShvBulletContact *contact = &bullet->contacts[contact_pair->contact_begin + k];
            const ShvVec3 impulse = shv_bullet_impulse(contact);
            sum += shv_norm(impulse);
        }
        ShvBulletRigidBody *pair[2] = {&bullet->bodies[contact_pair->a], &bullet->bodies[contact_pair->b]};
        for (int side = 0; side < 2; side++) {
            pair[side]->impulse += sum;
            if (!contact_pair->struck && sum > 0.0) pair[side]->held = true;
            if (sum > 0.0 && pair[!side]->coupled && pair[side]->fragment >= 0)
                bullet->backend.world.fragments->items[pair[side]->fragment].touches_coupled = true;
        }
        if (sum > 0.0 && (!pair[0]->moves || !pair[1]->moves))
            shv_bullet_island(bullet, contact_pair)->supported = true;
    }
}

static void move_struck(const ShvBullet *bullet, ShvBulletRigidBody *body, ShvVec3 momentum)
{
    const double time = body->impact_time, left = fmin(bullet->step, body->until) - time;
    ShvVec3 position = shv_madd(body->position, time, body->velocity);
    if (!body->held) position = shv_madd(position, 0.5 * time * time, bullet->gravity);
    position = shv_madd(position, left, body->new_velocity);
    if (!body->held && !body->stopped) {
        /* new_velocity is that of the step's end */
        const double whole = bullet->step - time;
        position = shv_madd(position, -left * (whole - 0.5 * left), bullet->gravity);
    }
    body->position = position;
    body->orientation = shv_free_rotation_advance(&body->rotation, body->solver_orientation, momentum, left);
}

/* Bodies that touch no support fall as one, whatever passes between them: with the velocities of the end less what gravity
   has not yet brought, momentum and angular momentum of the whole are exact. */
static void move_evenly(const ShvBullet *bullet, ShvBulletRigidBody *body, ShvVec3 momentum)
{
    const ShvBulletRigidBody *island = &bullet->bodies[body->island];
    ShvVec3 velocity = body->new_velocity, turning = momentum;
    if (!island->supported) {
        velocity = shv_madd(velocity, -0.5 * bullet->step, bullet->gravity);
    } else { /* what holds it lasts: velocities change evenly over the step */
        velocity = shv_scale(shv_add(body->velocity, body->new_velocity), 0.5);
        turning = shv_scale(shv_add(body->angular_momentum, momentum), 0.5);
    }
    const double left = fmin(bullet->step, body->until);
    body->position = shv_madd(body->position, left, velocity);
    body->orientation = shv_free_rotation_advance(&body->rotation, body->orientation, turning, left);
}

/* As Bullet's integrator does: with the velocities of the end, the spin unchanged. */
static ShvVec3 move_plainly(const ShvBullet *bullet, ShvBulletRigidBody *body)
{
    const double left = fmin(bullet->step, body->until);
    body->position = shv_madd(body->position, left, body->new_velocity);
    body->orientation =
        shv_quat_unit(shv_quat_multiply(shv_quat_exponential(shv_scale(body->new_spin, left)), body->orientation));
    return shv_free_rotation_momentum(&body->rotation, body->orientation, body->new_spin);
}

static void undo_overlaps(const ShvBullet *bullet, ShvBulletRigidBody *body)
{
    if (shv_norm(body->push) == 0.0 && shv_norm(body->turn) == 0.0) return;
    body->position = shv_madd(body->position, bullet->step, body->push);
    body->orientation =
        shv_quat_unit(shv_quat_multiply(shv_quat_exponential(shv_scale(body->turn, bullet->step)), body->orientation));
}

/* A body that goes no further in this step: at the place of its impact with something that has just woken, which brings it the rest of
   the step, or where it would get into what has been struck. */
static void wait_there(const ShvBullet *bullet, ShvBulletRigidBody *body)
{
    const ShvVec3 position = shv_bullet_body_position(body, body->until, bullet->gravity);
    const ShvQuat orientation = shv_bullet_body_orientation(body, body->until);
    body->velocity = shv_bullet_body_velocity(body, body->waits ? body->until : bullet->step, bullet->gravity);
    body->position = position;
    body->orientation = orientation;
}

static void move_body(const ShvBullet *bullet, ShvBulletRigidBody *body)
{
    if (body->until < bullet->step && !body->solved) {
        wait_there(bullet, body);
        return;
    }
    const ShvVec3 change = shv_sub(body->new_spin, body->solver_spin);
    ShvVec3 momentum =
        shv_add(body->angular_momentum, shv_free_rotation_momentum(&body->rotation, body->solver_orientation, change));
    if (!bullet->backend.world.settings->bullet.exact_flight)
        momentum = move_plainly(bullet, body);
    else if (body->impact_time >= 0.0 && body->solved)
        move_struck(bullet, body, momentum);
    else
        move_evenly(bullet, body, momentum);
    /* what it waits for brings it the rest of gravity's velocity, unless something holds it */
    const bool falls_on = body->waits && !bullet->bodies[body->island].supported;
    const double left = falls_on ? bullet->step - body->until : 0.0;
    body->velocity = shv_madd(body->new_velocity, -left, bullet->gravity);
    body->angular_momentum = momentum;
    undo_overlaps(bullet, body);
}

/* A free obstacle that somebody else moves over this step: what contacts gave it, at its start. */
static void leave_obstacle(const ShvBullet *bullet, ShvBulletRigidBody *body)
{
    const ShvVec3 change = shv_sub(body->new_spin, body->solver_spin);
    body->angular_momentum =
        shv_add(body->angular_momentum, shv_free_rotation_momentum(&body->rotation, body->solver_orientation, change));
    body->velocity = shv_madd(body->new_velocity, -bullet->step, bullet->gravity);
}

/* A coupled body: what contacts gave it acts where it is now, so that momentum and angular momentum of both sides stay the same. */
static void apply_impulse(const ShvBullet *bullet, ShvBulletRigidBody *body)
{
    const double time = fmax(0.0, body->impact_time);
    const ShvVec3 free = shv_bullet_body_velocity(body, bullet->step, bullet->gravity);
    const ShvVec3 change = shv_sub(body->new_velocity, free);
    const ShvVec3 turn = shv_sub(body->new_spin, body->solver_spin);
    const ShvVec3 displacement = shv_sub(shv_bullet_body_position(body, time, bullet->gravity), body->position);
    const ShvVec3 spin = shv_free_rotation_momentum(&body->rotation, body->solver_orientation, turn);
    body->velocity = shv_add(body->velocity, change);
    body->angular_momentum =
        shv_add(body->angular_momentum, shv_madd(spin, body->mass, shv_cross(displacement, change)));
}

/* ---- works ---- */

/* Friction's impulses on the mean velocities of the points of what moves here. */
static double friction_work(const ShvBullet *bullet)
{
    double work = 0.0;
    for (int32_t i = 0; i < bullet->contact_pair_count; i++) {
        const ShvContactPair *contact_pair = &bullet->contact_pairs[i];
        if (contact_pair->contact_count == 0) continue;
        const ShvBulletRigidBody *a = &bullet->bodies[contact_pair->a], *b = &bullet->bodies[contact_pair->b];
        const ShvVec3 none = shv_vec3(0.0, 0.0, 0.0);
        for (int32_t k = 0; k < contact_pair->contact_count; k++) {
            const ShvBulletContact *contact = &bullet->contacts[contact_pair->contact_begin + k];
            const ShvVec3 before =
                shv_bullet_relative(contact, a->moves ? a->velocity : none, a->moves ? a->spin : none,
                                    b->moves ? b->velocity : none, b->moves ? b->spin : none);
            const ShvVec3 after =
                shv_bullet_relative(contact, a->moves ? a->new_velocity : none, a->moves ? a->new_spin : none,
                                    b->moves ? b->new_velocity : none, b->moves ? b->new_spin : none);
            work += 0.5 * shv_dot(shv_load3(contact->friction_impulse), shv_add(before, after));
        }
    }
    return work;
}

/* ---- rest ---- */

/* Beside what is awake steps are short. Whether something rests, and under which load, is told by what lasts: by steps of at least
   this part of the scene's. */
static const double least_window = 0.5;

static void note_loads(ShvBullet *bullet)
{
    bullet->window += bullet->step;
    bullet->window_ends = bullet->window > least_window * bullet->backend.world.settings->time_step;
    for (int32_t i = 0; i < bullet->body_count; i++) {
        ShvBulletRigidBody *body = &bullet->bodies[i];
        if ((!body->moves && body->obstacle >= 0) || body->leaves || body->asleep) continue;
        body->load_impulse += body->impulse;
        if (!bullet->window_ends) continue;
        body->loads[body->load_next] = body->load_impulse / bullet->window;
        body->load_impulse = 0.0;
        body->load_next = (body->load_next + 1) % SHV_LOAD_STEPS;
        if (body->load_count < SHV_LOAD_STEPS) body->load_count++;
    }
    if (bullet->window_ends) bullet->window = 0.0;
}

static void count_still_steps(ShvBullet *bullet)
{
    const double window = fmax(bullet->step, least_window * bullet->backend.world.settings->time_step);
    const double none = still_share * shv_norm(bullet->gravity) * window;
    for (int32_t i = 0; i < bullet->body_count; i++) {
        ShvBulletRigidBody *body = &bullet->bodies[i];
        if (!body->moves || body->asleep) continue;
        const ShvVec3 spin = shv_free_rotation_velocity(&body->rotation, body->orientation, body->angular_momentum);
        const bool still =
            !body->coupled && body->impulse > 0.0 && shv_norm(body->velocity) + shv_norm(spin) * body->radius <= none;
        body->still = still ? body->still + bullet->window_ends : 0;
        bullet->bodies[body->island].restless |= body->still < STILL_STEPS;
    }
    for (int32_t i = 0; i < bullet->contact_pair_count; i++) {
        const ShvContactPair *contact_pair = &bullet->contact_pairs[i];
        if (contact_pair->contact_count == 0) continue;
        const ShvBulletRigidBody *a = &bullet->bodies[contact_pair->a], *b = &bullet->bodies[contact_pair->b];
        const ShvBulletRigidBody *support = a->moves ? b : a;
        ShvBulletRigidBody *island = shv_bullet_island(bullet, contact_pair);
        if (support->moves) continue;
        island->restless |= shv_norm(support->velocity) > 0.0 || shv_norm(support->spin) > 0.0;
    }
}

static void put_to_rest(ShvBullet *bullet)
{
    count_still_steps(bullet);
    for (int32_t i = 0; i < bullet->body_count; i++) {
        ShvBulletRigidBody *body = &bullet->bodies[i];
        const ShvBulletRigidBody *island = &bullet->bodies[body->island];
        if (!body->moves || body->asleep || !body->solved || island->restless || !island->supported) continue;
        body->velocity = body->angular_momentum = shv_vec3(0.0, 0.0, 0.0);
        body->asleep = true;
        body->asleep_gravity = bullet->gravity;
    }
}

/* ---- memory of contacts ---- */

static void keep_cached_impulses(ShvBullet *bullet)
{
    for (int32_t i = 0; i < bullet->contact_pair_count; i++) {
        ShvContactPair *contact_pair = &bullet->contact_pairs[i];
        const ShvQuat inverse = shv_quat_conjugate(bullet->bodies[contact_pair->a].seen_orientation);
        for (int32_t k = 0; k < contact_pair->contact_count; k++) {
            const ShvBulletContact *contact = &bullet->contacts[contact_pair->contact_begin + k];
            bullet->cached_impulses[contact_pair->contact_begin + k] =
                (ShvCachedImpulse){.arm = shv_rotate(inverse, shv_load3(contact->arm_first)),
                                   .normal_impulse = contact_pair->struck ? 0.0 : contact->normal_impulse,
                                   .friction_impulse = contact_pair->struck ? shv_vec3(0.0, 0.0, 0.0)
                                                                            : shv_load3(contact->friction_impulse)};
        }
    }
}

void shv_bullet_move(ShvBullet *bullet)
{
    find_holds(bullet);
    keep_cached_impulses(bullet);
    const double friction = friction_work(bullet);
    double change = 0.0;
    for (int32_t i = 0; i < bullet->body_count; i++) {
        ShvBulletRigidBody *body = &bullet->bodies[i];
        if (!body->moves || body->leaves || body->asleep) continue;
        body->energy = shv_bullet_body_energy(body, bullet->gravity);
        if (body->obstacle >= 0 && bullet->backend.leaves_obstacles)
            leave_obstacle(bullet, body);
        else if (body->coupled && body->solved)
            apply_impulse(bullet, body);
        else if (!body->coupled)
            move_body(bullet, body);
    }
    note_loads(bullet);
    put_to_rest(bullet);
    for (int32_t i = 0; i < bullet->body_count; i++) {
        ShvBulletRigidBody *body = &bullet->bodies[i];
        if (!body->moves || body->leaves || ((body->asleep || body->coupled) && !body->solved)) continue;
        const bool halted = body->until < bullet->step && !body->waits;
        if (body->solved || halted || !bullet->backend.world.settings->bullet.exact_flight)
            change += shv_bullet_body_energy(body, bullet->gravity) - body->energy;
        shv_bullet_body_write(body, &bullet->backend.world);
    }
    bullet->backend.friction_work += friction;
    bullet->backend.contact_work += change - friction;
}
