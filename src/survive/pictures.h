/* What a search looks like: a few of its shots again, recorded and drawn. */
#ifndef SHV_SURVIVE_PICTURES_H
#define SHV_SURVIVE_PICTURES_H

#include "survive/survive.h"

enum { SHV_SURVIVE_PICTURES = 3 };

typedef struct ShvSurvivePictures {
    const char *title[SHV_SURVIVE_PICTURES]; /* NULL: none of that kind */
    ShvShot shot[SHV_SURVIVE_PICTURES];
    char *drawing[SHV_SURVIVE_PICTURES]; /* an element of SVG, before and after */
} ShvSurvivePictures;

/* Of the highest fall that was survived, of the one that broke from nearest above the middle, and of the highest. Run files and
   drawings (picture-1.h5, picture-1.svg, …) stay in the folder. The caller releases them in every case. */
ShvStatus shv_survive_draw(ShvSurvive *survive, ShvSurvivePictures *pictures, ShvError *error);
void shv_survive_pictures_release(ShvSurvivePictures *pictures);

#endif
