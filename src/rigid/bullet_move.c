#include "rigid/bullet_step.h"

/* Steps without motion after which what is held is put to rest, and the speed that counts as none, against that gained by free
   fall in one step. */
enum { STILL_STEPS = 30 };
static const double still_share = 0.1;

/* ---- where everything is at the end ---- */

static const ShvBulletFlyer *mover_of(const ShvBullet *bullet, const ShvBulletMeeting *meeting)
{
    const ShvBulletFlyer *a = &bullet->flyers[meeting->a];
    return a->moves ? a : &bullet->flyers[meeting->b];
}

/* What pushes a body beside its impact. */
static void find_holds(ShvBullet *bullet)
{
    for (int32_t i = 0; i < bullet->meeting_count; i++) {
        const ShvBulletMeeting *meeting = &bullet->meetings[i];
        if (meeting->contact_count == 0) continue;
        double sum = 0.0;
        for (int32_t k = 0; k < meeting->contact_count; k++) {
            const ShvBulletContact *contact = &bullet->contacts[meeting->contact_begin + k];
            const ShvVec3 impulse = shv_bullet_impulse(contact);
            sum += shv_norm(impulse);
        }
        ShvBulletFlyer *pair[2] = {&bullet->flyers[meeting->a], &bullet->flyers[meeting->b]};
        for (int side = 0; side < 2; side++) {
            pair[side]->impulse += sum;
            if (!meeting->struck && sum > 0.0) pair[side]->held = true;
            if (sum > 0.0 && pair[!side]->companion && pair[side]->fragment >= 0)
                bullet->backend.world.fragments->items[pair[side]->fragment].touches_companion = true;
        }
        if (sum > 0.0 && (!pair[0]->moves || !pair[1]->moves))
            bullet->flyers[mover_of(bullet, meeting)->island].supported = true;
    }
}

static void move_struck(const ShvBullet *bullet, ShvBulletFlyer *flyer, ShvVec3 momentum)
{
    const double moment = flyer->impact_time, left = fmin(bullet->step, flyer->until) - moment;
    ShvVec3 position = shv_madd(flyer->position, moment, flyer->velocity);
    if (!flyer->held) position = shv_madd(position, 0.5 * moment * moment, bullet->gravity);
    position = shv_madd(position, left, flyer->new_velocity);
    if (!flyer->held && !flyer->stopped) {
        /* new_velocity is that of the step's end */
        const double whole = bullet->step - moment;
        position = shv_madd(position, -left * (whole - 0.5 * left), bullet->gravity);
    }
    flyer->position = position;
    flyer->orientation = shv_free_rotation_advance(&flyer->rotation, flyer->solver_orientation, momentum, left);
}

/* Bodies that touch no support fall as one, whatever passes between them: with the velocities of the end less what gravity
   has not yet brought, momentum and angular momentum of the whole are exact. */
static void move_evenly(const ShvBullet *bullet, ShvBulletFlyer *flyer, ShvVec3 momentum)
{
    const ShvBulletFlyer *island = &bullet->flyers[flyer->island];
    ShvVec3 velocity = flyer->new_velocity, turning = momentum;
    if (!island->supported) {
        velocity = shv_madd(velocity, -0.5 * bullet->step, bullet->gravity);
    } else { /* what holds it lasts: velocities change evenly over the step */
        velocity = shv_scale(shv_add(flyer->velocity, flyer->new_velocity), 0.5);
        turning = shv_scale(shv_add(flyer->angular_momentum, momentum), 0.5);
    }
    const double left = fmin(bullet->step, flyer->until);
    flyer->position = shv_madd(flyer->position, left, velocity);
    flyer->orientation = shv_free_rotation_advance(&flyer->rotation, flyer->orientation, turning, left);
}

/* As Bullet's integrator does: with the velocities of the end, the spin unchanged. */
static ShvVec3 move_plainly(const ShvBullet *bullet, ShvBulletFlyer *flyer)
{
    const double left = fmin(bullet->step, flyer->until);
    flyer->position = shv_madd(flyer->position, left, flyer->new_velocity);
    flyer->orientation =
        shv_quat_unit(shv_quat_multiply(shv_quat_exponential(shv_scale(flyer->new_spin, left)), flyer->orientation));
    return shv_free_rotation_momentum(&flyer->rotation, flyer->orientation, flyer->new_spin);
}

