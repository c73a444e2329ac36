/* The frame loop of the hybrid: rigid flight between impacts, fracture mode during them, and the hand-over both ways.

       flight ──contact that may break it──► awake: substeps of the solid with insertion, cohesion, closure, contact
         ▲                                     │ quiet
         └───components, best-fit motion ◄─────┘

   Time goes in rigid intervals. Fragments in flight cross an interval in one piece; those that hit something stop at
   their own time of impact and wake there; awake fragments cross the same interval in substeps. Nothing is rolled back. */
#ifndef SHV_COUPLING_HYBRID_H
#define SHV_COUPLING_HYBRID_H

#include "base/processors.h"
#include "base/timer.h"
#include "cohesive/cohesive.h"
#include "conditions/imposed.h"
#include "contact/surface_contact.h"
#include "fragment/fragment.h"
#include "fragment/free_rotation.h"
#include "model/ledger.h"
#include "model/state.h"
#include "pbd/bars.h"
#include "pbd/pbd_backend.h"
#include "pbd/relax.h"
#include "probes/probes.h"
#include "rigid/backend.h"
#include "shape/obstacle.h"
#include "shiver/simulation.h"
#include "solid/motion.h"
#include "solid/solid.h"

/* ---- what is awake ---- */

typedef struct ShvAwake {
    uint8_t *flags; /* per fragment index; capacity as the fragments' */
    int32_t flag_capacity;
    int32_t *nodes; /* nodes of awake fragments, fragment by fragment */
    int32_t node_count, node_capacity;
    int32_t count;         /* awake fragments */
    int32_t element_count; /* their tets */
    bool stale;            /* the lists must be rebuilt */
} ShvAwake;

/* Wakes that are pending in the present interval, by time. */
typedef struct ShvPendingWakes {
    ShvRigidContact *items;
    int32_t count, next, capacity;
} ShvPendingWakes;

/* Audit of the wake rule: impacts taken for harmless that wake all the same; how many have, and how many of these broke something
   before they came to rest. */
typedef struct ShvWakeAudit {
    int32_t wakes, audited, missed;
} ShvWakeAudit;

/* ---- steps of what is awake ---- */

typedef struct ShvSteps {
    double stable;          /* s: smallest exact element step of the whole model */
    int32_t stable_element; /* that sets it */
    double bulk;            /* s: stable step of the awake batches */
    double strained;        /* s: the same as strain has made it lately; infinity where it never counted */
    double last;            /* s: last step taken by something awake */
    int32_t inverted;       /* most elements found inside out at once so far */
} ShvSteps;

/* What follows from the choice of steps: how stress grows between checks decides when to look next. */
typedef struct ShvCheckClock {
    int32_t since; /* steps since the last check */
    int32_t due;   /* steps between the last check and the next */
    double last;   /* largest criterion / strength at the last check */
    double rate;   /* largest recent growth of it a step */
} ShvCheckClock;

/* The insertion criterion, only with model.can_break. */
typedef struct ShvInsertionCheck {
    ShvCheckClock clock;
    double *stress;    /* traction criterion: where a check has asked for it */
    bool forces_begun; /* state.force holds the internal forces of the present time: a check has found them */
    double *nodal;     /* principal criterion only; 6 per node */
    int64_t nodal_capacity;
    int32_t *candidates;
    double *overstress;
    int32_t since_rest; /* checks since fragments were last asked whether they may rest */
} ShvInsertionCheck;

/* Internal friction of the materials, and what crumbs have of it (vibration_damping.c). */
typedef struct ShvVibrationDamping {
    bool active;    /* some material has a loss factor, or crumbs may come off; else the rest is not there */
    ShvVec3 *force; /* per node, N: of the present step, at awake ones */
    int32_t capacity;
    double first_half; /* J: of its work in the present step */
} ShvVibrationDamping;

/* By obstacles on nodes so far. */
typedef struct ShvObstacleContact {
    ShvVec3 impulse;          /* N s */
    double time, first, last; /* s: of the steps with such impulses; with steps > 0 */
    int64_t steps;
} ShvObstacleContact;

