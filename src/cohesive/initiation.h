/* Where cracks begin on meshes that do not resolve the cohesive zone (SHV_UNRESOLVED_TIP_STRENGTH): at the surface of a body.

   Under bending the forces that facets pass on at a node are a section's moment shared among few nodes: on edges like the
   wall's thickness they come to a third of what the stress in its surface would make them, and the disk of star.h holds
   until that stress is three times the strength. But a face on the surface knows that stress, whatever the tet behind it is:
   from its strain, since nothing pulls on it from outside. Averaged over a node's faces, it is the stress by which cracks
   begin there: once it reaches the strength of the flaws at the node (shv_cohesive_node_strength), the disk across it parts
   whatever it passes on, and its laws start with just that. Their energy is that of what they cover of its plane. Where the mesh resolves the zone, σ_tip
   (front.h) exceeds the strength, and the force alone decides; so it does at nodes that cracks have come to. */
#ifndef SHV_COHESIVE_INITIATION_H
#define SHV_COHESIVE_INITIATION_H

#include "model/state.h"

struct ShvCohesive;

typedef struct ShvInitiation {
    int32_t count;
    int32_t *faces;   /* of awake tets, 4 × element + face: boundary faces of the mesh */
    double *tension;  /* per face: largest in its plane in the present check, Pa */
    double *strength; /* per node of the mesh: of its flaws, Pa; infinite where this is not for it */
} ShvInitiation;

/* Largest tension in the surface at a node, and its direction. */
typedef struct ShvSurfaceTension {
    double stress; /* Pa; 0 where cracks do not begin so */
    ShvVec3 direction;
} ShvSurfaceTension;

ShvStatus shv_initiation_create(struct ShvCohesive *cohesive, ShvError *error);
void shv_initiation_release(ShvInitiation *initiation);
void shv_initiation_watch(struct ShvCohesive *cohesive, const ShvState *state, const uint8_t *awake);
/* Nodes whose faces may bear more than their strength go to `nodes`, `count` of them, unless cohesive->search has a mark for
   them, and get one. Returns the largest ratio of tension to strength of all that had none. */
double shv_initiation_list(struct ShvCohesive *cohesive, const ShvState *state, int32_t *nodes, int32_t *count);
ShvSurfaceTension shv_initiation_tension(const struct ShvCohesive *cohesive, const ShvState *state, int32_t node);

#endif
