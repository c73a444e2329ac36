#include "evaluate/free_top.h"

static const double half_pi = 1.57079632679489661923;

/* ---- elliptic functions ---- */

enum { MEANS = 16 };

/* Arithmetic-geometric mean of 1 and √complement, with the terms on the way; returns their number. */
static int descend(double complement, double a[MEANS], double c[MEANS])
{
    int n = 0;
    double b = sqrt(complement);
    a[0] = 1.0;
    c[0] = sqrt(1.0 - complement);
    while (n + 1 < MEANS && fabs(c[n]) > 1e-16 * a[n]) {
        a[n + 1] = 0.5 * (a[n] + b);
        c[n + 1] = 0.5 * (a[n] - b);
        b = sqrt(a[n] * b);
        n++;
    }
    return n;
}

ShvElliptic shv_elliptic(double u, double complement)
{
    double a[MEANS], c[MEANS];
    const int count = descend(complement, a, c);
    double angle = ldexp(a[count] * u, count);
    for (int n = count; n > 0; n--) angle = 0.5 * (angle + asin(c[n] / a[n] * sin(angle)));
    const double sn = sin(angle), cn = cos(angle);
    /* dn² = 1 − m sn² = cn² + (1 − m) sn² */
    return (ShvElliptic){sn, cn, sqrt(cn * cn + complement * sn * sn)};
}

double shv_elliptic_quarter(double complement)
{
    double a[MEANS], c[MEANS];
    const int count = descend(complement, a, c);
    return half_pi / a[count];
}

/* Carlson's R_F(x, y, 1) by duplication, series to fifth order (Carlson 1979). */
static double carlson(double x, double y)
{
    double z = 1.0, mean = 0.0, dx = 1.0, dy = 1.0, dz = 1.0;
    while (fmax(fabs(dx), fmax(fabs(dy), fabs(dz))) > 1e-3) {
        const double lambda = sqrt(x * y) + sqrt(y * z) + sqrt(z * x);
        x = 0.25 * (x + lambda);
        y = 0.25 * (y + lambda);
        z = 0.25 * (z + lambda);
        mean = (x + y + z) / 3.0;
        dx = (mean - x) / mean;
        dy = (mean - y) / mean;
        dz = (mean - z) / mean;
    }
    const double second = dx * dy - dz * dz, third = dx * dy * dz;
    return (1.0 + (second / 24.0 - 0.1 - 3.0 * third / 44.0) * second + third / 14.0) / sqrt(mean);
}

double shv_elliptic_integral(double angle, double complement)
{
    const double halves = round(angle / (2.0 * half_pi)), rest = angle - 2.0 * half_pi * halves;
    const double s = sin(rest), c = cos(rest);
    const double part = s * carlson(c * c, c * c + complement * s * s);
    return halves != 0.0 ? 2.0 * halves * shv_elliptic_quarter(complement) + part : part;
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
