/* A reserve of memory for libraries that do not survive its end. */
#ifndef SHV_CLI_RESERVE_H
#define SHV_CLI_RESERVE_H

#include <stdbool.h>

/* Our own allocations may fail: each is followed by a message. Those of HDF5, libfyaml and the C++ library end in crashes in many
   places. The program therefore stands in front of malloc: when that fails, a block of the reserve is given, and from then on
   this is true. Whoever goes on for long should ask, and come to an end while the reserve lasts. Nothing of the reserve is touched
   before, so that it takes no memory. */
bool shv_reserve_used(void);

#endif
