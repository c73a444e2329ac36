#include "mesh/outline.h"

#include <math.h>
#include <stddef.h>

#include "base/deterministic.h"

/* Cosine between stretches of a profile: turns of 30° and more are edges of the body. */
static const double sharp_cosine = 0.8660254037844387;

typedef struct Stretch {
    double r[2], z[2];
} Stretch;

static Stretch stretch_of(const ShvOutline *outline, int32_t i)
{
    const double *p = outline->profile + 2 * (int64_t)i,
                 *q = outline->profile + 2 * (int64_t)((i + 1) % outline->count);
    return (Stretch){{p[0], q[0]}, {p[1], q[1]}};
}

static bool is_axis(const Stretch *s)
{
    return s->r[0] == 0.0 && s->r[1] == 0.0;
}

static double length_of(const Stretch *s)
{
    return sqrt((s->r[1] - s->r[0]) * (s->r[1] - s->r[0]) + (s->z[1] - s->z[0]) * (s->z[1] - s->z[0]));
}

/* A frustum without its ends. */
static double area_of(const Stretch *s)
{
    return SHV_PI * (s->r[0] + s->r[1]) * length_of(s);
}

/* ---- places ---- */

ShvVec3 shv_outline_half(const ShvOutline *outline, ShvVec3 *middle)
{
    *middle = shv_vec3(0.0, 0.0, 0.0);
    if (!outline->profile) return shv_load3(outline->half);
    double most = 0.0, low = (double)INFINITY, high = -low;
    for (int32_t i = 0; i < outline->count; i++) {
        most = fmax(most, outline->profile[2 * i]);
        low = fmin(low, outline->profile[2 * i + 1]);
        high = fmax(high, outline->profile[2 * i + 1]);
    }
    middle->z = 0.5 * (low + high);
    return shv_vec3(most, most, 0.5 * (high - low));
}

/* Cosine between stretches below which they are opposite sides of a wall. */
static const double opposite_cosine = -0.5;

static bool are_opposite(const Stretch *a, const Stretch *b)
{
    const double dot = (a->r[1] - a->r[0]) * (b->r[1] - b->r[0]) + (a->z[1] - a->z[0]) * (b->z[1] - b->z[0]);
    return dot < opposite_cosine * length_of(a) * length_of(b);
}

/* The nearest place on the profile, sides of a wall opposite to `side` (may be NULL) left out, and its stretch; returns its distance. */
static double nearest(const ShvOutline *outline, double r, double z, const Stretch *side, double found[2],
                      Stretch *found_on)
{
    double least = (double)INFINITY;
    for (int32_t i = 0; i < outline->count; i++) {
        const Stretch s = stretch_of(outline, i);
        if (is_axis(&s) || (side && are_opposite(side, &s))) continue;
        const double dr = s.r[1] - s.r[0], dz = s.z[1] - s.z[0];
        const double along = ((r - s.r[0]) * dr + (z - s.z[0]) * dz) / (dr * dr + dz * dz);
        const double share = fmax(0.0, fmin(1.0, along)), x = s.r[0] + share * dr, y = s.z[0] + share * dz;
        const double distance = sqrt((r - x) * (r - x) + (z - y) * (z - y));
        if (distance >= least) continue;
        least = distance;
        found[0] = x;
        found[1] = y;
        *found_on = s;
    }
    return least;
}

/* On which a place of the surface lies. */
static Stretch stretch_at(const ShvOutline *outline, ShvVec3 x)
{
    double place[2];
    Stretch found = {{0.0, 0.0}, {0.0, 0.0}};
    nearest(outline, sqrt(x.x * x.x + x.y * x.y), x.z, NULL, place, &found);
    return found;
}

bool shv_outline_are_opposite(const ShvOutline *outline, ShvVec3 a, ShvVec3 b)
{
    if (!outline->profile) return false;
    const Stretch first = stretch_at(outline, a), second = stretch_at(outline, b);
    return are_opposite(&first, &second);
}

static bool is_inside(const ShvOutline *outline, double r, double z)
{
    bool inside = false;
    for (int32_t i = 0; i < outline->count; i++) {
        const Stretch s = stretch_of(outline, i);
        if ((s.z[0] > z) == (s.z[1] > z)) continue;
        if (r < s.r[0] + (z - s.z[0]) / (s.z[1] - s.z[0]) * (s.r[1] - s.r[0])) inside = !inside;
    }
    return inside;
}

double shv_outline_depth(const ShvOutline *outline, ShvVec3 x)
{
    if (outline->profile) {
        double found[2];
        Stretch on;
        const double r = sqrt(x.x * x.x + x.y * x.y), distance = nearest(outline, r, x.z, NULL, found, &on);
        return is_inside(outline, r, x.z) ? distance : -distance;
    }
    const double plane = fmin(outline->half[0] - fabs(x.x), outline->half[1] - fabs(x.y));
    return outline->half[2] > 0.0 ? fmin(plane, outline->half[2] - fabs(x.z)) : plane;
}

