/* A run of the fake simulation, recorded. */
#ifndef SHV_TESTS_EXPORT_RUN_H
#define SHV_TESTS_EXPORT_RUN_H

#include "check.h"
#include "fake_simulation.h"
#include "record/record.h"

static const FakeSetup BREAKING = {.bricks = 4, .split_every = 2, .most = 7, .splits = 1};

static inline void record_setup(const ShvRecordDefinition *definition, const FakeSetup *setup, int frames)
{
    ShvError error;
    ShvRecord *record;
    ShvSimulation *simulation = fake_create(setup);
    check_ok(shv_record_create(&record, definition, simulation, &error), error);
    for (int i = 0; i < frames; i++) {
        fake_advance(simulation);
        check_ok(shv_record_frame(record, simulation, &error), error);
    }
    check_ok(shv_record_close(record, SHV_OK, "", &error), error);
    fake_destroy(simulation);
}

static inline void record_frames(const ShvRecordDefinition *definition, int frames)
{
    record_setup(definition, &BREAKING, frames);
}

#endif
