/* A simulation: made from a scene definition, pulled frame by frame. It prints nothing, owns no global state and never
   exits; several may live at once, each in one thread at a time, also of a program's own OpenMP loop. */
#ifndef SHIVER_SIMULATION_H
#define SHIVER_SIMULATION_H

#include <stddef.h>
#include <stdint.h>

#include "shiver/definition.h"
#include "shiver/status.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct ShvSimulation ShvSimulation;

typedef enum ShvFragmentMode {
    SHV_FRAGMENT_FLIGHT = 0,
    SHV_FRAGMENT_FRACTURE = 1,
    SHV_FRAGMENT_DEAD = 2,
    SHV_FRAGMENT_BINNED = 3 /* dust that stays where it is, out of motion and contact */
} ShvFragmentMode;

/* One fragment, alive or dead; `id` is its index in the list of all and never used again. */
typedef struct ShvFragmentView {
    int32_t id, parent;  /* parent −1: an object's first fragment */
    int32_t object;      /* index in the scene's objects */
    double birth, death; /* s; death NaN while alive */
    ShvFragmentMode mode;
    int32_t tets;
    double mass, volume; /* kg, m³ */
    double inertia[6];   /* xx, yy, zz, yz, xz, xy of the lumped masses about the centre, reference axes, kg m² */
    double reference_centre[3];              /* m, in the reference mesh */
    double position[3];                      /* centre of mass, m */
    double orientation[4];                   /* w, x, y, z: reference axes to world */
    double velocity[3], angular_velocity[3]; /* m/s, rad/s, world */
} ShvFragmentView;

typedef struct ShvObstacleView {
    const char *name;
    double position[3], orientation[4], velocity[3], angular_velocity[3];
} ShvObstacleView;

/* The ledger at one time, J unless said otherwise. Works are signed: energy given to the fragments and free obstacles
   is positive, and each is booked as the force or impulse acts.
     residual = kinetic + strain + gravity_potential − (the same at the start)
                − (cohesive + contact + friction + closure + crack_friction + constraint + traction + bars + damping + handover + event +
                   step_change):
   what the integrator gained or lost.
     cohesive_defect = cohesive + cohesive_recoverable + cohesive_released + fracture_dissipation:
   how far the work of the tractions is from what the cohesive law says for the openings that came about. */
/* Its columns between time and residual: one table, which run file, CSV, JSON, viewer, formulas and balance follow.
   NUMBER(member, unit); WORK(member, NAME), in J, part of the balance and booked as SHV_WORK_NAME; VECTOR(member, unit). */
#define SHV_LEDGER_COLUMNS(NUMBER, WORK, VECTOR)                                                                       \
    NUMBER(kinetic, "J") /* functions of the state */                                                                  \
    NUMBER(strain, "J")                                                                                                \
    NUMBER(gravity_potential, "J")                                                                                     \
    NUMBER(cohesive_recoverable, "J") /* of the cohesive law, from its openings and histories */                       \
    NUMBER(fracture_dissipation, "J")                                                                                  \
    WORK(contact, CONTACT)               /* by normal contact impulses */                                              \
    WORK(friction, FRICTION)             /* by tangential contact impulses */                                          \
    WORK(closure, CLOSURE)               /* by crack faces that close (≤ 0) */                                       \
    WORK(crack_friction, CRACK_FRICTION) /* by crack faces that slide under pressure (≤ 0) */                        \
    WORK(constraint, CONSTRAINT)         /* by supports and imposed velocities */                                      \
    WORK(traction, TRACTION)             /* by imposed tractions */                                                    \
    WORK(bars, BARS)                     /* by position based projections */                                           \
    WORK(damping, DAMPING)               /* by damping towards rigid motion (pbd, loss factors) */                     \
    WORK(handover, HANDOVER)       /* vibration and strain dropped or given at mode switches, each one in /events */   \
    WORK(event, EVENT)             /* by events of the time line */                                                    \
    WORK(step_change, STEP_CHANGE) /* by steps of another length: what is kept of vibrations hangs on it */            \
    NUMBER(cohesive, "J")          /* by cohesive tractions on the nodes */                                            \
    NUMBER(cohesive_released, "J") /* recoverable energy of cohesive zones that was let go at mode switches */         \
    NUMBER(cohesive_defect, "J")                                                                                       \
    NUMBER(failed_area, "m2")                                                                                          \
    NUMBER(inserted_area, "m2")                                                                                        \
    NUMBER(fracture_energy_area, "J") /* ΣG·A over failed facets */                                                  \
    VECTOR(momentum, "kg m/s")                                                                                         \
    VECTOR(angular_momentum, "kg m2/s") /* about the origin */

