/* Conditions on chosen nodes of an object: supports, imposed velocities, tractions. They follow node duplication: a copy
   of a held node is held; a traction stays with the (element, face) it was put on and reaches whichever copies the
   element's corners have now.

   One step:  forces of time n … shv_imposed_add_force … kick … contact … shv_imposed_apply (has the last word)
   … book contact and conditions … drift. What a condition acts on must stay awake until it is over (shv_imposed_holds). */
#ifndef SHV_CONDITIONS_IMPOSED_H
#define SHV_CONDITIONS_IMPOSED_H

#include <stdbool.h>

#include "conditions/condition_selection.h"
#include "model/ledger.h"
#include "model/state.h"

typedef struct ShvImposedCondition {
    const ShvConditionDefinition *definition;
    bool released;
    /* support, velocity */
    int32_t *origins; /* chosen nodes of the reference mesh, increasing */
    int32_t origin_count;
    int32_t *nodes; /* the same and their copies, in the order of their birth */
    int32_t node_count, node_capacity;
    double *before;  /* 3 per node: velocity before the kick, m/s */
    double *impulse; /* 3 per node: of this step, N·s */
    /* traction */
    ShvImposedFacet *facets; /* increasing (element, face) */
    int32_t facet_count;
    double power; /* W: of the tractions with the velocities before the kick */
} ShvImposedCondition;

typedef struct ShvImposed {
    ShvMemory *memory;
    const ShvModel *model;
    ShvImposedCondition *items;
    int32_t count;
    int32_t known_nodes; /* nodes of the state that have been looked at */
    uint8_t *held;       /* per node of the reference mesh: a condition that is not over acts on it */
    int32_t over_count;  /* conditions that were over when that was found */
    /* works of this step, J: with the velocities before the kick, and with those after everything */
    double constraint_work[2], traction_work[2];
} ShvImposed;

/* Chooses nodes and boundary facets on the placed mesh. A selection that chooses nothing, an unknown object, a support
   without an axis or a value that is not finite is an error that names the condition. */
ShvStatus shv_imposed_create(ShvImposed *imposed, const ShvModel *model, const ShvSceneDefinition *scene,
                             ShvError *error);
void shv_imposed_release(ShvImposed *imposed);
/* Takes a condition out of force for good; false when no condition has that name. */
bool shv_imposed_release_condition(ShvImposed *imposed, const char *name);
/* Whether a condition acts at a time: started, not ended, not released. */
bool shv_imposed_in_force(const ShvImposedCondition *condition, double time);
/* Whether a condition that is in force or still to come, as of the last step, acts on one of these nodes of the state. */
bool shv_imposed_holds(const ShvImposed *imposed, const ShvState *state, const int32_t *nodes, int32_t count);
/* How the supports in force hold these nodes of the state as a rigid body: it moves under a force at a point; it may be moved, but stays
   under that one; it may not. */
typedef enum ShvRestraint { SHV_UNRESTRAINED, SHV_IN_EQUILIBRIUM, SHV_FULLY_RESTRAINED } ShvRestraint;
ShvRestraint shv_imposed_restraint(const ShvImposed *imposed, const ShvState *state, const int32_t *nodes,
                                   int32_t count, ShvVec3 force, ShvVec3 point);
/* Takes those of these nodes off their supports by which a piece only hangs: those without a face whose nodes are all chosen. A support
   that has no such face at all, along a line or at points, keeps its nodes. Of a model that can break. */
void shv_imposed_release_nodes(ShvImposed *imposed, const ShvState *state, const int32_t *nodes, int32_t count);

/* After the forces of time n, before the kick: adds tractions to state->force and remembers the velocities of held nodes;
   adopts nodes that were duplicated since the last call. */
ShvStatus shv_imposed_add_force(ShvImposed *imposed, ShvState *state, ShvError *error);
/* After kick and contact: gives held components their velocity at state->time + step/2 and fills the works. `before` and
   `step`: the steps before and after time n, s. */
void shv_imposed_apply(ShvImposed *imposed, ShvState *state, double before, double step);
/* Fills the works anew with the velocities as they are now, when something has changed them since. */
void shv_imposed_book(ShvImposed *imposed, ShvState *state, double before, double step);

#endif
