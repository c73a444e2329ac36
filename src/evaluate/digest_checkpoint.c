/* Checkpoints of a study's run: the state of its simulation, and as a note what the digest has gathered. */
#include <string.h>

#include "base/timer.h"
#include "evaluate/digest.h"
#include "record/checkpoint.h"

/* In front of the times and states of all frames, one after another. */
typedef struct Gathered {
    double seconds, bars, numbers[SHV_DIGEST_NUMBERS];
    int32_t frame_count, body_count;
} Gathered;

/* s of run time from one to the next, and the share of that which goes there at most: one part in so many. */
static const double INTERVAL = 30.0, SHARE = 100.0;

static ShvCheckpointMark mark_of(const ShvDigestPull *pull)
{
    return (ShvCheckpointMark){.program = shv_checkpoint_program(),
                               .scene = pull->order->key,
                               .geometry = shv_simulation_geometry_hash(pull->simulation),
                               .sequence = pull->sequence};
}

/* ---- saving ---- */

static unsigned char *put(unsigned char *at, const void *data, size_t size)
{
    if (size > 0) memcpy(at, data, size);
    return at + size;
}

static ShvStatus save(ShvDigestPull *pull, ShvError *error)
{
    const ShvDigest *digest = pull->digest;
    Gathered gathered = {.seconds = pull->seconds + shv_now() - pull->begun,
                         .bars = pull->bars,
                         .frame_count = digest->frame_count,
                         .body_count = digest->body_count};
    memcpy(gathered.numbers, digest->numbers, sizeof gathered.numbers);
    const size_t times = (size_t)digest->frame_count * sizeof *digest->times;
    const size_t states = (size_t)digest->frame_count * (size_t)digest->body_count * sizeof *digest->states;
    const size_t size = sizeof gathered + times + states;
    unsigned char *note = shv_allocate(pull->order->memory, SHV_PART_RECORD, size, 1);
    if (!note) return shv_fail_memory(error, "a checkpoint", size);
    put(put(put(note, &gathered, sizeof gathered), digest->times, times), digest->states, states);
    ShvCheckpointMark mark = mark_of(pull);
    mark.sequence = ++pull->sequence;
    const ShvStatus status =
        shv_checkpoint_write(pull->order->checkpoint, pull->order->memory, pull->simulation, &mark, note, size, error);
    shv_release(note);
    return status;
}

bool shv_digest_ask(void *data)
{
    ShvDigestPull *pull = data;
    const ShvDigestOrder *order = pull->order;
    const bool stops = order->stop && order->stop(order->stop_data);
    if (!order->checkpoint || !pull->simulation || !shv_simulation_has_checkpoints(pull->simulation)) return stops;
    const double start = shv_now();
    if (pull->due == 0.0) pull->due = start + INTERVAL;
    if (!stops && start < pull->due) return false;
    ShvError ignored; /* the run is then begun anew, if it comes to that */
    (void)save(pull, &ignored);
    const double end = shv_now();
    pull->due = end + fmax(INTERVAL, SHARE * (end - start));
    return stops;
}

/* ---- going on ---- */

static bool fits(void *data, const ShvCheckpointMark *mark)
{
    (void)data, (void)mark;
    return true;
}

static ShvStatus take_note(ShvDigestPull *pull, const ShvCheckpoint *found, int32_t bodies, bool *good, ShvError *error)
{
    Gathered gathered;
    ShvDigest *digest = pull->digest;
    *good = found->note_size >= sizeof gathered;
    if (!*good) return SHV_OK;
    memcpy(&gathered, found->note, sizeof gathered);
    const size_t times = (size_t)gathered.frame_count * sizeof *digest->times;
    const size_t states = (size_t)gathered.frame_count * (size_t)gathered.body_count * sizeof *digest->states;
    *good = gathered.body_count == bodies && found->note_size == sizeof gathered + times + states;
    if (!*good) return SHV_OK;
    if (gathered.frame_count > 0)
        SHV_TRY(shv_digest_reserve(digest, (size_t)gathered.frame_count, (size_t)bodies, error));
    if (times > 0) memcpy(digest->times, found->note + sizeof gathered, times);
    if (states > 0) memcpy(digest->states, found->note + sizeof gathered + times, states);
    memcpy(digest->numbers, gathered.numbers, sizeof gathered.numbers);
    digest->frame_count = gathered.frame_count;
    pull->seconds = gathered.seconds;
    pull->bars = gathered.bars;
    return SHV_OK;
}

static ShvStatus take(ShvDigestPull *pull, const ShvCheckpoint *found, const ShvBodies *bodies, bool *goes_on,
                      ShvError *error)
{
    SHV_TRY(take_note(pull, found, pull->order->tracked ? bodies->count : 0, goes_on, error));
    if (!*goes_on) return SHV_OK;
    pull->sequence = found->mark.sequence;
    return shv_simulation_load(pull->simulation, found->descriptor, found->size, error);
}

ShvStatus shv_digest_go_on(ShvDigestPull *pull, const ShvBodies *bodies, bool *goes_on, ShvError *error)
{
    *goes_on = false;
    const ShvDigestOrder *order = pull->order;
    if (!order->checkpoint || !shv_simulation_has_checkpoints(pull->simulation)) return SHV_OK;
    ShvCheckpoint found;
    ShvError ignored;
    const ShvCheckpointMark own = mark_of(pull);
    ShvStatus status = shv_checkpoint_find(&found, order->checkpoint, order->memory, &own, fits, NULL, &ignored);
    if (status == SHV_OK && found.descriptor >= 0) status = take(pull, &found, bodies, goes_on, error);
    shv_checkpoint_close(&found);
    return *goes_on ? status : SHV_OK; /* what does not fit is as good as none */
}