static void undo_overlaps(const ShvBullet *bullet, ShvBulletFlyer *flyer)
{
    if (shv_norm(flyer->push) == 0.0 && shv_norm(flyer->turn) == 0.0) return;
    flyer->position = shv_madd(flyer->position, bullet->step, flyer->push);
    flyer->orientation = shv_quat_unit(
        shv_quat_multiply(shv_quat_exponential(shv_scale(flyer->turn, bullet->step)), flyer->orientation));
}

/* A body that waits at the place of its impact with something that has just woken. */
static void wait_there(const ShvBullet *bullet, ShvBulletFlyer *flyer)
{
    const ShvVec3 position = shv_bullet_flyer_position(flyer, flyer->until, bullet->gravity);
    const ShvQuat orientation = shv_bullet_flyer_orientation(flyer, flyer->until);
    flyer->velocity = shv_bullet_flyer_velocity(flyer, flyer->until, bullet->gravity);
    flyer->position = position;
    flyer->orientation = orientation;
}

static void move_body(const ShvBullet *bullet, ShvBulletFlyer *flyer)
{
    if (flyer->until < bullet->step && !flyer->solved) {
        wait_there(bullet, flyer);
        return;
    }
    const ShvVec3 change = shv_sub(flyer->new_spin, flyer->solver_spin);
    ShvVec3 momentum = shv_add(flyer->angular_momentum,
                               shv_free_rotation_momentum(&flyer->rotation, flyer->solver_orientation, change));
    if (!bullet->backend.world.settings->bullet.exact_flight)
        momentum = move_plainly(bullet, flyer);
    else if (flyer->impact_time >= 0.0 && flyer->solved)
        move_struck(bullet, flyer, momentum);
    else
        move_evenly(bullet, flyer, momentum);
    flyer->velocity = flyer->new_velocity;
    flyer->angular_momentum = momentum;
    undo_overlaps(bullet, flyer);
}

/* A free obstacle that somebody else moves over this step: what contacts gave it, at its start. */
static void leave_obstacle(const ShvBullet *bullet, ShvBulletFlyer *flyer)
{
    const ShvVec3 change = shv_sub(flyer->new_spin, flyer->solver_spin);
    flyer->angular_momentum = shv_add(flyer->angular_momentum,
                                      shv_free_rotation_momentum(&flyer->rotation, flyer->solver_orientation, change));
    flyer->velocity = shv_madd(flyer->new_velocity, -bullet->step, bullet->gravity);
}

/* A companion: what contacts gave it acts where it is now, so that momentum and angular momentum of both sides stay the same. */
static void apply_impulse(const ShvBullet *bullet, ShvBulletFlyer *flyer)
{
    const double moment = fmax(0.0, flyer->impact_time);
    const ShvVec3 free = shv_bullet_flyer_velocity(flyer, bullet->step, bullet->gravity);
    const ShvVec3 change = shv_sub(flyer->new_velocity, free);
    const ShvVec3 turn = shv_sub(flyer->new_spin, flyer->solver_spin);
    const ShvVec3 way = shv_sub(shv_bullet_flyer_position(flyer, moment, bullet->gravity), flyer->position);
    const ShvVec3 spin = shv_free_rotation_momentum(&flyer->rotation, flyer->solver_orientation, turn);
    flyer->velocity = shv_add(flyer->velocity, change);
    flyer->angular_momentum = shv_add(flyer->angular_momentum, shv_madd(spin, flyer->mass, shv_cross(way, change)));
}

/* ---- works ---- */