#define SHV_LEDGER_NUMBER(member, unit) double member;
#define SHV_LEDGER_WORK(member, name)   double member;
#define SHV_LEDGER_VECTOR(member, unit) double member[3];
typedef struct ShvLedgerView {
    double time;
    SHV_LEDGER_COLUMNS(SHV_LEDGER_NUMBER, SHV_LEDGER_WORK, SHV_LEDGER_VECTOR)
    double residual, largest; /* largest: the largest single energy so far, the residual's scale */
} ShvLedgerView;
#undef SHV_LEDGER_NUMBER
#undef SHV_LEDGER_WORK
#undef SHV_LEDGER_VECTOR

typedef enum ShvRunEvent {
    SHV_RUN_WAKE,      /* a fragment entered fracture mode; value: closing speed, m/s */
    SHV_RUN_SLEEP,     /* a fragment went back to flight; value: vibration and strain energy dropped, J */
    SHV_RUN_SPLIT,     /* a fragment ended and became others; value: number of children */
    SHV_RUN_INSERTION, /* first insertion in a fragment; value: criterion / strength */
    SHV_RUN_INVERSION, /* an element turned inside out; value: element */
    SHV_RUN_SCENE,     /* an event of the scene's time line; value: its index */
    SHV_RUN_BIN,       /* dust was put away instead of going back to flight; value: energy dropped, J */
    SHV_RUN_SQUEEZE /* a fragment is between two obstacles that leave it no room (fixed or scripted, facing each other): an
                          event for each of them; value: the room that is missing, m. Told again once it has been free */
} ShvRunEvent;

/* Why a fragment went from one mode to the other. */
typedef enum ShvSwitchReason {
    SHV_REASON_NONE, /* no switch */
    SHV_REASON_CONTACT, /* wakes: every new contact does (rigid.wake: contact), or supports hold it and something is near */
    SHV_REASON_IMPACT, /* wakes: the estimate of impact stress */
    SHV_REASON_LOAD,   /* wakes: the estimate of stress under load, or obstacles that move close on it */
    SHV_REASON_SPIN,   /* wakes: the estimate of stress by its own rotation */
    SHV_REASON_AUDIT,  /* wakes: taken for harmless, to see whether that is true (audit_wakes) */
    SHV_REASON_QUIET,  /* rests: nothing has broken for long enough, and what is dropped is little */
    SHV_REASON_CHECKS, /* rests: enough checks without insertion (rigid.wake: contact) */
    SHV_REASON_LONGEST /* rests: fracture.longest is over */
} ShvSwitchReason;

typedef struct ShvEventView {
    double time;
    ShvRunEvent kind;
    int32_t fragment; /* −1: none */
    int32_t obstacle; /* −1: none */
    double value;
    double kinetic_before, kinetic_after, strain_before, strain_after; /* J, of the fragment */
    double momentum_before[3], momentum_after[3];                      /* kg m/s */
    double angular_before[3], angular_after[3];                        /* kg m²/s about the origin */
    /* mode switches only (wake, sleep, bin): */
    ShvSwitchReason reason;
    int32_t hulls; /* convex pieces that stand for the fragment in flight; 0: the rigid engine makes none */
    double mass;   /* kg */
    double momentum_scale, angular_scale; /* kg m/s, kg m²/s: Σ m|v|, Σ m|r||v| over the nodes, r from the origin */
    double cohesive_before, cohesive_after; /* J, recoverable energy of its cohesive facets, those to others included */
    /* J that the switch took from the energies above (negative: gave): motion other than rigid (of dust that is binned all
       motion), strain, and open cracks whose faces a rigid body keeps shut or that nothing holds any more */
    double dropped_vibration, dropped_strain, dropped_cohesive;
    /* shares of the volume: space in hulls without tets, tets in no hull */
    double hull_outside, hull_missing;
} ShvEventView;

