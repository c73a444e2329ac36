/* A stock Bullet world as rigid engine: Bullet moves, meets and answers; this hands records over and back. */
#include "bullet_bridge/dynamics_world.h"
#include "rigid/backend.h"
#include "rigid/bullet_shape.h"

typedef struct PlainBody {
    bool present, moves;
    bool joined; /* since the last step */
    double mass;
    ShvFreeRotation rotation;
    /* as the record was left: events of the time line change it */
    ShvVec3 position, velocity, spin;
    ShvQuat orientation;
    ShvVec3 angular_momentum; /* with exact flight: that belongs to them */
} PlainBody;

typedef struct BulletPlain {
    ShvRigidBackend backend; /* first: the interface's pointer is this one's */
    ShvBulletPlainDefinition settings;
    ShvDynamicsWorld *bullet;
    PlainBody *bodies; /* by number: obstacles by their index, then fragments by theirs */
    int32_t body_count, body_room;
    ShvVec3 gravity;
    double end; /* s: of the last step */
    /* one step, for the judge */
    double time;
    ShvWakeJudge judge;
    void *judge_data;
    ShvRigidContact *wakes;
    int32_t *wake_count;
} BulletPlain;

/* ---- records ---- */

static int32_t obstacle_count(const BulletPlain *plain)
{
    return plain->backend.world.obstacles->count;
}

static ShvFragment *fragment_of(const BulletPlain *plain, int32_t number)
{
    const int32_t fragment = number - obstacle_count(plain);
    return fragment < 0 ? NULL : &plain->backend.world.fragments->items[fragment];
}

static ShvObstacle *obstacle_of(const BulletPlain *plain, int32_t number)
{
    return number < obstacle_count(plain) ? &plain->backend.world.obstacles->items[number] : NULL;
}

/* Whether somebody has changed the record since it was left. */
static bool read_record(const BulletPlain *plain, int32_t number)
{
    PlainBody *body = &plain->bodies[number];
    const ShvFragment *fragment = fragment_of(plain, number);
    const ShvObstacle *obstacle = obstacle_of(plain, number);
    const PlainBody before = *body;
    body->position = fragment ? fragment->position : obstacle->position;
    body->velocity = fragment ? fragment->velocity : obstacle->velocity;
    body->spin = fragment ? fragment->angular_velocity : obstacle->angular_velocity;
    body->orientation = fragment ? fragment->orientation : obstacle->orientation;
    const bool turned = !shv_same3(body->spin, before.spin) || !shv_same_quat(body->orientation, before.orientation);
    if (turned && body->moves)
        body->angular_momentum = shv_free_rotation_momentum(&body->rotation, body->orientation, body->spin);
    return turned || !shv_same3(body->position, before.position) || !shv_same3(body->velocity, before.velocity);
}

static void write_record(const BulletPlain *plain, int32_t number)
{
    const PlainBody *body = &plain->bodies[number];
    ShvFragment *fragment = fragment_of(plain, number);
    ShvObstacle *obstacle = obstacle_of(plain, number);
    *(fragment ? &fragment->position : &obstacle->position) = body->position;
    *(fragment ? &fragment->velocity : &obstacle->velocity) = body->velocity;
    *(fragment ? &fragment->angular_velocity : &obstacle->angular_velocity) = body->spin;
    *(fragment ? &fragment->orientation : &obstacle->orientation) = body->orientation;
}

static ShvDynamicsMotion motion_of(const PlainBody *body)
{
    ShvDynamicsMotion motion;
    const ShvMat3 turned = shv_quat_to_matrix(body->orientation), axes = shv_multiply(&turned, &body->rotation.axes);
    shv_store3(motion.position, body->position);
    for (int i = 0; i < 9; i++) motion.axes[i] = axes.m[i / 3][i % 3];
    shv_store3(motion.velocity, body->velocity);
    shv_store3(motion.spin, body->spin);
    return motion;
}

static void take_motion(PlainBody *body, const ShvDynamicsMotion *motion)
{
    ShvMat3 axes;
    for (int i = 0; i < 9; i++) axes.m[i / 3][i % 3] = motion->axes[i];
    const ShvMat3 back = shv_transpose(&body->rotation.axes), turned = shv_multiply(&axes, &back);
    body->position = shv_load3(motion->position);
    body->orientation = shv_quat_unit(shv_quat_from_matrix(&turned));
    body->velocity = shv_load3(motion->velocity);
    body->spin = shv_load3(motion->spin);
}

/* ---- bodies ---- */

