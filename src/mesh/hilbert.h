/* The Hilbert curve through a cube: points near each other on it are near each other in space. */
#ifndef SHV_MESH_HILBERT_H
#define SHV_MESH_HILBERT_H

#include <stdint.h>

enum { SHV_HILBERT_BITS = 20 /* along each axis */ };

/* Place of a cell on the curve: Skilling's transform of the coordinates ("Programming the Hilbert curve", AIP Conf. Proc. 707,
   2004), then their bits interleaved. Uses up `x`. */
uint64_t shv_hilbert_place(uint32_t x[3]);

#endif
