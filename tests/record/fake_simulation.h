/* A simulation that computes nothing: a row of two-tet bricks thrown into the air. After every `split_every` frames the first
   living fragment of more than one brick breaks in two. Positions are ballistic, rotations are about a fixed axis. It stands
   in for the simulation in the tests of the run file, so that every number that should be in the file is known. */
#ifndef SHV_TESTS_FAKE_SIMULATION_H
#define SHV_TESTS_FAKE_SIMULATION_H

#include "shiver/simulation.h"

typedef struct FakeSetup {
    int32_t bricks;
    int32_t split_every;          /* frames; 0: never */
    int32_t most;                 /* fragments that ever live */
    int32_t splits;               /* at a time */
    int32_t probes;               /* at most 2; frame n has n rows of samples */
    double sync_interval;         /* s, of the record */
    const ShvNodesWithin *within; /* NULL: all nodes */
} FakeSetup;

ShvSimulation *fake_create(const FakeSetup *setup);
void fake_destroy(ShvSimulation *simulation);
/* Goes on to the next frame; the first call gives the frame of time 0. */
void fake_advance(ShvSimulation *simulation);

#endif
