#include "evaluate/closed_form.h"

#include <math.h>
#include <string.h>

/* ---- along a line ---- */

/* Position and velocity after `time` of constant acceleration. */
static ShvLineMotion accelerate(ShvLineMotion from, double acceleration, double time)
{
    return (ShvLineMotion){from.position + (from.velocity + 0.5 * acceleration * time) * time,
                           from.velocity + acceleration * time};
}

ShvLineMotion shv_law_bounce(double height, double velocity, double gravity, double restitution, double time)
{
    ShvLineMotion motion = {height, velocity};
    /* v_end² = v² + 2 g h; the first root of h + v t − ½ g t² after the start is (v + |v_end|)/g. */
    double speed = sqrt(velocity * velocity + 2.0 * gravity * height);
    double fall = (velocity + speed) / gravity;
    while (time >= fall) {
        time -= fall;
        speed *= restitution;
        motion = (ShvLineMotion){0.0, speed};
        fall = 2.0 * speed / gravity;
        /* So short a hop, of less than a thousand steps of double precision, stands for all that follow. */
        if (fall <= 1e-13 * (1.0 + time)) return (ShvLineMotion){0.0, 0.0};
    }
    return accelerate(motion, -gravity, time);
}

/* Friction of acceleration `drag` against the motion of the contact point slows the centre and spins the rim. */
static ShvRollMotion roll_on(ShvRollMotion from, double pull, double drag, double shape, double time)
{
    return (ShvRollMotion){accelerate(from.centre, pull - drag, time), accelerate(from.rim, drag / shape, time)};
}

ShvRollMotion shv_law_roll(double velocity, double rim_speed, double pull, double friction, double shape, double time)
{
    ShvRollMotion motion = {{0.0, velocity}, {0.0, rim_speed}};
    const double slip = velocity - rim_speed;
    if (slip != 0.0) {
        const double drag = copysign(friction, slip), change = pull - drag * (1.0 + 1.0 / shape);
        const double stop = slip * change < 0.0 ? -slip / change : HUGE_VAL;
        motion = roll_on(motion, pull, drag, shape, fmin(time, stop));
        if (time < stop) return motion;
        time -= stop;
        motion.rim.velocity = motion.centre.velocity;
    }
    /* Rolling needs drag = pull shape/(1 + shape). */
    const double needed = isinf(shape) ? pull : pull * shape / (1.0 + shape);
    return roll_on(motion, pull, fabs(needed) <= friction ? needed : copysign(friction, pull), shape, time);
}

/* ---- the body and its plane ---- */

/* Relative to speeds, lengths and gravity: what typed numbers and their products leave. */
static const double nearly = 1e-6;

/* A body, and the plane that its law needs. */
typedef struct Setting {
    const ShvSceneDefinition *scene;
    const ShvSimulation *simulation;
    const ShvBody *body;
    const ShvObstacleDefinition *own; /* NULL: an object */
    const char *name;
    int32_t object;
    const ShvObstacleDefinition *plane;
    ShvVec3 normal;
} Setting;

static ShvStatus find_plane(Setting *setting, ShvError *error)
{
    const ShvSceneDefinition *scene = setting->scene;
    const char *name = scene->reference.on ? scene->reference.on : "";
    for (int32_t i = 0; i < scene->obstacle_count; i++)
        if (strcmp(scene->obstacles[i].name, name) == 0) setting->plane = &scene->obstacles[i];
    if (!setting->plane || setting->plane->shape != SHV_OBSTACLE_PLANE)
        return shv_fail(error, SHV_BAD_INPUT, "reference.on must name a plane of the scene, not '%s'", name);
    setting->normal = shv_unit(shv_load3(setting->plane->plane_normal));
    return SHV_OK;
}

/* ---- where a body touches ---- */

/* Lowest point of an object from its centre, and how far the middle of its lowest nodes is from being under that. */
static double lowest_node(const Setting *setting, ShvVec3 centre, double *aside)
{
    const ShvMeshView mesh = shv_simulation_mesh(setting->simulation);
    const ShvObjectView *part = &mesh.objects[setting->object];
    const double slack = nearly * setting->body->radius;
    double lowest = HUGE_VAL, count = 0.0;
    ShvVec3 sum = shv_vec3(0.0, 0.0, 0.0);
    for (int32_t i = part->node_begin; i < part->node_end; i++)
        lowest = fmin(lowest, shv_dot(setting->normal, shv_load3(mesh.positions + 3 * (int64_t)i)));
    for (int32_t i = part->node_begin; i < part->node_end; i++) {
        const ShvVec3 x = shv_load3(mesh.positions + 3 * (int64_t)i);
        if (shv_dot(setting->normal, x) > lowest + slack) continue;
        sum = shv_add(sum, shv_sub(x, centre));
        count += 1.0;
    }
    *aside = shv_norm(shv_cross(setting->normal, sum)) / count;
    return lowest - shv_dot(setting->normal, centre);
}

