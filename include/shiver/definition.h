/* What a scene is made of: plain structs with defaults. Fill one from shv_…_default(), never from zero bytes:
   `cookie` marks a struct that started from its default, and a zeroed one is refused rather than run with zero
   toughness. SI units; angles in degrees where a name ends in _degrees. Arrays and strings stay the caller's
   (or the ShvScene's that parsed them) and must outlive the simulation made from them. */
#ifndef SHIVER_DEFINITION_H
#define SHIVER_DEFINITION_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SHV_DEFINITION_COOKIE 0x53484956u

/* ---- materials ---------------------------------------------------------------------------------------- */

typedef enum ShvKinematics {
    SHV_GREEN_STRAIN, /* St. Venant-Kirchhoff */
    SHV_COROTATIONAL  /* linear elastic in the element's rotated frame */
} ShvKinematics;

typedef enum ShvCohesiveLaw { SHV_PPR, SHV_CAMACHO_ORTIZ } ShvCohesiveLaw;

/* What becomes of a material whose cohesive zone the mesh is too coarse for. */
typedef enum ShvUnresolved {
    SHV_UNRESOLVED_KEEP,           /* strength and energy as given: crack tips are too tough on such a mesh */
    SHV_UNRESOLVED_SCALE_STRENGTH, /* lowers the strengths: cracks cost G, but begin too early */
    SHV_UNRESOLVED_SCALE_ENERGY,   /* raises the energies: cracks begin at the strength, but cost too much */
    SHV_UNRESOLVED_TIP_STRENGTH /* lowers the strengths ahead of cracks alone: they begin at the strength and cost G */
} ShvUnresolved;

/* Over what the strain of linear tets is averaged. */
typedef enum ShvSmoothing {
    SHV_SMOOTHING_AUTO, /* edges with SHV_UNRESOLVED_TIP_STRENGTH, else nothing */
    SHV_SMOOTHING_NONE, /* each tet has its own */
    SHV_SMOOTHING_EDGES /* the tets round each edge: walls about as thin as their edges bend */
} ShvSmoothing;

typedef struct ShvMaterialDefinition {
    uint32_t cookie;
    const char *name;
    double density;                 /* kg/m³, > 0 */
    double youngs_modulus;          /* Pa, > 0 */
    double poissons_ratio;          /* −1 < ν < 0.5 */
    ShvKinematics kinematics;       /* Green strain */
    ShvSmoothing smoothing;         /* SHV_SMOOTHING_AUTO */
    bool breakable;                 /* false: no facet of it ever opens */
    ShvCohesiveLaw law;             /* PPR */
    double fracture_energy;         /* J/m², mode I, ≥ 0 */
    double cohesive_strength;       /* Pa, mode I, ≥ 0; infinity: never opens */
    double fracture_energy_shear;   /* J/m²; NaN: as mode I */
    double cohesive_strength_shear; /* Pa; NaN: as mode I */
    double ppr_shape;               /* α > 1: 2 softens linearly in pure opening */
    double ppr_shape_shear;         /* β > 1; NaN: as α */
    double weibull_modulus;         /* spread of strength from facet to facet; 0: none */
    double weibull_volume;   /* m³ to which cohesive_strength belongs; 0: the same scatter for facets of any size */
    double weibull_area;     /* the same in m², of a material whose flaws lie on its surface; 0; one of both at most */
    double loss_factor;      /* η, 0 to 1: a vibration loses the share 2π η of its energy a period; 0 */
    double face_restitution; /* of crack faces that have opened and close again, 0 to 1; 0 */
    double friction_angle_degrees; /* φ: faces under pressure p resist p tan φ in shear besides cohesion; 0 to 90; 0 */
    ShvUnresolved unresolved;      /* where the cohesive zone is shorter than zone_edges mean edges of the mesh */
    double zone_edges;             /* mean edges that a resolved cohesive zone spans, ≥ 1; 5 */
} ShvMaterialDefinition;
ShvMaterialDefinition shv_material_default(void);

/* ---- meshes ------------------------------------------------------------------------------------------- */

