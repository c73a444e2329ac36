#include "bullet_bridge/rigid_mixing.hpp"

// A change that is this nearly a sum of others tells nothing (of its own length); a residual so many times the smallest one
// (squared) means that contacts have opened or closed: what is known does not hold there.
static const btScalar dependent = 1e-3, astray = 100;

static btScalar product(const std::vector<btScalar> &a, const std::vector<btScalar> &b)
{
    btScalar sum = 0;
    for (size_t i = 0; i < a.size(); i++) sum += a[i] * b[i];
    return sum;
}

static void add(std::vector<btScalar> &sum, btScalar share, const std::vector<btScalar> &more)
{
    for (size_t i = 0; i < sum.size(); i++) sum[i] += share * more[i];
}

void ShvMixing::forget()
{
    known = oldest = 0;
    started = false;
    near = BT_LARGE_FLOAT;
}

void ShvMixing::begin()
{
    forget();
    least = -1;
}

// The residual; its square.
btScalar ShvMixing::measure(const Column &before, const Column &after)
{
    residual = after;
    add(residual, -1, before);
    const btScalar size = product(residual, residual);
    if (least >= 0 && size > least) return size;
    least = size;
    best_after = after;
    return size;
}

void ShvMixing::remember(const Column &after)
{
    if (started) {
        changes[oldest] = residual;
        add(changes[oldest], -1, last_residual);
        results[oldest] = after;
        add(results[oldest], -1, last_after);
        oldest = (oldest + 1) % most;
        if (known < most) known++;
    }
    last_residual = residual;
    last_after = after;
    started = true;
}

// Weights that take the most from the residual: least squares, by Gram and Schmidt.
void ShvMixing::choose()
{
    btScalar along[most];
    for (size_t k = 0; k < known; k++) {
        base[k] = changes[k];
        const btScalar length = btSqrt(product(base[k], base[k]));
        for (size_t i = 0; i < k; i++) upper[i][k] = 0;
        for (int twice = 0; twice < 2; twice++)
            for (size_t i = 0; i < k; i++) {
                const btScalar part = product(base[i], base[k]);
                upper[i][k] += part;
                add(base[k], -part, base[i]);
            }
        const btScalar left = btSqrt(product(base[k], base[k]));
        upper[k][k] = left > dependent * length ? left : 0;
        for (btScalar &value : base[k]) value = upper[k][k] > 0 ? value / left : 0;
        along[k] = product(base[k], residual);
    }
    for (size_t k = known; k-- > 0;) {
        weight[k] = along[k];
        for (size_t i = k + 1; i < known; i++) weight[k] -= upper[k][i] * weight[i];
        weight[k] = upper[k][k] > 0 ? weight[k] / upper[k][k] : 0;
    }
}

void ShvMixing::mix(const Column &before, Column &after)
{
    const btScalar size = measure(before, after);
    if (size > astray * near) forget();
    if (size < near) near = size;
    remember(after);
    choose();
    for (size_t k = 0; k < known; k++) add(after, -weight[k], results[k]);
}

const std::vector<btScalar> &ShvMixing::best(const Column &before, const Column &after)
{
    measure(before, after);
    return best_after;
}
