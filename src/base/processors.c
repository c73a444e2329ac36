#include "base/processors.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

#include "base/timer.h"

/* "cpu user nice system idle iowait irq softirq steal …" in clock ticks, of all processors; a virtual machine's stolen time is
   time in which a thread of ours waits, too. NaN where the system does not tell. */
static double read_busy(void)
{
    double user, nice, system, idle, waiting, irq, soft_irq, stolen;
    FILE *file = fopen("/proc/stat", "r");
    if (!file) return (double)NAN;
    const int found = fscanf(file, "cpu %lf %lf %lf %lf %lf %lf %lf %lf", &user, &nice, &system, &idle, &waiting, &irq,
                             &soft_irq, &stolen);
    fclose(file);
    const double ticks = user + nice + system + irq + soft_irq + stolen;
    return found == 8 ? ticks / (double)sysconf(_SC_CLK_TCK) : (double)NAN;
}

/* "0.20 0.18 0.12 1/80 11206": of 80 threads one runs, or waits for a processor: this one. */
static double read_others_running(void)
{
    double running = 1.0;
    FILE *file = fopen("/proc/loadavg", "r");
    if (!file) return 0.0;
    if (fscanf(file, "%*f %*f %*f %lf/", &running) != 1) running = 1.0;
    fclose(file);
    return fmax(0.0, running - 1.0);
}

int32_t shv_processors_granted(int32_t online, const char *quota)
{
    double time, period;
    if (sscanf(quota, "%lf %lf", &time, &period) != 2 || !(time > 0.0 && period > 0.0)) return online;
    return shv_processors_left(online, fmax(0.0, online - time / period));
}

static int32_t read_granted(int32_t online)
{
    char quota[64] = "";
    FILE *file = fopen("/sys/fs/cgroup/cpu.max", "r");
    if (!file) return online;
    if (!fgets(quota, sizeof quota, file)) quota[0] = '\0';
    fclose(file);
    return shv_processors_granted(online, quota);
}

static double read_own(void)
{
    struct timespec now = {0, 0};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int32_t shv_processors_left(int32_t online, double others)
{
    const double left = online - floor(others + 0.5);
    return left > 1.0 ? (int32_t)fmin(left, online) : 1;
}

void shv_processors_look(ShvProcessors *processors)
{
    const ShvProcessors before = *processors;
    const int32_t online = (int32_t)sysconf(_SC_NPROCESSORS_ONLN), granted = read_granted(online);
    *processors = (ShvProcessors){.time = shv_now(), .busy = read_busy(), .own = read_own(), .free = granted};
    const double used = (processors->busy - before.busy) - (processors->own - before.own);
    const double interval = processors->time - before.time;
    const bool known = before.free > 0 && interval > 0.0 && isfinite(used);
    const double others = known ? fmax(used, 0.0) / interval : read_others_running();
    const int32_t left = shv_processors_left(online, others);
    processors->free = left < granted ? left : granted;
}
