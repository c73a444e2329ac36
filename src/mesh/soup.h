/* Triangles on their way from a file to a surface: vertices may be repeated, as in STL. */
#ifndef SHV_MESH_SOUP_H
#define SHV_MESH_SOUP_H

#include "mesh/scan.h"
#include "mesh/surface.h"

typedef struct ShvSoup {
    ShvMemory *memory;
    double scale;
    int32_t vertex_count, triangle_count;
    int64_t vertex_capacity, triangle_capacity;
    double *positions;  /* scaled */
    int32_t *triangles; /* 3 a triangle */
} ShvSoup;

void shv_soup_release(ShvSoup *soup);
/* `scan` names the place in messages. */
ShvStatus shv_soup_add_vertex(ShvSoup *soup, const ShvScan *scan, ShvVec3 position, ShvError *error);
/* Corners need not be there yet: the reader answers for their range. */
ShvStatus shv_soup_add_triangle(ShvSoup *soup, const ShvScan *scan, int32_t a, int32_t b, int32_t c, ShvError *error);
/* Merges equal vertices, drops collapsed triangles and unused vertices. `surface` comes with memory and part set. */
ShvStatus shv_soup_finish(ShvSoup *soup, ShvSurface *surface, ShvError *error);

/* One a format; each fills the soup from the whole file. */
ShvStatus shv_read_obj(ShvSoup *soup, ShvScan *scan, ShvError *error);
ShvStatus shv_read_stl(ShvSoup *soup, ShvScan *scan, ShvError *error);
ShvStatus shv_read_ply(ShvSoup *soup, ShvScan *scan, ShvError *error);

#endif
