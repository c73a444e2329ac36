#include "fragment/fragment.h"
#include "fragment/free_rotation.h"

/* Sums over the nodes of one fragment in node order, relative to a centre of mass. */
typedef struct Sums {
    double mass;
    ShvVec3 shift;    /* mean displacement: the centre is the reference centre plus it */
    ShvVec3 velocity; /* mean */
    ShvMat3 moment;   /* Σ m x Xᵀ */
    ShvVec3 spin;     /* angular momentum about the centre */
} Sums;

static ShvVec3 reference_arm(const ShvFragment *fragment, const ShvState *state, int32_t node)
{
    return shv_sub(shv_load3(state->reference + 3 * (int64_t)node), fragment->reference_centre);
}

static void sum_means(Sums *sums, const ShvState *state, const int32_t *nodes, int32_t count)
{
    ShvVec3 displacement = shv_vec3(0.0, 0.0, 0.0), momentum = shv_vec3(0.0, 0.0, 0.0);
    for (int32_t i = 0; i < count; i++) {
        const double m = state->mass[nodes[i]];
        displacement = shv_madd(displacement, m, shv_load3(state->displacement + 3 * (int64_t)nodes[i]));
        momentum = shv_madd(momentum, m, shv_load3(state->velocity + 3 * (int64_t)nodes[i]));
        sums->mass += m;
    }
    const double inverse = sums->mass > 0.0 ? 1.0 / sums->mass : 0.0;
    sums->shift = shv_scale(displacement, inverse);
    sums->velocity = shv_scale(momentum, inverse);
}

static Sums sum_nodes(const ShvFragment *fragment, const ShvFragments *fragments, const ShvState *state)
{
    const int32_t *nodes = fragments->nodes + fragment->node_begin;
    Sums sums = {0};
    sum_means(&sums, state, nodes, fragment->node_count);
    for (int32_t i = 0; i < fragment->node_count; i++) {
        const int64_t k = 3 * (int64_t)nodes[i];
        const double m = state->mass[nodes[i]];
        const ShvVec3 before = reference_arm(fragment, state, nodes[i]);
        const ShvVec3 now = shv_add(before, shv_sub(shv_load3(state->displacement + k), sums.shift));
        const ShvVec3 relative = shv_sub(shv_load3(state->velocity + k), sums.velocity);
        sums.spin = shv_madd(sums.spin, m, shv_cross(now, relative));
        const double x[3] = {now.x, now.y, now.z}, y[3] = {before.x, before.y, before.z};
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) sums.moment.m[a][b] += m * x[a] * y[b];
    }
    return sums;
}

/* Cosine between opposite directions, where the arc between them is no longer well defined. */
static const double opposite = -0.999999;

/* The shortest rotation from one direction to another. */
static ShvQuat shortest_arc(ShvVec3 from, ShvVec3 to)
{
    const double cosine = shv_dot(from, to);
    if (cosine < opposite) {
        const ShvVec3 side = fabs(from.x) < 0.5 ? shv_vec3(1.0, 0.0, 0.0) : shv_vec3(0.0, 1.0, 0.0);
        const ShvVec3 axis = shv_unit(shv_cross(from, side));
        const ShvQuat half_turn = {0.0, axis.x, axis.y, axis.z};
        return shv_quat_multiply(shortest_arc(shv_rotate(half_turn, from), to), half_turn);
    }
    const ShvVec3 axis = shv_cross(from, to);
    return shv_quat_unit((ShvQuat){1.0 + cosine, axis.x, axis.y, axis.z});
}

static ShvQuat fit_orientation(const ShvFragment *fragment, const ShvFreeRotation *rotation, const ShvMat3 *moment)
{
    if (rotation->moment[2] <= 0.0) return fragment->orientation;
    if (rotation->moment[0] > 0.0) {
        const ShvMat3 best = shv_polar_rotation(moment);
        return shv_quat_from_matrix(&best);
    }
    const ShvVec3 line = shv_vec3(rotation->axes.m[0][0], rotation->axes.m[1][0], rotation->axes.m[2][0]);
    const ShvVec3 now = shv_unit(shv_apply(moment, line));
    if (shv_dot(now, now) == 0.0) return fragment->orientation;
    const ShvQuat turn = shortest_arc(shv_rotate(fragment->orientation, line), now);
    return shv_quat_unit(shv_quat_multiply(turn, fragment->orientation));
}

void shv_fragment_fit(ShvFragment *fragment, const ShvFragments *fragments, const ShvState *state)
{
    const Sums sums = sum_nodes(fragment, fragments, state);
    const ShvFreeRotation rotation = shv_free_rotation_make(&fragment->inertia);
    fragment->position = shv_add(fragment->reference_centre, sums.shift);
    fragment->velocity = sums.velocity;
    fragment->orientation = fit_orientation(fragment, &rotation, &sums.moment);
    fragment->angular_velocity = shv_free_rotation_velocity(&rotation, fragment->orientation, sums.spin);
}

