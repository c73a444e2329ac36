/* A step that stays on the springs of both components, as nearly all do: for the innermost loop of the sweeps (pull.c). */
#ifndef SHV_COHESIVE_SPRING_H
#define SHV_COHESIVE_SPRING_H

#include "cohesive/pair.h"

/* Share of the backward rule's excess that is added to the traction of the chord: the largest that takes no energy out of the
   spring, i.e. damping·(to − from) ≥ 0, and changes the traction by no more than k/2 × `room`, the way left on the
   spring. Both fade to nothing where the rule changes, so that the traction is continuous in what the neighbours do,
   and sweeps over them can settle. `square`: of the excess; `path`: excess·(to − from). */
static inline double shv_spring_damping(const ShvPairSpring *spring, double square, double path, double room)
{
    if (!(square > 0.0 && path > 0.0 && room > 0.0)) return 0.0;
    const double most = 0.5 * spring->stiffness * room;
    double share = spring->yield * square > path ? path / (spring->yield * square) : 1.0;
    if (share * share * square > most * most) share = most / sqrt(square);
    return share;
}

/* From an open pair to the opening `to` of the chord, ≥ 0. Whether the end lies on the spring; `damped`: damping traction. */
static inline bool shv_spring_normal(const ShvPair *pair, double to, double *traction, double *damped)
{
    const ShvPairSpring *spring = &pair->spring[SHV_NORMAL];
    const double from = pair->from, limit = spring->branch.limit;
    const double whole = spring->excess * (1.5 * (to - from) - pair->drift);
    const double room = to > from ? limit - from : to;
    *damped = whole * shv_spring_damping(spring, whole * whole, whole * (to - from), room);
    const double end = to - spring->yield * *damped;
    *traction = shv_larger(0.5 * spring->stiffness * (end + from) + *damped, 0.0);
    return to <= from || end <= limit;
}

/* From a pair that is closed: no work before zero. Whether the end lies on the spring. */
static inline bool shv_spring_opens(const ShvPair *pair, double free, double *traction)
{
    const ShvPairSpring *spring = &pair->spring[SHV_NORMAL];
    *traction = 0.0;
    if (!(free > 0.0)) return true;
    if (!(spring->stiffness > 0.0)) return false;
    const double a = 1.0 + 0.5 * pair->compliance * spring->stiffness, b = free + pair->from, p = free * pair->from;
    const double root = sqrt(b * b - 4.0 * a * p);
    const double to = b > 0.0 ? (b + root) / (2.0 * a) : 2.0 * p / (b - root);
    *traction = 0.5 * spring->stiffness * to * (to / (to - pair->from));
    return to <= spring->branch.limit;
}

/* Of an open pair that closes: all that is stored comes back over the path. */
static inline double shv_spring_closes(const ShvPair *pair, double free)
{
    const double from = pair->from, gap = from - free;
    const double stored = 0.5 * pair->spring[SHV_NORMAL].stiffness * from * from;
    const double root = sqrt(gap * gap + 4.0 * pair->compliance * stored);
    const double path = gap > 0.0 ? 0.5 * (gap + root) : 2.0 * pair->compliance * stored / (root - gap);
    return path > 0.0 ? stored / path : 0.0;
}

/* Of a pair that has opened before, to the opening `free` without traction. Whether its normal component stays on the spring. */
static inline bool shv_spring_stays(const ShvPair *pair, double free, double *traction, double *damped)
{
    const ShvPairSpring *spring = &pair->spring[SHV_NORMAL];
    *damped = 0.0;
    if (pair->from < 0.0) return shv_spring_opens(pair, free, traction);
    const double half = 0.5 * pair->compliance * spring->stiffness, to = (free - half * pair->from) * spring->share;
    if (to >= 0.0) return shv_spring_normal(pair, to, traction, damped);
    *traction = shv_spring_closes(pair, free);
    return true;
}

/* `sum`: of the openings in the plane at the start and without traction. Whether the end lies on the spring; `damped`: damping
   traction. */
static inline bool shv_spring_shear(const ShvPair *pair, const ShvPairSpring *spring, ShvVec3 sum, ShvVec3 *traction,
                                    ShvVec3 *damped)
{
    const double limit = spring->branch.limit, from = shv_smaller(pair->slip, limit);
    const ShvVec3 chord = shv_sub(shv_scale(sum, spring->share), pair->start), path = shv_sub(chord, pair->start);
    const ShvVec3 whole = shv_scale(shv_madd(shv_scale(pair->sideways, -1.0), 1.5, path), spring->excess);
    const double square = shv_dot(whole, whole);
    *damped = shv_scale(whole, shv_spring_damping(spring, square, shv_dot(whole, path), limit - from));
    const ShvVec3 end = shv_madd(chord, -spring->yield, *damped);
    *traction = shv_madd(*damped, 0.5 * spring->stiffness, shv_add(end, pair->start));
    return shv_dot(end, end) <= limit * limit;
}

/* shv_pair_traction of a pair that stays on both springs; whether it does. */
static inline bool shv_pair_stays(const ShvPair *pair, ShvVec3 free, ShvVec3 *traction)
{
    const ShvPairSpring *normal = &pair->spring[SHV_NORMAL], *shear = &pair->spring[SHV_SHEAR];
    const double open = shv_dot(free, pair->normal);
    double tension, damped;
    if (!(normal->branch.limit > 0.0) || !shv_spring_stays(pair, open, &tension, &damped)) return false;
    const double to = shv_larger(open - pair->compliance * tension, 0.0);
    if (!(to <= pair->still && shear->branch.limit > 0.0 && shear->branch.peak > 0.0)) return false;
    const ShvVec3 sum = shv_add(shv_madd(free, -open, pair->normal), pair->start);
    ShvVec3 along, held;
    if (!shv_spring_shear(pair, shear, sum, &along, &held)) return false;
    *traction = shv_madd(along, tension, pair->normal);
    return true;
}

#endif
