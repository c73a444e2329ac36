/* Fragments: connected parts of the objects, joined through shared nodes. An id is never used again: a split ends the
   parent and starts all its children; a crack without a split keeps the id. */
#ifndef SHV_RIGID_FRAGMENT_H
#define SHV_RIGID_FRAGMENT_H

#include "model/state.h"

typedef enum ShvMode { SHV_MODE_FLIGHT, SHV_MODE_FRACTURE, SHV_MODE_DEAD } ShvMode;

typedef struct ShvFragment {
    int32_t id, parent;        /* parent −1: an object's first fragment; id = index in ShvFragments */
    int32_t object;
    double birth, death;       /* s; death NaN while alive */
    ShvMode mode;
    int32_t element_count, node_count;
    int32_t element_begin;     /* into ShvFragments.elements */
    int32_t node_begin;        /* into ShvFragments.nodes */
    double mass;               /* Σ ρV of its elements in element order, kg */
    double volume;             /* m³, reference */
    ShvVec3 reference_centre;  /* of the lumped masses at reference positions, m */
    ShvMat3 inertia;           /* of the lumped masses at reference positions, about the centre, kg m²: the one inertia used
                                  on both sides of a hand-over, so that L is continuous */
    double radius;             /* farthest node from the reference centre, m */
    ShvVec3 position;          /* centre of mass, m */
    ShvQuat orientation;       /* reference axes → world */
    ShvVec3 velocity, angular_velocity; /* m/s, rad/s, world */
    double last_insertion;     /* s: time of the last facet inserted in it (or of its waking) */
    double strength;           /* Pa: weakest facet; infinity: nothing can break */
    int32_t quiet;             /* checks in a row without insertion or closing contact */
} ShvFragment;

typedef struct ShvFragments {
    ShvMemory *memory;
    ShvFragment *items;
    int32_t count, capacity;   /* all that ever lived */
    int32_t alive;
    int32_t *elements;         /* element_count: permutation, elements of each living fragment together, increasing */
    int32_t *nodes;            /* node lists of the living fragments, increasing; rebuilt with the components */
    int32_t node_capacity;
} ShvFragments;

/* One fragment per connected component of the start; labels state->element_fragment. */
ShvStatus shv_fragments_create(ShvFragments *fragments, const ShvModel *model, ShvState *state, ShvError *error);
void shv_fragments_release(ShvFragments *fragments);

/* Finds the components of one living fragment after nodes were duplicated. One component: node lists and inertia are
   refreshed, the id stays. Several: the fragment dies, its children start, in the order of their lowest element, with
   mode and rotation of the parent. Returns the number of components in `parts`. Relabels state->element_fragment. */
ShvStatus shv_fragments_split(ShvFragments *fragments, const ShvModel *model, ShvState *state, int32_t fragment, int32_t *parts,
                              ShvError *error);

/* Rigid motion of a deforming fragment: centre of mass, best-fit rotation (polar factor of Σ m x Xᵀ), velocity P/m and
   angular velocity from L and the current lumped inertia (pseudo-inverse when degenerate). Velocities as they stand. */
void shv_fragment_fit(ShvFragment *fragment, const ShvFragments *fragments, const ShvState *state);
/* Writes positions and velocities of the rigid motion to the fragment's nodes. */
void shv_fragment_scatter(const ShvFragment *fragment, const ShvFragments *fragments, ShvState *state);
/* Momentum and angular momentum (about the origin) of the fragment's nodes, kinetic energy of them. */
void shv_fragment_momentum(const ShvFragment *fragment, const ShvFragments *fragments, const ShvState *state, ShvVec3 *momentum,
                           ShvVec3 *angular_momentum, double *kinetic);
/* Inertia about the centre in world axes. */
ShvMat3 shv_fragment_world_inertia(const ShvFragment *fragment);

#endif
