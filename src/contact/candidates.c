#include "contact/candidates.h"

enum { STEPS_BETWEEN_LOOKS = 16, STEPS_TO_LAST = 64 };

double shv_candidates_obstacle_speed(const ShvObstacle *obstacle)
{
    if (obstacle->motion == SHV_OBSTACLE_FIXED) return 0.0;
    return shv_norm(obstacle->velocity) + shv_norm(obstacle->angular_velocity) * obstacle->bounding_radius;
}

static double largest_obstacle_speed(const ShvObstacles *obstacles)
{
    double largest = 0.0;
    for (int32_t i = 0; i < obstacles->count; i++)
        largest = fmax(largest, shv_candidates_obstacle_speed(&obstacles->items[i]));
    return largest;
}

static double largest_node_speed(const ShvState *state, const int32_t *nodes, int32_t count)
{
    double largest = 0.0;
    for (int32_t k = 0; k < count; k++) {
        const ShvVec3 v = shv_load3(state->velocity + 3 * (int64_t)nodes[k]);
        const double squared = shv_dot(v, v);
        largest = squared > largest ? squared : largest;
    }
    return sqrt(largest);
}

static double diagonal(const ShvState *state, const int32_t *nodes, int32_t count)
{
    if (count == 0) return 0.0;
    ShvVec3 low = shv_state_position(state, nodes[0]), high = low;
    for (int32_t k = 1; k < count; k++) {
        const ShvVec3 x = shv_state_position(state, nodes[k]);
        low = shv_vec3(fmin(low.x, x.x), fmin(low.y, x.y), fmin(low.z, x.z));
        high = shv_vec3(fmax(high.x, x.x), fmax(high.y, x.y), fmax(high.z, x.z));
    }
    return shv_norm(shv_sub(high, low));
}

ShvStatus shv_candidates_grow(ShvMemory *memory, void **block, int32_t *capacity, int32_t count, size_t size,
                              ShvError *error)
{
    if (count < *capacity) return SHV_OK;
    const int32_t wanted = *capacity < 64 ? 128 : *capacity > INT32_MAX / 2 ? INT32_MAX : 2 * *capacity;
    void *grown = shv_reallocate(memory, SHV_PART_CONTACT, *block, (size_t)wanted, size);
    if (!grown || wanted == *capacity) return shv_fail_memory(error, "contact", (size_t)wanted * size);
    *block = grown;
    *capacity = wanted;
    return SHV_OK;
}

static ShvStatus choose(ShvNodeContact *contact, const ShvState *state, const ShvObstacles *obstacles,
                        const int32_t *nodes, int32_t count, ShvError *error)
{
    int32_t chosen = 0;
    for (int32_t i = 0; i < obstacles->count; i++) {
        contact->candidate_start[i] = chosen;
        for (int32_t k = 0; k < count; k++) {
            const ShvVec3 x = shv_state_position(state, nodes[k]);
            if (shv_obstacle_closest(&obstacles->items[i], x, contact->skin).gap >= contact->skin) continue;
            if (!(state->mass[nodes[k]] > 0.0)) continue;
            void *block = contact->candidates;
            SHV_TRY(shv_candidates_grow(contact->memory, &block, &contact->capacity, chosen, sizeof(int32_t), error));
            contact->candidates = block;
            contact->candidates[chosen++] = nodes[k];
        }
    }
    contact->candidate_start[obstacles->count] = chosen;
    return SHV_OK;
}

static void look(ShvNodeContact *contact, const ShvState *state, const int32_t *nodes, int32_t count)
{
    contact->node_speed = largest_node_speed(state, nodes, count);
    contact->since = 0;
}

ShvStatus shv_candidates_refresh(ShvNodeContact *contact, const ShvState *state, const ShvObstacles *obstacles,
                                 const int32_t *nodes, int32_t count, double step, double gravity, ShvError *error)
{
    const double others = largest_obstacle_speed(obstacles) + (STEPS_BETWEEN_LOOKS + 1) * step * gravity;
    const bool forced = contact->stale || contact->listed != count;
    if (!forced && ++contact->since >= STEPS_BETWEEN_LOOKS) look(contact, state, nodes, count);
    contact->moved += step * (2.0 * contact->node_speed + others);
    if (!forced && contact->moved <= 0.5 * contact->skin) return SHV_OK;
    look(contact, state, nodes, count);
    const double motion = step * (2.0 * contact->node_speed + others);
    contact->skin = fmax(2.0 * STEPS_TO_LAST * motion, 2e-3 * diagonal(state, nodes, count));
    contact->stale = true; /* until it is done */
    SHV_TRY(choose(contact, state, obstacles, nodes, count, error));
    contact->stale = false;
    contact->listed = count;
    contact->moved = motion;
    return SHV_OK;
}
