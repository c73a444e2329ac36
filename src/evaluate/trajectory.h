/* The way of a scene's bodies through a run beside that of another run, or of the closed form that the scene's `reference` names.
   Both are lists of the run's outcome: "track" (and "exact" of the closed form), states body by body and frame by frame. */
#ifndef SHV_EVALUATE_TRAJECTORY_H
#define SHV_EVALUATE_TRAJECTORY_H

#include "base/vector.h"
#include "evaluate/outcome.h"

/* body.c: bodies that move in a scene, and where they are. Both are numbers alone, so that lists of an outcome are of them. */
typedef struct ShvBodyState {
    ShvVec3 position; /* of the centre of mass, m */
    ShvQuat orientation;
    ShvVec3 velocity, angular_velocity; /* world */
} ShvBodyState;

typedef struct ShvBody {
    double mass;     /* kg */
    double radius;   /* m: of the ball of this mass with the same sum of moments */
    ShvMat3 inertia; /* kg m², about the centre, body axes */
    double chosen;   /* 1: the closed form is of it; else 0 */
} ShvBody;

enum { SHV_STATE_NUMBERS = sizeof(ShvBodyState) / sizeof(double), SHV_BODY_NUMBERS = sizeof(ShvBody) / sizeof(double) };

/* The bodies of a scene are the fragments of its first frame and then its free obstacles. */
int32_t shv_body_count(const ShvSceneDefinition *scene, int32_t fragments);
/* The obstacle that a body is, NULL where it is a fragment. */
const ShvObstacleDefinition *shv_body_obstacle(const ShvSceneDefinition *scene, int32_t fragments, int32_t body);
/* SHV_UNSUPPORTED for free obstacles of triangles, whose inertia is not known here. `frame`: the first. */
ShvStatus shv_body_describe(ShvBody *body, const ShvSceneDefinition *scene, const ShvFrameView *frame, int32_t index,
                            ShvError *error);
ShvBodyState shv_body_state(const ShvSceneDefinition *scene, const ShvFrameView *frame, int32_t fragments,
                            int32_t body);

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

/* In the list "track.scene", numbers alone; "track.bodies" is how many there are, "track.masses" has a ShvBody of each. */
typedef struct ShvTrackScene {
    double law;      /* ShvReferenceLaw of the closed form, SHV_REFERENCE_NONE without one */
    double duration; /* s */
    ShvVec3 gravity;
    ShvVec3 up; /* of a bounce: the normal of what is met */
} ShvTrackScene;

/* NaN where a figure has no meaning or is not kept. `reference` NULL: the closed form. */
ShvStatus shv_trajectory_errors(const ShvOutcome *run, const ShvOutcome *reference,
                                double errors[SHV_TRAJECTORY_MEASURES], ShvError *error);

/* One body frame by frame. */
typedef struct ShvTrack {
    const double *times;
    const ShvBodyState *states;
    int32_t stride, count; /* states from one frame to the next; frames */
} ShvTrack;
/* Times of events that mark a motion (impacts, flips), at most `most`; returns their number. */
/* Impacts on a plane: where the parabolas through two frames meet, between which the velocity along `normal` turned from in
   to out by more than thrice what gravity does in between. `heights`, one fewer: of the apex after each, above where the body is at
   the first: from speed and place half way to the next one. */
int shv_track_impacts(const ShvTrack *track, ShvVec3 normal, ShvVec3 gravity, double *times, double *heights, int most);
/* Flips: spin about the middle principal axis (of `inertia`, body axes) passes through zero, by linear interpolation. */
int shv_track_flips(const ShvTrack *track, const ShvMat3 *inertia, double *times, int most);

#endif