typedef enum ShvMeshKind {
    SHV_MESH_BOX,
    SHV_MESH_BALL,
    SHV_MESH_HOLLOW_BALL,
    SHV_MESH_CYLINDER,
    SHV_MESH_NOTCHED_BEAM,
    SHV_MESH_GMSH,   /* .msh 2.2 ASCII, 4.1 ASCII and binary */
    SHV_MESH_TETGEN, /* .node and .ele */
    SHV_MESH_SHELL,  /* prisms extruded from a closed triangle surface, three tets a prism */
    SHV_MESH_STL, /* a closed triangle surface (STL, OBJ, PLY) or a CAD file, filled by gmsh, which must be installed */
    SHV_MESH_MEMORY, /* nodes and tets of the caller's */
    SHV_MESH_TURNED  /* what a closed profile sweeps about z, unstructured */
} ShvMeshKind;

typedef enum ShvMeshPattern {
    SHV_PATTERN_LATTICE,     /* body-centred lattice: tets all alike, cells halved towards the notch */
    SHV_PATTERN_BRICKS,      /* five tets a brick, bricks thinned along x towards the notch: fewer tets a node */
    SHV_PATTERN_UNSTRUCTURED /* no order, and at least two layers; not for notched beams */
} ShvMeshPattern;

typedef struct ShvMeshDefinition {
    uint32_t cookie;
    ShvMeshKind kind;
    double size[3];         /* box, notched beam: length (x), depth (y), height (z), m; centred on the origin */
    double radius;          /* ball, hollow ball, cylinder: outer radius, m */
    double inner_radius;    /* hollow ball: > 0; cylinder: 0 (solid) or > 0 */
    double height;          /* cylinder: along z, m */
    double edge;            /* target edge length, m */
    double notch_depth;     /* notched beam: from the bottom face (−z) upwards, m */
    double notch_offset;    /* notched beam: along x from midspan, m */
    double notch_edge;      /* notched beam: edge length at the notch, m; graded to `edge` away from it; 0: `edge` */
    double notch_growth;    /* notched beam: growth of the edge asked for per distance from the notch, > 0; 0.3 */
    ShvMeshPattern pattern; /* box, notched beam */
    double jitter;    /* random shift of nodes as a share of the shortest incident edge, 0…0.3; surface nodes stay on
                               the surface; no tet is inverted, and the worst are improved */
    uint64_t seed;    /* of the jitter, of an unstructured mesh, of what `improve` tries */
    bool improve;     /* gmsh, tetgen, memory: improves the tenth of its tets that is worst; stl does so always */
    const char *file; /* gmsh, tetgen (base name or .node), shell surface (OBJ, STL, PLY), stl */
    double scale;     /* multiplies every coordinate of a file, > 0; 1. stl: `edge` is that after it */
    double thickness; /* shell: inwards, m (after scale) */
    int32_t layers;   /* shell: ≥ 1 */
    int64_t
        refine_to; /* shell: split the longest edges until the surface has at least this many triangles; 0: as it is */
    /* memory: 3 × node_count, m; 4 × tet_count, nodes from 0, the fourth on the side to which the triangle of the first three
       goes counter-clockwise. They are copied when the simulation is made. */
    const double *positions;
    const int32_t *tets;
    int32_t node_count, tet_count;
    const double *profile; /* turned: radius (≥ 0) and height of each corner, m; the last joins the first */
    int32_t profile_count; /* corners, ≥ 3 */
} ShvMeshDefinition;
ShvMeshDefinition shv_mesh_default(void);

/* ---- objects, sets of nodes, conditions --------------------------------------------------------------- */

typedef struct ShvPlacement {
    double position[3];      /* m: where the mesh's origin goes */
    double rotation_axis[3]; /* need not be a unit vector */
    double rotation_degrees;
    double velocity[3];         /* m/s of the centre of mass */
    double angular_velocity[3]; /* rad/s, world axes, about the centre of mass */
    double stretch_rate[3];     /* 1/s, objects: velocity rate × (x − centre of mass) along each world axis on top */
} ShvPlacement;

typedef enum ShvSelectionKind { SHV_SELECT_ALL, SHV_SELECT_BOX, SHV_SELECT_PLANE } ShvSelectionKind;

/* Nodes (or, for a traction, boundary facets whose three nodes are all chosen) of one object, judged on its placed
   mesh at the start, world coordinates. */
typedef struct ShvSelection {
    ShvSelectionKind kind;
    double box_min[3], box_max[3];
    double plane_normal[3], plane_offset; /* |n·x − offset| ≤ tolerance, n of unit length */
    double tolerance;                     /* m */
} ShvSelection;

