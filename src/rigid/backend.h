/* Rigid flight behind one interface: the analytic backend here, others beside it. A backend moves the fragments that are
   in flight and the free obstacles, and reports contacts that may wake a fragment before it answers them. */
#ifndef SHV_RIGID_BACKEND_H
#define SHV_RIGID_BACKEND_H

#include "base/archive.h"
#include "fragment/fragment.h"
#include "shape/obstacle.h"

typedef struct ShvRigidContact {
    int32_t fragment; /* index */
    int32_t obstacle; /* index; −1: the other side is a fragment, */
    int32_t other;    /* whose index this is; −1: it is an obstacle */
    int32_t fresh;   /* 1: not touching at the previous step; no bool, so that no bytes of a checkpoint are undefined */
    double time;     /* s: when it closes */
    double expected; /* s: when it will have closed, where that is known to be later than `time`; else 0 */
    ShvVec3 point, normal; /* world; the normal points from the other side to the fragment */
    double closing_speed;  /* m/s along the normal, ≥ 0, before any response */
    double other_mass;     /* kg of the other side with all that it touches; infinity: something holds that */
    double load;           /* N: Σ of the contact forces on the fragment, mean of the last steps; 0 where not kept */
} ShvRigidContact;

/* Whether a contact wakes its fragment. */
typedef bool (*ShvWakeJudge)(void *data, const ShvRigidContact *contact);

typedef struct ShvRigidWorld {
    const ShvModel *model;
    ShvState *state;
    ShvFragments *fragments;
    ShvObstacles *obstacles;
    const ShvRigidDefinition *settings;
} ShvRigidWorld;

typedef struct ShvRigidBackend ShvRigidBackend;
typedef struct ShvRigidFunctions {
    const char *name;
    /* A fragment enters flight with the pose and velocities in its record, or leaves it. */
    ShvStatus (*add)(ShvRigidBackend *backend, int32_t fragment, ShvError *error);
    void (*remove)(ShvRigidBackend *backend, int32_t fragment);
    /* Moves everything in flight, but for coupled bodies (fragment.h), from `time` on by `step`; what an earlier call has moved there already (because others
       came to rest meanwhile) stays. A contact that `judge` accepts stops its fragment at the contact's time: the
       fragment keeps the pose and velocity of that time (before response), leaves flight, and its contact is appended to
       `wakes` (room for one a fragment in flight). All other contacts are answered by impulses with the pair's
       restitution and friction. */
    ShvStatus (*advance)(ShvRigidBackend *backend, double time, double step, const double gravity[3],
                         ShvWakeJudge judge, void *judge_data, ShvRigidContact *wakes, int32_t *wake_count,
                         ShvError *error);
    /* To a checkpoint, or from it into a backend that was just made of the same scene, once fragments and obstacles are as they
       were. NULL: a backend without checkpoints. */
    bool (*archive)(ShvRigidBackend *backend, ShvArchive *archive);
    void (*destroy)(ShvRigidBackend *backend);
} ShvRigidFunctions;
struct ShvRigidBackend {
    const ShvRigidFunctions *functions;
    ShvRigidWorld world;
    double fragment_friction, fragment_restitution; /* between two fragments, where they see each other */
    double contact_work;                            /* J on fragments and free obstacles by answered contacts, so far */
    double friction_work;                           /* J, so far */
    /* A backend that moves nodes: bars hold them together, damping towards rigid motion; J, so far. */
    double bars_work, damping_work;
    bool
        keeps_nodes; /* the nodes are the state in flight, at the time the last advance led to, and a fragment's record is
                         only fitted to them: whoever adds a fragment leaves its nodes as they are, with velocities of
                         the present time, and need not scatter the record when it wakes; whoever changes its motion
                         changes its nodes' */
    bool moves_obstacles; /* free obstacles are moved by `advance`; nobody else must, unless */
    bool
        leaves_obstacles; /* this was set before it: they take part in contacts, but only their velocities change, by the
                              contacts' impulses, and the caller moves them over the same step (shv_obstacles_advance) */
};

/* Refuses what is not finite, or turns by more than SHV_LARGEST_ROTATION, rad, in the step. `kind`: "fragment" or "obstacle". */
ShvStatus shv_rigid_check_motion(const char *kind, int32_t number, ShvVec3 position, ShvVec3 velocity, ShvVec3 spin,
                                 double turn, ShvError *error);
ShvStatus shv_rigid_check_mass(const ShvFragment *fragment, ShvError *error);

/* Room in a block of a backend. */
#define SHV_BACKEND_RESERVE(backend, block, room, wanted, what, error)                                                 \
    SHV_RESERVE((backend)->world.fragments->memory, SHV_PART_RIGID, (block), (room), (wanted), (what), (error))

/* Exact ballistic motion and free rotation (L constant, energy to round-off) between impacts; nodes of the fragments' surfaces
   against obstacles (a small obstacle may slip between the nodes of a coarse face), answered at their time of impact by
   sequential impulses with Newton's restitution and Coulomb friction. What closes slower than free fall gains in a step
   does not bounce; supports hold without creep, and a motionless fragment costs nothing. Fragments do not see each other.
   Velocities in a fragment's record may be changed between steps. Free obstacles are given their new motion such that
   advancing them over the whole step afterwards leads them where they belong. */
ShvStatus shv_analytic_create(ShvRigidBackend **backend, const ShvRigidWorld *world, ShvError *error);

/* Bullet: fragments as convex hulls that meet obstacles and each other, free obstacles among them, with Bullet's broadphase,
   GJK and sequential impulses. Between contacts the flight is exact: a parabola, and free rotation whose angular momentum is
   the state. A pair that closes faster than gravity gains in a step meets at its own time of impact and rebounds there with
   the pair's restitution (the obstacles' own; between two of them the larger, friction the geometric mean; between
   fragments the backend's); slower contacts are held. `judge` is asked once a step for each side of every pair that
   touches, before any impulse; a fragment that wakes is gone for its partners at once. What rests on supports that do not
   move is put to sleep. Overlaps that a pair has when one of the two comes are let be, and shrink with the pair's parting.
   Free obstacles of triangles count as their convex hull; two obstacles meet only if one is free. */
ShvStatus shv_bullet_create(ShvRigidBackend **backend, const ShvRigidWorld *world, ShvError *error);

/* Plain Bullet: the same hulls, masses and pair laws in a btDiscreteDynamicsWorld that integrates, detects, puts to sleep and solves
   as it comes, save the overrides asked for. `judge` is asked between detection and solution, once a step for each side of
   every pair that touches or will in the step; what wakes leaves with the state of the step's start. What joins in the midst of
   a step flies freely to its end. No coupled bodies: what flies goes through what is awake. */
ShvStatus shv_bullet_plain_create(ShvRigidBackend **backend, const ShvRigidWorld *world,
                                  const ShvBulletPlainDefinition *settings, ShvError *error);

#endif
