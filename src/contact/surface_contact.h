/* Deforming surfaces against obstacles in fracture mode, one another, and coupled bodies (fragments still rigid): nodes against
   facets, both ways, and sharp edges against each other (edge_pair.h); pieces of one body and faces of its cracks included.
   Unilateral, Coulomb friction, restitution 0.

   A node that would be behind a facet at the end of the step gets the impulse that lets it just arrive (gap > 0) or stops
   it (gap ≤ 0), and so do edges that would have crossed; nothing is ever pushed out. So what touches, interlocks or overlaps
   from birth stays as it is and only comes no closer, and each impulse takes energy or leaves it. Momentum and angular momentum
   are kept by each impulse. Where a node is inside a body, the facet it is least deep behind counts, and a facet only to half the depth of its tet. Faces of a crack
   are left to shv_cohesive_close until they have separated (SHV_COHESIVE_SEPARATED). Edges meet where both are convex by
   SHV_SHARP_EDGE degrees or more, beside their nodes: within a hundredth of an edge of a node the node meets facets, and
   flatter edges can pass until a node does, by a fiftieth of an edge. Edges of two coupled bodies do not.

   Neighbours in the mesh meet across the facet between them; those that share a node only are left alone until they are
   out of place by a fiftieth of a facet's size.

   Obstacles are met as well, by nodes, and by facets where an obstacle is small or has edges of its own (obstacle_pair.c), so that
   what stands on a floor under the load of another body is solved in one go. A point of a facet shares its impulse among
   the facet's nodes as they share the point; free obstacles take the opposite impulse. Obstacles keep out what deforms to
   rounding, with more sweeps than surfaces have.

   One step, for time n:
       forces …, shv_cohesive_begin
       shv_surface_contact_begin    velocities of n − 1/2
       kick (coupled bodies too), shv_cohesive_pull, shv_cohesive_close
       shv_surface_contact_apply
       supports
       shv_surface_contact_book     with the velocities that the drift will use
       drift (coupled bodies too)
   A step may be thrown away by putting back the velocities of nodes and coupled bodies. Pairs are worked through in the order
   of their numbers, whatever the candidates were and whenever they were found. Costs nothing and holds no memory while
   no obstacle is there, one fragment alone is awake and none of its cracks have failed. */
#ifndef SHV_CONTACT_SURFACE_CONTACT_H
#define SHV_CONTACT_SURFACE_CONTACT_H

#include "contact/edge_pair.h"
#include "contact/hash_grid.h"
#include "contact/surface_list.h"
#include "model/ledger.h"

/* Motion of a coupled body before the kick. */
typedef struct ShvCoupledBodyBefore {
    ShvVec3 velocity, angular_velocity;
} ShvCoupledBodyBefore;

/* Most steps from one detection of contact among coupled bodies to the next: they have no waves to resolve, and weight moves them by
   g t²/2, nanometres, in so short a time. */
enum { SHV_SURFACE_DETECTION_INTERVAL = 8 };

/* What touches one fragment in a step. */
typedef struct ShvFragmentTouch {
    double impulse; /* Σ of magnitudes, N·s */
    /* of the touch from a gap (of rigid bodies also of one that is to come in the next step) with the largest speed ×
       √max(1, mass of the other/own); 0 where there is none: */
    double closing_speed; /* m/s */
    double other_mass;    /* kg; infinite: an obstacle */
    double severity;      /* m/s: that product */
} ShvFragmentTouch;

/* What a side of a candidate goes with: by itself, a node or facet that deforms; a rigid body; all obstacles. */
typedef enum ShvSideKind { SHV_SIDE_NODE, SHV_SIDE_FACET, SHV_SIDE_BODY, SHV_SIDE_OBSTACLES } ShvSideKind;

/* Below which sum of the paths of both sides a candidate cannot meet. */
typedef struct ShvMotionBound {
    double path;       /* m; −∞: motion classes alone decide */
    int32_t places[2]; /* of the node or facet in the list; the fragment; −1 */
    ShvSideKind kinds[2];
} ShvMotionBound;

/* A candidate that may meet in the step. */
typedef struct ShvNearCandidate {
    int32_t place, pairs; /* of its pairs in `found`, and how many there are */
} ShvNearCandidate;

typedef struct ShvSurfaceCandidates {
    ShvSurfaceCandidate *items;
    double *due; /* per candidate, m: the same of the paths of its motion classes, which costs least to ask */
    ShvMotionBound *motion_bounds; /* per candidate */
    uint8_t *motion_classes; /* per candidate: that of the node × SHV_SURFACE_MOTION_CLASSES + the other side's */
    int32_t count, capacity;
    int32_t held; /* when void ones were last dropped */
    int32_t *now; /* those that are due in the step by their motion classes, then those of them that are near */
    ShvNearCandidate *near; /* as `now` */
    int32_t now_capacity;
} ShvSurfaceCandidates;

/* A fragment since candidates were chosen. */
typedef struct ShvSurfaceFragment {
    double path;         /* m: no node of a coupled body has gone farther in the frame */
    uint8_t speed_class; /* of all a coupled body's nodes */
    bool rigid;          /* it was a coupled body */
    bool cracked;        /* a crack runs in it: its own surfaces are candidates of one another */
    bool opened;         /* its nodes are to look for what they may meet anew */
    bool leaves_skin;    /* a coupled body that may leave its skin */
} ShvSurfaceFragment;

/* Most steps from one time that the speeds of all nodes are read to the next. */
enum { SHV_SURFACE_STEPS_BETWEEN_CHECKS = 4 };

typedef struct ShvPairKey {
    int32_t node, end, element, face, edge, feature, found; /* end: −1: none */
} ShvPairKey;

