/* Betters the worst tets of a mesh: other tets round their edges and facets, other places of their nodes. What counts of a tet
   is the step that it allows (physics: 1/step² = c² Σ 1/altitude²): slivers, which have four nodes near one circle, go first. */
#ifndef SHV_MESH_IMPROVE_H
#define SHV_MESH_IMPROVE_H

#include "base/memory.h"
#include "mesh/outline.h"

typedef struct ShvImprove {
    ShvMemory *memory;
    const ShvOutline *outline; /* nodes stay on it */
    const uint8_t *held;       /* a node, outline.h */
    double *positions;         /* 3 a node */
    int32_t node_count, tet_count;
    int32_t *tets; /* 4 a tet; replaced by others */
    double wanted; /* tets of this measure and more stay, m */
    uint64_t seed;
} ShvImprove;

/* 3 V/√ΣA²: 0.41 of the edge of a regular tet; negative when it is inverted. */
double shv_improve_measure(const double *positions, const int32_t tet[4]);
/* Works until nothing gets better. Memory can be out; the mesh is then as good as it was, and the tets still the caller's. */
ShvStatus shv_improve(ShvImprove *mesh, ShvError *error);

#endif