static ShvStatus add_body(BulletPlain *plain, int32_t number, const PlainBody *made, const ShvBulletShape *shape,
                          ShvError *error)
{
    PlainBody *body = &plain->bodies[number];
    const ShvObstacle *obstacle = obstacle_of(plain, number);
    *body = *made;
    read_record(plain, number);
    ShvDynamicsBody given = {.shape = *shape, .inverse_mass = body->moves ? 1.0 / body->mass : 0.0};
    for (int i = 0; i < 3; i++) given.inverse_moment[i] = body->rotation.inverse[i];
    if (obstacle) {
        given.friction = obstacle->friction;
        given.restitution = obstacle->restitution;
    }
    const ShvDynamicsMotion motion = motion_of(body);
    SHV_TRY(shv_dynamics_world_add(plain->bullet, number, &given, &motion, error));
    body->present = body->joined = true;
    return SHV_OK;
}

static ShvStatus reserve_body(BulletPlain *plain, int32_t number, ShvError *error)
{
    SHV_BACKEND_RESERVE(&plain->backend, plain->bodies, plain->body_room, (int64_t)number + 1,
                        "the fragments in flight", error);
    if (plain->body_count <= number) plain->body_count = number + 1;
    return SHV_OK;
}

static ShvStatus add_pieces(BulletPlain *plain, int32_t fragment, ShvConvexPieces *pieces, ShvError *error)
{
    ShvFragment *record = &plain->backend.world.fragments->items[fragment];
    const PlainBody body = {.moves = true, .mass = record->mass, .rotation = shv_free_rotation_make(&record->inertia)};
    ShvBodyShape shape;
    SHV_TRY(shv_body_shape_of_pieces(&shape, pieces, &body.rotation.axes, record->dust, error));
    const ShvStatus status = add_body(plain, obstacle_count(plain) + fragment, &body, &shape.shape, error);
    shv_body_shape_release(&shape);
    record->hulls = pieces->count;
    record->hull_outside = pieces->outside;
    record->hull_missing = pieces->missing;
    return status;
}

static ShvStatus add(ShvRigidBackend *backend, int32_t fragment, ShvError *error)
{
    BulletPlain *plain = (BulletPlain *)backend;
    const ShvRigidWorld *world = &backend->world;
    const ShvFragment *record = &world->fragments->items[fragment];
    SHV_TRY(shv_rigid_check_mass(record, error));
    SHV_TRY(reserve_body(plain, obstacle_count(plain) + fragment, error));
    ShvConvexPieces pieces;
    SHV_TRY(shv_convex_pieces_make(&pieces, world->fragments, world->model, world->state, fragment, error));
    const ShvStatus status = add_pieces(plain, fragment, &pieces, error);
    shv_convex_pieces_release(&pieces);
    if (status == SHV_OK || status == SHV_NO_MEMORY) return status;
    return shv_fail_within(error, status, "fragment %d", (int)record->id);
}

static ShvStatus add_obstacle(BulletPlain *plain, int32_t index, ShvError *error)
{
    const ShvObstacle *obstacle = &plain->backend.world.obstacles->items[index];
    PlainBody body = {.moves = obstacle->motion == SHV_OBSTACLE_FREE,
                      .mass = obstacle->mass,
                      .rotation = shv_free_rotation_make(&obstacle->inertia)};
    if (!body.moves) body.rotation.axes = shv_identity();
    SHV_TRY(reserve_body(plain, index, error));
    ShvBodyShape shape;
    SHV_TRY(shv_body_shape_of_obstacle(&shape, obstacle, &body.rotation.axes, plain->backend.world.fragments->memory,
                                       error));
    const ShvStatus status = add_body(plain, index, &body, &shape.shape, error);
    shv_body_shape_release(&shape);
    if (status == SHV_OK || status == SHV_NO_MEMORY) return status;
    return shv_fail_within(error, status, "obstacle %s", obstacle->name);
}

static void take_out(ShvRigidBackend *backend, int32_t fragment)
{
    BulletPlain *plain = (BulletPlain *)backend;
    const int32_t number = obstacle_count(plain) + fragment;
    if (number >= plain->body_count || !plain->bodies[number].present) return;
    shv_dynamics_world_remove(plain->bullet, number);
    plain->bodies[number].present = false;
}

/* ---- wakes ---- */

static ShvRigidContact report(const BulletPlain *plain, const ShvDynamicsContact *contact, int32_t own, int32_t other)
{
    const int32_t obstacles = obstacle_count(plain);
    const bool first = own == contact->first;
    return (ShvRigidContact){.fragment = own - obstacles,
                             .obstacle = other < obstacles ? other : -1,
                             .other = other < obstacles ? -1 : other - obstacles,
                             .time = plain->time,
                             .point = shv_load3(contact->point),
                             .normal = shv_scale(shv_load3(contact->normal), first ? 1.0 : -1.0),
                             .closing_speed = contact->closing,
                             .fresh = contact->fresh,
                             .other_mass = plain->bodies[other].moves ? plain->bodies[other].mass : (double)INFINITY};
}

