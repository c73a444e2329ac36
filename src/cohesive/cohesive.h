/* Cohesive facets: those that have been inserted between two tets. Each carries three points, one at each corner
   (nodal quadrature, weight area/3), so that a point's opening is the distance of one pair of node copies; where the
   crack front still shares its node, the opening is zero.

   Traction is an impulse after the kick of the other forces, which does the law's work exactly for any step (pair.h);
   there is no cohesive limit on the step. The calls of one step, in this order:
       shv_cohesive_begin    positions of n, velocities of n − 1/2
       kick by the other forces
       shv_cohesive_pull     cohesive impulses
       shv_cohesive_close    closing faces
       contact, supports
       shv_cohesive_book     with the velocities that the drift will use
       drift
   `begin` moves the histories to where the last step really led and may be called again at the same time. A cluster of
   pairs never gives more energy than it stores, and never stores more than it had and was given, however far its
   impulses are from having settled: the first by scaling them, the second by softening it. The last four may be tried and thrown away by putting the velocities back. Insertion comes before `begin`. */
#ifndef SHV_COHESIVE_COHESIVE_H
#define SHV_COHESIVE_COHESIVE_H

#include "cohesive/front.h"
#include "cohesive/pair.h"
#include "cohesive/star.h"
#include "model/ledger.h"
#include "model/state.h"

typedef enum ShvCohesivePhase {
    SHV_COHESIVE_CARRYING,
    SHV_COHESIVE_FAILED,   /* no traction left; its faces can still meet */
    SHV_COHESIVE_SEPARATED /* the faces have left each other: nothing looks at it any more */
} ShvCohesivePhase;

/* What a point remembers from step to step: side by side, as they are asked for together, in 64 bytes. */
typedef struct ShvInternalVariables {
    ShvHistory history;
    ShvOpening opening; /* at the last half step */
    double peak;        /* largest traction still to come, Pa */
    double energy_debt; /* what sweeps that had not settled have given more than was stored so far, J */
    double held;        /* taken by closing faces, to be given back when they part, J */
} ShvInternalVariables;

/* A corner of a facet whose nodes are split and whose law still carries, in the present step. */
typedef struct ShvCohesivePoint {
    int32_t first, second; /* nodes */
    int32_t point;         /* 3 × cohesive facet + corner */
    int32_t rotation;      /* of its facet */
    int32_t block;         /* points of the same pair of nodes from this one on */
    double weight;         /* area/3, m² */
    double start_energy;   /* of the rigid start of its law: strength × normal opening, J */
    double peak;           /* largest traction it may still show, Pa */
    double stored;         /* recoverable energy at n − 1/2, J */
    double work;           /* of the pull on the way from n − 1/2 to n + 1/2, as booked, J */
    ShvOpening reached;    /* at n + 1/2, as booked */
    ShvLawSprings springs; /* of its history (force.c) */
    ShvVec3 opening, from; /* of n and, seen by one who turns with the facet, n − 1/2, second − first, m */
    ShvVec3 pull;          /* cohesive force on the first node, N */
    ShvVec3 last;          /* the same in the last step that was taken */
    ShvVec3 settled;       /* rate of opening that the pull was to lead to, m/s; not finite: none yet */
} ShvCohesivePoint;

/* What the pull of a point needs besides, as long as its cluster is solved. */
typedef struct ShvPointSolve {
    ShvPair pair;
    double response;       /* 1/kg: change of relative velocity per impulse, masses shared among the points of a pair */
    double yield[2];       /* kick/mass of both nodes: change of velocity per force, s/kg */
    ShvVec3 rotation_rate; /* rate of opening that is the facet's turn alone, m/s */
    ShvVec3 change;        /* of pull, in the present sweep, N */
} ShvPointSolve;

/* A corner of a facet that carries, split or not: where answers to couples go. */
typedef struct ShvCohesiveCorner {
    int32_t first, second; /* nodes */
    int32_t slot;          /* 3 × turn + corner */
} ShvCohesiveCorner;

