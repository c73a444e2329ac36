#include <stdlib.h>
#include <unistd.h>

#include "cli/command.h"

/* Threads that wait for each other spin for a while before they sleep: GNU's OpenMP 300,000 rounds, which is milliseconds. Where
   another program has one of the processors, each of the thousands of waits of a step loses that long to a thread that
   cannot come. To sleep and wake takes some fifty microseconds in a virtual machine, 2,000 rounds; spinning no longer than that costs at
   most twice the best. OpenMP reads its settings before main begins, so the program starts itself again with them; what the
   user has set stays. */
static void bound_waiting(char **argv)
{
    if (getenv("OMP_WAIT_POLICY") || getenv("GOMP_SPINCOUNT") || getenv("KMP_BLOCKTIME")) return;
    if (setenv("GOMP_SPINCOUNT", "2000", 0) != 0 || setenv("KMP_BLOCKTIME", "0", 0) != 0) return;
    execv("/proc/self/exe", argv); /* where that is not to be had, it goes on as it is */
}

int main(int argc, char **argv)
{
    bound_waiting(argv);
    return shv_program(argc, argv);
}
