/* When, within a step, two moving bodies first touch: conservative advancement with rotation. Nothing tunnels. */
#ifndef BULLET_BRIDGE_IMPACT_TIME_H
#define BULLET_BRIDGE_IMPACT_TIME_H

#include <stdbool.h>
#include <stdint.h>

#include "shiver/status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A body's surface in body axes, made once and used for many steps; readable from several threads at once. */
typedef struct ShvImpactShape ShvImpactShape;

/* On failure *shape is NULL. `hulls` convex pieces: piece i has the points vertex_begin[i] … vertex_begin[i + 1] − 1, 3 doubles
   each, m, from the body's position (what ShvConvexPieces holds). */
ShvStatus shv_impact_hulls_create(ShvImpactShape **shape, const double *vertices, const int32_t *vertex_begin,
                                  int32_t hulls, ShvError *error);
/* The half-space normal · x ≤ offset; unit normal. */
ShvStatus shv_impact_plane_create(ShvImpactShape **shape, const double normal[3], double offset, ShvError *error);
ShvStatus shv_impact_sphere_create(ShvImpactShape **shape, double radius, ShvError *error);
ShvStatus shv_impact_box_create(ShvImpactShape **shape, const double half[3], ShvError *error);
/* A surface of triangles, 3 vertex indices each. What starts deep inside it, touching no triangle, touches nothing. */
ShvStatus shv_impact_mesh_create(ShvImpactShape **shape, const double *vertices, int32_t vertex_count,
                                 const int32_t *triangles, int32_t triangle_count, ShvError *error);
void shv_impact_shape_release(ShvImpactShape *shape); /* NULL is accepted */

/* Motion from time 0 on: a parabola, and a rotation about the position. */
typedef struct ShvImpactMotion {
    double position[3], velocity[3], acceleration[3]; /* m, m/s, m/s² */
    double orientation[4];                            /* unit quaternion w, x, y, z: body → world axes */
    double angular_velocity[3];                       /* rad/s, world: constant, unless there is `turn` */
    /* Orientation and angular velocity at a time of the step, or NULL. */
    void (*turn)(const void *data, double time, double orientation[4], double angular_velocity[3]);
    const void *data;
    double fastest;              /* with `turn`: bound of |ω| over the step, rad/s, */
    double angular_acceleration; /* and of |dω/dt|, rad/s² (free rotation: growth × fastest²) */
} ShvImpactMotion;

typedef struct ShvImpactBody {
    const ShvImpactShape *shape;
    ShvImpactMotion motion;
} ShvImpactBody;

typedef struct ShvImpactSettings {
    double step;      /* s: impacts in [0, step] */
    double tolerance; /* contact is a gap below this share of the smaller piece's size (and of 1e-3 of the larger's);
                         1e-9 … 0.01, 1e-6 is a good choice */
    double slowest;   /* m/s ≥ 0: contact that closes slower, or opens, is no impact (rest, sliding, rolling) */
} ShvImpactSettings;

typedef struct ShvImpact {
    double time;                /* s; 0 when bodies that touch at the start close at once */
    double normal[3];           /* unit, from the first body to the second */
    double first[3], second[3]; /* closest (or deepest) points of the two, world */
    double gap;     /* m at that time; negative: overlap there was at the start, or a slow approach before */
    double closing; /* m/s along the normal, > slowest */
    int32_t first_piece, second_piece; /* hull or triangle; 0 of others */
    int32_t evaluations;               /* gaps measured for all pairs of pieces: the cost */
} ShvImpact;

/* The first impact of two bodies, if *found. Let slop be the tolerance in metres. Apart at the start: the time is that of a
   gap between 0 and slop, so early by at most slop/closing and never late. Touching or overlapping at the start (gap
   ≤ slop): parting is no impact; pieces that go deeper than at the start by ½ slop impact, at time 0 when they close from
   the start on. Contact that closes no faster than `slowest` is passed over; the depth then allowed doubles from slop on, each
   time it is reached, and so it does for pieces that stay within it for 64 evaluations without touching. A piece
   that leaves a deep overlap and comes back between two evaluations is found at the old depth. A pair not settled by 4096
   evaluations counts as an impact at the time reached, whatever its closing: early, not missed. Of equal times the first
   pair found is taken. Two planes never meet. Bodies that turn by φ in the step cost about φ × size/gap evaluations
   while within each other's reach. */
ShvStatus shv_impact_time(const ShvImpactBody *first, const ShvImpactBody *second, const ShvImpactSettings *settings,
                          bool *found, ShvImpact *impact, ShvError *error);

#ifdef __cplusplus
}
#endif
#endif
