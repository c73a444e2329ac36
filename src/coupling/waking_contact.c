/* The contact that woke a fragment. Nothing rests before that has carried its impulse or has opened: convex pieces, time of
   impact and the wake rule see it before nodes and facets do, and what is quiet then has not been hit yet. */
#include "coupling/hybrid.h"

/* Of the speed with which it closed: the contact has carried its impulse when both sides approach each other no faster. */
static const double left_share = 0.1;

/* Least distance of a fragment's nodes above a plane, m; 0 where one stands below. */
static double height_above(const ShvHybrid *hybrid, const ShvFragment *fragment, ShvVec3 point, ShvVec3 normal)
{
    double least = HUGE_VAL;
    for (int32_t k = 0; k < fragment->node_count; k++) {
        const int32_t node = hybrid->fragments.nodes[fragment->node_begin + k];
        const bool flies = fragment->mode == SHV_MODE_FLIGHT && !hybrid->backend->keeps_nodes;
        const ShvVec3 x =
            flies ? shv_add(fragment->position, shv_rotate(fragment->orientation,
                                                           shv_fragment_shape_position(fragment, &hybrid->state, node)))
                  : shv_state_position(&hybrid->state, node);
        least = fmin(least, shv_dot(shv_sub(x, point), normal));
    }
    return fmax(0.0, least);
}

/* How far nodes have yet to go to what convex pieces touch already: to the obstacle itself, or both sides' to the plane of contact. */
static double gap_of_nodes(const ShvHybrid *hybrid, const ShvFragment *fragment, const ShvRigidContact *contact)
{
    if (contact->obstacle < 0 && contact->other < 0) return 0.0; /* nodes have met: a coupled body wakes */
    if (contact->obstacle < 0) {
        const ShvFragment *other = &hybrid->fragments.items[contact->other];
        return height_above(hybrid, fragment, contact->point, contact->normal) +
               height_above(hybrid, other, contact->point, shv_scale(contact->normal, -1.0));
    }
    double least = HUGE_VAL;
    for (int32_t k = 0; k < fragment->node_count; k++) {
        const int32_t node = hybrid->fragments.nodes[fragment->node_begin + k];
        const ShvVec3 x = shv_state_position(&hybrid->state, node);
        least = fmin(least, shv_obstacle_closest(&hybrid->obstacles.items[contact->obstacle], x, HUGE_VAL).gap);
    }
    return fmax(0.0, least);
}

/* When nodes that close with a speed have met, s: weight may close a gap sooner than what little speed a body at rest has. */
static double time_to_meet(const ShvHybrid *hybrid, double gap, double speed)
{
    const double gravity = shv_norm(shv_load3(hybrid->gravity));
    return gap > 0.0 ? 2.0 * gap / (speed + sqrt(speed * speed + 2.0 * gravity * gap)) : 0.0;
}

/* Waits for nodes to meet no longer than vibration takes to decay: what creeps up on a gap is borne by convex pieces until then. */
void shv_waking_contact_begin(const ShvHybrid *hybrid, ShvFragment *fragment, const ShvRigidContact *contact)
{
    const double speed = contact->closing_speed;
    fragment->contact_obstacle = contact->obstacle;
    fragment->contact_other = contact->other;
    fragment->contact_speed = speed;
    fragment->contact_normal = contact->normal;
    fragment->contact_arm =
        shv_rotate(shv_quat_conjugate(fragment->orientation), shv_sub(contact->point, fragment->position));
    fragment->touched = fmax(hybrid->state.time, contact->expected);
    if (speed > 0.0)
        fragment->touched += fmin(time_to_meet(hybrid, gap_of_nodes(hybrid, fragment, contact), speed),
                                  shv_hybrid_longest(hybrid, fragment));
    fragment->last_insertion = fragment->touched;
}

static int32_t fragment_of(const ShvState *state, int32_t node)
{
    return state->element_fragment[state->corners[state->corner_start[node]] / 4];
}

/* Touches of other bodies or obstacles are not those of the contact that woke it. */
static void note(ShvHybrid *hybrid, int32_t fragment, int32_t obstacle, int32_t other, double impulse)
{
    ShvFragment *item = &hybrid->fragments.items[fragment];
    if (impulse > 0.0 && item->contact_obstacle == obstacle && item->contact_other == other)
        item->touched = hybrid->state.time;
}

void shv_waking_contact_follow(ShvHybrid *hybrid)
{
    const ShvState *state = &hybrid->state;
    for (int32_t k = 0; k < hybrid->stabiliser.relax.touch_count && hybrid->stabiliser.active; k++) {
        const ShvRelaxTouch *touch = &hybrid->stabiliser.relax.touches[k];
        note(hybrid, fragment_of(state, touch->node), touch->obstacle, -1, touch->normal_impulse);
    }
    for (int32_t k = 0; k < hybrid->coupling.surface.pair_count; k++) {
        const ShvFacetPair *pair = &hybrid->coupling.surface.pairs[k];
        if (pair->element < 0) {
            note(hybrid, pair->fragments[0], -1 - pair->element, -1, pair->normal_impulse);
            continue;
        }
        note(hybrid, pair->fragments[0], -1, pair->fragments[1], pair->normal_impulse);
        note(hybrid, pair->fragments[1], -1, pair->fragments[0], pair->normal_impulse);
    }
}

/* Of the other side at a point; false: it is no more. */
static bool other_velocity(const ShvHybrid *hybrid, const ShvFragment *fragment, ShvVec3 point, ShvVec3 *velocity)
{
    if (fragment->contact_obstacle >= 0) {
        *velocity = shv_obstacle_velocity(&hybrid->obstacles.items[fragment->contact_obstacle], point);
        return true;
    }
    if (fragment->contact_other < 0) return false;
    ShvFragment other = hybrid->fragments.items[fragment->contact_other];
    if (other.mode == SHV_MODE_DEAD) return false;
    if (other.mode == SHV_MODE_FRACTURE) shv_fragment_fit(&other, &hybrid->fragments, &hybrid->state);
    *velocity = shv_fragment_velocity(&other, point);
    return true;
}

/* Velocities as shv_hybrid_velocities_without_impulses leaves them. */
static double closing_speed(const ShvHybrid *hybrid, const ShvFragment *fragment)
{
    ShvFragment fitted = *fragment;
    ShvVec3 other;
    shv_fragment_fit(&fitted, &hybrid->fragments, &hybrid->state);
    const ShvVec3 point = shv_add(fitted.position, shv_rotate(fitted.orientation, fragment->contact_arm));
    if (!other_velocity(hybrid, fragment, point, &other)) return 0.0;
    return shv_dot(shv_sub(other, shv_fragment_velocity(&fitted, point)), fragment->contact_normal);
}

bool shv_waking_contact_is_over(const ShvHybrid *hybrid, const ShvFragment *fragment, double transit)
{
    if (hybrid->state.time > fragment->touched + transit || !(fragment->contact_speed > 0.0)) return true;
    return closing_speed(hybrid, fragment) <= left_share * fragment->contact_speed;
}
