#include "base/deterministic.h"

#include <math.h>
#include <stdint.h>

/* An unevaluated sum hi + lo with |lo| at most about half a unit in the last place of hi. */
typedef struct Pair {
    double hi, lo;
} Pair;

static const double half_pi_high = 0x1.921fb54442d18p+0; /* π/2 in three parts of 53 bits */
static const double half_pi_middle = 0x1.1a62633145c07p-54;
static const double half_pi_low = -0x1.f1976b7ed8fbcp-110;
static const double two_over_pi = 0x1.45f306dc9c883p-1;
static const double ln2 = 0x1.62e42fefa39efp-1;
static const double ln2_rest = 0x1.abc9e3b39803fp-56;
static const double ln2_short = 0x1.62e42fee00000p-1; /* 32 bits: products with an exponent are exact */
static const double ln2_short_rest = 0x1.a39ef35793c76p-33;
static const double third = 0x1.5555555555555p-2;
static const double third_rest = 0x1.5555555555555p-56;

/* Exact sum (Knuth, TAOCP 2, 4.2.2). */
static Pair two_sum(double a, double b)
{
    const double s = a + b, t = s - a;
    return (Pair){s, (a - (s - t)) + (b - t)};
}

/* Σ c[i] xⁱ by Horner's rule. */
static double polynomial(const double *c, int n, double x)
{
    double p = c[n - 1];
    for (int i = n - 2; i >= 0; i--) p = fma(p, x, c[i]);
    return p;
}

/* exp(hi + lo): 2^k exp(r) with |r| ≤ ln 2 / 2, exp(r) = 1 + r + r² P(r). Taylor's rest beyond r¹³ is below 5e-18. */
static double exp_of_pair(double hi, double lo)
{
    static const double c[] = {1.0 / 2.0,     1.0 / 6.0,      1.0 / 24.0,      1.0 / 120.0,
                               1.0 / 720.0,   1.0 / 5040.0,   1.0 / 40320.0,   1.0 / 362880.0,
                               1.0 / 3628800, 1.0 / 39916800, 1.0 / 479001600, 1.0 / 6227020800};
    if (hi > 800.0) return (double)INFINITY;
    if (hi < -800.0) return 0.0;
    if (isnan(hi)) return hi;
    const double k = floor(fma(hi, 1.0 / ln2, 0.5));
    const double r = fma(-k, ln2, hi);
    const double small = fma(-k, ln2_rest, lo);
    const double curve = r * r * polynomial(c, 12, r);
    return ldexp(1.0 + (r + fma(small, 1.0 + (r + curve), curve)), (int)k);
}

/* Natural logarithm of a positive finite x as a pair, relative error near 1e-19: x = 2^e m with m near 1,
   log m = 2 atanh f = 2 f (1 + f²/3 + f⁴/5 + …), f = (m−1)/(m+1), |f| ≤ 0.172. The first two terms carry a second
   word, so that powers with large exponents stay accurate; the rest beyond f²² is below 2e-20. */
static Pair log_pair(double x)
{
    static const double c[] = {1.0 / 5.0,  1.0 / 7.0,  1.0 / 9.0,  1.0 / 11.0, 1.0 / 13.0,
                               1.0 / 15.0, 1.0 / 17.0, 1.0 / 19.0, 1.0 / 21.0, 1.0 / 23.0};
    int e;
    double m = frexp(x, &e);
    if (m < 0.70710678118654752) {
        m *= 2.0;
        e -= 1;
    }
    const Pair d = two_sum(m, 1.0);
    const double f = (m - 1.0) / d.hi;
    const double f_rest = (fma(-f, d.hi, m - 1.0) - f * d.lo) / d.hi;
    const double p = f * f, p_rest = fma(f, f, -p) + 2.0 * f * f_rest;
    Pair q = two_sum(third, p * polynomial(c, 10, p));
    q.lo += third_rest;
    const double g = p * q.hi, g_rest = fma(p, q.hi, -g) + (p * q.lo + p_rest * q.hi);
    const double h = f * g, h_rest = fma(f, g, -h) + (f * g_rest + f_rest * g);
    const Pair series = two_sum(f, h);
    const double series_rest = series.lo + (f_rest + h_rest);
    const Pair sum = two_sum((double)e * ln2_short, 2.0 * series.hi);
    const double rest = sum.lo + fma((double)e, ln2_short_rest, 2.0 * series_rest);
    const double hi = sum.hi + rest;
    return (Pair){hi, (sum.hi - hi) + rest};
}

double shv_exp(double x)
{
    return exp_of_pair(x, 0.0);
}

double shv_log(double x)
{
    if (x == 0.0) return -(double)INFINITY;
    if (x < 0.0) return (double)NAN;
    if (!isfinite(x)) return x;
    return log_pair(x).hi;
}

/* x^(twice/2) by multiplication: at most six roundings for twice ≤ 16. */
static double power_of_halves(double x, int twice)
{
    double result = (twice & 1) ? sqrt(x) : 1.0;
    for (int n = twice / 2; n > 0; n /= 2) {
        if (n & 1) result *= x;
        x *= x;
    }
    return result;
}