typedef struct ShvCostView {
    const char *name;
    double seconds;
    int64_t calls;
} ShvCostView;
typedef struct ShvBytesView {
    const char *name;
    size_t bytes, peak;
} ShvBytesView;

/* One probe at one time. NaN is what is not known: a whole sample while the probe's body is not looked at, stress and forces
   of what flies, stress and reaction of obstacles, forces on points.
   In fracture mode all values are those of one time step n: the velocity is that of time n, not of the half step. */
typedef struct ShvProbeSample {
    double displacement[3]; /* m, since the start; of a set of nodes the mean weighted by mass */
    double velocity[3];     /* m/s, likewise */
    double stress[6];   /* Pa, Cauchy: xx, yy, zz, yz, xz, xy; of a set the mean of the tets at its nodes, by volume */
    double contact[3];  /* N: by obstacles and other bodies on the nodes of a set; by all nodes on an obstacle */
    double reaction[3]; /* N: by supports and imposed velocities on the nodes of a set */
} ShvProbeSample;
enum { SHV_PROBE_NUMBERS = sizeof(ShvProbeSample) / sizeof(double) };

typedef struct ShvProbeView {
    const char *name;
    ShvProbeKind kind;
} ShvProbeView;

/* Everything about the present time. Arrays belong to the simulation and are valid until its next advance. */
typedef struct ShvFrameView {
    double time;
    bool
        animation; /* on the animation grid (output.rate); else a frame of the fracture phase (output.fracture_every) */
    bool fracture; /* some fragment is in fracture mode */
    const ShvFragmentView *fragments; /* all that ever lived */
    int32_t fragment_count, alive_count;
    const ShvObstacleView *obstacles;
    int32_t obstacle_count;
    const ShvEventView *events; /* since the last frame */
    int32_t event_count;
    const ShvProbeView *probes;
    int32_t probe_count;
    /* Rows since the last frame: one a sampled step of fracture mode, and one a frame of the animation grid while the body of
       some probe flies. Times do not decrease. */
    const double *probe_times;           /* probe_row_count, s */
    const ShvProbeSample *probe_samples; /* probe_row_count × probe_count */
    int64_t probe_row_count;
    ShvLedgerView ledger;
    int64_t steps;        /* of fracture mode so far */
    double step, courant; /* s: last step of fracture mode; its ratio to the stable step */
    /* Three numbers that are not one another: facets made cohesive, those of them that bond no more, and (alive_count) fragments.
       `pieces`: how many fragments there would be if a facet held down to 1, 10 and 50 % of its normal strength; far apart, they
       say that it depends on the limit what a fragment is. */
    int32_t inserted, failed, pieces[3];
    int32_t softened; /* of them: half opened or more, not all, with less than half the dissipation that takes */
    int32_t audited,
        missed; /* impacts that woke for ShvSimulationOptions.audit_wakes; those of them that broke something */
    double worst_overshoot; /* largest criterion / strength at an insertion so far */
    /* Step at which cohesive zones, integrated explicitly as springs, would be stable, over that of the tets: the least of all
       frames so far; NaN: none were active. Runs need not keep it: cohesive impulses are exact for any step. */
    double cohesive_share;
    /* What obstacles did to nodes in fracture mode so far: Σ of impulses, N s; Σ of the steps in which one acted, s; beginning of the
       first such step and end of the last, s (NaN: none). Impacts in flight are not in it. */
    double contact_impulse[3], contact_time, first_contact, last_contact;
    double edge_strain; /* largest |length/rest − 1| of all edges; NaN unless position based dynamics is used */
    double
        bar_work_share; /* Σ|work of bars| / Σ(|work of bars| + |work of elastic forces|) over all steps, of which those
                                   of rigid mode have no elastic forces; NaN without bars: how much of the stiffness seen
                                   is the bars' */
    const ShvCostView *costs;
    int32_t cost_count;
    const ShvBytesView *bytes;
    int32_t bytes_count;
} ShvFrameView;

