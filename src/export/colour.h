/* Colours of pieces: they follow the line of descent. */
#ifndef SHV_EXPORT_COLOUR_H
#define SHV_EXPORT_COLOUR_H

#include <math.h>
#include <stdint.h>

enum { SHV_OBSTACLE_COLOUR = 0xa9a59c, SHV_STONE_COLOUR = 0xd9d1c2, SHV_CRACK_COLOUR = 0x5a3d33 };

/* 0xRRGGBB; src/view/web/colours.js has the same. Multiplicative hashing (Knuth, The Art of Computer Programming 3, 6.4) spreads
   neighbouring numbers. */
static inline uint32_t shv_line_colour(int32_t line)
{
    static const uint32_t colours[] = {0xd1495b, 0xedae49, 0x2a8fa3, 0x6aa58f, 0x9a73a3, 0xf4845f,
                                       0x4f7fb8, 0xa9c777, 0xcf7fa4, 0x86b3d9, 0xe3c567, 0x4fa37a};
    const uint32_t count = sizeof colours / sizeof colours[0];
    return colours[(((uint32_t)line * UINT32_C(2654435769)) >> 16) % count];
}

/* Shades of one colour in a drawing: so few that neighbouring triangles often share one; 0 is the darkest. */
enum { SHV_SHADES = 24 };

static inline uint32_t shv_shaded(uint32_t colour, int shade)
{
    const double strength = 0.5 + 0.56 * shade / (SHV_SHADES - 1);
    uint32_t result = 0;
    for (int k = 16; k >= 0; k -= 8) result |= (uint32_t)fmin(255.0, floor(strength * (colour >> k & 255u) + 0.5)) << k;
    return result;
}

#endif
