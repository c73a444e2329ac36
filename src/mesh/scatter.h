/* Points in and on a body, nowhere near each other and in no order: darts that fall too near another are taken away. */
#ifndef SHV_MESH_SCATTER_H
#define SHV_MESH_SCATTER_H

#include "base/memory.h"
#include "mesh/outline.h"

typedef struct ShvScatter {
    ShvMemory *memory;
    int32_t count, capacity;
    double *positions; /* 3 each */
    uint8_t *held;     /* outline.h */
} ShvScatter;

/* Points whose tets will have edges of about `edge` on average. On failure owns nothing. */
ShvStatus shv_scatter_make(ShvScatter *scatter, ShvMemory *memory, const ShvOutline *outline, double edge,
                           uint64_t seed, ShvError *error);
void shv_scatter_release(ShvScatter *scatter);

#endif