/* What a material asks of a mesh and gets from it. */
typedef struct ShvMaterialView {
    const char *name;
    bool breakable; /* fracture is on, and its facets can open */
    ShvUnresolved unresolved;
    double mesh_edge;                  /* m: mean edge of the coarsest object of it; 0: no object is of it */
    double zone_edges, resolved_edge;  /* edges that a resolved zone spans; m: longest mean edge for that, as given */
    double nominal_strength, strength; /* Pa, mode I: as given, and in effect */
    double nominal_energy, energy;     /* J/m², likewise */
    double cohesive_zone, snap_back;   /* m: (π/8) E/(1−ν²) G/σ² and 2 E G/σ², in effect */
    double tip_toughness;              /* times G: estimate of what a crack tip costs on this mesh, at least 1 */
    double youngs_modulus, poissons_ratio; /* Pa */
    double tip_strength;                   /* Pa: c √(E G/mesh_edge), for `tip_strength`; 0 in run files */
    double compressive_strength;           /* Pa: of a free column, 2 τ tan(45° + φ/2), in effect; 0 in run files */
} ShvMaterialView;

/* An object's half-open ranges in the joint mesh. */
typedef struct ShvObjectView {
    const char *name, *material; /* "glass + steel" where groups are of other materials */
    int32_t element_begin, element_end, node_begin, node_end;
} ShvObjectView;

/* Reference geometry, constant: the joint mesh of all objects. */
typedef struct ShvMeshView {
    int32_t node_count, element_count;
    const double *positions; /* 3 × node_count, m, world at the start */
    const int32_t *elements; /* 4 × element_count */
    const ShvObjectView *objects;
    int32_t object_count;
} ShvMeshView;

typedef struct ShvSimulationOptions {
    uint32_t cookie;
    const char *folder;       /* what relative file names of the scene start from; NULL: working directory */
    struct ShvMemory *memory; /* counter of allocations; NULL: one of its own */
    /* The first so many impacts that the wake rule takes for harmless (of what can break, faster than gravity makes anything in a
       rigid step) go to fracture mode all the same: those that then break something before they come to rest are the rule's
       misses. The run takes the course that the fracture solver gives it. */
    int32_t audit_wakes;
    /* Asked now and then (at least every few milliseconds of work): true stops with SHV_INTERRUPTED at a consistent state. */
    bool (*stop)(void *data);
    void *stop_data;
} ShvSimulationOptions;
ShvSimulationOptions shv_simulation_options_default(void);

/* On failure *simulation is NULL and everything is released. Objects that overlap at the start are bad input, unless the scene's
   `overlaps` keeps them. */
ShvStatus shv_simulation_create(ShvSimulation **simulation, const ShvSceneDefinition *scene,
                                const ShvSimulationOptions *options, ShvError *error);
void shv_simulation_destroy(ShvSimulation *simulation);

/* Goes on to the next frame to record (the first call gives the frame of time 0). After SHV_DIVERGED or SHV_INTERRUPTED
   the frame view shows the last consistent state. */
ShvStatus shv_simulation_advance(ShvSimulation *simulation, ShvError *error);
/* True when the scene's duration has been reached. */
bool shv_simulation_finished(const ShvSimulation *simulation);
const ShvFrameView *shv_simulation_frame(const ShvSimulation *simulation);
ShvMeshView shv_simulation_mesh(const ShvSimulation *simulation);

/* Current node positions by element corner (12 doubles an element: copies of a node differ across a crack), m; `corners`
   has room for 12 × element_count. Fragments in flight: the rigid pose. */
void shv_simulation_corner_positions(const ShvSimulation *simulation, double *corners);
/* Fragment index of every element, and damage 0…1 of every interior facet of it (4 per element: opposite corner 0…3; 0 on
   the boundary); either pointer may be NULL. */
