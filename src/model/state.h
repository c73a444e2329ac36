/* The changing side of a simulation: connectivity, motion, mass. One list of arrays drives allocation, growth and
   hashing. Elements stand in batches of SHV_LANES: the node of corner a of element e is
   connectivity[(e / SHV_LANES) * 4 * SHV_LANES + a * SHV_LANES + e % SHV_LANES]. Positions are reference +
   displacement: a body at rest has displacements of exactly zero, and small motion loses no digits. */
#ifndef SHV_MODEL_STATE_H
#define SHV_MODEL_STATE_H

#include "model/model.h"

enum { SHV_LANES = 8 };

/* X(type, name, components): per node, grown when nodes are duplicated. */
#define SHV_NODE_ARRAYS(X)                                                                                             \
    X(double, reference, 3)     /* m: a copy has the reference position of its origin */                               \
    X(double, displacement, 3)  /* m, at time n */                                                                     \
    X(double, velocity, 3)      /* m/s, at time n − 1/2 of the last step (ShvState.last_step) */                     \
    X(double, force, 3)         /* N, at time n */                                                                     \
    X(double, mass, 1)          /* kg, lumped: Σ ρV/4 of the node's own elements, in corner order */                 \
    X(int32_t, origin, 1)       /* node of the reference mesh */                                                       \
    X(int32_t, corner_start, 1) /* the node's own range of ShvState.corners; a split divides its parent's range */     \
    X(int32_t, corner_count, 1)

typedef struct ShvState {
    ShvMemory *memory;
    int32_t node_count, node_capacity;
    int32_t element_count, batch_count; /* lanes beyond element_count repeat the last element, with zero volume */
#define SHV_DECLARE(type, name, components) type *name;
    SHV_NODE_ARRAYS(SHV_DECLARE)
#undef SHV_DECLARE
    int32_t *connectivity;     /* 4 × SHV_LANES × batch_count */
    double *element_mass;      /* ρV per element, kg */
    int32_t *element_fragment; /* index of the fragment each element belongs to (ShvFragments) */
    int32_t *corners; /* 4 × element_count, element × 4 + corner, grouped by node; increasing within a node */
    double time;      /* s */
    double last_step; /* s: the step that led to `time`; 0 at a start, where velocity is that of `time` */
    int64_t step;     /* steps of fracture mode so far */
} ShvState;

/* Initial state of a model: displacement zero, masses lumped, velocities those of the placements (v + ω × r about each
   object's lumped centre of mass). */
ShvStatus shv_state_create(ShvState *state, const ShvModel *model, const ShvSceneDefinition *scene, ShvError *error);
void shv_state_release(ShvState *state);
/* Room for at least `nodes` nodes; grows by half. On failure nothing changed. */
ShvStatus shv_state_reserve(ShvState *state, int64_t nodes, ShvError *error);
/* 64-bit hash of all state arrays and the clock: equal states, equal bits. */
uint64_t shv_state_hash(const ShvState *state);

static inline int64_t shv_corner_slot(int32_t element, int32_t corner)
{
    return (int64_t)(element / SHV_LANES) * (4 * SHV_LANES) + corner * SHV_LANES + element % SHV_LANES;
}
static inline int32_t shv_state_node(const ShvState *state, int32_t element, int32_t corner)
{
    return state->connectivity[shv_corner_slot(element, corner)];
}
static inline bool shv_state_has_node(const ShvState *state, int32_t element, int32_t node)
{
    for (int corner = 0; corner < 4; corner++)
        if (shv_state_node(state, element, corner) == node) return true;
    return false;
}
/* The node that a copy was split from, or another copy of it: whose corners stand before the copy's own. Until one of them is
   split again these lead from copy to copy to the original. */
static inline int32_t shv_state_split_from(const ShvState *state, int32_t copy)
{
    const int32_t corner = state->corners[state->corner_start[copy] - 1];
    return shv_state_node(state, corner / 4, corner % 4);
}
static inline ShvVec3 shv_state_position(const ShvState *state, int32_t node)
{
    const int64_t i = 3 * (int64_t)node;
    return shv_add(shv_load3(state->reference + i), shv_load3(state->displacement + i));
}

#endif