/* fracture.stabiliser: bars. */
typedef struct ShvBarStabiliser {
    bool active; /* without it the rest is not there */
    ShvBars bars;
    ShvRelax relax;
    bool stale;
    uint8_t *fixed; /* per node: components that conditions hold */
    int64_t fixed_capacity;
    double elastic_turnover, bars_turnover; /* J: Σ |work| of each step, by elastic forces and by bars */
} ShvBarStabiliser;

/* ---- coupling of what is awake with what flies ---- */

/* Fragments in flight that fracture mode moves with it (coupled_bodies.c). */
typedef struct ShvCoupledBodies {
    ShvCoupledBody *items, *kept; /* kept: while a ghost step is made */
    ShvFreeRotation *rotations;
    double *impulses;             /* N·s: Σ of magnitudes since the interval began */
    int32_t *fragments;           /* index of each */
    ShvCoupledBody **by_fragment; /* NULL where none */
    ShvFragmentTouch *touches;    /* per fragment, of the step */
    double *masses;               /* per fragment, kg */
    uint8_t *wanted;              /* per fragment: it goes along */
    int32_t *island;              /* per fragment: parent among those that press on each other (base/disjoint_sets.h) */
    int32_t count, room;
    double since; /* s: when the sums of impulses began */
} ShvCoupledBodies;

typedef struct ShvCoupling {
    bool mutual; /* fragments meet one another: */
    ShvSurfaceContact surface;
    ShvCoupledBodies bodies;
} ShvCoupling;

/* Of dust when it was put away, about the origin. */
typedef struct ShvBinned {
    double momentum[3], angular[3]; /* kg m/s, kg m²/s */
} ShvBinned;

/* ---- observing ---- */

typedef struct ShvEventLog {
    ShvEventView *items;
    int32_t count, capacity;
} ShvEventLog;

/* Velocities around the present time, made by a step that is not taken (observe.c). */
typedef struct ShvGhost {
    double *before;       /* 3 per node: v(n−1/2) */
    double *displacement; /* 3 per node, with bars only: they move nodes */
    int64_t capacity;
    ShvObstacle *obstacles; /* as they are at this time: with half of that step's impulses */
    double kinetic;         /* J, of awake nodes and coupled bodies: Σ ½ m v₋·v₊ */
    double
        obstacle_exchange; /* J: first halves of the works on free obstacles, beyond the energy they have before the step */
    double first[SHV_WORK_COUNT]; /* J: first halves of the works of the step to come */
} ShvGhost;

typedef struct ShvObserver {
    ShvLedger ledger;
    ShvCohesiveEnergy cohesive_energy;    /* of the last observed time */
    double least_spring_step;             /* s: of all frames so far; 0: none */
    ShvLedgerView balance;                /* of the last observed time */
    double start_energy, start_potential; /* J */
    double least_contact_work;            /* J: of contacts and closing faces with their friction, so far */
    bool started;                         /* the balance */
    int32_t steps_since;                  /* the ledger was last looked at */
    double backend_contact, backend_friction, backend_bars, backend_damping; /* works already booked */
    ShvGhost ghost;
} ShvObserver;

typedef struct ShvHybrid {
    ShvMemory *memory;
    const ShvSceneDefinition *scene;
    double gravity[3];
    ShvModel model;
    ShvState state;
    ShvSolid solid;
    ShvCohesive cohesive; /* only with model.can_break */
    ShvInsertionCheck check;
    ShvBarStabiliser stabiliser;
    ShvVibrationDamping damping;
    ShvImposed imposed;
    ShvSteps steps;

    ShvObstacles obstacles;
    double obstacle_time;      /* s: time to which free ones have been moved */
    uint8_t *waiting;          /* per obstacle: it is not in the scene; NULL: all are */
    ShvVec3 waiting_direction; /* whither they wait, of unit length */
    ShvObstacleContact obstacle_contact;

    ShvFragments fragments;
    ShvAwake awake;
    ShvPendingWakes wakes;
    ShvWakeAudit wake_audit;
    ShvRigidBackend *backend;
    double interval_end; /* s; ≤ state.time: no rigid interval is under way */
    ShvCoupling coupling;
    ShvBinned binned;

    ShvObserver observer;
    ShvProbes probes;
    ShvEventLog log;
    int32_t next_event; /* of the scene's time line */
    ShvCosts costs;
    ShvProcessors processors;
    bool (*stop)(void *data);
    void *stop_data;
} ShvHybrid;

