/* One shot: the scene with its body as it falls, run until it is known what has become of it. */
#ifndef SHV_SURVIVE_DROP_H
#define SHV_SURVIVE_DROP_H

#include "base/memory.h"
#include "base/vector.h"
#include "shiver/survive.h"

typedef struct ShvDrop {
    const ShvSceneDefinition *scene; /* the caller's */
    const char *folder;              /* what its file names start from; the caller's */
    ShvMemory *memory;
    int32_t object;
    ShvVec3 direction; /* unit: of the speed */
    ShvVec3 centre;    /* m: that of its nodes, as the scene places them */
    double *nodes;     /* 3 × node_count, m, likewise */
    int32_t node_count;
    ShvObjectDefinition *objects; /* room for the scene's */
    bool (*stop)(void *data);
    void *stop_data;
} ShvDrop;

/* SHV_BAD_INPUT when the scene has no body to drop, or says not which, or nothing drives it. */
ShvStatus shv_drop_create(ShvDrop *drop, const ShvSceneDefinition *scene, const char *folder,
                          const ShvSurviveOptions *options, ShvError *error);
void shv_drop_release(ShvDrop *drop);

/* The speed of a fall from a height in standard gravity, m/s. */
double shv_drop_speed(double height);
ShvStatus shv_drop_shoot(ShvDrop *drop, uint64_t specimen, double height, ShvShot *shot, ShvError *error);
/* The same fall again, into a run file with its nodes; one that is there is replaced. */
ShvStatus shv_drop_record(ShvDrop *drop, const ShvShot *shot, const char *path, ShvError *error);

#endif