/* What wakes leaves as it stands at the step's start. */
static void judge_contacts(void *data, const ShvDynamicsContact *contacts, int32_t count)
{
    BulletPlain *plain = data;
    for (int32_t i = 0; i < count; i++) {
        const int32_t pair[2] = {contacts[i].first, contacts[i].second};
        if (!plain->bodies[pair[0]].present || !plain->bodies[pair[1]].present) continue;
        for (int side = 0; side < 2; side++) {
            if (pair[side] < obstacle_count(plain)) continue;
            const ShvRigidContact contact = report(plain, &contacts[i], pair[side], pair[1 - side]);
            if (!plain->judge(plain->judge_data, &contact)) continue;
            plain->wakes[(*plain->wake_count)++] = contact;
            take_out(&plain->backend, contact.fragment);
        }
    }
}

/* ---- advance ---- */

static double energy(const BulletPlain *plain, int32_t number)
{
    const PlainBody *body = &plain->bodies[number];
    const ShvFragment *fragment = fragment_of(plain, number);
    const double kinetic = fragment ? shv_fragment_kinetic(fragment) : shv_obstacle_kinetic(obstacle_of(plain, number));
    return kinetic - body->mass * shv_dot(plain->gravity, body->position);
}

static ShvStatus check_motion(const BulletPlain *plain, int32_t number, ShvError *error)
{
    const PlainBody *body = &plain->bodies[number];
    const bool fragment = fragment_of(plain, number) != NULL;
    return shv_rigid_check_motion(fragment ? "fragment" : "obstacle",
                                  fragment ? number - obstacle_count(plain) : number, body->position, body->velocity,
                                  body->spin, 0.0, error);
}

static ShvStatus begin(BulletPlain *plain, ShvVec3 gravity, ShvError *error)
{
    if (!shv_same3(gravity, plain->gravity)) shv_dynamics_world_wake_all(plain->bullet);
    plain->gravity = gravity;
    for (int32_t i = 0; i < plain->body_count; i++) {
        if (!plain->bodies[i].present || !read_record(plain, i)) continue;
        SHV_TRY(check_motion(plain, i, error));
        const ShvDynamicsMotion motion = motion_of(&plain->bodies[i]);
        shv_dynamics_world_place(plain->bullet, i, &motion);
    }
    return SHV_OK;
}

/* Between contacts a parabola, and free rotation whose angular momentum is the state. */
static void fly_exactly(BulletPlain *plain, int32_t number, double step, const PlainBody *before)
{
    PlainBody *body = &plain->bodies[number];
    const ShvVec3 change = shv_sub(body->spin, before->spin);
    body->angular_momentum =
        shv_add(before->angular_momentum, shv_free_rotation_momentum(&body->rotation, before->orientation, change));
    body->orientation = shv_free_rotation_advance(&body->rotation, before->orientation, body->angular_momentum, step);
    body->spin = shv_free_rotation_velocity(&body->rotation, body->orientation, body->angular_momentum);
    const ShvDynamicsTouch touch = shv_dynamics_world_touch(plain->bullet, number);
    if (touch == SHV_DYNAMICS_FREE) body->velocity = shv_madd(before->velocity, step, plain->gravity);
    if (touch != SHV_DYNAMICS_HELD)
        body->position = shv_madd(shv_madd(before->position, step, body->velocity), -0.5 * step * step, plain->gravity);
    const ShvDynamicsMotion motion = motion_of(body);
    shv_dynamics_world_correct(plain->bullet, number, &motion);
}

/* A body's motion over the step into its record; what the step did to its energy. That is the work of contacts, and of Bullet's
   integrator where flight is not exact: nobody can tell them apart where both act. */
static ShvStatus end_body(BulletPlain *plain, int32_t number, double step, double *work, ShvError *error)
{
    PlainBody *body = &plain->bodies[number];
    const double earlier = energy(plain, number);
    const PlainBody before = *body;
    ShvDynamicsMotion motion;
    const bool awake = shv_dynamics_world_read(plain->bullet, number, &motion);
    if (!awake && shv_norm(body->velocity) == 0.0 && shv_norm(body->spin) == 0.0) return SHV_OK;
    take_motion(body, &motion);
    SHV_TRY(check_motion(plain, number, error));
    if (awake && plain->settings.exact_flight) fly_exactly(plain, number, step, &before);
    if (obstacle_of(plain, number) && plain->backend.leaves_obstacles) {
        body->position = before.position;
        body->orientation = before.orientation;
        body->velocity = shv_madd(body->velocity, -step, plain->gravity);
    }
    write_record(plain, number);
    const bool touched = shv_dynamics_world_touch(plain->bullet, number) != SHV_DYNAMICS_FREE;
    if (touched || !plain->settings.exact_flight) *work += energy(plain, number) - earlier;
    return SHV_OK;
}

