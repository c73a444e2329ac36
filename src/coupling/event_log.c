#include "coupling/hybrid.h"

ShvStatus shv_hybrid_log(ShvHybrid *hybrid, const ShvEventView *event, ShvError *error)
{
    ShvEventLog *log = &hybrid->log;
    if (log->count == log->capacity) {
        const int32_t capacity = log->capacity ? 2 * log->capacity : 64;
        ShvEventView *items =
            shv_reallocate(hybrid->memory, SHV_PART_RECORD, log->items, (size_t)capacity, sizeof(ShvEventView));
        if (!items) return shv_fail_memory(error, "the event log", (size_t)capacity * sizeof(ShvEventView));
        log->items = items;
        log->capacity = capacity;
    }
    log->items[log->count++] = *event;
    return SHV_OK;
}