/* What moves: nodes and facets of each speed class, and obstacles. */
enum { SHV_SURFACE_OBSTACLES = SHV_SURFACE_SPEED_CLASSES, SHV_SURFACE_MOTION_CLASSES };

typedef struct ShvSurfaceContact {
    ShvMemory *memory;
    const ShvModel *model;
    double friction;
    bool stale;          /* the lists must be made anew */
    bool woken;          /* coupled bodies woke */
    bool idle;           /* nothing can meet */
    bool obstacles_only; /* no surface can meet another one */
    bool detect_now;     /* coupled bodies are looked at together at this time, whenever they were last */
    /* what the lists were made from */
    int32_t known_nodes, known_fragments, known_cohesive, known_live;
    ShvSurfaceList list;
    ShvHashGrid node_grid, facet_grid; /* facets by the centres of their boxes */
    ShvSurfaceFragment *fragments;
    int32_t fragment_capacity;
    double size;       /* of facets, mean, m */
    double built_time; /* s: when candidates were chosen */
    double
        half[SHV_SURFACE_SPEED_CLASSES]; /* m: no box of a facet of the speed class reaches farther from its centre */
    int32_t rebuild_number;              /* of neighbour lists, of all or some: the present or last one */
    int32_t rebuilt_nodes;               /* since all were rebuilt */
    int32_t facets_with_neighbours;      /* of the list, so many have a neighbour list */
    ShvSurfacePlaces rebuilt_facets;     /* in the last rebuild */
    ShvVec3 drift;                       /* velocity of the frame in which motion is measured, m/s */
    double skin[SHV_SURFACE_MOTION_CLASSES];  /* m: how far each may go until candidates are chosen anew */
    double speed[SHV_SURFACE_MOTION_CLASSES]; /* m/s: largest of candidates' nodes, and of obstacles */
    double path[SHV_SURFACE_MOTION_CLASSES];  /* m: how far the fastest has gone since */
    int32_t steps_to_check;                   /* steps until it is looked which nodes leave their skin */
    double seen_time;                         /* s: time up to which motion has been counted */
    double gravity;                           /* m/s² */
    ShvSurfaceCandidates candidates[2]; /* where something deforms or an obstacle is met; between coupled bodies */
    int64_t detected_step;              /* when coupled bodies were looked at together last, */
    int32_t detection_interval;         /* steps until they are again */
    int32_t *watched;                   /* nodes of candidates that are not coupled bodies': places in list.nodes */
    int32_t watched_count, watched_capacity;
    ShvSurfacePlaces watched_facets; /* likewise, of facets */
    double *before;                  /* 3 per watched node: velocity before the kick, m/s */
    int32_t before_capacity;
    ShvCoupledBodyBefore *coupled_body_before; /* per fragment */
    int32_t coupled_body_capacity;
    /* this step */
    ShvFacetPair *pairs; /* by nodes, element, face, edge, feature; those without an impulse included */
    ShvFacetPair *found; /* places for the same as they are found, some without one, */
    ShvPairKey *keys;    /* and their order */
    int32_t pair_count, pair_capacity, found_count, found_capacity;
    int32_t *visits; /* per place in list.nodes: last visit of the sweeps in which its velocity changed */
    int32_t visit_capacity;
    int32_t visit, rigid_visit; /* the present one; the last in which a coupled body's or obstacle's motion changed */
    int32_t touching;           /* pairs with an impulse, */
    int32_t pushed;             /* and those of them in which an obstacle pushes what deforms: */
    ShvVec3 push;               /* N·s, by it */
    /* J on nodes and coupled bodies, impulse · velocity / 2: before the kick, and now */
    double normal_work[2], friction_work[2];
    double obstacle_work[2];           /* J on free obstacles: with their velocity before and after impulses */
    double deepest;                    /* m: largest penetration of a pair */
    int64_t distance_checks, rebuilds; /* since the start */
} ShvSurfaceContact;

/* Allocates nothing. `friction`: Coulomb coefficient between any two surfaces, ≥ 0. */
ShvStatus shv_surface_contact_create(ShvSurfaceContact *contact, ShvMemory *memory, const ShvModel *model,
                                     double friction, ShvError *error);
void shv_surface_contact_release(ShvSurfaceContact *contact);
/* Forces new lists: fragments woke or slept, coupled bodies came or were let go, poses or velocities were set. Insertions,
   splits and cracks that part are noticed without, and cost no new lists. */
void shv_surface_contact_invalidate(ShvSurfaceContact *contact);
/* Coupled bodies have become awake where they stood: the lists go on with them. */
void shv_surface_contact_wake(ShvSurfaceContact *contact);
/* Coupled bodies have been given impulses from elsewhere: they are looked at together in the next step. */
void shv_surface_contact_recheck(ShvSurfaceContact *contact);
/* Before the kick, after shv_cohesive_begin. `step`: the one to come, s. Costs a pass over all listed nodes every few steps and
   over those of candidates each step. */
ShvStatus shv_surface_contact_begin(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step,
                                    ShvError *error);
/* After the kick; `bodies` as in shv_surface_contact_begin, with which every step starts. Ends with
   shv_surface_contact_book. */
ShvStatus shv_surface_contact_apply(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies, double step,
                                    ShvError *error);
/* Works of this step's impulses with the velocities as they are now. */
void shv_surface_contact_book(ShvSurfaceContact *contact, const ShvSurfaceBodies *bodies);
void shv_surface_contact_book_ledger(const ShvSurfaceContact *contact, ShvLedger *ledger);
/* Adds this step's touches, and those of rigid bodies in the next, to `fragments`, on both sides; masses of fragments, kg. */
void shv_surface_contact_by_fragment(const ShvSurfaceContact *contact, const double *masses,
                                     ShvFragmentTouch *fragments);

#endif
