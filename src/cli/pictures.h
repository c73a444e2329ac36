/* Pictures and films of a run, drawn by the viewer's page in a headless browser. */
#ifndef SHV_CLI_PICTURES_H
#define SHV_CLI_PICTURES_H

#include "cli/command.h"

typedef struct ShvPictures {
    const char *prefix;
    bool force, stretch;  /* stretch: every frame of the run as long as the others */
    const char *colour;   /* "piece", "damage", …; NULL: piece */
    const double *frames; /* png: numbers of frames; also times, s; without both all frames */
    const double *times;
    int32_t frame_count, time_count;
    int32_t every; /* films: every so many frames of the run; 1: all */
    int32_t width; /* pixels; the height is 9/16 of it */
    double lasts;  /* s: films */
} ShvPictures;

/* PREFIX_NNNNNN.png of frames of the run. */
ShvStatus shv_write_png(ShvRunFile *file, const ShvPictures *pictures, ShvError *error);
/* PREFIX.mp4 or PREFIX.webp, by ffmpeg. */
ShvStatus shv_write_film(ShvRunFile *file, const ShvPictures *pictures, bool webp, ShvError *error);

#endif
