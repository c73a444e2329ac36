/* The surfaces that may meet one another: boundary facets of the awake fragments and of coupled bodies, faces of cracks that
   have separated, and the nodes of both and of cracks that have failed. Cracks that still carry are closed within a few
   micrometres, so that nothing gets at their nodes. Facets are named by element and face. */
#ifndef SHV_CONTACT_SURFACE_LIST_H
#define SHV_CONTACT_SURFACE_LIST_H

#include <stdbool.h>

#include "cohesive/cohesive.h"
#include "contact/box.h"
#include "contact/coupled_body.h"
#include "model/state.h"
#include "shape/obstacle.h"

/* Whose surfaces meet. Fragments are numbered as in state->element_fragment. */
typedef struct ShvSurfaceBodies {
    ShvState *state;
    const ShvCohesive *cohesive;           /* NULL where nothing can break */
    const uint8_t *awake;                  /* per fragment */
    ShvCoupledBody *const *coupled_bodies; /* per fragment, NULL where it is none; or NULL: none at all */
    int32_t fragment_count;
    ShvObstacles *obstacles; /* NULL: none */
    ShvVec3 gravity;         /* m/s² */
    bool apart;              /* fragments do not meet one another, but obstacles alone */
    bool barred;             /* what deforms meets obstacles elsewhere (pbd/relax.h) */
} ShvSurfaceBodies;

/* Nodes and facets are told apart by how far they may go until candidates are chosen anew: each speed class is twice the one
   below, so that a fast splinter does not make everything else a candidate of everything else. */
enum { SHV_SURFACE_SPEED_CLASSES = 8 };

typedef struct ShvSurfaceFacet {
    int32_t element, face, fragment;
    int32_t slots[3];       /* of its nodes */
    int32_t rebuild_number; /* of the last in which its neighbour list was made */
    bool watched;           /* its path is counted: it has candidates and deforms */
    uint8_t speed_class;    /* the largest of its nodes */
    uint8_t sharp;          /* bits: the sharp edges that it names (surface_edge.h) */
    int32_t across[3];      /* half-edge on the other side of each edge, −1: none */
    ShvBox box;             /* of the facet and what is below it to half the depth of its tet, when last measured */
} ShvSurfaceFacet;

typedef struct ShvSurfaceNode {
    int32_t node, fragment;
    int32_t watch;          /* place among the nodes of candidates, −1: of none */
    int32_t rebuild_number; /* as of a facet */
    uint8_t speed_class;
    bool inner;    /* on no surface: obstacles alone meet it, where a body is crushed */
    bool outdated; /* its neighbour list is no longer whole, wherever it is */
    bool held;     /* one of a pair of copies that a crack keeps from passing each other: its facet has not separated */
    ShvVec3 from;  /* where it was when its speed class was chosen, m */
} ShvSurfaceNode;

/* A cohesive facet whose faces have not separated. */
typedef struct ShvSurfaceCrack {
    int32_t index;
    bool open; /* it has failed, its nodes are listed */
} ShvSurfaceCrack;

/* Places in a list. */
typedef struct ShvSurfacePlaces {
    int32_t *items;
    int32_t count, capacity;
} ShvSurfacePlaces;

typedef struct ShvSurfaceList {
    ShvMemory *memory;
    const ShvModel *model;
    int32_t *boundary; /* element × 4 + face; only where the model has no adjacency */
    int32_t boundary_count;
    ShvSurfaceFacet *facets;
    double *facet_path; /* m, per facet: so far its fastest corner has gone while it is watched */
    int32_t facet_count, facet_capacity;
    ShvSurfaceNode *nodes;
    double *node_path, *node_speed; /* per node: m, as of a facet; m/s, when last measured */
    int32_t node_count, node_capacity;
    int32_t *slot; /* per node of the state: its place in `nodes`, −1: none */
    int32_t slot_capacity;
    ShvSurfaceCrack *cracks;
    int32_t crack_count, crack_capacity;
    int32_t *place;            /* per element × 4 + face: its place in `facets`, −1: none */
    ShvSurfacePlaces outdated; /* nodes that are */
} ShvSurfaceList;

static inline ShvCoupledBody *shv_bodies_coupled_body(const ShvSurfaceBodies *bodies, int32_t fragment)
{
    return bodies->coupled_bodies ? bodies->coupled_bodies[fragment] : NULL;
}
static inline ShvObstacle *shv_bodies_obstacle(const ShvSurfaceBodies *bodies, int32_t element)
{
    return &bodies->obstacles->items[-1 - element];
}
static inline bool shv_bodies_active(const ShvSurfaceBodies *bodies, int32_t fragment)
{
    return bodies->awake[fragment] || shv_bodies_coupled_body(bodies, fragment);
}
/* Such have nodes in the list, which obstacles are to meet, and no facets. */
static inline bool shv_bodies_alone(const ShvSurfaceBodies *bodies, int32_t fragment)
{
    const ShvCoupledBody *coupled_body = shv_bodies_coupled_body(bodies, fragment);
    return coupled_body && coupled_body->alone;
}
static inline ShvVec3 shv_bodies_position(const ShvSurfaceBodies *bodies, int32_t node, int32_t fragment)
{
    const ShvCoupledBody *coupled_body = shv_bodies_coupled_body(bodies, fragment);
    if (coupled_body)
        return shv_coupled_body_point(coupled_body, shv_load3(bodies->state->reference + 3 * (int64_t)node));
    return shv_state_position(bodies->state, node);
}
static inline void shv_surface_corners(const ShvState *state, int32_t element, int32_t face, int32_t nodes[3])
{
    for (int k = 0; k < 3; k++) nodes[k] = shv_state_node(state, element, shv_face_corners[face][k]);
}

void shv_surface_list_release(ShvSurfaceList *list);
/* Lists the surfaces of what is awake or a coupled body. Costs work in proportion to the model's boundary and its cohesive
   facets. */
ShvStatus shv_surface_list_build(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, ShvError *error);
/* Measures boxes anew, of a list that still holds. */
void shv_surface_list_measure(ShvSurfaceList *list, const ShvSurfaceBodies *bodies);
/* Where the corners of a facet are, m. */
void shv_surface_facet_corners(const ShvSurfaceBodies *bodies, const ShvSurfaceFacet *facet, ShvVec3 corners[3]);
/* The box of one facet. */
void shv_surface_facet_measure(const ShvSurfaceBodies *bodies, ShvSurfaceFacet *facet);
/* What was known before insertions: nodes of the state, cohesive facets, fragments. */
typedef struct ShvSurfaceKnown {
    int32_t nodes, cohesive, fragments;
} ShvSurfaceKnown;

/* The neighbour list of a node is no longer whole. */
ShvStatus shv_surface_list_mark_outdated(ShvSurfaceList *list, int32_t slot, ShvError *error);
/* Goes on after insertions: copies of nodes are appended, and what was split is outdated, since it may meet its neighbours now;
   fragments are named anew where there are new ones, and new cohesive facets are followed. */
ShvStatus shv_surface_list_follow(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, ShvSurfaceKnown known,
                                  ShvError *error);
/* Appends the nodes inside of what is awake that are this near an obstacle, m. Costs a pass over all tets. */
ShvStatus shv_surface_list_inner(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, double distance,
                                 ShvError *error);
/* Appends the nodes of cracks that have failed since and the faces of those that have separated, whose nodes are outdated where no
   other crack holds them. */
ShvStatus shv_surface_list_update(ShvSurfaceList *list, const ShvSurfaceBodies *bodies, ShvError *error);

#endif
