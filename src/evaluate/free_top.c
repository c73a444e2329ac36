#include "evaluate/closed_form.h"

#include <string.h>

ShvFreeTop shv_free_top(const ShvMat3 *inertia, ShvQuat orientation, ShvVec3 spin)
{
    double I[3];
    ShvMat3 axes;
    ShvFreeTop top = {.time = 0.0};
    shv_symmetric_eigen(inertia, I, &axes);
    top.axes = shv_quat_from_matrix(&axes);
    top.pose = shv_quat_multiply(orientation, top.axes);
    shv_store3(top.spin, shv_rotate(shv_quat_conjugate(top.pose), spin));
    for (int i = 0; i < 3; i++) top.rate[i] = (I[(i + 1) % 3] - I[(i + 2) % 3]) / I[i];
    return top;
}

/* A step of at most 0.2/|ω|. The nearest pole is at least 1.57/|ω| away: what is left out of so many terms is below 1e-18. */
static void advance(ShvFreeTop *top, double step)
{
    enum { TERMS = 20 };
    double spin[TERMS][3], pose[TERMS][4];
    const ShvQuat start = top->pose;
    memcpy(spin[0], top->spin, sizeof spin[0]);
    memcpy(pose[0], (const double[]){start.w, start.x, start.y, start.z}, sizeof pose[0]);
    for (int n = 0; n + 1 < TERMS; n++) {
        double rate[3] = {0.0, 0.0, 0.0};
        ShvQuat turn = {0.0, 0.0, 0.0, 0.0};
        for (int k = 0; k <= n; k++) {
            const double *w = spin[n - k], *q = pose[k];
            for (int i = 0; i < 3; i++) rate[i] += spin[k][(i + 1) % 3] * w[(i + 2) % 3];
            const ShvQuat part = shv_quat_multiply((ShvQuat){q[0], q[1], q[2], q[3]}, (ShvQuat){0.0, w[0], w[1], w[2]});
            turn = (ShvQuat){turn.w + part.w, turn.x + part.x, turn.y + part.y, turn.z + part.z};
        }
        for (int i = 0; i < 3; i++) spin[n + 1][i] = top->rate[i] * rate[i] / (n + 1);
        const double half = 0.5 / (n + 1);
        memcpy(pose[n + 1], (const double[]){half * turn.w, half * turn.x, half * turn.y, half * turn.z}, sizeof *pose);
    }
    double turned[4] = {0.0, 0.0, 0.0, 0.0}, rates[3] = {0.0, 0.0, 0.0};
    for (int n = TERMS - 1; n >= 0; n--) { /* the smallest first: what rounds is the sum */
        for (int i = 0; i < 3; i++) rates[i] = spin[n][i] + step * rates[i];
        for (int i = 0; i < 4; i++) turned[i] = pose[n][i] + step * turned[i];
    }
    memcpy(top->spin, rates, sizeof rates);
    top->pose = shv_quat_unit((ShvQuat){turned[0], turned[1], turned[2], turned[3]});
}

void shv_free_top_at(ShvFreeTop *top, double time, ShvQuat *orientation, ShvVec3 *spin)
{
    while (top->time < time) {
        const double step = fmin(time - top->time, 0.2 / shv_norm(shv_load3(top->spin)));
        advance(top, step);
        top->time = top->time + step > top->time ? top->time + step : time;
    }
    *orientation = shv_quat_multiply(top->pose, shv_quat_conjugate(top->axes));
    *spin = shv_rotate(top->pose, shv_load3(top->spin));
}
