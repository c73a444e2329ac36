/* Counted allocation. Every block belongs to a part of the program, so that a plan can promise, and a
   test can check, how many bytes each part takes; a limit makes allocations fail on purpose. */
#ifndef SHV_BASE_MEMORY_H
#define SHV_BASE_MEMORY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shiver/status.h"

typedef enum ShvPart {
    SHV_PART_GENERAL,
    SHV_PART_MESH,      /* reference mesh */
    SHV_PART_ADJACENCY, /* facets and node corners: only where something can break */
    SHV_PART_STATE,     /* nodal and element state of the solver */
    SHV_PART_STRESS,    /* nodal stress of the insertion criterion */
    SHV_PART_COHESIVE,  /* cohesive facets and their history */
    SHV_PART_BARS,      /* position based bars */
    SHV_PART_SHAPE,     /* obstacles */
    SHV_PART_CONTACT,   /* candidates of contact */
    SHV_PART_RIGID,     /* fragments in flight, convex pieces */
    SHV_PART_RECORD,    /* buffers of the run file */
    SHV_PART_SCENE,     /* parsed scenes */
    SHV_PART_COUNT
} ShvPart;

typedef struct ShvMemory ShvMemory;

/* A new counter, or NULL. A NULL ShvMemory is accepted everywhere and counts nothing. */
ShvMemory *shv_memory_create(void);
/* Releases the counter; blocks that are still alive must have been released before. */
void shv_memory_destroy(ShvMemory *memory);
/* Lets the next `count` allocations succeed and every later one fail (tests); negative: no limit. */
void shv_memory_fail_after(ShvMemory *memory, int64_t count);
/* Allocations asked for so far, and bytes now held by a part (SHV_PART_COUNT: by all). */
int64_t shv_memory_requests(const ShvMemory *memory);
size_t shv_memory_bytes(const ShvMemory *memory, ShvPart part);
size_t shv_memory_peak_bytes(const ShvMemory *memory, ShvPart part);
/* "adjacency", "state", … for reports. */
const char *shv_part_name(ShvPart part);

/* `count` zeroed elements of `size` bytes, aligned to 64 bytes; NULL when memory is out or the product
   overflows. A zero count gives a valid block. Thread-safe. */
void *shv_allocate(ShvMemory *memory, ShvPart part, size_t count, size_t size);
/* Grows or shrinks to `count` elements; new bytes are zero; on NULL the old block is untouched.
   `block` may be NULL. */
void *shv_reallocate(ShvMemory *memory, ShvPart part, void *block, size_t count, size_t size);
/* Releases a block of shv_allocate; NULL is accepted. */
void shv_release(void *block);
/* Of a block of shv_allocate: its bytes, and what it was counted for. */
size_t shv_block_bytes(const void *block);
ShvPart shv_block_part(const void *block);
/* A copy of a terminated string, or NULL. */
char *shv_copy_text(ShvMemory *memory, ShvPart part, const char *text);

/* Whether a request of ordinary size of this thread has failed since it last asked: for where a library between does not say why it
   failed. */
bool shv_memory_missed(void);

/* shv_fail with SHV_NO_MEMORY and one wording for all: "out of memory for <what> (<bytes> bytes)". */
ShvStatus shv_fail_memory(ShvError *error, const char *what, size_t bytes);

/* Returns from the calling function when `expression` is not SHV_OK. */
#define SHV_TRY(expression)                                                                                            \
    do {                                                                                                               \
        const ShvStatus shv_try_ = (expression);                                                                       \
        if (shv_try_ != SHV_OK) return shv_try_;                                                                       \
    } while (0)

/* Gives a block `count` elements of its type, as shv_reallocate does; out of memory returns shv_fail_memory(error, what, bytes)
   from the calling function. */
#define SHV_RESIZE(memory, part, block, count, what, bytes, error)                                                     \
    do {                                                                                                               \
        void *shv_resized_ = shv_reallocate((memory), (part), (block), (count), sizeof *(block));                      \
        if (!shv_resized_) return shv_fail_memory((error), (what), (bytes));                                           \
        (block) = shv_resized_;                                                                                        \
    } while (0)

/* Room for `wanted` elements in a block that has room for `capacity`, with some to spare; new ones are zero. Out of memory, or of what
   indices can number, it returns the status from the calling function. */
ShvStatus shv_reserve(ShvMemory *memory, ShvPart part, void **block, int32_t *capacity, int64_t wanted, size_t size,
                      const char *what, ShvError *error);
#define SHV_RESERVE(memory, part, block, capacity, wanted, what, error)                                                \
    do {                                                                                                               \
        void *shv_reserved_ = (block);                                                                                 \
        SHV_TRY(                                                                                                       \
            shv_reserve((memory), (part), &shv_reserved_, &(capacity), (wanted), sizeof *(block), (what), (error)));   \
        (block) = shv_reserved_;                                                                                       \
    } while (0)
/* One more than `count`. */
#define SHV_GROW(memory, part, block, capacity, count, what, error)                                                    \
    SHV_RESERVE((memory), (part), (block), (capacity), (int64_t)(count) + 1, (what), (error))

#endif