/* A crack that is there from the start: facets whose corners are all chosen by `plane` and whose middle by `box`. */
typedef struct ShvCrackDefinition {
    ShvSelection plane, box; /* a plane; a box, or all */
} ShvCrackDefinition;

/* A physical volume of a gmsh file that is of another material. */
typedef struct ShvGroupDefinition {
    const char *name; /* of the physical volume, or its number */
    const char *material;
} ShvGroupDefinition;

typedef struct ShvObjectDefinition {
    uint32_t cookie;
    const char *name;
    ShvMeshDefinition mesh;
    const char *material; /* of all that is in none of `groups`; when the object wakes and rests follows from it */
    const ShvGroupDefinition *groups;
    int32_t group_count;
    ShvPlacement placement;
    bool waits; /* it is not in the scene until shv_simulation_enter brings it */
    const ShvCrackDefinition *cracks;
    int32_t crack_count;
} ShvObjectDefinition;
ShvObjectDefinition shv_object_default(void);

typedef enum ShvConditionKind {
    SHV_CONDITION_SUPPORT,  /* the chosen components keep zero velocity */
    SHV_CONDITION_VELOCITY, /* the chosen components follow `value`, m/s */
    SHV_CONDITION_TRACTION  /* `value`, Pa, on the chosen boundary facets (area at the start) */
} ShvConditionKind;

typedef struct ShvConditionDefinition {
    uint32_t cookie;
    const char *name; /* for `release` events */
    const char *object;
    ShvSelection selection;
    ShvConditionKind kind;
    bool axes[3]; /* support, velocity: which components */
    double value[3];
    double ramp_time;  /* s: value × min(1, (t − start)/ramp_time); 0: at once */
    double start, end; /* s: in force for start ≤ t < end */
} ShvConditionDefinition;
ShvConditionDefinition shv_condition_default(void);

/* ---- obstacles ---------------------------------------------------------------------------------------- */

typedef enum ShvObstacleShape {
    SHV_OBSTACLE_PLANE,
    SHV_OBSTACLE_SPHERE,
    SHV_OBSTACLE_BOX,
    SHV_OBSTACLE_MESH
} ShvObstacleShape;
typedef enum ShvObstacleMotion {
    SHV_OBSTACLE_FIXED,
    SHV_OBSTACLE_SCRIPTED, /* follows its keyframes */
    SHV_OBSTACLE_FREE      /* an unbreakable rigid body with mass */
} ShvObstacleMotion;

typedef struct ShvKeyframe {
    double time;        /* s, increasing */
    double position[3]; /* m */
    double rotation_axis[3];
    double rotation_degrees; /* linear motion between keyframes, rotation by the shortest arc; held before and after */
} ShvKeyframe;

typedef struct ShvObstacleDefinition {
    uint32_t cookie;
    const char *name;
    ShvObstacleShape shape;
    double plane_normal[3], plane_offset; /* solid below n·x = offset; a plane is fixed */
    double radius;                        /* sphere */
    double size[3];                       /* box: full edge lengths, centred */
    const char *file;                     /* mesh: closed triangle surface, OBJ, STL or PLY */
    double scale;
    double friction;    /* Coulomb coefficient, ≥ 0 */
    double restitution; /* 0…1: rigid modes and PBD; node contact of explicit fracture has none */
    ShvObstacleMotion motion;
    double mass; /* kg, free: > 0; inertia that of the homogeneous solid */
    ShvPlacement placement;
    bool waits; /* free ones: not in the scene until shv_simulation_enter brings it */
    const ShvKeyframe *keyframes;
    int32_t keyframe_count;
} ShvObstacleDefinition;
ShvObstacleDefinition shv_obstacle_default(void);

/* ---- probes ------------------------------------------------------------------------------------------- */

typedef enum ShvProbeKind {
    SHV_PROBE_POINT,   /* a point of a body, in the tet that holds it at the start: it moves with that tet */
    SHV_PROBE_NODES,   /* mean over chosen nodes of an object and all their copies */
    SHV_PROBE_OBSTACLE /* an obstacle */
} ShvProbeKind;

/* What is watched; what a sample holds is told by ShvProbeSample (simulation.h). */
typedef struct ShvProbeDefinition {
    uint32_t cookie;
    const char *name;
    ShvProbeKind kind;
    const char *object;     /* nodes; point: NULL takes the first object that has the point */
    double point[3];        /* m, world at the start */
    ShvSelection selection; /* nodes */
    const char *obstacle;
} ShvProbeDefinition;
ShvProbeDefinition shv_probe_default(void);

