/* Nodes against obstacles in fracture mode, and facets and edges where an obstacle is small or has edges of its own
   (shape/feature.h): unilateral, Coulomb friction, restitution 0. Acts on velocities after the kick: a node, or a point of
   a facet, that would be inside at the end of the step gets the impulse that lets it just arrive (gap > 0) or stops it
   (gap ≤ 0); it is never pushed out, so contact takes energy or leaves it. A facet's nodes share an impulse as they share
   its point, which keeps momentum and angular momentum. Free obstacles take the opposite impulse. Nodes and obstacles are
   worked through in increasing order, in a few sweeps, each impulse dissipative by itself. */
#ifndef SHV_CONTACT_NODE_CONTACT_H
#define SHV_CONTACT_NODE_CONTACT_H

#include <stdbool.h>

#include "cohesive/cohesive.h"
#include "model/ledger.h"
#include "model/state.h"
#include "shape/obstacle.h"

/* A node and an obstacle with an impulse in this step (faces of a mesh that meet a node together: one each; of a facet: one
   for each node, with its share). */
typedef struct ShvNodeTouch {
    int32_t node, obstacle;
    bool fresh;            /* the node touched nothing in the step before */
    double closing_speed;  /* m/s along the normal, after the kick and before any response */
    ShvVec3 point, normal; /* on the obstacle; outward; world */
    double normal_impulse; /* N·s on the node along the normal, > 0 */
    ShvVec3 friction;      /* N·s on the node, perpendicular to the normal */
    ShvVec3 before;        /* velocity of the node before the kick, m/s */
} ShvNodeTouch;

/* A node that an obstacle may meet. */
typedef struct ShvNodeCandidate {
    int32_t node, obstacle;
    ShvVec3 before; /* velocity before the kick, m/s */
} ShvNodeCandidate;

/* A facet that a feature of an obstacle may meet. */
typedef struct ShvFacetCandidate {
    int32_t obstacle, feature;
    int32_t nodes[3], apex;
    ShvVec3 before[3]; /* velocities of the nodes before the kick, m/s */
} ShvFacetCandidate;

/* Where the nodes' facets are looked up. */
typedef struct ShvNodeSurface {
    const ShvModel *model;       /* NULL: nodes alone meet obstacles */
    const ShvCohesive *cohesive; /* NULL where nothing can break */
    uint8_t *const *awake;       /* per fragment */
} ShvNodeSurface;

typedef struct ShvNodeContact {
    ShvMemory *memory;
    ShvNodeSurface surface;
    int32_t *boundary; /* faces of the model's mesh, 4 × element + face; found once they are needed */
    int32_t boundary_count;
    double facet_radius;       /* m: of the largest facet of the mesh */
    ShvFacetCandidate *facets; /* chosen with the nodes */
    int32_t facet_count, facet_capacity;
    /* nodes near obstacles, chosen anew when motion since then may exceed the skin; of each obstacle in the order given, then copies */
    ShvNodeCandidate *candidates;
    int32_t candidate_count, candidate_capacity;
    double skin, moved; /* m */
    bool stale, split;  /* they no longer hold; nodes have been duplicated since they were chosen */
    int32_t listed;     /* number of nodes they were chosen from, */
    int32_t of_nodes;   /* and of those of the state then */
    int32_t since;      /* steps since the nodes' speeds were last looked at */
    double node_speed;  /* largest then, m/s */
    double next_time;   /* s: end of the last step */
    int64_t step_number;
    int64_t *last_touch; /* per node: number of the step of its last touch; 0: never */
    int32_t known_nodes, node_capacity;
    struct ShvNodePair *pairs; /* of a node and an obstacle close enough to meet within this step */
    int32_t pair_count, pair_capacity;
    /* this step */
    ShvNodeTouch *touches;
    int32_t touching, touch_capacity;
    /* J on the nodes, impulse · velocity / 2: with the velocity before the kick, and with the velocity now */
    double normal_work[2], friction_work[2];
    double obstacle_work[2];      /* J on free obstacles: with their velocity before and after each impulse */
    double largest_closing_speed; /* m/s of fresh touches */
    ShvVec3 impulse;              /* N·s on the nodes, total */
    int32_t unresolved;           /* pairs still closing when the sweeps were used up */
} ShvNodeContact;

/* Allocates nothing. */
void shv_node_contact_create(ShvNodeContact *contact, ShvMemory *memory);
void shv_node_contact_release(ShvNodeContact *contact);
/* From now on facets of awake fragments meet obstacles as well. */
void shv_node_contact_know_surface(ShvNodeContact *contact, ShvNodeSurface surface);
/* Forces a rebuild of the candidates: fragments woke or slept, velocities or poses were set. */
void shv_node_contact_invalidate(ShvNodeContact *contact);
/* Awake nodes were duplicated, or cracks have separated: copies are candidates where they are near an obstacle. */
void shv_node_contact_follow(ShvNodeContact *contact);
/* Before the kick of a step: finds which of the awake nodes (surface nodes suffice) may touch, and remembers their velocities, from
   which the first halves of the works come. */
ShvStatus shv_node_contact_begin(ShvNodeContact *contact, const ShvState *state, const ShvObstacles *obstacles,
                                 const int32_t *nodes, int32_t count, double step, const double gravity[3],
                                 ShvError *error);
/* One step (of length `step` = dt₊), after the kick and whatever else changes velocities but may be overruled. Obstacles are at
   time n: a free one's mean velocity over the step is taken as velocity + ½ step gravity. Ends with shv_node_contact_book. */
ShvStatus shv_node_contact_apply(ShvNodeContact *contact, ShvState *state, ShvObstacles *obstacles, double step,
                                 const double gravity[3], ShvError *error);
/* Works of this step's impulses with the velocities as they are now; call it again when something (a support) has changed
   velocities since, so that second halves use the final ones. */
void shv_node_contact_book(ShvNodeContact *contact, const ShvState *state);
/* Books normal and friction work into a ledger. */
void shv_node_contact_book_ledger(const ShvNodeContact *contact, ShvLedger *ledger);

/* Coulomb friction at a point that slips, N s: the impulse so far against what slip is left of the relative velocity, no larger
   than its bound. `inverse_mass`: across the normal, 1/kg. */
ShvVec3 shv_coulomb_friction(ShvVec3 so_far, ShvVec3 relative, ShvVec3 normal, double inverse_mass, double bound);

#endif
