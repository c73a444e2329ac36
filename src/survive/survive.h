/* Inside of a search for the height from which a body breaks, for the files of this folder. */
#ifndef SHV_SURVIVE_SURVIVE_H
#define SHV_SURVIVE_SURVIVE_H

#include "shiver/scene.h"
#include "survive/design.h"
#include "survive/drop.h"
#include "survive/shots.h"

struct ShvSurvive {
    ShvSurviveOptions options;
    ShvScene *scene;
    const char *scene_path; /* the caller's */
    uint64_t key;           /* hash of all that a shot follows from */
    char *path;             /* of this task's table */
    ShvDrop drop;
    ShvShots shots;
    ShvSpecimen *specimens; /* room for as many as there are shots, and one */
    int32_t room;
    ShvSurviveView view;
};

/* Fits what there is; view.shots and all else of it is then of these shots. */
ShvStatus shv_survive_fit(ShvSurvive *survive, ShvError *error);

#endif
