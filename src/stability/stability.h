/* Inside of a measurement, for the files of this folder. */
#ifndef SHV_STABILITY_STABILITY_H
#define SHV_STABILITY_STABILITY_H

#include "stability/probe.h"

struct ShvStability {
    char name[128]; /* of the scene */
    ShvStabilityOptions options;
    ShvMemory *memory;
    ShvStabilityRow *rows;
    int32_t count;
};

#endif
