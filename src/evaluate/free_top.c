#include "evaluate/closed_form.h"

static const double pi = 3.14159265358979323846;

/* ---- elliptic functions ---- */

enum { MEANS = 16 };

/* Arithmetic-geometric mean of 1 and √complement: the steps to it, and their number (Abramowitz and Stegun 16.4, 17.6). */
typedef struct Means {
    double a[MEANS], b[MEANS], c[MEANS];
    int last;
} Means;

static Means means_of(double complement)
{
    Means means = {.a = {1.0}, .b = {sqrt(complement)}, .c = {sqrt(1.0 - complement)}};
    int n = 0;
    while (n + 1 < MEANS && fabs(means.c[n]) > 1e-16 * means.a[n]) {
        means.a[n + 1] = 0.5 * (means.a[n] + means.b[n]);
        means.c[n + 1] = 0.5 * (means.a[n] - means.b[n]);
        means.b[n + 1] = sqrt(means.a[n] * means.b[n]);
        n++;
    }
    means.last = n;
    return means;
}

ShvElliptic shv_elliptic(double u, double complement)
{
    const Means means = means_of(complement);
    double angle = ldexp(means.a[means.last] * u, means.last);
    for (int n = means.last; n > 0; n--) angle = 0.5 * (angle + asin(means.c[n] / means.a[n] * sin(angle)));
    const double sn = sin(angle), cn = cos(angle);
    /* dn² = 1 − m sn² = cn² + (1 − m) sn² */
    return (ShvElliptic){sn, cn, sqrt(cn * cn + complement * sn * sn)};
}

double shv_elliptic_quarter(double complement)
{
    const Means means = means_of(complement);
    return 0.5 * pi / means.a[means.last];
}

double shv_elliptic_integral(double angle, double complement)
{
    const Means means = means_of(complement);
    for (int n = 0; n < means.last; n++) {
        /* tan(next − angle) = b/a tan(angle), in the same half turn */
        const double more = atan2(means.b[n] * sin(angle), means.a[n] * cos(angle));
        angle += more + 2.0 * pi * round((angle - more) / (2.0 * pi));
    }
    return ldexp(angle, -means.last) / means.a[means.last];
}

/* ---- the top ---- */

/* (I_x − I_y) I_z ω_z², the pieces of which 2 E I − L² is made without cancellation. */
static double piece(const double moment[3], const double spin[3], int x, int y, int z)
{
    return (moment[x] - moment[y]) * moment[z] * spin[z] * spin[z];
}

static double square(double x)
{
    return x * x;
}

/* The last axis c is the one that the angular momentum circles: the third where L² > 2 E I₂, else the first. With a the
   opposite axis and b = 1 the middle one,
       ω_a = A cn, ω_b = B sn, ω_c = C dn of p t + phase,  p = C √((I_c − I_b)(I_c − I_a)/(I_a I_b)),
       parameter m = (I_b − I_a)(2 E I_c − L²) / ((I_c − I_b)(L² − 2 E I_a))   (Landau and Lifshitz, Mechanics, § 37). */
static void solve(ShvFreeTop *top)
{
    const double *I = top->moment;
    const double spin[3] = {top->start_spin.x, top->start_spin.y, top->start_spin.z};
    const bool third = piece(I, spin, 2, 1, 2) >= piece(I, spin, 1, 0, 0);
    const int a = third ? 0 : 2, b = 1, c = third ? 2 : 0;
    const double energy_a = piece(I, spin, c, a, c) + piece(I, spin, b, a, b); /* L² − 2 E I_a */
    const double whole = (I[c] - I[b]) * energy_a;
    const bool alone = (spin[a] == 0.0) + (spin[b] == 0.0) + (spin[c] == 0.0) >= 2;
    top->first = a;
    top->last = c;
    top->steady = alone || whole == 0.0;
    if (top->steady) return;
    const double ratio = I[b] * (I[c] - I[b]) / (I[a] * (I[c] - I[a]));
    top->amplitude[a] = sqrt(square(spin[a]) + ratio * square(spin[b]));
    top->amplitude[b] = sqrt(square(spin[b]) + square(spin[a]) / ratio);
    top->amplitude[c] = copysign(sqrt(energy_a / (I[c] * (I[c] - I[a]))), spin[c]);
    /* 1 − m without cancellation; on the separatrix itself, where the period is infinite, a period of 50/p stands for it. */
    const double difference = (I[c] - I[a]) * (piece(I, spin, c, b, c) - piece(I, spin, b, a, a));
    top->complement = fmin(1.0, fmax(difference / whole, 1e-20));
    top->rate = top->amplitude[c] * sqrt((I[c] - I[b]) * (I[c] - I[a]) / (I[a] * I[b]));
    top->phase =
        shv_elliptic_integral(atan2(spin[b] / top->amplitude[b], spin[a] / top->amplitude[a]), top->complement);
}

