/* The Bullet backend's step, a file a part:

     pairs   Bullet's broadphase
     find    contacts where everything stands at the start; when pairs that close fast meet             (bullet_find.c)
     judge   contacts that wake a fragment take it out                                                 (bullet_judge.c)
     gather  what every contact leaves at least, and whom it moves                                     (bullet_solve.c)
     solve   Bullet's islands and impulses
     guard   what has been struck and meets something fast again in the same step waits there          (bullet_guard.c)
     move    poses at the end, works, rest                                                              (bullet_move.c)

   Companions (fragment.h) take part in all but the last, with what is in flight alone.

   Each body has one moment of impact in a step, or none: it flies freely until then, and the solver sees it in the pose of that
   moment. What else it meets in the step is held off by the velocity that just closes the gap, without rebound. */
#ifndef SHV_RIGID_BULLET_STEP_H
#define SHV_RIGID_BULLET_STEP_H

#include "rigid/bullet_flyer.h"

/* Two bodies that may meet in this step, and what is remembered of them. */
typedef struct ShvBulletMeeting {
    int32_t first, second; /* numbers */
    int32_t a, b;          /* places of the flyers */
    bool found;            /* contacts have been looked for */
    bool touched;          /* in the step before */
    bool touching;         /* now: a gap within the slop */
    bool struck;           /* meets at its own time of impact */
    double allowance;      /* m: overlap that is let be */
    double slop;           /* m: a smaller gap is a touch */
    double reach;          /* m: bound of their relative motion in the step */
    double impact;         /* s since the step's start; −1: no fast impact */
    int32_t contact_begin, contact_count;
} ShvBulletMeeting;

typedef struct ShvBulletMoment {
    double moment; /* s since the step's start */
    int32_t meeting;
} ShvBulletMoment;

/* What a contact of the last step leaves for the next: impulses to start from. */
typedef struct ShvBulletTrace {
    ShvVec3 arm; /* in the first body's axes */
    double normal_impulse;
    ShvVec3 friction_impulse;
} ShvBulletTrace;

typedef struct ShvBullet {
    ShvRigidBackend backend; /* first: the interface's pointer is this one's */
    ShvBulletWorld *bullet;
    ShvBulletFlyer *flyers; /* by number in a step; between steps what is new comes last, and some may be gone */
    int32_t flyer_count, flyer_room;
    int32_t *places; /* of numbers among the flyers, + 1; 0: not there */
    int32_t place_count, place_room;
    bool untidy;                                /* the flyers are */
    ShvBulletMeeting *meetings, *last_meetings; /* by numbers */
    int32_t meeting_count, last_count, meeting_room, last_room;
    ShvBulletContact *contacts;
    ShvBulletTrace *traces, *last_traces; /* as the contacts of this and the last step */
    int32_t contact_count, contact_room, trace_room, last_trace_room;
    ShvBulletMoment *order; /* meetings with impacts, by time */
    int32_t order_count, order_room;
    ShvBulletMotion *motions;   /* of flyers that contacts move, in their order */
    ShvBulletContact *gathered; /* takes the place of `contacts`, without those that take no part */
    int32_t *heaps;             /* of flyers: disjoint sets of what touched before the step */
    int32_t motion_count, motion_room, gathered_room, heap_room;
    /* the step */
    ShvVec3 gravity;
    double time, step, last_step;
    double rest;      /* m/s: what closes slower is held, not thrown back */
    double window;    /* s: since contact forces are averaged, over a step or some short ones */
    bool window_ends; /* with this step */
} ShvBullet;

/* Place of a number among the flyers; −1 when it is not there. */
static inline int32_t shv_bullet_place(const ShvBullet *bullet, int32_t number)
{
    return number < bullet->place_count ? bullet->places[number] - 1 : -1;
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
ShvVec3 shv_bullet_relative_gravity(const ShvBullet *bullet, const ShvBulletFlyer *a, const ShvBulletFlyer *b);

/* Whether the pair is somebody else's to keep apart, or nobody's. */
bool shv_bullet_leaves_pair(const ShvBulletFlyer *a, const ShvBulletFlyer *b);

/* Whether it may move in this step. */
bool shv_bullet_is_active(const ShvBulletFlyer *flyer);
/* Tells Bullet where a flyer gets in a time from its present state. */
ShvStatus shv_bullet_reach(const ShvBullet *bullet, const ShvBulletFlyer *flyer, double time, ShvError *error);

ShvStatus shv_bullet_place_all(ShvBullet *bullet, ShvError *error);
ShvStatus shv_bullet_find(ShvBullet *bullet, const ShvBulletPair *pairs, int32_t count, ShvError *error);
ShvStatus shv_bullet_judge(ShvBullet *bullet, ShvWakeJudge judge, void *judge_data, ShvRigidContact *wakes,
                           int32_t *wake_count, ShvError *error);
ShvStatus shv_bullet_gather(ShvBullet *bullet, ShvBulletTask *task, ShvError *error);
void shv_bullet_take_motions(ShvBullet *bullet);
ShvStatus shv_bullet_guard(ShvBullet *bullet, ShvError *error);
void shv_bullet_move(ShvBullet *bullet);

#endif
