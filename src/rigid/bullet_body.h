/* What the Bullet backend keeps of a body, a fragment in flight or an obstacle. */
#ifndef SHV_RIGID_BULLET_BODY_H
#define SHV_RIGID_BULLET_BODY_H

#include "bullet_bridge/impact_time.h"
#include "rigid/backend.h"
#include "rigid/bullet_shape.h"

enum { SHV_LOAD_STEPS = 8 /* windows over which contact forces are averaged */ };

typedef struct ShvBulletRigidBody {
    int32_t number;             /* in the world of Bullet: obstacles by their index, then fragments by theirs */
    int32_t fragment, obstacle; /* one of them is −1 */
    bool moves;                 /* as its mass does, and nothing holds it */
    bool round;                 /* turning does not change where its surface is */
    double mass, radius;        /* infinite where it has none */
    double friction, restitution;
    ShvConvexPieces pieces; /* fragments */
    ShvImpactShape *impact; /* made when first needed */
    ShvFreeRotation rotation;
    /* state, at the step's start */
    ShvVec3 position, velocity, angular_momentum;
    ShvVec3 spin; /* that belongs to the momentum; of obstacles that do not move: as given */
    ShvQuat orientation;
    /* as last written to the record: events of the time line change it */
    ShvVec3 seen_position, seen_velocity, seen_spin;
    ShvQuat seen_orientation;
    double loads[SHV_LOAD_STEPS]; /* N: mean Σ |contact force| in the last windows (bullet_step.h) */
    int32_t load_count, load_next;
    double load_impulse; /* N s: since the last of them */
    int32_t still;       /* windows in a row without noticeable motion on supports */
    bool asleep;
    ShvVec3 asleep_gravity;
    bool settled; /* Bullet knows the pose in which it stays */
    bool gone;    /* has left; its shapes are released */
    bool born;    /* came since the last step: what it touches now is not fresh, and overlaps are let be */
    /* of the present step */
    bool dust;          /* fragments: meets obstacles alone */
    bool coupled;       /* moved by somebody else meanwhile */
    double fall;        /* share of gravity that it follows: 1; 0 of what is looked at as asleep (bullet_guard.c) */
    double fastest;     /* bound of |ω|, rad/s */
    double impact_time; /* s since its start at which it meets something fast; −1: nothing, or it does not move */
    double until;       /* s since its start: goes no further */
    bool leaves;        /* wakes */
    bool waits;         /* for what has just woken at its impact with it, as of `until` */
    bool later_impact;  /* something fast, on its foreseen way after its impact */
    bool thrown;        /* by its impact, off that way; or it meets again */
    bool stopped;       /* its impact did not throw it back */
    bool meets;         /* closes on something that it touches, faster than bodies at rest do */
    bool held;          /* pushed by contacts other than its impact */
    bool solved;        /* has contacts in the solver */
    bool restless, supported; /* its island, where this stands for it: something moves; something holds it; */
    bool rebounds, kinematic; /* something is thrown back; something that moves by itself takes part; */
    double work, square;      /* J: of all its impulses on the velocities without them, and on what they make of them */
    int32_t island;           /* place of the body that stands for all that hangs together */
    double heap_mass;         /* kg of that */
    ShvQuat solver_orientation; /* pose in which the solver sees it, */
    ShvVec3 solver_spin;        /* and its spin there before the contacts */
    ShvVec3 new_velocity;       /* m/s at the step's end, */
    ShvVec3 new_spin;           /* and the spin after the contacts in the solver's pose */
    ShvVec3 push, turn;         /* m/s, rad/s: undo overlaps */
    double impulse;             /* N s: Σ |contact impulse| */
    double energy;              /* J before */
} ShvBulletRigidBody;

/* A fragment joins the world of Bullet as it stands in its record. On failure nothing is left of it. */
ShvStatus shv_bullet_body_fragment(ShvBulletRigidBody *body, ShvBulletWorld *bullet, const ShvRigidWorld *world,
                                   int32_t fragment, ShvError *error);
ShvStatus shv_bullet_body_obstacle(ShvBulletRigidBody *body, ShvBulletWorld *bullet, const ShvRigidWorld *world,
                                   int32_t obstacle, ShvError *error);
/* Once more, from its pieces. */
ShvStatus shv_bullet_body_add_pieces(const ShvBulletRigidBody *body, ShvBulletWorld *bullet, ShvError *error);
void shv_bullet_body_release(ShvBulletRigidBody *body, ShvBulletWorld *bullet);

/* Takes the state from the record; true when somebody has changed it since it was written. */
bool shv_bullet_body_read(ShvBulletRigidBody *body, const ShvRigidWorld *world);
void shv_bullet_body_write(ShvBulletRigidBody *body, const ShvRigidWorld *world);

/* Pose and velocity on the free flight from the step's start. */
ShvVec3 shv_bullet_body_position(const ShvBulletRigidBody *body, double time, ShvVec3 gravity);
ShvQuat shv_bullet_body_orientation(const ShvBulletRigidBody *body, double time);
ShvVec3 shv_bullet_body_velocity(const ShvBulletRigidBody *body, double time, ShvVec3 gravity);
/* Angular velocity at an orientation on that flight. */
ShvVec3 shv_bullet_body_spin(const ShvBulletRigidBody *body, ShvQuat orientation);
/* Tells Bullet a pose. */
void shv_bullet_body_place(const ShvBulletRigidBody *body, ShvBulletWorld *bullet, ShvVec3 position,
                           ShvQuat orientation);
/* Kinetic energy and that of weight, J. */
double shv_bullet_body_energy(const ShvBulletRigidBody *body, ShvVec3 gravity);
/* Contact force, N: the mean of the last steps, over at least 5 of them (missing ones count as 0). */
double shv_bullet_body_load(const ShvBulletRigidBody *body);
/* How far nodes of a body may stand out of its convex pieces, m: of one that nothing has broken off, where those cut corners of what is
   round. 0 of pieces, whose hulls stand back from rough faces of cracks on purpose, and of obstacles. */
double shv_bullet_body_cut(const ShvBulletRigidBody *body, const ShvRigidWorld *world);
/* For impact_time.h; the body must outlive the motion. */
ShvStatus shv_bullet_body_impact_body(ShvBulletRigidBody *body, const ShvRigidWorld *world, ShvVec3 gravity,
                                      ShvImpactBody *impact_body, ShvError *error);

#endif
