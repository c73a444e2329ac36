/* The bars of one chunk. */
#ifndef SHV_PBD_BAR_CHUNK_H
#define SHV_PBD_BAR_CHUNK_H

#include "pbd/bars.h"

enum { SHV_BAR_CHUNK_NODES = 128 }; /* reference nodes */

/* Collects, colours and stores the items of a chunk from the present connectivity. */
ShvStatus shv_bar_chunk_make(ShvBars *bars, const ShvState *state, int32_t chunk, ShvError *error);
/* Colours the chunks of the reference mesh and sorts them by colour. */
ShvStatus shv_bar_chunks_colour(ShvBars *bars, ShvError *error);

/* Reference node of a corner. */
static inline int32_t shv_bar_origin(const ShvBars *bars, int32_t element, int32_t corner)
{
    return bars->model->mesh.elements[4 * (int64_t)element + corner];
}
/* Half-open range of a chunk's reference nodes. */
static inline int32_t shv_bar_chunk_end(const ShvBars *bars, int32_t chunk)
{
    const int64_t end = ((int64_t)chunk + 1) * SHV_BAR_CHUNK_NODES;
    return end < bars->model->mesh.node_count ? (int32_t)end : bars->model->mesh.node_count;
}

#endif
