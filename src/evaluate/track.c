#include "evaluate/track.h"

/* Whether the body hit a plane between this row and the next; *time receives when, *place where along the normal. */
static bool impact_after(const ShvTrackRow *row, ShvVec3 normal, ShvVec3 gravity, double *time, double *place)
{
    const ShvBodyState *from = &row[0].state, *to = &row[1].state;
    const double step = row[1].time - row[0].time, g = shv_dot(gravity, normal);
    const double x0 = shv_dot(from->position, normal), x1 = shv_dot(to->position, normal);
    const double v0 = shv_dot(from->velocity, normal), v1 = shv_dot(to->velocity, normal);
    const double jump = v1 - v0 - g * step;
    if (jump <= 3.0 * fabs(g) * step || v0 + g * step >= 0.0 || v1 - g * step <= 0.0) return false;
    /* x0 + v0 τ + ½ g τ² = x1 − v1 (h − τ) + ½ g (h − τ)² */
    const double since = fmin(step, fmax(0.0, (x0 - x1 + v1 * step - 0.5 * g * step * step) / jump));
    *time = row->time + since;
    *place = x0 + (v0 + 0.5 * g * since) * since;
    return true;
}

int shv_track_impacts(const ShvTrack *track, ShvVec3 normal, ShvVec3 gravity, double *times, int most)
{
    int count = 0;
    double place;
    for (int32_t i = 0; i + 1 < track->count && count < most; i++)
        if (impact_after(&track->rows[i], normal, gravity, &times[count], &place)) count++;
    return count;
}

int shv_track_apices(const ShvTrack *track, ShvVec3 normal, ShvVec3 gravity, double *heights, int most)
{
    int count = 0;
    int32_t last = -1;
    double ground = 0.0, time, place;
    for (int32_t i = 0; i + 1 < track->count && count < most; i++) {
        if (!impact_after(&track->rows[i], normal, gravity, &time, &place)) continue;
        if (last < 0) {
            ground = place;
        } else {
            const ShvBodyState *middle = &track->rows[(last + i + 1) / 2].state;
            const double v = shv_dot(middle->velocity, normal);
            heights[count++] = shv_dot(middle->position, normal) + 0.5 * v * v / -shv_dot(gravity, normal) - ground;
        }
        last = i;
    }
    return count;
}

int shv_track_flips(const ShvTrack *track, const ShvMat3 *inertia, double *times, int most)
{
    double moments[3], before = 0.0;
    ShvMat3 axes;
    int count = 0;
    shv_symmetric_eigen(inertia, moments, &axes);
    const ShvVec3 middle = {axes.m[0][1], axes.m[1][1], axes.m[2][1]};
    for (int32_t i = 0; i < track->count && count < most; i++) {
        const ShvBodyState *state = &track->rows[i].state;
        const double spin = shv_dot(shv_rotate(state->orientation, middle), state->angular_velocity);
        const double whole = shv_norm(state->angular_velocity);
        /* Zero within round-off is no side to come from. */
        if (fabs(spin) <= 1e-12 * whole) continue;
        if (spin * before < 0.0) {
            const double step = track->rows[i].time - track->rows[i - 1].time;
            times[count++] = track->rows[i].time - step * spin / (spin - before);
        }
        before = spin;
    }
    return count;
}
