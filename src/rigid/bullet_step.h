/* The Bullet backend's step, a file a part:

     pairs   Bullet's broadphase
     find    contacts where everything stands at the start; when pairs that close fast meet             (bullet_find.c)
     judge   contacts that wake a fragment take it out                                                 (bullet_judge.c)
     set up  what every contact leaves at least, and whom it moves                                     (bullet_solve.c)
     solve   Bullet's islands and impulses
     guard   what has been struck and meets something fast again in the same step waits there          (bullet_guard.c)
     move    poses at the end, works, rest                                                              (bullet_move.c)

   Coupled bodies (fragment.h) take part in all but the last, with what is in flight alone.

   Each body has one time of impact in a step, or none: it flies freely until then, and the solver sees it in the pose of that
   time. What else it meets in the step is held off by the velocity that just closes the gap, without rebound. */
#ifndef SHV_RIGID_BULLET_STEP_H
#define SHV_RIGID_BULLET_STEP_H

#include "rigid/bullet_body.h"

/* Two bodies that may meet in this step, and what is remembered of them. */
typedef struct ShvContactPair {
    int32_t first, second;      /* numbers */
    int32_t a, b;               /* places of the bodies */
    bool found;                 /* contacts have been looked for */
    bool touched;               /* in the step before */
    bool touching;              /* now: a gap within the slop */
    bool struck;                /* meets at its own time of impact */
    double allowed_penetration; /* m: overlap that is let be */
    double slop;                /* m: a smaller gap is a touch */
    double reach;               /* m: bound of their relative motion in the step */
    double impact;              /* s since the step's start; −1: no fast impact */
    bool deferred;              /* it was taken for earlier */
    int32_t contact_begin, contact_count;
} ShvContactPair;

typedef struct ShvPairImpact {
    double time; /* s since the step's start */
    int32_t contact_pair;
} ShvPairImpact;

/* What a contact of the last step leaves for the next: impulses to start from. */
typedef struct ShvCachedImpulse {
    ShvVec3 arm; /* in the first body's axes */
    double normal_impulse;
    ShvVec3 friction_impulse;
} ShvCachedImpulse;

typedef struct ShvBullet {
    ShvRigidBackend backend; /* first: the interface's pointer is this one's */
    ShvBulletWorld *bullet;
    ShvBulletRigidBody *bodies; /* by number in a step; between steps what is new comes last, and some may be gone */
    int32_t body_count, body_room;
    int32_t *places; /* of numbers among the bodies, + 1; 0: not there */
    int32_t place_count, place_room;
    bool untidy;                                        /* the bodies are */
    ShvContactPair *contact_pairs, *last_contact_pairs; /* by numbers */
    int32_t contact_pair_count, last_count, contact_pair_room, last_room;
    ShvBulletContact *contacts;
    ShvCachedImpulse *cached_impulses, *last_cached_impulses; /* as the contacts of this and the last step */
    int32_t contact_count, contact_room, cached_impulse_room, last_cached_impulse_room;
    ShvPairImpact *order; /* contact pairs with impacts, by time */
    int32_t order_count, order_room;
    ShvBulletMotion *motions;          /* of bodies that contacts move, in their order */
    ShvBulletContact *active_contacts; /* takes the place of `contacts`, without those that take no part */
    int32_t *heaps;                    /* of bodies: disjoint sets of what touched before the step */
    int32_t motion_count, motion_room, active_contact_room, heap_room;
    /* the step */
    ShvVec3 gravity;
    double time, step, last_step;
    double rest;      /* m/s: what closes slower is held, not thrown back */
    double window;    /* s: since contact forces are averaged, over a step or some short ones */
    bool window_ends; /* with this step */
} ShvBullet;

/* Place of a number among the bodies; −1 when it is not there. */
static inline int32_t shv_bullet_place(const ShvBullet *bullet, int32_t number)
{
    return number < bullet->place_count ? bullet->places[number] - 1 : -1;
}

/* The body that stands for the island of a pair: of two one moves at least. */
static inline ShvBulletRigidBody *shv_bullet_island(const ShvBullet *bullet, const ShvContactPair *contact_pair)
{
    const ShvBulletRigidBody *a = &bullet->bodies[contact_pair->a], *b = &bullet->bodies[contact_pair->b];
    return &bullet->bodies[a->moves ? a->island : b->island];
}

/* What a contact gives its first body, N s; the second gets the opposite. */
static inline ShvVec3 shv_bullet_impulse(const ShvBulletContact *contact)
{
    return shv_madd(shv_load3(contact->friction_impulse), contact->normal_impulse, shv_load3(contact->normal));
}
/* Velocity of the first against the second at a contact, for velocities and spins of the two. */
ShvVec3 shv_bullet_relative(const ShvBulletContact *contact, ShvVec3 velocity_a, ShvVec3 spin_a, ShvVec3 velocity_b,
                            ShvVec3 spin_b);
/* Acceleration of a's centre against b's, without contacts. */
ShvVec3 shv_bullet_relative_gravity(const ShvBullet *bullet, const ShvBulletRigidBody *a, const ShvBulletRigidBody *b);
/* Whether the balls around two bodies touch on their ways, s. */
bool shv_bullet_paths_meet(const ShvBullet *bullet, const ShvBulletRigidBody *a, const ShvBulletRigidBody *b,
                           double time);

/* Whether the pair is somebody else's to keep apart, or nobody's. */
bool shv_bullet_leaves_pair(const ShvBulletRigidBody *a, const ShvBulletRigidBody *b);

/* Whether it may move in this step. */
bool shv_bullet_is_active(const ShvBulletRigidBody *body);
/* Tells Bullet where a body gets in a time from its present state. */
ShvStatus shv_bullet_reach(const ShvBullet *bullet, const ShvBulletRigidBody *body, double time, ShvError *error);

ShvStatus shv_bullet_place_all(ShvBullet *bullet, ShvError *error);
ShvStatus shv_bullet_find(ShvBullet *bullet, const ShvBulletPair *pairs, int32_t count, ShvError *error);
/* The pair as it stands at a time of the step; its contacts there, behind those of the others. */
ShvStatus shv_bullet_collide_at(ShvBullet *bullet, ShvContactPair *contact_pair, double time, ShvError *error);
ShvStatus shv_bullet_judge(ShvBullet *bullet, ShvWakeJudge judge, void *judge_data, ShvRigidContact *wakes,
                           int32_t *wake_count, ShvError *error);
ShvStatus shv_bullet_set_up_contacts(ShvBullet *bullet, ShvBulletTask *task, ShvError *error);
void shv_bullet_take_motions(ShvBullet *bullet);
void shv_bullet_limit_rebounds(ShvBullet *bullet);
ShvStatus shv_bullet_guard(ShvBullet *bullet, ShvError *error);
void shv_bullet_move(ShvBullet *bullet);

#endif