/* How a facet stands and turns in the present step, by the middles of its three pairs (facet_rotation.h). */
typedef struct ShvFacetRotation {
    int32_t index; /* cohesive facet */
    int32_t first[3], second[3];
    int32_t cluster[3]; /* of its corners, where it carries */
    bool carries;       /* its points are listed */
    bool rotates;       /* couples are answered */
    bool news;          /* nodes of it have other velocities since the last pull */
    bool answers;       /* `answer` is not zero */
    bool known;         /* what follows its constants is that of the present step */
    double area;        /* m², as all of its constants those of its two sides */
    double returned, friction;
    ShvVec3 reference[2];
    ShvVec3 normal;    /* of the mean of both faces, from the first to the second */
    ShvVec3 rate;      /* of turn, rad/s */
    ShvVec3 arm[3];    /* of the middles from their mean, m */
    double spread;     /* 1/Σ |arm|², 1/m² */
    double tilt;       /* 3/(twice the area)², 1/m⁴ */
    double inverse[6]; /* of Σ |arm|² − arm armᵀ: xx, xy, xz, yy, yz, zz; 1/m² */
    ShvVec3 couple;    /* N m: of the pulls, answered so far */
    ShvVec3 answer;    /* to what of it is new: half the force on a middle is answer × arm; zero: nothing is */
} ShvFacetRotation;

/* Of the three pairs of a facet; zero where they are not split. */
typedef struct ShvFacetGaps {
    ShvVec3 opening[3];  /* second − first, of n, m */
    ShvVec3 before[3];   /* way of the opening from n − 1/2 to n, seen by one who turns with the facet, m */
    ShvVec3 push[3];     /* closing force on the first node, N */
    bool pressed[3];     /* it keeps them from closing further, and does not give back what they hold */
    double freed[3];     /* kinetic energy that giving back has brought so far, J */
    double taken[3];     /* by the push from the nodes in the step, as booked, J */
    ShvVec3 friction[3]; /* friction on the first node, N */
} ShvFacetGaps;

/* What pulls of a cluster may still give, and how much of that changes of velocities may take at most. */
typedef struct ShvClusterBudget {
    double left;          /* stored + work of the pulls, round-off granted; J */
    double force;         /* Σ |pull|, N */
    double couple;        /* Σ |pull| |opening|, N m */
    double shift;         /* bound of the changes of rates by the answers to couples, m/s */
    bool limited;         /* in the last check of it */
    bool kicked, rotated; /* listed (below); false between pulls */
} ShvClusterBudget;

/* The two faces of a facet as they are joined to the mesh now. */
typedef struct ShvCohesiveSides {
    int32_t first[3], second[3]; /* nodes of corner i on both faces */
    int32_t elements[2];
    bool split;      /* in some corner the nodes are not the same */
    ShvVec3 arm[2];  /* of corners 1 and 2 from corner 0, at reference positions, m */
    double start;    /* normal opening with which the law starts (shv_law_start), m */
    double returned; /* share of what closing faces take that they give back: restitution² */
    double friction; /* tan φ */
} ShvCohesiveSides;

enum { SHV_NEAREST_FACETS = 16 };

/* Facets of a chunk that is closed by one thread: neighbours, as lists are in order of nodes. Fewer would need more colours, more leave
   threads without a chunk. Chunks of the last colour may share nodes, and follow one another. */
enum { SHV_CLOSING_CHUNK = 16, SHV_CLOSING_COLOURS = 31 };

typedef enum ShvFacetWatch {
    SHV_FACET_IGNORED,
    SHV_FACET_WATCHED,
    SHV_FACET_LISTED /* to be judged in the present check */
} ShvFacetWatch;

/* Who puts the stress of some batches of elements, each asked for once a check, where the check finds it. */
typedef struct ShvStressSource {
    void (*fill)(void *context, const int32_t *batches, int32_t count);
    void *context;
} ShvStressSource;

/* One for each thread. */
typedef struct ShvStars {
    ShvStar *items;
    int32_t count;
} ShvStars;