/* ---- events on the time line -------------------------------------------------------------------------- */

typedef enum ShvEventKind {
    SHV_EVENT_RELEASE,      /* `target`: a condition, from now on out of force */
    SHV_EVENT_SET_VELOCITY, /* `target`: an object's fragments or a free obstacle; value and angular */
    SHV_EVENT_IMPULSE,      /* `target`: likewise; value in N·s, shared by mass over the object's fragments */
    SHV_EVENT_GRAVITY       /* value: the new gravity, m/s² */
} ShvEventKind;

typedef struct ShvEventDefinition {
    uint32_t cookie;
    double time;
    ShvEventKind kind;
    const char *target;
    double value[3], angular[3];
} ShvEventDefinition;
ShvEventDefinition shv_event_default(void);

/* ---- rigid mode, fracture mode, output ---------------------------------------------------------------- */

typedef enum ShvRigidEngine {
    SHV_RIGID_ANALYTIC, /* flight in closed form; contacts with obstacles by impulses, none between fragments */
    SHV_RIGID_PBD,      /* nodes held together by bars and damped towards rigid motion; none between fragments */
    SHV_RIGID_BULLET, /* convex pieces in Bullet: contacts with obstacles and between fragments; flight in closed form */
    SHV_RIGID_BULLET_PLAIN /* the same pieces in a stock Bullet world, which integrates, detects and solves by itself */
} ShvRigidEngine;
/* The word of a scene for an engine: "bullet". */
const char *shv_rigid_engine_name(ShvRigidEngine engine);

typedef enum ShvBarForm {
    SHV_BARS_EDGE,   /* each edge once a sweep */
    SHV_BARS_ELEMENT /* each edge once for every tet around it, as in a loop over tets */
} ShvBarForm;

/* Position based dynamics: rigid bars along edges, damping towards rigid motion. Serves rigid.engine pbd and
   fracture.stabiliser bars. */
typedef struct ShvPbdDefinition {
    double stiffness;   /* k of a projection, 0…1 */
    int32_t iterations; /* sweeps a step, ≥ 1 */
    ShvBarForm form;
    double damping;      /* k of the damping in rigid mode, 0…1 */
    bool exact_rotation; /* rigid mode: nodes turn on circles instead of tangents, so that radii do not drift */
} ShvPbdDefinition;

/* What departs from Bullet's own ways with rigid.engine bullet: all true unless changed. */
typedef struct ShvBulletDefinition {
    bool exact_flight;     /* parabola and free rotation in closed form between contacts */
    bool times_of_impact;  /* what closes fast meets at its own time within a step, and rebounds there */
    bool exact_contacts;   /* on the hulls themselves, whole faces at once */
    bool settled_impulses; /* sweeps to a tolerance, mixed; friction on the cone */
    bool touching_islands; /* bodies that touch are solved together, not those whose boxes meet */
    bool keep_overlaps;    /* that a body comes with are let be */
} ShvBulletDefinition;

/* What departs from Bullet's defaults with rigid.engine bullet_plain. */
typedef struct ShvBulletPlainDefinition {
    double unit;        /* m: what Bullet takes for 1 */
    double margin;      /* round convex hulls, in those units */
    bool exact_flight;  /* parabola and free rotation in closed form between contacts */
    bool sharp_impacts; /* rebounds at the touch: gaps do not brake them, depth does not feed them */
    bool sorted_pairs;  /* the order of pairs is that of the bodies' numbers */
    bool keep_overlaps; /* overlaps that a body comes with are let be */
} ShvBulletPlainDefinition;

typedef enum ShvWake {
    SHV_WAKE_CONTACT, /* every new contact wakes; under Bullet at most one in a rigid step and body */
    SHV_WAKE_STRESS /* a new contact wakes when its impact stress estimate K ρ c₀ v reaches wake_fraction × strength */
} ShvWake;

typedef enum ShvDust {
    SHV_DUST_KEEP,     /* a rigid body like any other */
    SHV_DUST_PARTICLE, /* flies for good: meets obstacles, but no fragment, and does not wake */
    SHV_DUST_BIN       /* stays where it is, out of motion and contact; its momentum is booked */
} ShvDust;

