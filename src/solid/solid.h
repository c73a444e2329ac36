/* The elastic solid: element constants in batches of SIMD width, internal force, stress, stable step. */
#ifndef SHV_SOLID_SOLID_H
#define SHV_SOLID_SOLID_H

#include <stdbool.h>

#include "model/state.h"
#include "solid/smoothing.h"

/* Constants of the reference elements, and the order in which batches are worked through. Chunks of consecutive batches
   are coloured so that two chunks of a colour share no node: colours run one after another, the chunks of a colour in
   parallel, each adding to nodal forces in its own fixed order. The sums therefore do not depend on the number of
   threads; and since node duplication only ever removes sharing, the colouring stays valid for the whole run. */
typedef struct ShvSolid {
    ShvMemory *memory;
    const ShvModel *model;
    int32_t batch_count;
    double *gradients;       /* 9 × SHV_LANES × batch_count: rows of D_m⁻¹ (gradients of N1, N2, N3), 1/m */
    double *volumes;         /* SHV_LANES × batch_count; 0 in padding lanes */
    int16_t *batch_material; /* material of all lanes, or −1 when a batch is mixed */
    int32_t chunk_count, chunk_batches;
    int32_t colour_count;
    int32_t *colour_start; /* colour_count + 1, into chunk_order */
    int32_t *chunk_order;  /* chunks sorted by colour */
    int32_t *chunk_colour; /* of each chunk */
    uint8_t *batch_active; /* batch_count: batches without an awake element are skipped; all 1 at first */
    double *exact_step;    /* SHV_LANES × batch_count: of each element, once it has been asked for; NaN before; s */
    double *batch_safe;    /* batch_count: smallest safe step, s; where objects meet, of awake elements */
    double *batch_exact;   /* the same of the exact step, once it has been asked for; NaN before */
    /* batch_count: safe step as forces were found last, s; infinity where strain counts for nothing */
    double *batch_strained;
    ShvSmoothedEdges smoothing;
} ShvSolid;

ShvStatus shv_solid_create(ShvSolid *solid, const ShvModel *model, const ShvState *state, ShvError *error);
void shv_solid_release(ShvSolid *solid);

/* Finds the stress of smoothed edges at the present displacements: before anything below that asks for it. */
void shv_solid_smooth(const ShvSolid *solid, const ShvState *state);
/* Tells that batches have become active, or are so no more, and whether each fragment is awake (NULL: all are). What rests beside others in
   a batch has no stress or force of its own. */
void shv_solid_follow_active(const ShvSolid *solid, const int32_t *element_fragment, const uint8_t *awake);
/* Tells of nodes that were split, their copies among them, at the displacements of the last shv_solid_smooth. */
ShvStatus shv_solid_split(ShvSolid *solid, const ShvState *state, const int32_t *nodes, int32_t count, ShvError *error);

/* Elements that stand in their shape at the start again have no stress, whatever their edges went on from when they were split. */
void shv_solid_reset_offsets(const ShvSolid *solid, const int32_t *elements, int32_t count);

/* Adds −(internal force) of all active batches to state->force. */
void shv_solid_add_internal_force(const ShvSolid *solid, ShvState *state);
/* The same, and for each active batch the faces that may count `floor` or more: bit SHV_LANES × face + lane, a face as numbered by
   the corner opposite. What counts is the length of (⟨tension⟩, shear) of the element's Cauchy stress on the face × the face's
   weight, 1/Pa: weight[(e/8)*32 + face*8 + e%8]. Other batches keep their bits. Returns whether an element's volume is
   not positive. Needs shv_solid_smooth. */
bool shv_solid_add_internal_force_and_find_faces(const ShvSolid *solid, ShvState *state, const double *weight,
                                                 double floor, uint32_t *faces);
/* The internal force of some nodes after they were split, put into state->force: the bits that shv_solid_add_internal_force
   would add to zero. With smoothed elements the forces of nodes near them are others as well. */
ShvStatus shv_solid_put_internal_force(const ShvSolid *solid, ShvState *state, const int32_t *nodes, int32_t count,
                                       ShvError *error);
/* Strain energy of the active batches, J; summed in batch order within fixed blocks, whatever the threads. */
double shv_solid_strain_energy(const ShvSolid *solid, const ShvState *state);
/* Strain energy of elements, awake or not, J; with smoothed edges all of those that hang together. */
double shv_solid_energy_of(const ShvSolid *solid, const ShvState *state, const int32_t *elements, int32_t count);
double shv_solid_element_energy(const ShvSolid *solid, const ShvState *state, int32_t element);

#define SHV_SMALLEST_VOLUME_RATIO 0.1
/* Cauchy stress of every element in active batches: stress[6 × SHV_LANES × batch_count], component-major within a
   batch (xx, yy, zz, yz, xz, xy), Pa. `stress` is aligned as shv_allocate does. An element squeezed below
   SHV_SMALLEST_VOLUME_RATIO of its volume, or inverted, gets P Fᵀ over that ratio, so that its stress stays finite.
   Stress of element e, component c: stress[(e/8)*48 + c*8 + e%8]. */
void shv_solid_stress(const ShvSolid *solid, const ShvState *state, double *stress);
/* Of some batches, each once; the others keep theirs. Needs shv_solid_smooth. */
void shv_solid_stress_of(const ShvSolid *solid, const ShvState *state, const int32_t *batches, int32_t count,
                         double *stress);
/* The same of one batch, awake or not: stress[6 × SHV_LANES], aligned to 64 bytes. */
void shv_solid_batch_stress(const ShvSolid *solid, const ShvState *state, int32_t batch, double *stress);
/* Volume weighted average of the stress of a node's elements (its corners, in order); Voigt. */
void shv_solid_nodal_stress(const ShvSolid *solid, const ShvState *state, const double *stress, int32_t node,
                            double voigt[6]);
static inline int64_t shv_stress_slot(int32_t element, int component)
{
    return (int64_t)(element / SHV_LANES) * (6 * SHV_LANES) + component * SHV_LANES + element % SHV_LANES;
}

/* A step at which central difference is stable for the element with lumped masses ρV/4, from its reference shape:
   the safe bound 1/(c √(Σ 1/h_a²)), s, with ρ c² = max(λ, 0) + 2µ, from u·K u ≤ V ρ c² Σ|∇N_a|² |u|², and the exact one
   2/ω_max, whose rounding is kept on the safe side: it is never above the true one. */
double shv_solid_safe_step(const ShvSolid *solid, int32_t element);
double shv_solid_exact_step(const ShvSolid *solid, int32_t element);
/* Where objects meet in one batch its step is that of awake elements alone: a soft body does not go in the steps of a stiff one that
   sleeps. `awake`: by fragment. Before shv_solid_stable_step. */
void shv_solid_update_batch_steps(ShvSolid *solid, const int32_t *element_fragment, const uint8_t *awake);
/* Smallest exact step over active batches and the element that sets it (may be NULL; infinity and −1 without any).
   Irons: safe for the assembly. Node duplication lowers no node's mass share, so the bound holds through fracture. */
double shv_solid_stable_step(const ShvSolid *solid, int32_t *element);
/* A step that is stable for the active batches' elements of Green strain as they were when forces were found last, infinity where none is
   strained so much that it counts: this strain measure stiffens with stretch. */
double shv_solid_strained_step(const ShvSolid *solid);
/* Elements of active batches whose current volume is not positive: their number, and the first of them (−1: none). */
int32_t shv_solid_inverted(const ShvSolid *solid, const ShvState *state, int32_t *first);

#endif
