/* Which tets a smoothed edge has (smoothing.h). */
#ifndef SHV_SOLID_DOMAIN_H
#define SHV_SOLID_DOMAIN_H

#include "solid/solid.h"

/* All elements of smoothed materials; where no material is, nothing is allocated. */
ShvStatus shv_smoothing_create(ShvSolid *solid, const ShvState *state, ShvError *error);
void shv_smoothing_release(ShvSmoothedEdges *smoothing);

/* Energies of active domains besides their stresses. */
void shv_smoothing_find_energy(const ShvSolid *solid, const ShvState *state);
/* Stresses and energies of all edges of one batch, awake or not. */
void shv_smoothing_find_batch(const ShvSolid *solid, const ShvState *state, int32_t batch);
/* The same of all edges of elements that hang together, and share edges with no other. */
void shv_smoothing_find_body(const ShvSolid *solid, const ShvState *state, const int32_t *elements, int32_t count);
/* Stresses of the domains in `split`. */
void shv_smoothing_find_split(const ShvSolid *solid);

static inline int32_t shv_edge_element(const ShvSmoothedEdges *smoothing, int32_t edge)
{
    const int32_t lane = edge / SHV_TET_EDGES;
    return smoothing->blocks[lane / SHV_LANES] * SHV_LANES + lane % SHV_LANES;
}

/* Mean over the tets of a domain, by volume. */
static inline void shv_domain_gradient(const ShvSmoothedEdges *smoothing, int32_t domain, double mean[9])
{
    const int32_t *members = smoothing->members + smoothing->first_member[domain];
    const int32_t count = smoothing->member_count[domain];
    for (int c = 0; c < 9; c++) mean[c] = 0.0;
    for (int32_t i = 0; i < count; i++) {
        const int64_t lane = members[i] / SHV_TET_EDGES;
        for (int c = 0; c < 8; c++) mean[c] += smoothing->gradient[8 * lane + c];
        mean[8] += smoothing->gradient_zz[lane];
    }
    for (int c = 0; c < 9; c++) mean[c] *= smoothing->inverse_volume[domain];
}

#endif