/* The last step taken over the stable one of what is awake; 0 before anything was. */
static inline double shv_hybrid_courant(const ShvHybrid *hybrid)
{
    return hybrid->steps.bulk > 0.0 ? hybrid->steps.last / hybrid->steps.bulk : 0.0;
}

/* Builds everything the scene needs and nothing else. `hybrid` must not move afterwards. On failure it owns nothing. */
ShvStatus shv_hybrid_create(ShvHybrid *hybrid, ShvMemory *memory, const ShvSceneDefinition *scene, const char *folder,
                            ShvError *error);
void shv_hybrid_release(ShvHybrid *hybrid);

/* Advances to `until`, or less when `steps` > 0 substeps of fracture mode have been taken first; *taken receives their
   number. Stops with SHV_DIVERGED or SHV_INTERRUPTED at a consistent state. */
ShvStatus shv_hybrid_advance(ShvHybrid *hybrid, double until, int64_t steps, int64_t *taken, ShvError *error);

/* Brings fragments' motion and the ledger to the present time (hybrid->fragments, hybrid->observer.balance); the state is
   left as it was. Fails when the residual leaves the scene's bound or something is not finite. */
ShvStatus shv_hybrid_observe(ShvHybrid *hybrid, ShvError *error);

/* ---- parts of the loop, one file each ---- */

/* awake.c: lists of what is awake, rebuilt when stale; and after insertions, when the same elements are awake in other
   fragments and with more nodes. */
ShvStatus shv_awake_reserve(ShvHybrid *hybrid, ShvError *error);
ShvStatus shv_awake_refresh(ShvHybrid *hybrid, ShvError *error);
ShvStatus shv_awake_follow(ShvHybrid *hybrid, ShvError *error);
/* threads.c: gives loops as many threads as have work and find a processor, where the scene leaves that open. */
void shv_hybrid_choose_threads(ShvHybrid *hybrid);
/* wake.c: speed that bodies at rest seem to have in flight, m/s; severity of an impact, v √max(1, m_other/m_own), m/s. */
double shv_hybrid_rest_speed(const ShvHybrid *hybrid);
double shv_hybrid_severity(double speed, double own_mass, double other_mass);
bool shv_hybrid_judge(void *hybrid, const ShvRigidContact *contact);
ShvStatus shv_hybrid_wake(ShvHybrid *hybrid, const ShvRigidContact *contact, ShvError *error);
/* One that flies and that the engine's judge has not taken out, without a contact. */
ShvStatus shv_hybrid_wake_alone(ShvHybrid *hybrid, int32_t fragment, ShvError *error);
/* Centrifugal stress of a body, estimated, Pa; whether that wakes it; wakes what flies and spins so. */
double shv_hybrid_centrifugal_stress(const ShvFragment *fragment);
bool shv_hybrid_wakes_by_spin(const ShvHybrid *hybrid, const ShvFragment *fragment);
ShvStatus shv_hybrid_wake_spinning(ShvHybrid *hybrid, ShvError *error);
/* audit.c: an event with the fragment's mass and hulls; hulls as they are now; momenta of the rigid motion and of nodes, with
   the sums of magnitudes into `scales` (may be NULL); strain, recoverable energy. `close` finds what was dropped, books and
   logs it, and fails with SHV_DIVERGED above the scene's bounds. */
ShvEventView shv_audit_event(const ShvHybrid *hybrid, ShvRunEvent kind, int32_t fragment);
void shv_audit_hulls(const ShvFragment *fragment, ShvEventView *event);
void shv_audit_rigid(const ShvFragment *fragment, double momentum[3], double angular[3]);
void shv_audit_nodes(const ShvHybrid *hybrid, const ShvFragment *fragment, double momentum[3], double angular[3],
                     ShvEventView *scales);
