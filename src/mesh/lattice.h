/* Tetrahedra of a body-centred cubic lattice in a box, graded by halving cells towards a slit.

   The box is cut into cubic cells (scaled a little along each axis so that they fit). Every cell has a node at its
   centre. Two equal neighbours share a square face; its four edges, each with the two centres, make the four tets of the
   body-centred lattice, all alike, with dihedral angles of 60 and 90 degrees and facets in all six {110} directions.
   On the body's surface the square face and the centre make a pyramid, cut into two tets along a diagonal that
   alternates from face to face. Cells are halved towards the slit such that touching cells differ by one halving at
   most; an edge that a smaller neighbour halves splits its tets in two, and between a cell and four smaller neighbours
   the pyramids of both sides are cut along the diagonals through the middle of the large face. (The cells, the
   body-centred tets and the grading are those of Labelle & Shewchuk, "Isosurface stuffing", ACM Trans. Graph. 26(3),
   2007; nothing is warped here, because the surface consists of lattice planes.) */
#ifndef SHV_MESH_LATTICE_H
#define SHV_MESH_LATTICE_H

#include <stdbool.h>

#include "mesh/mesh.h"

/* Most halvings: six-fold products of lengths counted in halves of smallest cells stay within 64 bits. */
enum { SHV_LATTICE_LEVELS = 18 };

typedef struct ShvLattice {
    int32_t roots[3]; /* cells along each axis before halving */
    int32_t levels;   /* halvings at the slit, at most SHV_LATTICE_LEVELS; a smallest cell is a root cell / 2^levels */
    double low[3], high[3];
    int32_t knot[3];                   /* a plane between smallest cells, counted from `low`, … */
    double knot_value[3];              /* … and where it lies; the planes on either side of it are equally spaced */
    int32_t reach[SHV_LATTICE_LEVELS]; /* cells of level l < levels nearer to the slit than reach[l] smallest cells are
                                          halved; balance needs 0 < reach[l + 1] + 2^(levels − l − 1) ≤ reach[l] */
    bool slit; /* a slit in the plane x = knot from `low` up to z = knot, through all y: two lips whose nodes
                             coincide but differ; the nodes of its front are common */
} ShvLattice;

/* Mean length of the six edges of the tets of an unbounded lattice over the length of its cells: (2 + 4 √¾) / 6. */
#define SHV_LATTICE_EDGE 0.9106836025229591

/* Uniform lattice of a box centred on the origin, with cells of about `cell`. */
ShvLattice shv_lattice_box(const double size[3], double cell);
/* About how many elements the lattice has: too large a one is refused by its caller before it is made. */
double shv_lattice_estimate(const ShvLattice *lattice);
/* Refuses a lattice whose places cannot be numbered in 64 bits. */
ShvStatus shv_lattice_mesh(ShvMesh *mesh, ShvMemory *memory, const ShvLattice *lattice, ShvError *error);

#endif
