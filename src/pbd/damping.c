#include "pbd/damping.h"

/* Moments below this share of the largest belong to round-off: nodes on a line to the last digits. */
static const double degenerate = 1e-26;
enum { MOST_REFINEMENTS = 4 };

typedef struct Frame {
    const ShvState *state;
    const int32_t *nodes;
    int32_t count;
    ShvVec3 origin; /* position of the first node: far from the origin no digits are lost */
    ShvVec3 mean;   /* of the positions, from there */
    ShvVec3 velocity;
    double mass;
    ShvMat3 axes;   /* principal, in columns */
    ShvVec3 middle; /* mean of the arms in these axes: round-off along the longest, which would weigh across it */
    double moment[3];
} Frame;

static ShvVec3 from_first(const Frame *frame, int32_t node)
{
    const ShvState *state = frame->state;
    const int64_t first = 3 * (int64_t)frame->nodes[0], k = 3 * (int64_t)node;
    return shv_add(shv_sub(shv_load3(state->reference + k), shv_load3(state->reference + first)),
                   shv_sub(shv_load3(state->displacement + k), shv_load3(state->displacement + first)));
}

static ShvVec3 arm_of(const Frame *frame, int32_t node)
{
    return shv_sub(from_first(frame, node), frame->mean);
}

static ShvVec3 velocity_of(const Frame *frame, int32_t node)
{
    return shv_sub(shv_load3(frame->state->velocity + 3 * (int64_t)node), frame->velocity);
}

/* Means are corrected by the mean of what is left, so that Σ m r and Σ m v vanish to the last digits. */
static void find_means(Frame *frame)
{
    for (int pass = 0; pass < 2; pass++) {
        ShvVec3 moment = {0.0, 0.0, 0.0}, momentum = {0.0, 0.0, 0.0};
        double mass = 0.0;
        for (int32_t i = 0; i < frame->count; i++) {
            const double m = frame->state->mass[frame->nodes[i]];
            mass += m;
            moment = shv_madd(moment, m, arm_of(frame, frame->nodes[i]));
            momentum = shv_madd(momentum, m, velocity_of(frame, frame->nodes[i]));
        }
        frame->mass = mass;
        const double inverse = mass > 0.0 ? 1.0 / mass : 0.0;
        frame->mean = shv_madd(frame->mean, inverse, moment);
        frame->velocity = shv_madd(frame->velocity, inverse, momentum);
    }
}

static ShvMat3 inertia_of(const Frame *frame)
{
    double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0, xz = 0.0, yz = 0.0;
    for (int32_t i = 0; i < frame->count; i++) {
        const double m = frame->state->mass[frame->nodes[i]];
        const ShvVec3 r = arm_of(frame, frame->nodes[i]);
        xx += m * (r.y * r.y + r.z * r.z);
        yy += m * (r.x * r.x + r.z * r.z);
        zz += m * (r.x * r.x + r.y * r.y);
        xy -= m * r.x * r.y;
        xz -= m * r.x * r.z;
        yz -= m * r.y * r.z;
    }
    return (ShvMat3){{{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}}};
}

/* In principal axes the arms of nearly collinear nodes keep their digits. */
static ShvVec3 principal_arm(const Frame *frame, int32_t node)
{
    return shv_sub(shv_apply_transposed(&frame->axes, arm_of(frame, node)), frame->middle);
}

/* Angular momentum, in principal axes, of what is left of the velocities beside a spin; the sum of magnitudes goes to
   `scale`. */
static ShvVec3 left_momentum(const Frame *frame, ShvVec3 spin, double *scale)
{
    ShvVec3 sum = {0.0, 0.0, 0.0};
    *scale = 0.0;
    for (int32_t i = 0; i < frame->count; i++) {
        const double m = frame->state->mass[frame->nodes[i]];
        const ShvVec3 r = principal_arm(frame, frame->nodes[i]);
        const ShvVec3 v = shv_apply_transposed(&frame->axes, velocity_of(frame, frame->nodes[i]));
        sum = shv_madd(sum, m, shv_cross(r, shv_sub(v, shv_cross(spin, r))));
        *scale += m * shv_norm(r) * shv_norm(v);
    }
    return sum;
}

