/* Which tets a smoothed edge has (smoothing.h). */
#ifndef SHV_SOLID_DOMAIN_H
#define SHV_SOLID_DOMAIN_H

#include "solid/solid.h"

/* All elements of smoothed materials; where no material is, nothing is allocated. */
ShvStatus shv_smoothing_create(ShvSolid *solid, const ShvState *state, ShvError *error);
void shv_smoothing_release(ShvSmoothedEdges *smoothing);

/* A domain for so many edges, in the last group or, where that is full or not as wide or `apart` is asked for, in a new one that is
   `width` wide or more. Its edges are to be set, then it is closed. */
ShvStatus shv_smoothing_add_domain(ShvSolid *solid, ShvSmoothedEdges *smoothing, int32_t count, int32_t width,
                                   bool apart, int16_t material, int32_t *domain, ShvError *error);
void shv_smoothing_set_edge(ShvSmoothedEdges *smoothing, int32_t domain, int32_t i, int32_t edge);
void shv_smoothing_close_domain(const ShvSolid *solid, ShvSmoothedEdges *smoothing, int32_t domain, int32_t count);
/* Domains in groups and windows anew; which there are, their offsets and stresses stay. */
ShvStatus shv_smoothing_lay_out(ShvSolid *solid, const ShvState *state, ShvError *error);

/* Energies of active domains besides their stresses. */
void shv_smoothing_find_energy(const ShvSolid *solid, const ShvState *state);
/* Stresses and energies of all edges of one batch, awake or not. */
void shv_smoothing_find_batch(const ShvSolid *solid, const ShvState *state, int32_t batch);
/* The energies of all edges of elements that hang together, and share edges with no other. */
void shv_smoothing_find_body(const ShvSolid *solid, const ShvState *state, const int32_t *elements, int32_t count);
/* Stresses of the domains in `split`, and their tets' means. */
void shv_smoothing_find_split(const ShvSolid *solid);

static inline int32_t shv_edge_element(const ShvSmoothedEdges *smoothing, int32_t edge)
{
    const int32_t lane = edge / SHV_TET_EDGES;
    return smoothing->blocks[lane / SHV_LANES] * SHV_LANES + lane % SHV_LANES;
}

/* Both nodes of edge k of an element, the lower first. */
static inline void shv_edge_nodes(const ShvState *state, int32_t element, int k, int32_t nodes[2])
{
    const int32_t a = shv_state_node(state, element, shv_tet_edges[k][0]);
    const int32_t b = shv_state_node(state, element, shv_tet_edges[k][1]);
    nodes[0] = a < b ? a : b;
    nodes[1] = a < b ? b : a;
}

/* Where the lane of a domain's i-th edge is noted. */
static inline int32_t *shv_domain_member(const ShvSmoothedEdges *smoothing, int32_t domain, int32_t i)
{
    return smoothing->members + smoothing->group_member[domain / SHV_LANES] + (int64_t)SHV_LANES * i +
           domain % SHV_LANES;
}

/* The lane with no strain. */
static inline int32_t shv_smoothing_no_lane(const ShvSmoothedEdges *smoothing)
{
    return SHV_LANES * smoothing->block_count;
}

static inline int32_t shv_domain_edge_count(const ShvSmoothedEdges *smoothing, int32_t domain)
{
    int32_t count = 0;
    while (count < smoothing->group_width[domain / SHV_LANES] &&
           *shv_domain_member(smoothing, domain, count) != shv_smoothing_no_lane(smoothing))
        count++;
    return count;
}

/* Component c of G. */
static inline double *shv_domain_offset(const ShvSmoothedEdges *smoothing, int32_t domain, int c)
{
    return smoothing->offset + (9 * (int64_t)(domain / SHV_LANES) + c) * SHV_LANES + domain % SHV_LANES;
}

static inline bool shv_domain_has_offset(const ShvSmoothedEdges *smoothing, int32_t domain)
{
    for (int c = 0; c < 9; c++)
        if (*shv_domain_offset(smoothing, domain, c) != 0.0) return true;
    return false;
}

#endif