/* Gap between body and plane. */
static double gap_of(const Setting *setting, const ShvBodyState *start, double *aside)
{
    const ShvVec3 local = shv_rotate(shv_quat_conjugate(start->orientation), setting->normal);
    double lowest = 0.0;
    *aside = 0.0;
    if (!setting->own)
        lowest = lowest_node(setting, start->position, aside);
    else if (setting->own->shape == SHV_OBSTACLE_SPHERE)
        lowest = -setting->own->radius;
    else
        lowest = -0.5 * shv_dot(shv_load3(setting->own->size), shv_vec3(fabs(local.x), fabs(local.y), fabs(local.z)));
    return shv_dot(setting->normal, start->position) + lowest - setting->plane->plane_offset;
}

/* ---- laws ---- */

/* What a law does not know, and what to change; of the body and its plane. */
typedef struct Fault {
    bool is;
    const char *format;
} Fault;

static ShvStatus refuse(const Setting *setting, const Fault *faults, int count, ShvError *error)
{
    for (int i = 0; i < count; i++)
        if (faults[i].is) return shv_fail(error, SHV_BAD_INPUT, faults[i].format, setting->name, setting->plane->name);
    return SHV_OK;
}

static ShvStatus start_bounce(ShvClosedForm *form, const Setting *setting, ShvError *error)
{
    const ShvVec3 n = setting->normal, velocity = form->start.velocity;
    double aside;
    form->height = gap_of(setting, &form->start, &aside);
    form->direction = n;
    form->speed = shv_dot(n, velocity);
    form->pull = -shv_dot(n, form->gravity);
    form->restitution = setting->plane->restitution;
    const Fault faults[] = {
        {!(form->pull > 0.0) || shv_norm(shv_cross(n, form->gravity)) > nearly * form->pull,
         "a bounce of '%s' needs gravity straight on to '%s'"},
        {form->height < 0.0, "a bounce of '%s' must begin above '%s'"},
        {shv_norm(shv_cross(n, velocity)) > nearly * shv_norm(velocity) || shv_norm(form->start.angular_velocity) > 0.0,
         "a bounce is straight: give '%s' no velocity along '%s' and no spin"},
        {aside > nearly * setting->body->radius,
         "'%s' would begin to turn on '%s': its lowest point is beside the vertical through its centre"}};
    return refuse(setting, faults, 4, error);
}

static ShvStatus must_touch(const ShvClosedForm *form, const Setting *setting, ShvError *error)
{
    double aside;
    const double gap = gap_of(setting, &form->start, &aside);
    if (fabs(gap) <= 1e-4 * setting->body->radius && shv_dot(setting->normal, form->gravity) < 0.0) return SHV_OK;
    return shv_fail(error, SHV_BAD_INPUT,
                    "this law needs '%s' on '%s' from the start, pressed by gravity; the gap is %.3g m", setting->name,
                    setting->plane->name, gap);
}

/* Sliding, and the rolling of a sphere: what moves a body along its plane must lie in one line: velocity, gravity, and for a ball
   the slip. */
static ShvStatus start_along(ShvClosedForm *form, const Setting *setting, ShvError *error)
{
    const ShvObstacleDefinition *plane = setting->plane, *own = setting->own;
    const ShvVec3 n = setting->normal, spin = form->start.angular_velocity, velocity = form->start.velocity;
    const ShvVec3 along = shv_madd(form->gravity, -shv_dot(form->gravity, n), n);
    const bool rolls = form->law == SHV_REFERENCE_ROLL, round = own && own->shape == SHV_OBSTACLE_SPHERE;
    const bool steep = shv_norm(along) > nearly * shv_norm(form->gravity);
    SHV_TRY(refuse(setting,
                   &(Fault){rolls && !round, "'%s' is not round enough to roll on '%s': give a sphere with mass"}, 1,
                   error));
    SHV_TRY(must_touch(form, setting, error));
    /* Against an object the plane's own friction holds, between obstacles the geometric mean. */
    form->friction = -shv_dot(form->gravity, n) * sqrt((own ? own->friction : plane->friction) * plane->friction);
    form->radius = rolls ? own->radius : 0.0;
    form->shape =
        rolls ? setting->body->inertia.m[0][0] / (setting->body->mass * form->radius * form->radius) : HUGE_VAL;
    /* Velocity of the rim at the top, against the centre: ω × r n. */
    const ShvVec3 rim = shv_scale(shv_cross(spin, n), form->radius);
    form->direction = shv_unit(steep ? along : shv_norm(velocity) > 0.0 ? velocity : rim);
    if (shv_norm(form->direction) == 0.0) form->direction = shv_unit(shv_cross(n, shv_vec3(n.y, n.z, -n.x)));
    form->speed = shv_dot(velocity, form->direction);
    form->pull = steep ? shv_dot(along, form->direction) : 0.0;
    form->axis = shv_cross(n, form->direction);
    form->rim_speed = shv_dot(rim, form->direction);
    const Fault faults[] = {
        {!rolls && shv_norm(spin) > 0.0, "'%s' slides on '%s' without turning: remove its angular_velocity"},
        {shv_norm(shv_cross(velocity, form->direction)) > nearly * shv_norm(velocity) ||
             shv_norm(shv_cross(rim, form->direction)) > nearly * shv_norm(rim),
         "'%s' must move along the slope of '%s' or against it, in one straight line"},
        {rolls && fabs(shv_dot(n, spin)) > nearly * shv_norm(spin), "'%s' must not spin about the normal of '%s'"}};
    return refuse(setting, faults, 3, error);
}