ShvVec3 shv_outline_keep(const ShvOutline *outline, uint8_t held, ShvVec3 old, ShvVec3 wanted)
{
    if (!outline->profile)
        return shv_vec3(held & 1 ? old.x : wanted.x, held & 2 ? old.y : wanted.y, held & 4 ? old.z : wanted.z);
    if (held == SHV_HELD_NOT) return wanted;
    const double r = sqrt(wanted.x * wanted.x + wanted.y * wanted.y);
    double place[2] = {sqrt(old.x * old.x + old.y * old.y), old.z}; /* of a ring: it moves along it */
    if (held == SHV_HELD_SURFACE) {
        Stretch side = stretch_at(outline, old), on;
        nearest(outline, r, wanted.z, &side, place, &on);
    }
    if (!(r > 0.0)) return shv_vec3(place[0], 0.0, place[1]);
    return shv_vec3(wanted.x * (place[0] / r), wanted.y * (place[0] / r), place[1]);
}

bool shv_outline_is_sharp(const ShvOutline *outline, int32_t corner)
{
    const Stretch before = stretch_of(outline, (corner + outline->count - 1) % outline->count);
    const Stretch after = stretch_of(outline, corner);
    if (outline->profile[2 * (int64_t)corner] == 0.0) return false;
    const double dot = (before.r[1] - before.r[0]) * (after.r[1] - after.r[0]) +
                       (before.z[1] - before.z[0]) * (after.z[1] - after.z[0]);
    return dot < sharp_cosine * length_of(&before) * length_of(&after);
}

/* ---- sizes ---- */

double shv_outline_area(const ShvOutline *outline)
{
    const double *h = outline->half;
    if (!outline->profile) return 8.0 * (h[0] * h[1] + h[1] * h[2] + h[2] * h[0]);
    double sum = 0.0;
    for (int32_t i = 0; i < outline->count; i++) {
        const Stretch s = stretch_of(outline, i);
        sum += area_of(&s);
    }
    return sum;
}

/* Of the frusta between the profile's stretches and the axis, with their signs. */
double shv_outline_volume(const ShvOutline *outline)
{
    const double *h = outline->half;
    if (!outline->profile) return 8.0 * h[0] * h[1] * h[2];
    double sum = 0.0;
    for (int32_t i = 0; i < outline->count; i++) {
        const Stretch s = stretch_of(outline, i);
        const double squares = s.r[0] * s.r[0] + s.r[0] * s.r[1] + s.r[1] * s.r[1];
        sum += 2.0 * SHV_PI / 6.0 * (s.z[1] - s.z[0]) * squares;
    }
    return fabs(sum);
}

/* ---- draws ---- */

static ShvVec3 draw_on_box(const ShvOutline *outline, const double draw[3], uint8_t *held)
{
    const double *h = outline->half;
    double rest = draw[0] * (h[1] * h[2] + h[2] * h[0] + h[0] * h[1]), x[3];
    int axis = 0;
    while (axis < 2 && rest > h[(axis + 1) % 3] * h[(axis + 2) % 3]) {
        rest -= h[(axis + 1) % 3] * h[(axis + 2) % 3];
        axis++;
    }
    /* Twice the second number: its first bit chooses between two faces. */
    const double twice = 2.0 * draw[1];
    x[axis] = twice < 1.0 ? -h[axis] : h[axis];
    x[(axis + 1) % 3] = (2.0 * (twice < 1.0 ? twice : twice - 1.0) - 1.0) * h[(axis + 1) % 3];
    x[(axis + 2) % 3] = (2.0 * draw[2] - 1.0) * h[(axis + 2) % 3];
    *held = (uint8_t)(1u << axis);
    return shv_load3(x);
}

ShvVec3 shv_outline_draw(const ShvOutline *outline, const double draw[3], uint8_t *held)
{
    if (!outline->profile) return draw_on_box(outline, draw, held);
    double rest = draw[0] * shv_outline_area(outline);
    Stretch s = stretch_of(outline, 0);
    for (int32_t i = 0; i < outline->count; i++) {
        const Stretch next = stretch_of(outline, i);
        if (!(area_of(&next) > 0.0)) continue;
        s = next;
        if (rest <= area_of(&s)) break;
        rest -= area_of(&s);
    }
    const double low = s.r[0] * s.r[0], high = s.r[1] * s.r[1], r = sqrt(low + draw[1] * (high - low));
    const double share = s.r[1] != s.r[0] ? (r - s.r[0]) / (s.r[1] - s.r[0]) : draw[1], angle = 2.0 * SHV_PI * draw[2];
    *held = SHV_HELD_SURFACE;
    return shv_vec3(r * shv_cos(angle), r * shv_sin(angle), s.z[0] + share * (s.z[1] - s.z[0]));
}
