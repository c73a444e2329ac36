/* What a study keeps of one run: numbers of its end, masses of its pieces, facets of its cracks, and, where asked for, the way
   of its bodies. A digest is one text file; numbers are written in full (hexadecimal), so that reading gives the same bits. */
#ifndef SHV_EVALUATE_DIGEST_H
#define SHV_EVALUATE_DIGEST_H

#include "base/timer.h"
#include "evaluate/body.h"
#include "evaluate/crack_surface.h"
#include "shiver/run_file.h"

/* Of the last frame, where nothing else is said; NaN: not known. */
typedef enum ShvDigestNumber {
    SHV_DIGEST_TIME,         /* s */
    SHV_DIGEST_STEPS,        /* of fracture mode */
    SHV_DIGEST_STEP,         /* s: last one of fracture mode */
    SHV_DIGEST_COURANT,      /* largest at any frame */
    SHV_DIGEST_STABLE_STEP,  /* s: smallest of all tets */
    SHV_DIGEST_KINETIC,      /* J */
    SHV_DIGEST_STRAIN,       /* J */
    SHV_DIGEST_DISSIPATED,   /* J: by the cohesive law */
    SHV_DIGEST_BARS_GIVEN,   /* J: Σ of the rises of the bars' work from frame to frame */
    SHV_DIGEST_BARS_TAKEN,   /* J: Σ of its falls, positive */
    SHV_DIGEST_BAR_SHARE,    /* of bars in all work */
    SHV_DIGEST_RESIDUAL,     /* J: largest magnitude at any frame */
    SHV_DIGEST_LARGEST,      /* J: scale of the residual */
    SHV_DIGEST_FAILED_AREA,  /* m² */
    SHV_DIGEST_INSERTED,     /* facets */
    SHV_DIGEST_FAILED,       /* facets */
    SHV_DIGEST_FRAGMENTS,    /* alive */
    SHV_DIGEST_LARGEST_MASS, /* of one fragment, share of all */
    SHV_DIGEST_MASS,         /* kg, of all fragments */
    SHV_DIGEST_MOMENTUM_X,   /* kg m/s, of all fragments */
    SHV_DIGEST_MOMENTUM_Y,
    SHV_DIGEST_MOMENTUM_Z,
    SHV_DIGEST_IMPULSE_X, /* N s: by obstacles in fracture mode */
    SHV_DIGEST_IMPULSE_Y,
    SHV_DIGEST_IMPULSE_Z,
    SHV_DIGEST_CONTACT_TIME,  /* s */
    SHV_DIGEST_FIRST_CONTACT, /* s */
    SHV_DIGEST_AUDITED,       /* impacts that woke although the wake rule took them for harmless */
    SHV_DIGEST_MISSED,        /* those that broke something */
    SHV_DIGEST_SETUP,         /* s of run time: making the simulation */
    SHV_DIGEST_NUMBERS
} ShvDigestNumber;

typedef struct ShvDigest {
    ShvMemory *memory;
    uint64_t key;                      /* hash of all that the run follows from */
    ShvStatus status;                  /* of the run */
    char message[256], processor[128]; /* of a failure; where it ran */
    bool shared;                       /* other runs went on at the same time: run times say little */
    int32_t threads;
    double numbers[SHV_DIGEST_NUMBERS];
    double costs[SHV_COST_COUNT]; /* s, of the first repeat */
    double *seconds;              /* run time of every repeat, without set-up */
    int32_t repeats;
    double *masses; /* kg, of living fragments, ascending */
    int32_t mass_count;
    ShvCrackSurface crack;
    bool tracked;         /* the rest is filled */
    double *times;        /* s, of each frame */
    ShvBodyState *states; /* bodies of a frame one after another */
    int32_t frame_count, body_count, frame_capacity;
} ShvDigest;

typedef struct ShvDigestOrder {
    const ShvSceneDefinition *scene;
    const char *folder;
    ShvMemory *memory;
    double multiple;     /* fracture.time_step in stable steps; NaN: as the scene says */
    int32_t repeats;     /* ≥ 1 */
    double repeat_below; /* s: no further repeats once the run times add up to this; 0: all */
    int32_t audit_wakes;
    bool tracked;
    /* Checkpoints: "CHECKPOINT.checkpoint-1" and "-2", of a run with this key. NULL: none. */
    const char *checkpoint;
    uint64_t key;
    bool (*stop)(void *data);
    void *stop_data;
} ShvDigestOrder;

/* Runs the scene and keeps what a digest holds. A run that fails by its own fault is a digest with that status; returned are
   SHV_INTERRUPTED and SHV_NO_MEMORY. The caller releases the digest in every case. */
ShvStatus shv_digest_run(ShvDigest *digest, const ShvDigestOrder *order, ShvError *error);
/* Of a run file: what it does not hold is NaN. */
ShvStatus shv_digest_of_run_file(ShvDigest *digest, const char *path, ShvMemory *memory, ShvError *error);
void shv_digest_release(ShvDigest *digest);

/* Writes whole or not at all. */
ShvStatus shv_digest_save(const ShvDigest *digest, const char *path, ShvError *error);
/* SHV_FILE_ERROR where there is no file, SHV_BAD_INPUT for one that is not whole. */
ShvStatus shv_digest_load(ShvDigest *digest, const char *path, ShvMemory *memory, ShvError *error);

/* Median of the run times; NaN without any. */
double shv_digest_seconds(const ShvDigest *digest);
/* Median of `count` numbers, those that are not finite left out; sorts them. NaN of none. */
double shv_median(double *values, int32_t count);

/* Ascending. */
void shv_sort_numbers(double *values, int32_t count);

/* digest_checkpoint.c: a run under way, and what is known of it so far. */
typedef struct ShvDigestPull {
    const ShvDigestOrder *order;
    ShvDigest *digest;
    ShvSimulation *simulation; /* NULL: nothing to save yet */
    double seconds, bars;      /* s, of all frames so far; J: work of bars at the last one */
    double begun, due;         /* s: shv_now as the advance under way began; of the next checkpoint */
    uint64_t sequence;         /* of the last one */
} ShvDigestPull;
/* ShvSimulationOptions.stop, of a pull: saves it when it is time to or the run stops. */
bool shv_digest_ask(void *pull);
/* Loads the latest checkpoint into a simulation of which the first frame has been asked for; false: there is none. After a failure
   the simulation can only be destroyed. */
ShvStatus shv_digest_go_on(ShvDigestPull *pull, const ShvBodies *bodies, bool *goes_on, ShvError *error);

/* Adds the present frame's bodies to the track. */
ShvStatus shv_digest_track(ShvDigest *digest, const ShvBodies *bodies, const ShvFrameView *frame, ShvError *error);
/* Room for so many frames of so many bodies. */
ShvStatus shv_digest_reserve(ShvDigest *digest, size_t room, size_t bodies, ShvError *error);

#endif