ShvFreeTop shv_free_top(const ShvMat3 *inertia, ShvQuat orientation, ShvVec3 spin)
{
    ShvFreeTop top = {.start = orientation};
    shv_symmetric_eigen(inertia, top.moment, &top.axes);
    top.start_spin = shv_apply_transposed(&top.axes, shv_rotate(shv_quat_conjugate(orientation), spin));
    const double *I = top.moment;
    const ShvVec3 w = top.start_spin, L = {I[0] * w.x, I[1] * w.y, I[2] * w.z};
    top.momentum = shv_norm(L);
    top.twice_energy = shv_dot(L, w);
    solve(&top);
    return top;
}

ShvVec3 shv_free_top_spin(const ShvFreeTop *top, double time)
{
    if (top->steady) return top->start_spin;
    const ShvElliptic value = shv_elliptic(top->rate * time + top->phase, top->complement);
    double spin[3];
    spin[top->first] = top->amplitude[top->first] * value.cn;
    spin[1] = top->amplitude[1] * value.sn;
    spin[top->last] = top->amplitude[top->last] * value.dn;
    return shv_load3(spin);
}

/* Angular momentum in principal axes. */
static ShvVec3 momentum_at(const ShvFreeTop *top, double time)
{
    const ShvVec3 w = shv_free_top_spin(top, time);
    return shv_vec3(top->moment[0] * w.x, top->moment[1] * w.y, top->moment[2] * w.z);
}

static double part(ShvVec3 v, int axis)
{
    return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/* Rate at which the axis `first`, which never points along L, goes round it: L (2E − L_a²/I_a)/(L² − L_a²). */
static double precession(const ShvFreeTop *top, double time)
{
    const double along = part(momentum_at(top, time), top->first);
    return top->momentum * (top->twice_energy - along * along / top->moment[top->first]) /
           (top->momentum * top->momentum - along * along);
}

/* Gauss-Legendre with four points on pieces short against the elliptic functions, whose nearest pole is at least a quarter
   period 1.57/p away: error of a piece of 0.1/p below 1e-15 of the turn. */
static double turn_between(const ShvFreeTop *top, double from, double to)
{
    static const double point[2] = {0.33998104358485626, 0.86113631159405258};
    static const double weight[2] = {0.65214515486254614, 0.34785484513745386};
    const double pieces = fmax(1.0, ceil((to - from) * fabs(top->rate) / 0.1)), half = 0.5 * (to - from) / pieces;
    double turned = 0.0;
    for (double i = 0.0; i < pieces; i += 1.0) {
        const double middle = from + (2.0 * i + 1.0) * half;
        for (int k = 0; k < 2; k++)
            turned += half * weight[k] *
                      (precession(top, middle - half * point[k]) + precession(top, middle + half * point[k]));
    }
    return turned;
}

/* Body axes → axes whose third is along L and whose first lies towards the axis `first`. */
static ShvMat3 along_momentum(const ShvFreeTop *top, double time)
{
    const ShvVec3 z = shv_unit(momentum_at(top, time));
    const ShvVec3 axis = shv_vec3(top->first == 0, 0.0, top->first == 2);
    const ShvVec3 x = shv_unit(shv_madd(axis, -shv_dot(axis, z), z)), y = shv_cross(z, x);
    const ShvMat3 rows = {{{x.x, x.y, x.z}, {y.x, y.y, y.z}, {z.x, z.y, z.z}}};
    const ShvMat3 inverse = shv_transpose(&top->axes);
    return shv_multiply(&rows, &inverse);
}

void shv_free_top_at(ShvFreeTop *top, double time, ShvQuat *orientation, ShvVec3 *spin)
{
    if (top->steady) {
        const ShvVec3 body = shv_apply(&top->axes, top->start_spin);
        *orientation = shv_quat_multiply(top->start, shv_quat_exponential(shv_scale(body, time)));
        *spin = shv_rotate(*orientation, body);
        return;
    }
    top->turned += turn_between(top, top->time, time);
    top->time = time;
    const ShvMat3 start = along_momentum(top, 0.0), now = along_momentum(top, time);
    const ShvQuat to_start = shv_quat_conjugate(shv_quat_from_matrix(&start)), from_now = shv_quat_from_matrix(&now);
    const ShvQuat turn = shv_quat_exponential(shv_vec3(0.0, 0.0, top->turned));
    *orientation =
        shv_quat_unit(shv_quat_multiply(top->start, shv_quat_multiply(to_start, shv_quat_multiply(turn, from_now))));
    *spin = shv_rotate(*orientation, shv_apply(&top->axes, shv_free_top_spin(top, time)));
}
