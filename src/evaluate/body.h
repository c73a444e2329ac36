/* Bodies that move in a scene, and where they are. */
#ifndef SHV_EVALUATE_BODY_H
#define SHV_EVALUATE_BODY_H

#include "base/memory.h"
#include "base/vector.h"
#include "shiver/simulation.h"

typedef struct ShvBodyState {
    ShvVec3 position; /* of the centre of mass, m */
    ShvQuat orientation;
    ShvVec3 velocity, angular_velocity; /* world */
} ShvBodyState;

enum { SHV_BODY_NUMBERS = sizeof(ShvBodyState) / sizeof(double) };

typedef struct ShvBody {
    const char *name;
    double mass;      /* kg */
    ShvMat3 inertia;  /* kg m², about the centre, body axes */
    double radius;    /* m: of the ball of this mass with the same sum of moments */
    int32_t fragment; /* −1: a free obstacle, */
    int32_t obstacle; /* whose index this is */
    bool chosen;      /* errors are taken of it */
} ShvBody;

typedef struct ShvBodies {
    ShvBody *items; /* fragments, then free obstacles */
    int32_t count;
} ShvBodies;

/* All bodies of a simulation at its first frame; `scene` is what it was made from. SHV_UNSUPPORTED for free obstacles of
   triangles, whose inertia is not known here. */
ShvStatus shv_bodies_create(ShvBodies *bodies, const ShvSceneDefinition *scene, const ShvFrameView *frame,
                            ShvMemory *memory, ShvError *error);
void shv_bodies_release(ShvBodies *bodies);

ShvBodyState shv_body_state(const ShvBody *body, const ShvFrameView *frame);
double shv_body_kinetic(const ShvBody *body, const ShvBodyState *state);
/* About its own centre, world axes. */
ShvVec3 shv_body_spin_momentum(const ShvBody *body, const ShvBodyState *state);
/* The angle between two orientations, rad. */
double shv_angle_between(ShvQuat a, ShvQuat b);

#endif