void shv_simulation_element_state(const ShvSimulation *simulation, int32_t *fragment, double *damage);
/* Whether a tet is held across each of its facets (4 per element, likewise): 1 where the facet is intact or bonds, 0 where its
   bond has failed and on the boundary. */
void shv_simulation_bonds(const ShvSimulation *simulation, uint8_t *bonds);
/* Where it stands between frames; may be asked from `stop`. */
typedef struct ShvSimulationSummary {
    double time;
    int64_t steps;
    int32_t alive_count;
    bool fracture;
} ShvSimulationSummary;
ShvSimulationSummary shv_simulation_summary(const ShvSimulation *simulation);

/* Checkpoints. The whole state, as numbers lie in memory: for the same program, scene and meshes. Saving changes nothing; a
   simulation that goes on from there gives the same bits as one that never stopped. To be asked between frames or from `stop`. */
/* False where the scene's rigid engine has none (bullet_plain: Bullet's world cannot be made again as it was). */
bool shv_simulation_has_checkpoints(const ShvSimulation *simulation);
/* Writes to an open descriptor, from where it stands: so many bytes, with this CRC-32. */
ShvStatus shv_simulation_save(ShvSimulation *simulation, int descriptor, uint64_t *size, uint32_t *checksum,
                              ShvError *error);
/* Reads so many bytes, which must be just those that were written, into a simulation that was just made of the same scene (its
   duration may be another one). On failure it can only be destroyed. */
ShvStatus shv_simulation_load(ShvSimulation *simulation, int descriptor, uint64_t size, ShvError *error);
/* Of the placed meshes of objects and the surfaces of obstacles. */
uint64_t shv_simulation_geometry_hash(const ShvSimulation *simulation);
/* The crack that began first: all inserted facets joined, through shared nodes, to the first one. */
typedef struct ShvCrackView {
    int32_t facets;   /* 0: nothing was inserted, the rest is NaN */
    double origin[3]; /* centroid of the first facet inserted, m, in the reference mesh */
    double centre[3]; /* their centroid, weighted by area × damage, likewise; NaN while nothing has been damaged */
    /* unit normal of the plane through them: least squares of their centroids, weighted likewise */
    double normal[3];
} ShvCrackView;
ShvStatus shv_simulation_crack(const ShvSimulation *simulation, ShvCrackView *crack, ShvError *error);
/* Materials of the scene, in its order. */
int32_t shv_simulation_material_count(const ShvSimulation *simulation);
ShvMaterialView shv_simulation_material(const ShvSimulation *simulation, int32_t index);
/* "keep", "scale_strength", "scale_energy", "tip_strength" */
const char *shv_unresolved_name(ShvUnresolved unresolved);
/* What an obstacle is, in its own axes about its position; constant. Unused numbers are 0. */
typedef struct ShvObstacleBody {
    const char *name;
    ShvObstacleShape shape;
    ShvObstacleMotion motion;
    double normal[3], offset; /* plane: unit normal; solid below normal·x = offset, m, in the world's axes */
    double radius;            /* sphere, m */
    double size[3];           /* box: full edge lengths, m */
    double mass;              /* free: kg; else infinite */
    double friction, restitution;
    const double *positions; /* mesh: 3 × node_count, m, about the centre of mass; both valid as long as the owner */
    const int32_t *triangles;
    int32_t node_count, triangle_count;
} ShvObstacleBody;
ShvObstacleBody shv_simulation_obstacle(const ShvSimulation *simulation, int32_t index);
/* Threads that the solver uses. */
int32_t shv_simulation_threads(const ShvSimulation *simulation);
/* What the scene's output.nodes_within says. */
ShvNodesWithin shv_simulation_nodes_within(const ShvSimulation *simulation);
/* shv_rigid_engine_name of what moves bodies between impacts. */
const char *shv_simulation_rigid_engine(const ShvSimulation *simulation);
/* 64-bit hash of the whole solver state: equal runs, equal hashes. */
uint64_t shv_simulation_hash(const ShvSimulation *simulation);

#ifdef __cplusplus
}
#endif
#endif
