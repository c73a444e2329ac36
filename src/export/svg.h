/* Colours of a drawing. */
#ifndef SHV_EXPORT_SVG_H
#define SHV_EXPORT_SVG_H

#include <stdint.h>

/* Shades of one colour: so few that neighbouring triangles often share one. */
enum { SHV_SVG_SHADES = 24 };

/* 0xRRGGBB of a colour in a shade, 0 the darkest. */
uint32_t shv_svg_shaded(uint32_t colour, int shade);

#endif
