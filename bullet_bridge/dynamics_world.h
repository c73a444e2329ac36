/* Bullet as Bullet: a btDiscreteDynamicsWorld with its own broadphase, dispatcher, manifolds, islands, sleeping and solver. What
   departs from Bullet's defaults is an override, each with a name, each off unless asked for (docs/rigid_engines.md).
   Same calls, same bits: one thread, and nothing that depends on addresses. */
#ifndef BULLET_BRIDGE_DYNAMICS_WORLD_H
#define BULLET_BRIDGE_DYNAMICS_WORLD_H

#include <stdbool.h>

#include "bullet_bridge/rigid_world.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ShvDynamicsWorld ShvDynamicsWorld;

typedef struct ShvDynamicsSettings {
    double
        unit; /* m: what Bullet takes for 1; its thresholds (0.02 and 0.04 of length, 0.2 and 0.8 of speed) are of that */
    double margin;                /* round every hull, in those units */
    double friction, restitution; /* between two bodies neither of which is an obstacle */
    bool exact_flight;            /* no gyroscopic term: free rotation is the caller's, by shv_dynamics_world_correct */
    bool sharp_impacts; /* points of a rebounding pair that have a gap yet are left out, and overlaps undone by split
                                     impulses, however small: a rebound neither brakes before the touch nor gains from depth */
    bool sorted_pairs;  /* pairs in the order of the bodies' numbers, whatever happened before */
    bool keep_overlaps; /* that bodies have when one of them comes are let be, and shrink as they part */
} ShvDynamicsSettings;

typedef struct ShvDynamicsBody {
    ShvBulletShape shape;
    double inverse_mass,
        inverse_moment[3];        /* 1/kg, 1/(kg m²), principal; 0 of the mass: moved by its velocities alone */
    double friction, restitution; /* of an obstacle */
} ShvDynamicsBody;

typedef struct ShvDynamicsMotion {
    double position[3], axes[9]; /* m, of the origin; row major, columns are the body's axes in the world */
    double velocity[3], spin[3]; /* m/s, rad/s, world */
} ShvDynamicsMotion;

/* The fastest point at which two bodies touch, or will in the step that begins. */
typedef struct ShvDynamicsContact {
    int32_t first, second; /* first < second */
    double point[3];       /* m, world */
    double normal[3];      /* from the second to the first */
    double closing;        /* m/s, before any impulse */
    bool fresh;            /* they did not touch in the step before */
} ShvDynamicsContact;

/* What contacts did to a body in the last step. */
typedef enum ShvDynamicsTouch {
    SHV_DYNAMICS_FREE,
    SHV_DYNAMICS_STRUCK, /* with sharp impacts: it was thrown back, by nothing but impacts */
    SHV_DYNAMICS_HELD
} ShvDynamicsTouch;

/* Between detection and solution. Whoever is called may remove bodies. */
typedef void (*ShvDynamicsJudge)(void *data, const ShvDynamicsContact *contacts, int32_t count);

ShvStatus shv_dynamics_world_create(ShvDynamicsWorld **world, const ShvDynamicsSettings *settings, ShvError *error);
void shv_dynamics_world_destroy(ShvDynamicsWorld *world);

/* A new body under a number ≥ 0 that is free. Refuses shapes without volume, and pieces smaller than Bullet's distances of contact.
   On failure the world is as before. */
ShvStatus shv_dynamics_world_add(ShvDynamicsWorld *world, int32_t number, const ShvDynamicsBody *body,
                                 const ShvDynamicsMotion *motion, ShvError *error);
/* What touches it wakes up. */
void shv_dynamics_world_remove(ShvDynamicsWorld *world, int32_t number);
/* Tells a body's motion; it wakes up. */
void shv_dynamics_world_place(ShvDynamicsWorld *world, int32_t number, const ShvDynamicsMotion *motion);
/* Puts its motion in the place of that which a step gave it. What no contact pushed is kept from sleep. */
void shv_dynamics_world_correct(ShvDynamicsWorld *world, int32_t number, const ShvDynamicsMotion *motion);
/* false: it sleeps, and nothing has changed. */
bool shv_dynamics_world_read(const ShvDynamicsWorld *world, int32_t number, ShvDynamicsMotion *motion);
ShvDynamicsTouch shv_dynamics_world_touch(const ShvDynamicsWorld *world, int32_t number);
void shv_dynamics_world_wake_all(ShvDynamicsWorld *world);

/* One step; the work of friction in it, J. `judge` may be NULL. */
ShvStatus shv_dynamics_world_step(ShvDynamicsWorld *world, double step, const double gravity[3], ShvDynamicsJudge judge,
                                  void *data, double *friction_work, ShvError *error);

#ifdef __cplusplus
}
#endif
#endif
