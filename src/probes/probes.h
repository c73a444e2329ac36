/* Probes: what named points, sets of nodes and obstacles do while time goes on. A sample is completed by the step that is taken
   anyway: positions and stress before the kick of step n, velocities around it, impulses of it. Sampling changes nothing. */
#ifndef SHV_PROBES_PROBES_H
#define SHV_PROBES_PROBES_H

#include "conditions/imposed.h"
#include "contact/surface_contact.h"
#include "fragment/fragment.h"
#include "pbd/relax.h"
#include "shape/obstacle.h"
#include "shiver/simulation.h"
#include "solid/solid.h"

typedef struct ShvSampledProbe {
    const ShvProbeDefinition *definition;
    int32_t *elements; /* the one that holds the point, or those with a chosen node; increasing */
    int32_t element_count;
    double *corner_shares; /* 4 per element: what each corner counts in the mean; they sum to 1 */
    double *stress_shares; /* per element; they sum to 1 */
    int32_t *origins;      /* chosen nodes of the reference mesh, increasing; none for a point */
    int32_t origin_count;
    int32_t obstacle;
    ShvVec3 start; /* m: where the obstacle was */
} ShvSampledProbe;

typedef struct ShvProbes {
    ShvMemory *memory;
    ShvSampledProbe *items;
    int32_t count;
    int64_t every;
    double interval, next_time; /* s; interval 0: by steps */
    double *times;              /* per row, s */
    ShvProbeSample *samples;    /* row by row */
    int64_t rows, capacity;
} ShvProbes;

/* What a sample is taken from. */
typedef struct ShvProbeScene {
    const ShvSolid *solid;
    const ShvState *state;
    const ShvFragments *fragments;
    const ShvObstacles *obstacles;
} ShvProbeScene;

/* Finds points and nodes on the placed mesh. An unknown object or obstacle, a point outside all bodies and a selection without
   nodes are errors that name the probe. On failure it owns nothing. */
ShvStatus shv_probes_create(ShvProbes *probes, const ShvModel *model, const ShvSceneDefinition *scene,
                            const ShvObstacles *obstacles, const ShvState *state, ShvError *error);
void shv_probes_release(ShvProbes *probes);

/* Whether the step from this time is to be sampled. */
bool shv_probes_due(ShvProbes *probes, const ShvState *state);
/* Before the kick of a step: begins a row. Samples of bodies that are not wholly awake are NaN. */
ShvStatus shv_probes_begin(ShvProbes *probes, const ShvProbeScene *scene, const uint8_t *awake, ShvError *error);
/* After the kick between steps of `before` and `after` seconds: completes the row. `relax`: pushes of obstacles where bars are, NULL
   elsewhere. */
void shv_probes_end(ShvProbes *probes, const ShvProbeScene *scene, double before, double after,
                    const ShvSurfaceContact *contact, const ShvRelax *relax, const ShvImposed *imposed);
/* A row of the probes whose bodies fly, if there are such; all of them and the obstacles when `none_awake`. `keeps_nodes`: the
   nodes of what flies are in the state. */
ShvStatus shv_probes_fly(ShvProbes *probes, const ShvProbeScene *scene, bool none_awake, bool keeps_nodes,
                         ShvError *error);

#endif
