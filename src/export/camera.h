/* A camera in front of and above what is drawn, z up, with a mild perspective. */
#ifndef SHV_EXPORT_CAMERA_H
#define SHV_EXPORT_CAMERA_H

#include <stdbool.h>

#include "base/vector.h"

typedef struct ShvCamera {
    ShvVec3 right, up, toward; /* unit axes; `toward` points at the viewer */
    double low[3], high[3];    /* what must be in view, along these axes, m */
    ShvVec3 centre;            /* m */
    double distance, scale;    /* of the eye from the centre, m; pixels a metre at the centre */
    double width, height;      /* of the picture, pixels */
} ShvCamera;

typedef struct ShvScreenPoint {
    double x, y; /* pixels from the left and from the top */
    double near; /* inverse of the distance along the line of sight, 1 at the centre: linear over a flat surface */
} ShvScreenPoint;

/* A camera that has nothing to show yet. */
ShvCamera shv_camera_begin(void);
void shv_camera_include(ShvCamera *camera, ShvVec3 point);
/* Places eye and frame around the included points; the height follows from them within reason. */
void shv_camera_aim(ShvCamera *camera, double width);
/* False when the point is beside or behind the eye. */
bool shv_camera_project(const ShvCamera *camera, ShvVec3 point, ShvScreenPoint *seen);

#endif
