/* Betters the worst tets of a mesh: other tets round their edges and facets, other places of their nodes. What counts of a tet
   is the step that it allows (physics: 1/step² = c² Σ 1/altitude²): slivers, which have four nodes near one circle, go first. */
#ifndef SHV_MESH_IMPROVE_H
#define SHV_MESH_IMPROVE_H

#include "base/memory.h"
#include "mesh/freedom.h"
#include "mesh/outline.h"

typedef struct ShvImprove {
    ShvMemory *memory;
    const ShvOutline *outline; /* nodes stay on it; NULL: the surface is that of a mesh */
    const uint8_t *held;       /* a node, outline.h */
    ShvFreedom freedom;        /* without an outline: as far as the surface lets them, and as much as `wanted` from */
    const double *original;    /* where they were, 3 a node */
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

/* The tenth of a mesh whose tets are worst. Nodes of flat surfaces slide in their plane, those of straight edges along them; if `curved`,
   those of smooth surfaces and edges as well, by less than half an edge, in the mean of the planes of their facets. Nodes that two groups
   share stay where they are. */
ShvStatus shv_mesh_improve(ShvMesh *mesh, bool curved, uint64_t seed, ShvError *error);

#endif
