/* The way of a scene's bodies through a run beside that of another run, or of the closed form that the scene's `reference` names. */
#ifndef SHV_EVALUATE_WAY_H
#define SHV_EVALUATE_WAY_H

#include "evaluate/closed_form.h"
#include "evaluate/outcome.h"
#include "evaluate/track.h"

/* Errors, the largest over time and over the bodies compared; docs/study.md tells them. */
typedef enum ShvWayError {
    SHV_WAY_POSITION,
    SHV_WAY_ORIENTATION,
    SHV_WAY_VELOCITY,
    SHV_WAY_SURFACE,
    SHV_WAY_ENERGY,
    SHV_WAY_ENERGY_GAIN,
    SHV_WAY_LINEAR_MOMENTUM,
    SHV_WAY_ANGULAR_MOMENTUM,
    SHV_WAY_MOMENT,
    SHV_WAY_APEX,
    SHV_WAY_MOMENTS,
    SHV_WAY_ERRORS
} ShvWayError;
/* figures.c: by the name of a formula's function; −1: none. */
int shv_way_index(const char *name);

typedef struct ShvWay {
    const ShvSceneDefinition *scene;
    ShvMemory *memory;
    ShvBodies bodies;
    ShvClosedForm *forms; /* one a body that is chosen; NULL without a closed form */
    ShvTrack track;       /* of the last run that was followed */
} ShvWay;

/* Looks at the scene's start. With `closed`, SHV_BAD_INPUT where the scene is not one of the law's. The caller closes the way
   in every case; the scene must live as long. */
ShvStatus shv_way_open(ShvWay *way, const ShvSceneDefinition *scene, const char *folder, bool closed, ShvMemory *memory,
                       ShvError *error);
void shv_way_close(ShvWay *way);
/* NaN where a figure has no meaning. `reference` NULL: the closed form. */
ShvStatus shv_way_follow(ShvWay *way, const ShvOutcome *run, const ShvOutcome *reference, double errors[SHV_WAY_ERRORS],
                         ShvError *error);

#endif
