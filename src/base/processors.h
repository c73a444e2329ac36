/* How many of the machine's processors other programs leave free. */
#ifndef SHV_BASE_PROCESSORS_H
#define SHV_BASE_PROCESSORS_H

#include <stdint.h>

/* As last looked at. All zero: not yet. */
typedef struct ShvProcessors {
    double time;      /* s: shv_now */
    double busy, own; /* s of processor time: of all programs since the machine started; of this process */
    int32_t free;     /* of those that are there, at least 1 */
} ShvProcessors;

/* Looks again. Others have what they used since the last look (/proc/stat); at the first one, a processor for each of their threads that
   runs (/proc/loadavg); nothing where the system does not tell. Of a container with a quota (/sys/fs/cgroup/cpu.max) no more is free than
   that. */
void shv_processors_look(ShvProcessors *processors);

/* Those of `online` that `others` leave, where these had so many processors on average: at least one. */
int32_t shv_processors_left(int32_t online, double others);
/* Those of `online` that a quota grants, "200000 100000" (µs of processor time in so many µs) or "max 100000": at least one. */
int32_t shv_processors_granted(int32_t online, const char *quota);

#endif