ShvStatus shv_closed_form(ShvClosedForm *form, const ShvSceneDefinition *scene, const ShvSimulation *simulation,
                          const ShvBody *body, int32_t index, ShvError *error)
{
    const ShvFrameView *frame = shv_simulation_frame(simulation);
    const ShvObstacleDefinition *own = shv_body_obstacle(scene, frame->fragment_count, index);
    const int32_t object = own ? -1 : frame->fragments[index].object;
    Setting setting = {scene,  simulation, body,         own, own ? own->name : scene->objects[object].name,
                       object, NULL,       form->gravity};
    const ShvBodyState start = shv_body_state(scene, frame, frame->fragment_count, index);
    *form = (ShvClosedForm){.law = scene->reference.law, .start = start, .gravity = shv_load3(scene->gravity)};
    if (scene->event_count > 0 || scene->condition_count > 0)
        return shv_fail(
            error, SHV_BAD_INPUT,
            "the closed forms of `reference` know no events, supports or loads; remove them or `reference`");
    if (form->law == SHV_REFERENCE_FLIGHT) {
        form->top = shv_free_top(&body->inertia, start.orientation, start.angular_velocity);
    } else if (form->law == SHV_REFERENCE_REST) {
        if (shv_norm(start.velocity) + shv_norm(start.angular_velocity) > 0.0)
            return shv_fail(error, SHV_BAD_INPUT, "'%s' is to stay at rest, but it has a velocity at the start",
                            setting.name);
    } else {
        SHV_TRY(find_plane(&setting, error));
        return form->law == SHV_REFERENCE_BOUNCE ? start_bounce(form, &setting, error)
                                                 : start_along(form, &setting, error);
    }
    return SHV_OK;
}

static void move(ShvBodyState *state, const ShvClosedForm *form, double distance, double speed)
{
    state->position = shv_madd(form->start.position, distance, form->direction);
    state->velocity = shv_scale(form->direction, speed);
}

ShvBodyState shv_closed_form_at(ShvClosedForm *form, double time)
{
    ShvBodyState state = form->start;
    if (form->law == SHV_REFERENCE_FLIGHT) {
        const ShvVec3 mean = shv_madd(form->start.velocity, 0.5 * time, form->gravity);
        state.position = shv_madd(form->start.position, time, mean);
        state.velocity = shv_madd(form->start.velocity, time, form->gravity);
        shv_free_top_at(&form->top, time, &state.orientation, &state.angular_velocity);
    } else if (form->law == SHV_REFERENCE_BOUNCE) {
        const ShvLineMotion line = shv_law_bounce(form->height, form->speed, form->pull, form->restitution, time);
        move(&state, form, line.position - form->height, line.velocity);
    } else if (form->law == SHV_REFERENCE_SLIDE || form->law == SHV_REFERENCE_ROLL) {
        const ShvRollMotion roll =
            shv_law_roll(form->speed, form->rim_speed, form->pull, form->friction, form->shape, time);
        move(&state, form, roll.centre.position, roll.centre.velocity);
        if (form->law == SHV_REFERENCE_SLIDE) return state;
        const ShvQuat turn = shv_quat_exponential(shv_scale(form->axis, roll.rim.position / form->radius));
        state.orientation = shv_quat_multiply(turn, form->start.orientation);
        state.angular_velocity = shv_scale(form->axis, roll.rim.velocity / form->radius);
    }
    return state;
}
