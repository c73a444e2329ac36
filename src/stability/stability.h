/* Inside of a measurement: the bodies of a scene by themselves, awake, as fracture mode steps them, and what is tried on them. */
#ifndef SHV_STABILITY_STABILITY_H
#define SHV_STABILITY_STABILITY_H

#include "coupling/hybrid.h"
#include "scene/pool.h"
#include "shiver/stability.h"

struct ShvStability {
    char name[128]; /* of the scene */
    ShvStabilityOptions options;
    ShvMemory *memory;
    ShvStabilityRow *rows;
    int32_t count;
};

/* The small-step run without bars. */
typedef struct ShvProbeReference {
    double step, period; /* s */
    double compliance;   /* s²: static q of a load of 1/s² */
    double *q;           /* after 0, 1, … steps, as of a stretching rate of 1/s: s */
    int32_t count;
    double largest; /* |q| */
} ShvProbeReference;

/* An edge of the first body. */
typedef struct ShvBarAlone {
    int32_t ends[2], visits; /* nodes; of one sweep */
    double weight;           /* reduced mass × (change of length per stretch)² over E V, s² */
} ShvBarAlone;

typedef struct ShvProbe {
    ShvPool pool; /* of materials, fields and bars */
    ShvMaterialDefinition *materials;
    ShvSceneDefinition scene;
    ShvHybrid hybrid;    /* made from `scene`, whose pbd is changed from run to run */
    double *shake;       /* 3 per node: random velocities without rigid motion, m/s */
    double *before;      /* 3 per node: scratch */
    double *stretch;     /* 3 per node: s, m; zero outside of the first body */
    double stretch_norm; /* Σ m s·s, kg m² */
    ShvVec3 axis;
    double modulus, bar_speed, length; /* of the first body; length: diameter about its centre, m */
    ShvProbeReference reference;
    ShvBarAlone *bars;
    int32_t bar_count;
} ShvProbe;

/* `modulus`: of all materials, NaN for their own. `probe` must not move afterwards; the caller releases it in every case. */
ShvStatus shv_probe_create(ShvProbe *probe, const ShvSceneDefinition *scene, const ShvStabilityOptions *options,
                           double modulus, ShvError *error);
void shv_probe_release(ShvProbe *probe);
/* Back to the reference shape, with 3 velocities a node × `scale` (NULL: at rest), and other bars; no iterations: none. */
void shv_probe_restart(ShvProbe *probe, const double *velocities, double scale, double stiffness, int32_t iterations);
ShvStatus shv_probe_step(ShvProbe *probe, double step);
double shv_probe_energy(const ShvProbe *probe);
/* q. */
double shv_probe_elongation(const ShvProbe *probe);
/* Adds the velocity of a steady load, `rate` × s in a step, and multiplies velocities by `keep`. */
void shv_probe_push(ShvProbe *probe, double rate, double keep);

/* search.c: `steps` steps of `multiple` stable steps from the shaken state. */
ShvStabilityClass shv_probe_judge(ShvProbe *probe, const ShvStabilityRow *row, double multiple, int32_t steps);
/* Limit, failed, classes and monotony of a row. */
void shv_probe_search(ShvProbe *probe, const ShvStabilityOptions *options, ShvStabilityRow *row);

/* accuracy.c: makes the reference; errors of one step against it. */
ShvStatus shv_probe_refer(ShvProbe *probe, ShvError *error);
void shv_probe_measure(ShvProbe *probe, const ShvStabilityRow *row, ShvStabilityPoint *point);
/* Stiffness over that without bars if every bar were alone, for one k, n and step (s). */
double shv_probe_bars_alone(const ShvProbe *probe, double stiffness, int32_t iterations, double step);

#endif