/* Work space of the force criterion (star.h); empty with the others. */
typedef struct ShvStarSearch {
    ShvStars stars;
    int32_t *nodes; /* node_capacity: those to look at, then those whose tets part */
    double *ratio;  /* as nodes */
    uint8_t *mark;  /* node_capacity; 0 between checks */
    double *value;  /* node_capacity: largest of a node's facets in the present check; 0 between checks */
    double *held; /* node_capacity: the same in the last check of the node, which found that the node holds; 0: none */
    double
        *left; /* node_capacity: then, of half of what would part it, the share that its facets still lacked; 0: none */
    double *facet_along; /* interior_count: of facets that were chosen, |cosine| between normal and opening */
} ShvStarSearch;

typedef struct ShvCohesive {
    ShvMemory *memory;
    const ShvModel *model;
    const ShvFractureDefinition *settings;
    int32_t *facet_cohesive; /* interior_count: index of the cohesive facet, −1 while intact */
    double *facet_strength;  /* interior_count: normal strength with scatter, Pa; infinite: cannot break */
    int32_t count, capacity;
    /* per cohesive facet, in the order of insertion */
    int32_t *facet;   /* facet of the adjacency */
    uint8_t *partner; /* 3 per facet: which corner of the second element's face meets corner i of the first's */
    ShvCohesiveSides *sides;
    double *area; /* m², reference */
    ShvLaw *law;
    ShvInternalVariables *internal; /* 3 per facet */
    ShvVec3 *force;                 /* 3 per facet: pull of the last step, where it is in no list; N */
    uint8_t *phase;                 /* ShvCohesivePhase */
    uint8_t *bonded;                /* it joins its two tets (bond.c) */
    double *born;                   /* time of insertion, s */
    double *apart; /* way of its nodes on which its faces stay apart (solve.h), m; −∞: pushed, or new in the lists */
    uint8_t *opened; /* enough for its nodes to be a front (front.h) */
    int32_t *failed; /* facets whose bonds failed in the last search, increasing */
    int32_t failed_count;
    double worst_overshoot; /* largest criterion / strength met at an insertion */
    int32_t live_count;     /* not separated: */
    int32_t *live;          /* cohesive facets, increasing */
    /* The present step: live facets with a split corner that do not rest, listed anew when others come or many fail. */
    bool unlisted;             /* the lists do not fit any more; */
    bool idle;                 /* or from the next time on, since many of their facets carry no more */
    const uint8_t *list_awake; /* what they were made with */
    bool torn; /* bonds have been since `begin`: springs of points may not be those of their histories */
    int32_t rotation_count;
    ShvFacetRotation *rotations;
    ShvVec3 *couple;    /* 3 per facet that turns: of pulls, opening × pull, N m */
    ShvFacetGaps *gaps; /* as `rotations` */
    int32_t *closed;    /* as `rotations`: number of its last look in the present closing, of all looks at facets */
    int32_t *chunks;    /* of facets in the lists (closure.c), colour by colour; as many as `rotations` have room for */
    int32_t colour_start[SHV_CLOSING_COLOURS + 1]; /* into `chunks` */
    bool pushed;                                   /* some closing forces are not zero */
    double booked_time, begun_time;                /* s: of the time whose step was booked, begun last */
    int32_t point_count;                           /* of facets that carry: */
    ShvCohesivePoint *points;
    int32_t most_facets;   /* round one node of the mesh */
    ShvPointSolve *solves; /* so many for each thread */
    int32_t pair_count;    /* split corners of all facets in the lists */
    int32_t cluster_count;
    int32_t *cluster;        /* cluster_count + 1, into `points`: those between copies of one node of the mesh */
    int32_t *cluster_corner; /* cluster_count + 1, into `corners` */
    ShvCohesiveCorner *corners;
    ShvClusterBudget *budget; /* cluster_count */
    int32_t kicked_count,
        rotated_count; /* as far as `cluster_count`, in one pull: clusters whose nodes answers to couples have kicked, */
    int32_t *kicked_clusters, *rotated_clusters; /* and those of whose facets some rotate otherwise since */
    double pull_kick, pull_step;                 /* of the last pull; 0: none yet */
    double *pulled_velocity;                     /* 3 × node_capacity: as the last pull left it */
    uint8_t *node_news;                          /* node_capacity: it has another velocity since */
    int32_t *corner_nodes;                       /* node_capacity: nodes of `corners`, each once, */
    int32_t corner_node_count;                   /* so many */
    int32_t *struck; /* node_capacity: number (`closed`) + 1 of its last strike by closing faces; 0: none in the step */
    int32_t *origin_fill; /* mesh.node_count; zero between steps */
    double *overdrawn;    /* mesh.node_count: given by closing faces at its copies beyond what they held, J */
    int32_t node_capacity;
    int64_t sweeps; /* of the last pull, over all clusters */
    /* work space of insertion and criterion */
    int32_t *corner_label, *corner_queue, *corner_copy; /* largest number of corners at a node */
    double *facet_value;                                /* interior_count */
    uint8_t *facet_watch;                               /* interior_count: ShvFacetWatch */
    /* traction criterion: weight of each face of an element on a watched facet, 1/Pa, 0 elsewhere (4 × SHV_LANES × batches), and
       the faces whose traction may count (batches), which the solid finds with the internal force; no facet counts more
       than the larger of its two faces */
    double *face_weight;
    uint32_t *faces;
    ShvStarSearch search;
    ShvFront front;
    ShvInitiation initiation;
    int32_t *asked;                      /* batches whose stress the check asks for: batches */
    uint8_t *stress_known;               /* batches: of the present check */
    int32_t nearest[SHV_NEAREST_FACETS]; /* facets that had the largest values below the level at the last check */
    int32_t nearest_count;
    int32_t *watched,
        *watched_nodes; /* facets that the check looks at closely; with the principal criterion facets and nodes that it looks at,
                           increasing */
    int32_t watched_count, watched_node_count;
    double
        *node_value; /* 2 × node_capacity, principal criterion only: largest principal stress or a bound, lower bound */
} ShvCohesive;

