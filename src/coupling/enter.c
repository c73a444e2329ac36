/* Bodies that come into a running scene and leave it. Where they wait they are out of motion and contact: objects as put-away dust
   is, free obstacles far beyond everything, whence they are brought back at the beginning of every rigid interval. */
#include <string.h>

#include "coupling/hybrid.h"

/* m: beyond any scene, near enough that a millimetre is a number there. */
static const double far_away = 1e5;

/* ---- where obstacles wait ---- */

/* How far outside of all planes a direction leads, per metre; negative: into one. */
static double clearance(const ShvObstacles *obstacles, ShvVec3 direction)
{
    double least = HUGE_VAL;
    for (int32_t i = 0; i < obstacles->count; i++)
        if (obstacles->items[i].shape == SHV_OBSTACLE_PLANE)
            least = fmin(least, shv_dot(obstacles->items[i].normal, direction));
    return least;
}

static ShvVec3 find_clear_direction(const ShvObstacles *obstacles, double *best)
{
    ShvVec3 found = {0.0, 0.0, 0.0};
    *best = -HUGE_VAL;
    for (int k = 0; k < 27; k++) {
        const ShvVec3 direction = shv_unit(shv_vec3(k / 9 - 1, k / 3 % 3 - 1, k % 3 - 1));
        const double room = clearance(obstacles, direction);
        if (k == 13 || !(room > *best)) continue; /* 13: no direction */
        *best = room;
        found = direction;
    }
    return found;
}

static void hold(ShvObstacle *obstacle, ShvVec3 place)
{
    obstacle->position = place;
    obstacle->velocity = obstacle->angular_velocity = shv_vec3(0.0, 0.0, 0.0);
}

/* Of far_away, from one obstacle that waits to the next, so that they do not meet. */
static const double apart_while_waiting = 0.01;

void shv_hybrid_hold_waiting(ShvHybrid *hybrid)
{
    for (int32_t i = 0; i < hybrid->obstacles.count; i++)
        if (hybrid->waiting && hybrid->waiting[i])
            hold(&hybrid->obstacles.items[i],
                 shv_scale(hybrid->waiting_direction, far_away * (1.0 + apart_while_waiting * i)));
}

static ShvStatus reserve_waiting(ShvHybrid *hybrid, ShvError *error)
{
    const ShvSceneDefinition *scene = hybrid->scene;
    if (hybrid->waiting) return SHV_OK;
    double room;
    hybrid->waiting_direction = find_clear_direction(&hybrid->obstacles, &room);
    if (!(room >= 0.0))
        return shv_fail(error, SHV_BAD_INPUT, "planes close the scene on all sides: no obstacle can wait outside");
    hybrid->waiting = shv_allocate(hybrid->memory, SHV_PART_GENERAL, (size_t)scene->obstacle_count, 1);
    if (!hybrid->waiting) return shv_fail_memory(error, "obstacles that wait", (size_t)scene->obstacle_count);
    memset(hybrid->waiting, 0, (size_t)scene->obstacle_count);
    return SHV_OK;
}

ShvStatus shv_hybrid_let_wait(ShvHybrid *hybrid, ShvError *error)
{
    const ShvSceneDefinition *scene = hybrid->scene;
    int32_t count = 0;
    for (int32_t i = 0; i < scene->obstacle_count; i++) count += scene->obstacles[i].waits;
    if (count == 0) return SHV_OK;
    SHV_TRY(reserve_waiting(hybrid, error));
    for (int32_t i = 0; i < scene->obstacle_count; i++) hybrid->waiting[i] = scene->obstacles[i].waits;
    shv_hybrid_hold_waiting(hybrid);
    return SHV_OK;
}

bool shv_hybrid_waits(const ShvHybrid *hybrid, int32_t obstacle)
{
    return hybrid->waiting && hybrid->waiting[obstacle];
}

/* ---- works ---- */

static double weigh(const ShvHybrid *hybrid, double mass, ShvVec3 position)
{
    return -mass * shv_dot(shv_load3(hybrid->gravity), position);
}

static double obstacle_energy(const ShvHybrid *hybrid, const ShvObstacle *obstacle)
{
    return shv_obstacle_kinetic(obstacle) + weigh(hybrid, obstacle->mass, obstacle->position);
}

static void changed(ShvHybrid *hybrid)
{
    shv_surface_contact_invalidate(&hybrid->coupling.surface);
    hybrid->awake.stale = true;
}

/* ---- obstacles ---- */