typedef struct ShvRigidDefinition {
    ShvRigidEngine engine;
    double time_step; /* s */
    ShvWake wake;
    double wake_fraction; /* of the weakest facet's strength; 0.5 */
    double wake_factor;   /* K; 6 */
    double friction;      /* between fragments, where they see each other, Coulomb coefficient, ≥ 0; 0.5 */
    double restitution;   /* between fragments in flight, 0…1; 0 */
    ShvDust dust;         /* of fragments that would go to rest and are smaller than */
    double dust_size; /* m: diameter of the sphere about the centre of mass that holds the fragment; 0: none is dust */
    ShvBulletDefinition bullet;
} ShvRigidDefinition;

typedef enum ShvStabiliser {
    SHV_STABILISER_NONE, /* plain central difference below the stable step */
    SHV_STABILISER_BARS  /* bars relax predicted positions: steps of a few times the stable one become possible, and the
                            bars do work that is not the material's */
} ShvStabiliser;

typedef enum ShvCriterion {
    SHV_CRITERION_TRACTION, /* facet traction √(⟨tn⟩² + |tt|²/β²), β = shear/normal strength, against the facet's strength */
    SHV_CRITERION_FORCE,    /* forces between the tets at a node: all facets of the disk by which they part, together */
    SHV_CRITERION_PRINCIPAL /* largest principal stress at each of the facet's three nodes (volume average) */
} ShvCriterion;

typedef enum ShvActivation {
    SHV_ACTIVATION_TRACTION, /* the law starts at the facet's own traction: no jump of acceleration */
    SHV_ACTIVATION_STRENGTH  /* the law starts at the strength (plain extrinsic law, jumps) */
} ShvActivation;

/* What joins tets to a fragment. */
typedef enum ShvConnectivity {
    SHV_CONNECTIVITY_BONDS, /* intact facets, and cohesive ones of whose normal strength more than a hundredth is left */
    SHV_CONNECTIVITY_NODES  /* shared nodes: a crack cuts as soon as it is inserted, whatever it still carries */
} ShvConnectivity;

typedef enum ShvDeformation {
    SHV_DEFORMATION_DROP, /* a fragment that leaves fracture mode is as it was made; strain energy is dropped, and booked */
    SHV_DEFORMATION_KEEP /* it wakes as deformed as it came to rest: strain and open cracks go on where they were */
} ShvDeformation;

typedef struct ShvFractureDefinition {
    bool enabled;    /* false: bodies deform but nothing opens */
    ShvSelection on; /* facets that may open: those whose three nodes are chosen, on the placed mesh; all */
    ShvStabiliser stabiliser;
    double time_step;    /* s; NaN: automatic */
    double safety;       /* share of the stable step when automatic, 0…1; 0.9 */
    int32_t check_every; /* steps between checks; 0: automatic, for an overshoot of 10 % while stress grows as it did */
    double threshold;    /* share of the strength at which facets open; 1 */
    ShvCriterion criterion;
    ShvActivation activation;
    double
        regularisation; /* ε of PPR: slip below ε × final slip meets only part of the shear traction, whose direction it
                                 fixes; costs 2ε/3 of the work of separation in pure opening; 0.005 */
    ShvConnectivity connectivity;
    int32_t quiet_checks;       /* checks without insertion that end fracture mode when no contact is closing; 20 */
    double longest;             /* s: a fragment leaves fracture mode this long after its last insertion; 0: automatic,
                                 20 transits of the slowest bending wave */
    ShvDeformation deformation; /* over a rigid phase */
    double energy_bound; /* the run stops when the ledger's residual exceeds this share of the largest energy; 0.05 */
} ShvFractureDefinition;

/* Bounds on what a mode switch may change; one exceeded stops the run with SHV_DIVERGED. Infinity: no bound. */
typedef struct ShvAuditDefinition {
    double
        momentum; /* |change of P| / Σ m|v| and |change of L| / Σ m|r||v| over a fragment's nodes, about the origin */
    double
        dropped_share; /* energy dropped when a fragment goes to rest, of all that it carries (potential aside), or of
                             what it woke with where that was more */
    double hull_error; /* space that convex pieces hold without tets, and tets in none of them, of the volume */
} ShvAuditDefinition;