double shv_audit_strain(const ShvHybrid *hybrid, const ShvFragment *fragment);
double shv_audit_cohesive(const ShvHybrid *hybrid, const ShvFragment *fragment);
ShvStatus shv_audit_close(ShvHybrid *hybrid, ShvEventView *event, ShvError *error);
/* waking_contact.c: a fragment wakes by a contact; the touches of a step; whether that contact has carried its impulse, or has
   been open for a transit of the bar wave, s. */
void shv_waking_contact_begin(const ShvHybrid *hybrid, ShvFragment *fragment, const ShvRigidContact *contact);
void shv_waking_contact_follow(ShvHybrid *hybrid);
bool shv_waking_contact_is_over(const ShvHybrid *hybrid, const ShvFragment *fragment, double transit);
/* rest.c: one transit of the longest extent by the bar wave, and by the slowest bending wave of a plate of the shortest extent
   (half the period of the free fundamental, never less than the former), s; what has dissipated in a body that wakes now, after shv_waking_contact_begin, and in one of which damage is looked at from now on; nodes of a fragment get its shape at the
   start, in its pose, and its motion; how long after its last crack a body without any that holds goes to rest at the latest, s; those that
   may rest do; between which times an awake fragment goes to rest if nothing more breaks in it, s (infinite: conditions hold it). */
void shv_hybrid_transit_times(const ShvHybrid *hybrid, const ShvFragment *fragment, double *bar, double *bending);
void shv_hybrid_begin_growth(const ShvHybrid *hybrid, ShvFragment *fragment);
void shv_hybrid_note_damage(const ShvHybrid *hybrid, ShvFragment *fragment);
void shv_hybrid_scatter(ShvHybrid *hybrid, const ShvFragment *fragment);
double shv_hybrid_longest(const ShvHybrid *hybrid, const ShvFragment *fragment);
ShvStatus shv_hybrid_sleep_quiet(ShvHybrid *hybrid, ShvError *error);
void shv_hybrid_rest_between(const ShvHybrid *hybrid, const ShvFragment *fragment, double *soonest, double *latest);
/* s: until what a cracked body carries beside its rigid motion has fallen to what it may rest with, as it falls in scenes that were
   watched: e-fold in about the longest window of a body without a crack. */
double shv_hybrid_time_to_decay(const ShvHybrid *hybrid, const ShvFragment *fragment);
/* For how long what is awake may be expected to stay so, mean over its tets, s: bodies that carry too much vibration to rest to
   the latest time, or `until`; others for the geometric mean of the least and the longest time. */
ShvStatus shv_hybrid_expect_rest(ShvHybrid *hybrid, double until, double *time, ShvError *error);
/* advance.c: whether there is one body alone, without a crack, and nothing else that moves. */
bool shv_hybrid_is_alone(const ShvHybrid *hybrid);
/* substep.c: forces of the present time into state.force; kick from v(n−1/2) to v(n+1/2) with the steps `before` and
   `after` around it, all impulses and conditions, works booked; the length of the equal steps that fill what is left of
   `limit` seconds; and one of them. */
ShvStatus shv_hybrid_forces(ShvHybrid *hybrid, ShvError *error);
ShvStatus shv_hybrid_kick(ShvHybrid *hybrid, double before, double after, ShvError *error);
double shv_hybrid_choose_step(const ShvHybrid *hybrid, double limit);
ShvStatus shv_hybrid_substep(ShvHybrid *hybrid, double limit, ShvError *error);
/* Parts that both kicks share: cohesive tractions and closing faces; works of cohesion, contact and conditions. */
void shv_hybrid_pull_and_close(ShvHybrid *hybrid, double kick, double after);
void shv_hybrid_book_forces(ShvHybrid *hybrid, double after);
/* vibration_damping.c: forces of internal friction, where they are due, on to state.force, for the kick between the steps `before` and
   `after`; and their work, once velocities are those of n + 1/2. */
