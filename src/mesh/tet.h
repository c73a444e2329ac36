/* One tetrahedron measured: volume, faces, shape. */
#ifndef SHV_MESH_TET_H
#define SHV_MESH_TET_H

#include "mesh/mesh.h"

typedef struct ShvTet {
    ShvVec3 corners[4];
    ShvVec3 normals[4]; /* of the face opposite each corner: outward, as long as the face is large */
    double areas[4];
    double volume; /* negative when inverted */
} ShvTet;

ShvTet shv_tet_of_nodes(const ShvMesh *mesh, const int32_t nodes[4]);
/* Of the face opposite a corner, m². */
double shv_tet_face_area(const ShvMesh *mesh, const int32_t nodes[4], int face);
/* 3 × inradius / circumradius: 1 regular, 0 flat; negative when inverted. */
double shv_tet_aspect(const ShvTet *tet);
/* Writes element `element` of a mesh whose positions are set, swapping two of the nodes when that makes it positive. */
void shv_tet_write(ShvMesh *mesh, int64_t element, const int32_t nodes[4]);

#endif