ShvStatus shv_cohesive_create(ShvCohesive *cohesive, const ShvModel *model, const ShvFractureDefinition *settings,
                              ShvError *error);
void shv_cohesive_release(ShvCohesive *cohesive);

/* Material whose law a facet follows: that of its weaker element, of equal ones the first's. */
const ShvMaterial *shv_cohesive_material(const ShvModel *model, int32_t facet);
/* Strength scale of a facet, 1 without scatter: Weibull, (−ln u)^(1/m) (V₀/V)^(1/m), with u from model->seed and the facet's
   number, V a quarter of both elements' volumes (each element shared among its four facets), V₀ weibull_volume; with
   weibull_area in its place V is the facet's own area; with neither there is no effect of size. Independent of order. */
double shv_cohesive_strength_scale(const ShvModel *model, int32_t facet);
/* Strength of the flaws at a node of the mesh, where all tets are of one material, Pa: with scatter that of a quarter of their
   volumes, or a third of their area on the surface, by the same rule. */
double shv_cohesive_node_strength(const ShvModel *model, int32_t node);
/* Weakest facet strength of a set of elements' interior facets (elements NULL: all), Pa; infinity when none can break. */
double shv_cohesive_weakest(const ShvCohesive *cohesive, const int32_t *elements, int32_t count);

/* From now on checks look at the intact facets whose two elements are in awake fragments (awake: one byte per fragment index,
   NULL: all). To be called before the first check and whenever fragments wake, sleep or come apart. */
void shv_cohesive_watch(ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake);
/* Criterion value / facet strength of every watched facet that is intact; returns the largest. Fills `candidates` (room for interior_count) with
   facets at or above settings->threshold, ordered by descending overstress, ties by facet number. `stress` from
   shv_solid_stress; `nodal` (6 per node) only for the principal criterion. */
double shv_cohesive_candidates(ShvCohesive *cohesive, const ShvState *state, const double *stress, const double *nodal,
                               int32_t *candidates, double *overstress, int32_t *count);

/* The same for the traction criterion in two halves, around the search for faces that count at least the first's result into
   cohesive->faces (shv_solid_add_internal_force_and_find_faces): stress is asked for where it matters alone. */