static void find_moments(Frame *frame)
{
    double sum[3] = {0.0};
    ShvVec3 first = {0.0, 0.0, 0.0};
    for (int32_t i = 0; i < frame->count; i++) {
        const double m = frame->state->mass[frame->nodes[i]];
        const ShvVec3 r = principal_arm(frame, frame->nodes[i]);
        first = shv_madd(first, m, r);
        sum[0] += m * r.x * r.x;
        sum[1] += m * r.y * r.y;
        sum[2] += m * r.z * r.z;
    }
    if (frame->mass > 0.0) frame->middle = shv_scale(first, 1.0 / frame->mass);
    sum[0] = fmax(0.0, sum[0] - first.x * frame->middle.x);
    sum[1] = fmax(0.0, sum[1] - first.y * frame->middle.y);
    sum[2] = fmax(0.0, sum[2] - first.z * frame->middle.z);
    for (int i = 0; i < 3; i++) frame->moment[i] = sum[(i + 1) % 3] + sum[(i + 2) % 3];
}

static ShvVec3 spin_from(const Frame *frame, ShvVec3 momentum)
{
    const double least = degenerate * fmax(frame->moment[0], fmax(frame->moment[1], frame->moment[2]));
    return shv_vec3(frame->moment[0] > least ? momentum.x / frame->moment[0] : 0.0,
                    frame->moment[1] > least ? momentum.y / frame->moment[1] : 0.0,
                    frame->moment[2] > least ? momentum.z / frame->moment[2] : 0.0);
}

/* The principal axes are right to round-off only; repeating with the momentum that is left mends that. */
static ShvVec3 find_spin(const Frame *frame, ShvVec3 *momentum)
{
    double scale;
    ShvVec3 left = *momentum = left_momentum(frame, shv_vec3(0.0, 0.0, 0.0), &scale);
    ShvVec3 spin = spin_from(frame, left);
    for (int i = 0; i < MOST_REFINEMENTS; i++) {
        left = left_momentum(frame, spin, &scale);
        spin = shv_add(spin, spin_from(frame, left));
        if (shv_norm(left) <= 1e-15 * scale) break;
    }
    return spin;
}

static ShvRigidField find_field(Frame *frame, ShvVec3 *spin)
{
    find_means(frame);
    ShvRigidField field = {.mass = frame->mass,
                           .centre = shv_add(frame->origin, frame->mean),
                           .velocity = frame->velocity,
                           .inertia = inertia_of(frame)};
    double values[3];
    shv_symmetric_eigen(&field.inertia, values, &frame->axes);
    find_moments(frame);
    ShvVec3 momentum;
    *spin = find_spin(frame, &momentum);
    field.angular_velocity = shv_apply(&frame->axes, *spin);
    field.angular_momentum = shv_apply(&frame->axes, momentum);
    return field;
}

static Frame frame_of(const ShvState *state, const int32_t *nodes, int32_t count)
{
    return (Frame){.state = state,
                   .nodes = nodes,
                   .count = count,
                   .origin = count > 0 ? shv_state_position(state, nodes[0]) : shv_vec3(0.0, 0.0, 0.0)};
}

ShvRigidField shv_rigid_field(const ShvState *state, const int32_t *nodes, int32_t count)
{
    Frame frame = frame_of(state, nodes, count);
    ShvVec3 spin;
    return find_field(&frame, &spin);
}

double shv_damp_velocities(ShvState *state, const int32_t *nodes, int32_t count, double damping, ShvRigidField *field)
{
    Frame frame = frame_of(state, nodes, count);
    ShvVec3 spin;
    const ShvRigidField rigid = find_field(&frame, &spin);
    if (field) *field = rigid;
    if (damping == 0.0) return 0.0;
    double deviation = 0.0;
    for (int32_t i = 0; i < count; i++) {
        double *velocity = state->velocity + 3 * (int64_t)nodes[i];
        const ShvVec3 turning = shv_apply(&frame.axes, shv_cross(spin, principal_arm(&frame, nodes[i])));
        const ShvVec3 change = shv_sub(turning, velocity_of(&frame, nodes[i]));
        deviation += state->mass[nodes[i]] * shv_dot(change, change);
        shv_add_to3(velocity, shv_scale(change, damping));
    }
    /* The deviations are orthogonal to every rigid motion: energy falls from ½ Σ m d² to its (1 − k)² part. */
    return 0.5 * damping * (2.0 - damping) * deviation;
}
