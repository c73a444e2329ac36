/* An obstacle as triangles, in its own axes about its position; a plane as a square around what the run moves. */
#ifndef SHV_EXPORT_OBSTACLE_MESH_H
#define SHV_EXPORT_OBSTACLE_MESH_H

#include "export/lines.h"

typedef struct ShvObstacleMesh {
    ShvObstacleBody body;
    double *positions;  /* 3 × node_count, m */
    int32_t *triangles; /* 3 × triangle_count, counter-clockwise seen from outside */
    int32_t node_count, triangle_count;
} ShvObstacleMesh;

/* All obstacles of a run; *meshes is to be released with the function below, also after a failure. */
ShvStatus shv_obstacle_meshes_create(ShvObstacleMesh **meshes, const ShvPieces *pieces, struct ShvMemory *memory,
                                     ShvError *error);
void shv_obstacle_meshes_release(ShvObstacleMesh *meshes, int32_t count);

#endif