ShvStatus shv_vibration_damping_add_force(ShvHybrid *hybrid, double before, double after, ShvError *error);
void shv_vibration_damping_book(ShvHybrid *hybrid, double after);
/* coupled_bodies.c: room for the present fragments; who goes along in the interval to come, s; one more, one less (it wakes); the parts of a step; copies for a ghost
   step, and back, with the kinetic energy of the time. */
ShvStatus shv_coupled_bodies_reserve(ShvHybrid *hybrid, ShvError *error);
ShvStatus shv_coupled_bodies_choose(ShvHybrid *hybrid, double interval, ShvError *error);
ShvStatus shv_coupled_bodies_add(ShvHybrid *hybrid, int32_t fragment, ShvError *error);
void shv_coupled_bodies_remove(ShvHybrid *hybrid, int32_t fragment);
void shv_coupled_bodies_kick(ShvHybrid *hybrid, double kick);
/* Before and after flight has crossed a rigid interval: it sees them as they are now, and the impulses of what meets them there
   act on both at once. */
void shv_coupled_bodies_to_flight(ShvHybrid *hybrid);
void shv_coupled_bodies_from_flight(ShvHybrid *hybrid);
void shv_coupled_bodies_drift(ShvHybrid *hybrid, double step);
void shv_coupled_bodies_keep(ShvHybrid *hybrid);
double shv_coupled_bodies_put_back(ShvHybrid *hybrid);
/* Those that the step's touches wake. */
ShvStatus shv_coupled_bodies_judge(ShvHybrid *hybrid, ShvError *error);
void shv_coupled_bodies_release(ShvHybrid *hybrid);
ShvSurfaceBodies shv_hybrid_bodies(ShvHybrid *hybrid);
/* relaxed.c: the same kick with bars, which also moves the nodes to time n + 1; set-up; and the largest |length/rest − 1|
   over all edges. */
ShvStatus shv_hybrid_create_bars(ShvHybrid *hybrid, ShvError *error);
ShvStatus shv_hybrid_kick_relaxed(ShvHybrid *hybrid, double before, double after, ShvError *error);
double shv_hybrid_edge_strain(const ShvHybrid *hybrid);
/* check.c: stress, criterion, insertion, when due; what has come apart is labelled at once. */
ShvStatus shv_hybrid_check(ShvHybrid *hybrid, ShvError *error);
/* Fragments come apart where their last bonds have failed; once a step, when its forces have been found. */
ShvStatus shv_hybrid_split(ShvHybrid *hybrid, ShvError *error);
/* The clock of a body that has just woken. */
void shv_check_clock_start(ShvCheckClock *clock);
/* time_line.c: scene events that are due. */
ShvStatus shv_hybrid_time_line(ShvHybrid *hybrid, ShvError *error);
double shv_hybrid_next_event_time(const ShvHybrid *hybrid);
/* The same things at the present time, between rigid intervals, for whoever drives the simulation: an event, an impulse (N s) at a
   world point of one fragment in flight or awake. */
ShvStatus shv_hybrid_apply(ShvHybrid *hybrid, const ShvEventDefinition *event, ShvError *error);
ShvStatus shv_hybrid_push(ShvHybrid *hybrid, int32_t fragment, ShvVec3 impulse, ShvVec3 point, ShvError *error);
/* supported.c: whether a condition that is not over acts on a fragment; whether supports alone hold an awake one and restrain all its
   rigid motion, so that flight may hold it in their place; whether flight does from the start. From here on it does: the fitted record,
   without motion, goes back to where the supports have it unless its deformation is kept. At the beginning of an interval what may be
   struck in it wakes, and what is awake is noted as approached; all that is fixed wakes. */