/* Friction's impulses on the mean velocities of the points of what moves here. */
static double friction_work(const ShvBullet *bullet)
{
    double work = 0.0;
    for (int32_t i = 0; i < bullet->meeting_count; i++) {
        const ShvBulletMeeting *meeting = &bullet->meetings[i];
        if (meeting->contact_count == 0) continue;
        const ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
        const ShvVec3 none = shv_vec3(0.0, 0.0, 0.0);
        for (int32_t k = 0; k < meeting->contact_count; k++) {
            const ShvBulletContact *contact = &bullet->contacts[meeting->contact_begin + k];
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
    for (int32_t i = 0; i < bullet->flyer_count; i++) {
        ShvBulletFlyer *flyer = &bullet->flyers[i];
        if (!flyer->moves || flyer->leaves || flyer->asleep) continue;
        flyer->load_impulse += flyer->impulse;
        if (!bullet->window_ends) continue;
        flyer->loads[flyer->load_next] = flyer->load_impulse / bullet->window;
        flyer->load_impulse = 0.0;
        flyer->load_next = (flyer->load_next + 1) % SHV_LOAD_STEPS;
        if (flyer->load_count < SHV_LOAD_STEPS) flyer->load_count++;
    }
    if (bullet->window_ends) bullet->window = 0.0;
}

static void count_still_steps(ShvBullet *bullet)
{
    const double window = fmax(bullet->step, least_window * bullet->backend.world.settings->time_step);
    const double none = still_share * shv_norm(bullet->gravity) * window;
    for (int32_t i = 0; i < bullet->flyer_count; i++) {
        ShvBulletFlyer *flyer = &bullet->flyers[i];
        if (!flyer->moves || flyer->asleep) continue;
        const ShvVec3 spin = shv_free_rotation_velocity(&flyer->rotation, flyer->orientation, flyer->angular_momentum);
        const bool still = !flyer->companion && flyer->impulse > 0.0 &&
                           shv_norm(flyer->velocity) + shv_norm(spin) * flyer->radius <= none;
        flyer->still = still ? flyer->still + bullet->window_ends : 0;
        bullet->flyers[flyer->island].restless |= flyer->still < STILL_STEPS;
    }
    for (int32_t i = 0; i < bullet->meeting_count; i++) {
        const ShvBulletMeeting *meeting = &bullet->meetings[i];
        if (meeting->contact_count == 0) continue;
        const ShvBulletFlyer *a = &bullet->flyers[meeting->a], *b = &bullet->flyers[meeting->b];
        const ShvBulletFlyer *support = a->moves ? b : a;
        ShvBulletFlyer *island = &bullet->flyers[mover_of(bullet, meeting)->island];
        if (support->moves) continue;
        island->restless |= shv_norm(support->velocity) > 0.0 || shv_norm(support->spin) > 0.0;
    }
}

static void put_to_rest(ShvBullet *bullet)
{
    count_still_steps(bullet);
    for (int32_t i = 0; i < bullet->flyer_count; i++) {
        ShvBulletFlyer *flyer = &bullet->flyers[i];
        const ShvBulletFlyer *island = &bullet->flyers[flyer->island];
        if (!flyer->moves || flyer->asleep || !flyer->solved || island->restless || !island->supported) continue;
        flyer->velocity = flyer->angular_momentum = shv_vec3(0.0, 0.0, 0.0);
        flyer->asleep = true;
        flyer->asleep_gravity = bullet->gravity;
    }
}

/* ---- memory of contacts ---- */

static void keep_traces(ShvBullet *bullet)
{
    for (int32_t i = 0; i < bullet->meeting_count; i++) {
        ShvBulletMeeting *meeting = &bullet->meetings[i];
        const ShvQuat inverse = shv_quat_conjugate(bullet->flyers[meeting->a].seen_orientation);
        for (int32_t k = 0; k < meeting->contact_count; k++) {
            const ShvBulletContact *contact = &bullet->contacts[meeting->contact_begin + k];
            bullet->traces[meeting->contact_begin + k] = (ShvBulletTrace){
                .arm = shv_rotate(inverse, shv_load3(contact->arm_first)),
                .normal_impulse = meeting->struck ? 0.0 : contact->normal_impulse,
                .friction_impulse = meeting->struck ? shv_vec3(0.0, 0.0, 0.0) : shv_load3(contact->friction_impulse)};
        }
    }
}

void shv_bullet_move(ShvBullet *bullet)
{
    find_holds(bullet);
    keep_traces(bullet);
    const double friction = friction_work(bullet);
    double change = 0.0;
    for (int32_t i = 0; i < bullet->flyer_count; i++) {
        ShvBulletFlyer *flyer = &bullet->flyers[i];
        if (!flyer->moves || flyer->leaves || flyer->asleep) continue;
        flyer->energy = shv_bullet_flyer_energy(flyer, bullet->gravity);
        if (flyer->obstacle >= 0 && bullet->backend.leaves_obstacles)
            leave_obstacle(bullet, flyer);
        else if (flyer->companion && flyer->solved)
            apply_impulse(bullet, flyer);
        else if (!flyer->companion)
            move_body(bullet, flyer);
    }
    note_loads(bullet);
    put_to_rest(bullet);
    for (int32_t i = 0; i < bullet->flyer_count; i++) {
        ShvBulletFlyer *flyer = &bullet->flyers[i];
        if (!flyer->moves || flyer->leaves || ((flyer->asleep || flyer->companion) && !flyer->solved)) continue;
        if (flyer->solved || !bullet->backend.world.settings->bullet.exact_flight)
            change += shv_bullet_flyer_energy(flyer, bullet->gravity) - flyer->energy;
        shv_bullet_flyer_write(flyer, &bullet->backend.world);
    }
    bullet->backend.friction_work += friction;
    bullet->backend.contact_work += change - friction;
}