/* Which node positions are recorded with `nodes`; damage, bonds and fragments of tets are, of all. */
typedef struct ShvNodesWithin {
    double from, to;  /* s: of frames in between; 0 and infinity: all */
    int64_t every;    /* of every so many frames of the run file, the first counted; ≥ 1 */
    ShvSelection box; /* of tets with a corner in it at the start; infinite: all */
} ShvNodesWithin;
/* Whether that leaves anything out. */
bool shv_nodes_limited(const ShvNodesWithin *within);

typedef struct ShvOutputDefinition {
    const char *file;       /* run file; NULL: from the scene's name */
    double rate;            /* frames a second */
    int64_t fracture_every; /* also record a frame every so many steps of fracture mode; 0: off */
    bool nodes;             /* node positions and facet damage of every frame */
    int64_t probe_every;    /* probes are sampled every so many steps of fracture mode, ≥ 1; 1 */
    double probe_interval;  /* s: instead, at the first step at or after every multiple of it; 0: off */
    ShvNodesWithin nodes_within;
} ShvOutputDefinition;

/* A motion that is known in closed form and follows from the scene's own numbers: what `shiver compare` measures errors from. */
typedef enum ShvReferenceLaw {
    SHV_REFERENCE_NONE,   /* the finest run instead */
    SHV_REFERENCE_FLIGHT, /* parabola and torque-free rotation, no contact */
    SHV_REFERENCE_BOUNCE, /* falls straight on to a plane, hits it below its centre, rebounds with the plane's restitution */
    SHV_REFERENCE_SLIDE, /* slides on a plane or sticks to it, Coulomb friction; does not turn */
    SHV_REFERENCE_ROLL,  /* sphere: slips on a plane until friction makes it roll */
    SHV_REFERENCE_REST   /* stays where it is */
} ShvReferenceLaw;

typedef struct ShvReferenceDefinition {
    ShvReferenceLaw law;
    const char *body; /* object or free obstacle that follows it; NULL: every one (flight and rest alone) */
    const char *on;   /* obstacle, a plane: bounce, slide, roll; else NULL */
} ShvReferenceDefinition;

/* Objects that stand in each other or in obstacles at the start, by more than a millionth of the smaller one's size. */
typedef enum ShvOverlapPolicy {
    SHV_OVERLAPS_REFUSE, /* no simulation is made; the message says what overlaps and what parts it */
    SHV_OVERLAPS_KEEP    /* the run goes on as shv_simulation_overlap_course says */
} ShvOverlapPolicy;

/* What `shiver survive` varies, and what it calls broken. */
typedef enum ShvSurvivalVariation {
    SHV_SURVIVAL_HEIGHT, /* the speed along gravity that a fall from a height gives */
    SHV_SURVIVAL_SPEED   /* the speed along the velocity that the object has in the scene */
} ShvSurvivalVariation;

typedef struct ShvSurvivalDefinition {
    const char *object; /* that is dropped; NULL: the scene's only one */
    double broken;      /* share of its mass that the largest piece is below when it has broken, in (0, 1); 0.95 */
    ShvSurvivalVariation vary;
    bool turn; /* each specimen in an orientation of its own, at random; its lowest point stays as high as it was */
} ShvSurvivalDefinition;

typedef struct ShvSceneDefinition {
    uint32_t cookie;
    const char *name;
    const ShvMaterialDefinition *materials;
    int32_t material_count;
    const ShvObjectDefinition *objects;
    int32_t object_count;
    const ShvConditionDefinition *conditions;
    int32_t condition_count;
    const ShvObstacleDefinition *obstacles;
    int32_t obstacle_count;
    const ShvEventDefinition *events; /* increasing time */
    int32_t event_count;
    const ShvProbeDefinition *probes;
    int32_t probe_count;
    ShvOverlapPolicy overlaps; /* refuse */
    double gravity[3];
    ShvRigidDefinition rigid;
    ShvPbdDefinition pbd;
    ShvBulletPlainDefinition bullet_plain;
    ShvFractureDefinition fracture;
    ShvAuditDefinition audit;
    ShvOutputDefinition output;
    ShvReferenceDefinition reference;
    ShvSurvivalDefinition survival;
    double duration; /* s */
    uint64_t seed;   /* Weibull strengths */
    int32_t threads; /* 0: as many processors as have work */
} ShvSceneDefinition;
ShvSceneDefinition shv_scene_default(void);

#ifdef __cplusplus
}
#endif
#endif