double shv_power(double x, double a)
{
    if (a == 0.0 || x == 1.0) return 1.0;
    if (isnan(x) || isnan(a) || x < 0.0) return (double)NAN;
    if (x == 0.0 || isinf(x)) return (x == 0.0) == (a > 0.0) ? 0.0 : (double)INFINITY;
    if (a > 0.0 && a <= 8.0 && 2.0 * a == floor(2.0 * a)) return power_of_halves(x, (int)(2.0 * a));
    const Pair l = log_pair(x);
    const double hi = a * l.hi;
    if (!(fabs(hi) < 800.0)) return exp_of_pair(hi, 0.0);
    return exp_of_pair(hi, fma(a, l.hi, -hi) + a * l.lo);
}

double shv_cube_root(double x)
{
    int exponent;
    const double significand = frexp(x, &exponent);
    const int thirds = (int)floor(exponent / 3.0);
    return ldexp(shv_power(ldexp(significand, exponent - 3 * thirds), 1.0 / 3.0), thirds);
}

/* x − n π/2 for x ≥ 0 as a pair, |result| ≤ π/4, and n mod 4 (Cody and Waite in three parts). The first step is
   exact for n < 2^40: x and n times the high part are multiples of 2^-53 (or x < π/4 and n = 0). */
static Pair reduce(double x, int *quadrant)
{
    const double n = floor(fma(x, two_over_pi, 0.5));
    *quadrant = (int)((int64_t)n & 3);
    const double r = fma(-n, half_pi_high, x);
    const double w = n * half_pi_middle;
    const double w_rest = fma(n, half_pi_middle, -w) + n * half_pi_low;
    const Pair s = two_sum(r, -w);
    const double hi = s.hi + (s.lo - w_rest);
    return (Pair){hi, (s.hi - hi) + (s.lo - w_rest)};
}

/* Taylor series on |r| ≤ π/4; the rests beyond r¹⁷ and r¹⁸ are below 1e-19. */
static double sine_of(Pair r)
{
    static const double c[] = {-1.0 / 6.0,      1.0 / 120.0,      -1.0 / 5040.0,       1.0 / 362880.0,
                               -1.0 / 39916800, 1.0 / 6227020800, -1.0 / 1307674368e3, 1.0 / 355687428096e3};
    const double z = r.hi * r.hi;
    return r.hi + fma(r.hi * z, polynomial(c, 8, z), r.lo * (1.0 - 0.5 * z));
}

static double cosine_of(Pair r)
{
    static const double c[] = {1.0 / 24.0,        -1.0 / 720.0,         1.0 / 40320.0,          -1.0 / 3628800.0,
                               1.0 / 479001600.0, -1.0 / 87178291200.0, 1.0 / 20922789888000.0, -1.0 / 6402373705728e3};
    const double z = r.hi * r.hi;
    const Pair s = two_sum(1.0, -0.5 * z);
    return s.hi + (s.lo + fma(z * z, polynomial(c, 8, z), -r.hi * r.lo - 0.5 * fma(r.hi, r.hi, -z)));
}

/* sin of quadrants + r. */
static double sine_in_quadrant(Pair r, int quadrant)
{
    const double s = (quadrant & 1) ? cosine_of(r) : sine_of(r);
    return (quadrant & 2) ? -s : s;
}

static const double largest_angle = 0x1p40;

double shv_sin(double x)
{
    if (x == 0.0) return x;
    if (!(fabs(x) <= largest_angle)) return (double)NAN;
    int quadrant;
    const Pair r = reduce(fabs(x), &quadrant);
    const double s = sine_in_quadrant(r, quadrant);
    return x < 0.0 ? -s : s;
}

double shv_cos(double x)
{
    if (!(fabs(x) <= largest_angle)) return (double)NAN;
    int quadrant;
    const Pair r = reduce(fabs(x), &quadrant);
    return sine_in_quadrant(r, quadrant + 1);
}

/* (asin √z)/√z − 1 for z ≤ 1/4: Taylor series Σ (2n)!/(4ⁿ n!² (2n+1)) zⁿ from n = 1; its rest is below 1e-18. */
static double arc_sine_excess(double z)
{
    static const double c[] = {
        0.16666666666666666,   0.074999999999999997,  0.044642857142857144,  0.030381944444444444,
        0.022372159090909092,  0.017352764423076924,  0.013964843750000001,  0.011551800896139705,
        0.0097616095291940784, 0.0083903358096168151, 0.0073125258735988454, 0.0064472103118896487,
        0.0057400376708419236, 0.0051533096823199046, 0.0046601434869150962, 0.0042409070936793632,
        0.0038809645588376691, 0.0035692053938259347, 0.0032970595034734849, 0.0030578216492580306,
        0.0028461784011089421, 0.0026578706382072901, 0.0024894486782468836, 0.002338091892111975,
        0.0022014739737101384};
    return z * polynomial(c, 25, z);
}

double shv_acos(double x)
{
    if (!(fabs(x) <= 1.0)) return (double)NAN;
    if (fabs(x) <= 0.5) return half_pi_high - (x - (half_pi_middle - x * arc_sine_excess(x * x)));
    /* acos |x| = 2 asin √((1−|x|)/2), where 1−|x| is exact: full relative accuracy up to |x| = 1. */
    const double z = 0.5 * (1.0 - fabs(x)), s = sqrt(z);
    const double angle = 2.0 * fma(s, arc_sine_excess(z), s);
    return x > 0.0 ? angle : 2.0 * half_pi_high - (angle - 2.0 * half_pi_middle);
}