void shv_fragment_scatter(const ShvFragment *fragment, const ShvFragments *fragments, ShvState *state)
{
    const int32_t *nodes = fragments->nodes + fragment->node_begin;
    const ShvVec3 shift = shv_sub(fragment->position, fragment->reference_centre);
    const ShvQuat q = fragment->orientation;
    const ShvVec3 axis = shv_vec3(q.x, q.y, q.z);
    for (int32_t i = 0; i < fragment->node_count; i++) {
        const int64_t k = 3 * (int64_t)nodes[i];
        const ShvVec3 arm = reference_arm(fragment, state, nodes[i]);
        /* (R − 1) arm, exactly zero without rotation */
        const ShvVec3 t = shv_scale(shv_cross(axis, arm), 2.0);
        const ShvVec3 turned = shv_madd(shv_cross(axis, t), q.w, t);
        shv_store3(state->displacement + k, shv_add(shift, turned));
        shv_store3(state->velocity + k,
                   shv_velocity_at(fragment->velocity, fragment->angular_velocity, shv_add(arm, turned)));
    }
}

/* Inertia about the centre of a fragment whose nodes are where they are. */
static ShvMat3 inertia_of_nodes(const ShvFragment *fragment, const ShvFragments *fragments, const ShvState *state)
{
    ShvMat3 inertia = {{{0}}};
    for (int32_t i = 0; i < fragment->node_count; i++) {
        const int32_t node = fragments->nodes[fragment->node_begin + i];
        const ShvVec3 arm = shv_sub(shv_state_position(state, node), fragment->position);
        const double x[3] = {arm.x, arm.y, arm.z}, square = shv_dot(arm, arm);
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++) inertia.m[a][b] += state->mass[node] * ((a == b ? square : 0.0) - x[a] * x[b]);
    }
    return inertia;
}

ShvVec3 shv_fragment_shape_position(const ShvFragment *fragment, const ShvState *state, int32_t node)
{
    if (!fragment->deformed)
        return shv_sub(shv_load3(state->reference + 3 * (int64_t)node), fragment->reference_centre);
    return shv_rotate(shv_quat_conjugate(fragment->rest_orientation),
                      shv_sub(shv_state_position(state, node), fragment->rest_position));
}

void shv_fragment_unfold(const ShvFragment *fragment, const ShvFragments *fragments, ShvState *state)
{
    const int32_t *nodes = fragments->nodes + fragment->node_begin;
    const ShvVec3 move = shv_sub(fragment->position, fragment->rest_position);
    const ShvVec3 rest_shift = shv_sub(fragment->rest_position, fragment->reference_centre);
    const ShvQuat q =
        shv_quat_unit(shv_quat_multiply(fragment->orientation, shv_quat_conjugate(fragment->rest_orientation)));
    const ShvVec3 axis = shv_vec3(q.x, q.y, q.z);
    for (int32_t i = 0; i < fragment->node_count; i++) {
        double *u = state->displacement + 3 * (int64_t)nodes[i];
        const ShvVec3 arm = shv_add(reference_arm(fragment, state, nodes[i]), shv_sub(shv_load3(u), rest_shift));
        const ShvVec3 t = shv_scale(shv_cross(axis, arm), 2.0); /* (R − 1) arm, as in scatter */
        shv_add_to3(u, shv_add(move, shv_madd(shv_cross(axis, t), q.w, t)));
    }
    const ShvMat3 rigid = shv_fragment_world_inertia(fragment), now = inertia_of_nodes(fragment, fragments, state);
    const ShvFreeRotation rotation = shv_free_rotation_make(&now);
    const ShvVec3 spin =
        shv_free_rotation_velocity(&rotation, shv_quat_identity(), shv_apply(&rigid, fragment->angular_velocity));
    for (int32_t i = 0; i < fragment->node_count; i++) {
        const ShvVec3 arm = shv_sub(shv_state_position(state, nodes[i]), fragment->position);
        shv_store3(state->velocity + 3 * (int64_t)nodes[i], shv_velocity_at(fragment->velocity, spin, arm));
    }
}

void shv_fragment_momentum(const ShvFragment *fragment, const ShvFragments *fragments, const ShvState *state,
                           ShvVec3 *momentum, ShvVec3 *angular_momentum, double *kinetic)
{
    const int32_t *nodes = fragments->nodes + fragment->node_begin;
    *momentum = *angular_momentum = shv_vec3(0.0, 0.0, 0.0);
    *kinetic = 0.0;
    for (int32_t i = 0; i < fragment->node_count; i++) {
        const ShvVec3 v = shv_load3(state->velocity + 3 * (int64_t)nodes[i]);
        const double m = state->mass[nodes[i]];
        *momentum = shv_madd(*momentum, m, v);
        *angular_momentum = shv_madd(*angular_momentum, m, shv_cross(shv_state_position(state, nodes[i]), v));
        *kinetic += 0.5 * m * shv_dot(v, v);
    }
}
