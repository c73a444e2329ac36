/* The world of `rigid.engine: bullet`: a btDiscreteDynamicsWorld with these overrides.
     free flight      poses and velocities between contacts are the caller's: parabolas, free rotation in closed form
     swept boxes      bodies' boxes in Bullet's broadphase hold their ways in the step, as told
     exact contacts   the dispatcher asks for contacts on exact hulls, at moments that the caller chooses, and gets its manifolds
                      made of those; here impacts are judged, between detection and islands
     touching islands joined by contacts, not by boxes
     settled impulses Bullet's rows with the caller's target velocities, friction on the cone, mixed sweeps to a tolerance
     rest             what sleeps is the caller's
   Nothing here depends on the order in which bodies came, nor on earlier steps: pairs are sorted by the caller's numbers,
   contacts are found afresh, impulses to start from are the caller's. All lengths are metres; inside, lengths are scaled by a
   power of two. */
#ifndef BULLET_BRIDGE_RIGID_WORLD_H
#define BULLET_BRIDGE_RIGID_WORLD_H

#include <stdbool.h>
#include <stdint.h>

#include "shiver/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ShvBulletWorld ShvBulletWorld;

typedef enum ShvBulletKind {
    SHV_BULLET_PLANE,  /* half space below normal · x = offset, world; never moves */
    SHV_BULLET_SPHERE, /* about the body's origin */
    SHV_BULLET_HULLS,  /* convex hulls of vertices, each of positive volume */
    SHV_BULLET_TRIANGLES /* closed surface, outside where the corners run counter-clockwise; only for bodies without mass */
} ShvBulletKind;

/* Who is paired with whom. */
typedef enum ShvBulletLayer {
    SHV_BULLET_BODY,     /* with bodies and obstacles */
    SHV_BULLET_OBSTACLE, /* with all */
    SHV_BULLET_PARTICLE  /* with obstacles alone: as many as there are, they cost nothing to one another */
} ShvBulletLayer;

typedef struct ShvBulletShape {
    ShvBulletKind kind;
    ShvBulletLayer layer;
    double normal[3], offset;  /* plane */
    double radius;             /* sphere, m */
    int32_t hull_count;        /* hulls */
    const int32_t *hull_begin; /* hull_count + 1, into vertices */
    const double *vertices;    /* hulls, triangles: 3 a vertex, in the body's frame, m */
    int32_t triangle_count;    /* triangles */
    const int32_t *triangles;  /* 3 a triangle, into vertices */
    int32_t vertex_count;      /* triangles */
} ShvBulletShape;

typedef struct ShvBulletPair {
    int32_t first, second; /* bodies, first < second */
} ShvBulletPair;

/* A point where two bodies are near each other. collide fills the first part, the caller the second, solve the third. */
typedef struct ShvBulletContact {
    int32_t first, second;
    double arm_first[3], arm_second[3]; /* from the bodies' origins to the middle of the gap, world axes */
    double normal[3];                   /* unit, world, from the second to the first */
    double gap;                         /* m, negative inside */

    double target;     /* m/s: normal velocity of the first against the second that is left at least */
    double push;       /* m/s: speed with which an overlap is undone without leaving a velocity, ≥ 0 */
    double friction;   /* Coulomb's coefficient */
    double support[3]; /* m/s: velocity of a second body without mass at this point (a first: its opposite) */

    double normal_impulse;      /* N s on the first along the normal; in: to start from */
    double friction_impulse[3]; /* N s on the first; in: to start from */
} ShvBulletContact;

typedef struct ShvBulletMotion {
    int32_t body;            /* with mass */
    int32_t island;          /* out: the first motion of all that hang together */
    double velocity[3];      /* m/s; in: without the contacts, out: with them */
    double spin[3];          /* rad/s, world; likewise */
    double push[3], turn[3]; /* m/s, rad/s, out: undo overlaps over the step, leave no velocity */
} ShvBulletMotion;

/* What contacts a step has, and which bodies they move. */
typedef struct ShvBulletTask {
    ShvBulletMotion *motions;
    int32_t motion_count;
    ShvBulletContact
        *contacts; /* with bodies that are not among the motions these are fixed, moving with the support velocity */
    int32_t contact_count;
    double rest; /* m/s: sweeps that change no velocity by a small share of it are enough */
} ShvBulletTask;

/* Between Bullet's broadphase and its islands. The pairs may touch on their ways (by their boxes, and by the balls around them at
   each time, as all go evenly), in increasing order. */
typedef ShvStatus (*ShvBulletDetect)(void *data, const ShvBulletPair *pairs, int32_t count, ShvBulletTask *task,
                                     ShvError *error);

/* Of those above, what can be left out. */
typedef struct ShvBulletOverrides {
    bool exact_contacts, settled_impulses, touching_islands;
} ShvBulletOverrides;

/* An empty world. `length`: of a typical large body, m, > 0. On failure *world is NULL. */
ShvStatus shv_bullet_world_create(ShvBulletWorld **world, double length, const ShvBulletOverrides *overrides,
                                  ShvError *error);
void shv_bullet_world_destroy(ShvBulletWorld *world);

/* A new body under a number ≥ 0 that is free; axes of the body's frame are its principal axes. inverse_mass 0: moved by
   nobody but the caller, and never paired with others of its kind. An inverse moment may be 0. Refuses shapes without volume
   and hulls that cannot be made. On failure the world is as before. */
ShvStatus shv_bullet_world_add(ShvBulletWorld *world, int32_t body, const ShvBulletShape *shape, double inverse_mass,
                               const double inverse_moment[3], ShvError *error);
void shv_bullet_world_remove(ShvBulletWorld *world, int32_t body);

/* Pose: origin and axes of the body's frame (columns of the row major matrix) in the world. */
void shv_bullet_world_place(ShvBulletWorld *world, int32_t body, const double position[3], const double axes[9]);
/* Radius of the body about its origin, m; infinite for a plane. */
double shv_bullet_world_radius(const ShvBulletWorld *world, int32_t body);
/* What the pairs of a step are to reckon with, m: the body's origin goes a straight `way`, is off it by at most
   `drift`, and turning carries no point farther than `turn`. */
ShvStatus shv_bullet_world_reach(ShvBulletWorld *world, int32_t body, const double displacement[3], double drift,
                                 double turn, ShvError *error);
/* What a body that has been told a new way since the last step may meet on it, by boxes alone, in increasing order;
   valid until the next call. */
ShvStatus shv_bullet_world_near(ShvBulletWorld *world, int32_t body, const int32_t **others, int32_t *count,
                                ShvError *error);
/* Contacts of a pair whose gap is at most `reach` (at most four of each two convex parts), valid until the next call. */
ShvStatus shv_bullet_world_collide(ShvBulletWorld *world, int32_t first, int32_t second, double reach,
                                   ShvBulletContact **contacts, int32_t *count, ShvError *error);
/* One step: broadphase, detection, islands, impulses. What `detect` has put into its task has been answered when this returns. */
ShvStatus shv_bullet_world_step(ShvBulletWorld *world, double step, ShvBulletDetect detect, void *data,
                                ShvError *error);

#ifdef __cplusplus
}
#endif
#endif
