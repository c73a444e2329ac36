/* Apart from what follows a run, so that readers of formulas need no simulation. */
#include <string.h>

#include "evaluate/trajectory_error.h"

static const char *const names[SHV_TRAJECTORY_MEASURES] = {
    "position",        "orientation",      "velocity", "surface", "energy", "energy_gain",
    "linear_momentum", "angular_momentum", "moment",   "apex",    "moments"};

int shv_trajectory_measure_index(const char *name)
{
    for (int i = 0; i < SHV_TRAJECTORY_MEASURES; i++)
        if (strcmp(names[i], name) == 0) return i;
    return -1;
}
