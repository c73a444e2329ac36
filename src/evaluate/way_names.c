/* Apart from what follows a run, so that readers of formulas need no simulation. */
#include <string.h>

#include "evaluate/way.h"

static const char *const names[SHV_WAY_ERRORS] = {"position", "orientation", "velocity",        "surface",
                                                  "energy",   "energy_gain", "linear_momentum", "angular_momentum",
                                                  "moment",   "apex",        "moments"};

int shv_way_index(const char *name)
{
    for (int i = 0; i < SHV_WAY_ERRORS; i++)
        if (strcmp(names[i], name) == 0) return i;
    return -1;
}
