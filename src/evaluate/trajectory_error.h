/* The way of a scene's bodies through a run beside that of another run, or of the closed form that the scene's `reference` names. */
#ifndef SHV_EVALUATE_TRAJECTORY_ERROR_H
#define SHV_EVALUATE_TRAJECTORY_ERROR_H

#include "evaluate/closed_form.h"
#include "evaluate/outcome.h"
#include "evaluate/track.h"

/* Errors, the largest over time and over the bodies compared; docs/study.md tells them. */
typedef enum ShvTrajectoryMeasure {
    SHV_TRAJECTORY_POSITION,
    SHV_TRAJECTORY_ORIENTATION,
    SHV_TRAJECTORY_VELOCITY,
    SHV_TRAJECTORY_SURFACE,
    SHV_TRAJECTORY_ENERGY,
    SHV_TRAJECTORY_ENERGY_GAIN,
    SHV_TRAJECTORY_LINEAR_MOMENTUM,
    SHV_TRAJECTORY_ANGULAR_MOMENTUM,
    SHV_TRAJECTORY_EVENT_TIME,
    SHV_TRAJECTORY_APEX,
    SHV_TRAJECTORY_EVENT_COUNT,
    SHV_TRAJECTORY_MEASURES
} ShvTrajectoryMeasure;
/* figures.c: by the name of a formula's function; −1: none. */
int shv_trajectory_measure_index(const char *name);

typedef struct ShvTrajectoryError {
    const ShvSceneDefinition *scene;
    ShvMemory *memory;
    ShvBodies bodies;
    ShvClosedForm *forms; /* one a body that is chosen; NULL without a closed form */
    ShvTrack track,
        exact; /* of the first chosen body in the last run that was followed, and of what that was compared with */
} ShvTrajectoryError;

/* Looks at the scene's start. With `closed`, SHV_BAD_INPUT where the scene is not one of the law's. The caller closes the way
   in every case; the scene must live as long. */
ShvStatus shv_trajectory_error_open(ShvTrajectoryError *trajectory, const ShvSceneDefinition *scene, const char *folder,
                                    bool closed, ShvMemory *memory, ShvError *error);
void shv_trajectory_error_close(ShvTrajectoryError *trajectory);
/* NaN where a figure has no meaning. `reference` NULL: the closed form. */
ShvStatus shv_trajectory_error_measure(ShvTrajectoryError *trajectory, const ShvOutcome *run,
                                       const ShvOutcome *reference, double errors[SHV_TRAJECTORY_MEASURES],
                                       ShvError *error);

#endif