/* Bullet takes whole steps: what joins in the midst of one flies freely to its end. */
static ShvStatus catch_up(BulletPlain *plain, double step, ShvError *error)
{
    for (int32_t i = obstacle_count(plain); i < plain->body_count; i++) {
        PlainBody *body = &plain->bodies[i];
        if (!body->present || !body->joined) continue;
        body->joined = false;
        read_record(plain, i);
        SHV_TRY(check_motion(plain, i, error));
        body->velocity = shv_madd(body->velocity, step, plain->gravity);
        body->position = shv_madd(shv_madd(body->position, step, body->velocity), -0.5 * step * step, plain->gravity);
        body->orientation = shv_free_rotation_advance(&body->rotation, body->orientation, body->angular_momentum, step);
        body->spin = shv_free_rotation_velocity(&body->rotation, body->orientation, body->angular_momentum);
        write_record(plain, i);
        const ShvDynamicsMotion motion = motion_of(body);
        shv_dynamics_world_place(plain->bullet, i, &motion);
    }
    return SHV_OK;
}

/* Of the step: rounding of times. */
static const double rounding_of_time = 1e-9;

static ShvStatus advance(ShvRigidBackend *backend, double time, double step, const double gravity[3],
                         ShvWakeJudge judge, void *judge_data, ShvRigidContact *wakes, int32_t *wake_count,
                         ShvError *error)
{
    BulletPlain *plain = (BulletPlain *)backend;
    if (!(step > 0.0)) return SHV_OK;
    if (time < plain->end - rounding_of_time * step) return catch_up(plain, step, error);
    SHV_TRY(begin(plain, shv_load3(gravity), error));
    plain->time = time;
    plain->end = time + step;
    plain->judge = judge;
    plain->judge_data = judge_data;
    plain->wakes = wakes;
    plain->wake_count = wake_count;
    double friction, work = 0.0;
    SHV_TRY(
        shv_dynamics_world_step(plain->bullet, step, gravity, judge ? judge_contacts : NULL, plain, &friction, error));
    for (int32_t i = 0; i < plain->body_count; i++) {
        plain->bodies[i].joined = false;
        if (plain->bodies[i].present && plain->bodies[i].moves) SHV_TRY(end_body(plain, i, step, &work, error));
    }
    backend->friction_work += friction;
    backend->contact_work += work - friction;
    return SHV_OK;
}

/* ---- life ---- */

static void destroy(ShvRigidBackend *backend)
{
    BulletPlain *plain = (BulletPlain *)backend;
    if (!plain) return;
    shv_dynamics_world_destroy(plain->bullet);
    shv_release(plain->bodies);
    shv_release(plain);
}

static ShvStatus fill(BulletPlain *plain, ShvError *error)
{
    const ShvBulletPlainDefinition *settings = &plain->settings;
    const ShvDynamicsSettings dynamics = {.unit = settings->unit,
                                          .margin = settings->margin,
                                          .friction = plain->backend.fragment_friction,
                                          .restitution = plain->backend.fragment_restitution,
                                          .exact_flight = settings->exact_flight,
                                          .sharp_impacts = settings->sharp_impacts,
                                          .sorted_pairs = settings->sorted_pairs,
                                          .keep_overlaps = settings->keep_overlaps};
    SHV_TRY(shv_dynamics_world_create(&plain->bullet, &dynamics, error));
    for (int32_t i = 0; i < obstacle_count(plain); i++) SHV_TRY(add_obstacle(plain, i, error));
    return SHV_OK;
}

ShvStatus shv_bullet_plain_create(ShvRigidBackend **backend, const ShvRigidWorld *world,
                                  const ShvBulletPlainDefinition *settings, ShvError *error)
{
    static const ShvRigidFunctions functions = {
        .name = "bullet_plain", .add = add, .remove = take_out, .advance = advance, .destroy = destroy};
    *backend = NULL;
    BulletPlain *plain = shv_allocate(world->fragments->memory, SHV_PART_RIGID, 1, sizeof *plain);
    if (!plain) return shv_fail_memory(error, "the rigid backend", sizeof *plain);
    plain->settings = *settings;
    plain->backend.functions = &functions;
    plain->backend.world = *world;
    plain->backend.moves_obstacles = true;
    plain->end = -(double)INFINITY;
    plain->backend.fragment_friction = world->settings->friction;
    plain->backend.fragment_restitution = world->settings->restitution;
    const ShvStatus status = fill(plain, error);
    if (status == SHV_OK)
        *backend = &plain->backend;
    else
        destroy(&plain->backend);
    return status;
}