static const double radians_a_degree = 0.017453292519943295; /* π/180 */

void shv_hybrid_place_obstacle(ShvObstacle *obstacle, const ShvPlacement *placement)
{
    const double radians = placement->rotation_degrees * radians_a_degree;
    obstacle->orientation = shv_quat_from_axis_angle(shv_load3(placement->rotation_axis), radians);
    obstacle->position = shv_add(shv_load3(placement->position), shv_rotate(obstacle->orientation, obstacle->centre));
    obstacle->velocity = shv_load3(placement->velocity);
    obstacle->angular_velocity = shv_load3(placement->angular_velocity);
}

void shv_hybrid_enter_obstacle(ShvHybrid *hybrid, int32_t index, const ShvPlacement *placement)
{
    ShvObstacle *obstacle = &hybrid->obstacles.items[index];
    shv_hybrid_place_obstacle(obstacle, placement);
    hybrid->waiting[index] = 0;
    hybrid->observer.ledger.booked[SHV_WORK_EVENT] += obstacle_energy(hybrid, obstacle);
    changed(hybrid);
}

ShvStatus shv_hybrid_leave_obstacle(ShvHybrid *hybrid, int32_t index, ShvError *error)
{
    SHV_TRY(reserve_waiting(hybrid, error));
    hybrid->observer.ledger.booked[SHV_WORK_EVENT] -= obstacle_energy(hybrid, &hybrid->obstacles.items[index]);
    hybrid->waiting[index] = 1;
    shv_hybrid_hold_waiting(hybrid);
    changed(hybrid);
    return SHV_OK;
}

/* ---- objects ---- */

/* Its nodes' places in the reference mesh hold the placement of the scene, from which it is turned and moved to the new one. */
void shv_hybrid_place(const ShvHybrid *hybrid, ShvFragment *fragment, const ShvPlacement *placement)
{
    const ShvPlacement *start = &hybrid->scene->objects[fragment->object].placement;
    const ShvQuat first =
        shv_quat_from_axis_angle(shv_load3(start->rotation_axis), start->rotation_degrees * radians_a_degree);
    const ShvQuat wanted =
        shv_quat_from_axis_angle(shv_load3(placement->rotation_axis), placement->rotation_degrees * radians_a_degree);
    fragment->orientation = shv_quat_unit(shv_quat_multiply(wanted, shv_quat_conjugate(first)));
    const ShvVec3 arm = shv_sub(fragment->reference_centre, shv_load3(start->position));
    fragment->position = shv_add(shv_load3(placement->position), shv_rotate(fragment->orientation, arm));
    fragment->velocity = shv_load3(placement->velocity);
    fragment->angular_velocity = shv_load3(placement->angular_velocity);
}

ShvStatus shv_hybrid_enter_fragment(ShvHybrid *hybrid, int32_t index, const ShvPlacement *placement, ShvError *error)
{
    ShvFragment *fragment = &hybrid->fragments.items[index];
    const double before = weigh(hybrid, fragment->mass, fragment->position);
    const ShvFragment kept = *fragment;
    shv_hybrid_place(hybrid, fragment, placement);
    fragment->mode = SHV_MODE_FLIGHT;
    const ShvStatus status = hybrid->backend->functions->add(hybrid->backend, index, error);
    fragment = &hybrid->fragments.items[index];
    if (status != SHV_OK) {
        *fragment = kept;
        return status;
    }
    shv_fragment_scatter(fragment, &hybrid->fragments, &hybrid->state);
    hybrid->observer.ledger.booked[SHV_WORK_EVENT] += shv_hybrid_kinetic_in_flight(hybrid, fragment) +
                                                      fragment->strain +
                                                      weigh(hybrid, fragment->mass, fragment->position) - before;
    changed(hybrid);
    return SHV_OK;
}

void shv_hybrid_leave_fragment(ShvHybrid *hybrid, int32_t index)
{
    ShvFragment *fragment = &hybrid->fragments.items[index];
    hybrid->observer.ledger.booked[SHV_WORK_EVENT] -= shv_hybrid_kinetic_in_flight(hybrid, fragment) + fragment->strain;
    if (fragment->coupled) shv_coupled_bodies_remove(hybrid, index);
    hybrid->backend->functions->remove(hybrid->backend, index);
    fragment->velocity = fragment->angular_velocity = shv_vec3(0.0, 0.0, 0.0);
    fragment->mode = SHV_MODE_BINNED;
    changed(hybrid);
}
