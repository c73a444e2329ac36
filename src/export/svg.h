/* Inside of a drawing, for the files of this folder. */
#ifndef SHV_EXPORT_SVG_H
#define SHV_EXPORT_SVG_H

#include "export/output.h"
#include "export/raster.h"
#include "export/skin.h"

/* Shades of one colour: so few that many triangles share a path. */
enum { SHV_SVG_SHADES = 24 };

typedef struct ShvSvg {
    ShvSvgOptions options;
    ShvSkin skin;
    ShvCamera camera;
    ShvRaster raster;
    FILE *stream;
} ShvSvg;

/* Unit vector towards the light. */
ShvVec3 shv_svg_light(void);
/* 0xRRGGBB of a fragment's faces by shade, 0 the darkest; the largest fragment of a frame has a colour of its own. */
uint32_t shv_svg_colour(int32_t line, bool largest, int shade);
/* The frames to draw, one after another; *frames is to be released, also after a failure. */
ShvStatus shv_svg_frames(const ShvSvgOptions *options, const ShvRunFile *file, int64_t **frames, int32_t *count,
                         ShvError *error);

/* Definitions of the floor that all panels use; nothing without a floor that the camera sees from above. */
void shv_svg_define_floor(const ShvSvg *svg);
/* Floor and shadows, then the fragments, of the frame at which the skin is. */
ShvStatus shv_svg_draw_floor(ShvSvg *svg, ShvError *error);
ShvStatus shv_svg_draw_fragments(ShvSvg *svg, ShvError *error);
/* One triangle as part of a path. */
void shv_svg_triangle(FILE *stream, const ShvScreenPoint corner[3]);

#endif