bool shv_hybrid_is_held(const ShvHybrid *hybrid, const ShvFragment *fragment);
bool shv_hybrid_can_fix(const ShvHybrid *hybrid, const ShvFragment *fragment);
bool shv_hybrid_starts_fixed(const ShvHybrid *hybrid, const ShvFragment *fragment);
void shv_hybrid_fix(ShvHybrid *hybrid, ShvFragment *fragment, bool deformed);
ShvStatus shv_hybrid_wake_approached(ShvHybrid *hybrid, ShvError *error);
ShvStatus shv_hybrid_wake_fixed(ShvHybrid *hybrid, ShvError *error);
/* Whether something pressed on it in the last step as only a blow does. */
bool shv_hybrid_is_struck(const ShvHybrid *hybrid, const ShvFragment *fragment);
/* wake.c: estimate of the stress, Pa, that a force on a fragment, N, brings about. */
double shv_hybrid_load_stress(const ShvFragment *fragment, double load);
/* Of a fragment in flight, as its engine has it, J. */
double shv_hybrid_kinetic_in_flight(const ShvHybrid *hybrid, const ShvFragment *fragment);
/* enter.c: puts away the obstacles that wait; keeps them there, at the beginning of an interval; whether one waits. One comes, or
   goes; an object's only fragment, put away, comes into flight; a fragment in flight is put away. Between rigid intervals,
   with records and ledger of the time; works are booked. And the records alone, as a placement has them. */
ShvStatus shv_hybrid_let_wait(ShvHybrid *hybrid, ShvError *error);
void shv_hybrid_hold_waiting(ShvHybrid *hybrid);
bool shv_hybrid_waits(const ShvHybrid *hybrid, int32_t obstacle);
void shv_hybrid_enter_obstacle(ShvHybrid *hybrid, int32_t obstacle, const ShvPlacement *placement);
ShvStatus shv_hybrid_leave_obstacle(ShvHybrid *hybrid, int32_t obstacle, ShvError *error);
ShvStatus shv_hybrid_enter_fragment(ShvHybrid *hybrid, int32_t fragment, const ShvPlacement *placement,
                                    ShvError *error);
void shv_hybrid_leave_fragment(ShvHybrid *hybrid, int32_t fragment);
void shv_hybrid_place(const ShvHybrid *hybrid, ShvFragment *fragment, const ShvPlacement *placement);
void shv_hybrid_place_obstacle(ShvObstacle *obstacle, const ShvPlacement *placement);
/* squeeze.c: whether obstacles that move take more room from a body in flight that can break, in a time, than they leave it; what they
   close on in the interval that begins wakes; what is awake and pressed by obstacles that move, itself or by way of others, is marked,
   and does not rest; events of bodies that obstacles which hold their place leave no room, asked at the end of a rigid interval. */
bool shv_hybrid_is_squeezed(const ShvHybrid *hybrid, const ShvFragment *fragment, double time);
ShvStatus shv_hybrid_wake_squeezed(ShvHybrid *hybrid, ShvError *error);
void shv_hybrid_find_pressed(ShvHybrid *hybrid);
ShvStatus shv_hybrid_find_squeeze(ShvHybrid *hybrid, ShvError *error);
/* audit.c: one more event. */
ShvStatus shv_hybrid_log(ShvHybrid *hybrid, const ShvEventView *event, ShvError *error);
/* observe.c: mean of the velocities around the present time into state.velocity, those of n − 1/2 into ghost.before; and the
   latter back again. */
ShvStatus shv_hybrid_synchronise(ShvHybrid *hybrid, ShvError *error);
void shv_hybrid_resume(ShvHybrid *hybrid);
/* Around a kick whose step is another one than the last. Central difference keeps E = Σ ½ m v₋·v₊ + U, in which v₋ and v₊ stand a step
   apart. When the step becomes b in place of a, E becomes another by −(b − a)/4 Σ F·(v₊ − v₋) (exact where U is quadratic), F: forces that
   do their work on the way from n − 1/2 to n + 1/2, as all but contacts do. It is booked as SHV_WORK_STEP_CHANGE. */
ShvStatus shv_hybrid_begin_step_change(ShvHybrid *hybrid, double before, double after, ShvError *error);
void shv_hybrid_book_step_change(ShvHybrid *hybrid, double before, double after);
/* Velocities of the present time for a fragment that leaves the others: with elastic forces and gravity, without the impulses
   of the step that it will not take, which nobody else will get from it either; likewise into state.velocity. */
ShvStatus shv_hybrid_velocities_without_impulses(ShvHybrid *hybrid, ShvError *error);

#endif
