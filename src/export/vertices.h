/* The surface of each line of descent as a mesh whose triangles share their vertices, as programs want it that cut, weld or shade
   pieces. A node is one vertex of a line for each group of the line's tets round it that hang together by faces: so that
   every surface is closed, and does not touch itself where tets have a corner in common alone. Where two have an edge in common
   and hang together round both of its ends, four triangles share that edge. */
#ifndef SHV_EXPORT_VERTICES_H
#define SHV_EXPORT_VERTICES_H

#include "export/lines.h"

typedef struct ShvVertices {
    int64_t *begin;   /* lines + 1: in `node` */
    int32_t *node;    /* of the mesh, of each vertex; those of a line together */
    int32_t *corners; /* 3 × faces of the lines: the number of each corner's vertex in its line */
} ShvVertices;

/* Joins corners of tets ("4 × tet + corner") that are one vertex: of a node that two tets of a piece have in common behind a face of
   both, and, with `corners` (3 × 4 × tets; NULL: anywhere), in the same place. `parent` has 4 × tets, as in base/disjoint_sets.h. */
void shv_vertices_join(const ShvLines *lines, const int32_t *piece, const double *corners, int32_t *parent);
/* Of lines made without cracks. On failure everything is released. */
ShvStatus shv_vertices_create(ShvVertices *vertices, const ShvLines *lines, ShvError *error);
void shv_vertices_release(ShvVertices *vertices);
int64_t shv_vertices_count(const ShvVertices *vertices, int32_t line);
/* m, in the reference mesh, about the reference centre of the line's last fragment. */
ShvVec3 shv_vertices_place(const ShvVertices *vertices, const ShvLines *lines, int32_t line, int64_t vertex);

#endif