double shv_cohesive_floor(ShvCohesive *cohesive, const ShvState *state, const double *stress, ShvStressSource source);
double shv_cohesive_face_candidates(ShvCohesive *cohesive, const ShvState *state, const double *stress,
                                    ShvStressSource source, int32_t *candidates, double *overstress, int32_t *count);

/* Inserts facets: makes them cohesive and duplicates nodes by the rule that a node is split among the groups of its
   elements that are still joined across intact facets. Order of facets does not matter. Copies inherit position and
   velocity; masses are re-summed from elements. On failure nothing changed. `duplicated` receives the number of new
   nodes.

   Start of the law. A new pair is held by whatever traction it needs up to the law's peak, so that acceleration is
   continuous as long as the peak suffices. With SHV_ACTIVATION_STRENGTH the peak is the strength. With
   SHV_ACTIVATION_TRACTION strengths are scaled so that the peak (of each component) is the facet's own traction, raised
   to the criterion's limit where it is below: a facet that is found above its strength starts from what it carries, and
   one in mixed mode softens from the criterion's ellipse instead of the law's box. Energies are kept, so final openings
   change inversely; the scale lies between 1/√2 and the overshoot. `stress` NULL: no scaling.
   With the force criterion the law starts with the components of the traction by which the facet was judged, whatever it
   carries: strength is what it holds, and a disk opens as soon as it is asked for more. Disks that begin by the tension of the
   surface (initiation.h) start with what they pass on. */
ShvStatus shv_cohesive_insert(ShvCohesive *cohesive, ShvState *state, const double *stress, const int32_t *facets,
                              int32_t count, int32_t *duplicated, ShvError *error);

/* Gathers openings and frames and moves the histories on. Facets with an element in a fragment that is not awake (per
   fragment index, NULL: all) rest; flags are read anew after an insertion, after shv_cohesive_watch and when the array is another
   one. */
void shv_cohesive_begin(ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake);
/* Cohesive impulses on velocities after the kick; `kick`: mean of the steps before and after n, `step`: the one to come. The
   mean force goes to state->force as well. Pairs that share nodes are brought together by sweeps over the copies of a node,
   pair after pair, points of one pair at once with shares of its masses, from the forces of the last step on; a cluster that
   would have to be limited begins anew without any. A second call goes on from the first: it looks only at clusters with a
   facet whose nodes have other velocities since. The number of threads does not matter. */
void shv_cohesive_pull(ShvCohesive *cohesive, ShvState *state, double kick, double step);
/* Keeps closing crack faces from passing through each other: a pair whose normal opening after `step` would be negative gets
   the impulse that lets it just close (or, when it is closed already, stops it). What such impulses take from the nodes of a
   pair that has opened before is held, and given back in the step in which the pair parts: by the impulse whose work, on the
   way from n − 1/2 to n + 1/2, is just that. So faces are rigid, elastic without a stiffness, and nothing limits the step.
   A pair that is pushed rubs, whether its law still carries or not, by tan φ times the push at most, and never so that
   it does work on the nodes on that way. The mean force goes to state->force. */
void shv_cohesive_close(ShvCohesive *cohesive, ShvState *state, double kick, double step);
/* Books the works of both on the nodes; velocities are those of n + 1/2. Where the openings go from here is remembered for
   the next `begin`. */
void shv_cohesive_book(ShvCohesive *cohesive, const ShvState *state, double step, ShvLedger *ledger);

/* The step in which the fastest opening active point moves a tenth of what is left of its softening, s; infinite without
   one. After `begin`. Work is exact beyond it; the course of the softening is not resolved. */
double shv_cohesive_resolution_step(const ShvCohesive *cohesive, const ShvState *state);

