/* How far the surface of a mesh lets its nodes move: anywhere inside, in the plane of a flat surface, along the line where two planes
   meet, or not at all. */
#ifndef SHV_MESH_FREEDOM_H
#define SHV_MESH_FREEDOM_H

#include <stdbool.h>

#include "mesh/mesh.h"

typedef enum ShvFreedomKind { SHV_FREE, SHV_IN_PLANE, SHV_ON_LINE, SHV_FIXED } ShvFreedomKind;

typedef struct ShvFreedom {
    uint8_t *kind;   /* a ShvFreedomKind a node */
    double *normals; /* 6 a node: of the planes it lies in, the first two */
} ShvFreedom;

/* Normals that differ by less than this are those of one plane: above the rounding of coordinates (1e-9 of a facet's
   size), below the turn from facet to facet of any curved surface that a mesh resolves. */
static const double shv_same_plane = 1e-6;

/* Facets at a node whose unit normals differ by less than `same` are one plane: that of the first of them or, for `mean`, the mean by area.
   Released by the caller, also after a failure. */
ShvStatus shv_freedom_find(ShvFreedom *freedom, const ShvMesh *mesh, double same, bool mean, ShvError *error);
void shv_freedom_release(ShvFreedom *freedom);

/* What is left of a node's shift. */
ShvVec3 shv_freedom_shift(const ShvFreedom *freedom, int32_t node, ShvVec3 shift);

#endif