typedef struct ShvCohesiveEnergy {
    double recoverable,
        dissipated; /* J, at the present openings: histories are kept at half steps, and `dissipated` may
                                          fall back by a step's share when an opening turns round */
    double held;    /* by closing faces, to be given back, J */
    double inserted_area, failed_area; /* m²; failed: bonds no more */
    double failed_energy;              /* ΣG·A over failed facets, J */
    /* s: at which central difference with the law's springs as forces would be stable, were it not for the pull: 2/ω with
       ω² ≤ max 2 Σ k A/3 / m over the nodes that active points of the present step share, k secant stiffness; infinite
       without any */
    double spring_step;
    int32_t inserted, failed;
    /* facets that have gone through half of their law or more, but not all, and dissipated less than half of what that
       takes: what clusters that have not settled were softened by. 64 bits, so that no bytes of a checkpoint are undefined */
    int64_t softened;
} ShvCohesiveEnergy;
ShvCohesiveEnergy shv_cohesive_energy(const ShvCohesive *cohesive, const ShvState *state);
/* Recoverable energy of all facets of a fragment, those to others included, J: what is lost when it becomes rigid. */
double shv_cohesive_recoverable_of(const ShvCohesive *cohesive, const ShvState *state, int32_t fragment);
/* A fragment is about to become rigid: histories of its facets move to the present openings, and those to other fragments let
   go for good, since nothing could hold a flying fragment to them. */
void shv_cohesive_settle(ShvCohesive *cohesive, const ShvState *state, int32_t fragment);

/* ---- bonds (bond.c) ----
   A facet joins its two tets as long as it is intact, or the normal strength that is left at any of its points exceeds a
   hundredth of that at the start: what is left in shear acts as a traction, and holds nothing together. A corner whose nodes
   are not split has lost nothing. A facet with a corner that has opened, or slipped, beyond ten final openings and a
   twentieth of its edge is torn whole, so that nothing hangs or turns on one corner; what its other points had stored is
   released. */

/* Share of the initial normal strength below which a point joins nothing. What is left of the energy there is 1e-4 of G for a
   linear law. */
#define SHV_BOND_SHARE 0.01

/* Facets of the list of live ones between awake fragments (per fragment index, NULL: all) that have lost their bond since the
   last call go to cohesive->failed; once a step, after shv_cohesive_begin. */
void shv_cohesive_find_failed(ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake, ShvLedger *ledger);
/* Whether some cohesive facet of these elements still bonds. */
bool shv_cohesive_holds_cracks(const ShvCohesive *cohesive, const int32_t *elements, int32_t count);
/* Whether some bond inside these elements fails by the present time, half a step after the last search. */
bool shv_cohesive_is_failing(const ShvCohesive *cohesive, const ShvState *state, const int32_t *elements,
                             int32_t count);
/* Largest residual normal strength of a cohesive facet's points as a share of that at the start, 0…1; 0 once torn. */
double shv_cohesive_residual(const ShvCohesive *cohesive, int32_t cohesive_facet);
/* What the cohesive facets of a fragment have dissipated so far, J; those to others count half. */
double shv_cohesive_dissipated(const ShvCohesive *cohesive, const int32_t *elements, int32_t count);
/* Widest opening of the cohesive facets inside a fragment, in edges of the facet (of an equilateral triangle of its area). */
double shv_cohesive_widest(const ShvCohesive *cohesive, const ShvState *state, const int32_t *elements, int32_t count);
/* Whether either side of a cohesive facet is in a fragment that is not awake. */
static inline bool shv_cohesive_rests(const ShvCohesive *cohesive, const ShvState *state, int32_t cohesive_facet,
                                      const uint8_t *awake)
{
    const int32_t *elements = cohesive->sides[cohesive_facet].elements;
    return awake && !(awake[state->element_fragment[elements[0]]] && awake[state->element_fragment[elements[1]]]);
}
/* Whether the two tets of a facet of the adjacency are joined across it. */
static inline bool shv_cohesive_joins(const ShvCohesive *cohesive, int32_t facet)
{
    if (facet >= cohesive->model->adjacency.interior_count) return false;
    const int32_t index = cohesive->facet_cohesive[facet];
    return index < 0 || cohesive->bonded[index];
}

/* History and opening of a point at the present time, reached from the last half step. */
ShvHistory shv_cohesive_present(const ShvCohesive *cohesive, const ShvState *state, int32_t cohesive_facet, int corner,
                                ShvOpening *now);
/* Mean damage of its three points. */
double shv_cohesive_facet_damage(const ShvCohesive *cohesive, int32_t cohesive_facet);

#endif
