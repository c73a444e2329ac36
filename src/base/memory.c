#define _DEFAULT_SOURCE /* madvise */
#include "base/memory.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* Counters of the parts, and one more for their sum. */
struct ShvMemory {
    atomic_size_t bytes[SHV_PART_COUNT + 1];
    atomic_size_t peak[SHV_PART_COUNT + 1];
    atomic_int_fast64_t requests;
    atomic_int_fast64_t fail_from; /* the first request number that fails */
};

/* Stands in front of every block, so that a release needs no size. */
typedef struct Header {
    ShvMemory *owner;
    size_t bytes;
    ShvPart part;
} Header;

/* A cache line and the widest vector register. The header takes one such unit, the block follows aligned. */
enum { ALIGNMENT = 64 };
_Static_assert(sizeof(Header) <= ALIGNMENT, "the header must fit in front of an aligned block");

static Header *header_of(const void *block)
{
    return (Header *)((uintptr_t)block - ALIGNMENT);
}

size_t shv_block_bytes(const void *block)
{
    return header_of(block)->bytes;
}

ShvPart shv_block_part(const void *block)
{
    return header_of(block)->part;
}

ShvMemory *shv_memory_create(void)
{
    ShvMemory *memory = malloc(sizeof *memory);
    if (!memory) return NULL;
    for (int i = 0; i <= SHV_PART_COUNT; i++) {
        atomic_init(&memory->bytes[i], 0);
        atomic_init(&memory->peak[i], 0);
    }
    atomic_init(&memory->requests, 0);
    atomic_init(&memory->fail_from, INT64_MAX);
    return memory;
}

void shv_memory_destroy(ShvMemory *memory)
{
    free(memory);
}

void shv_memory_fail_after(ShvMemory *memory, int64_t count)
{
    if (!memory) return;
    atomic_store(&memory->fail_from, count < 0 ? INT64_MAX : atomic_load(&memory->requests) + count);
}

int64_t shv_memory_requests(const ShvMemory *memory)
{
    return memory ? atomic_load(&memory->requests) : 0;
}

size_t shv_memory_bytes(const ShvMemory *memory, ShvPart part)
{
    return memory ? atomic_load(&memory->bytes[part]) : 0;
}

size_t shv_memory_peak_bytes(const ShvMemory *memory, ShvPart part)
{
    return memory ? atomic_load(&memory->peak[part]) : 0;
}

const char *shv_part_name(ShvPart part)
{
    switch (part) {
    case SHV_PART_GENERAL:
        return "general";
    case SHV_PART_MESH:
        return "mesh";
    case SHV_PART_ADJACENCY:
        return "adjacency";
    case SHV_PART_STATE:
        return "state";
    case SHV_PART_STRESS:
        return "stress";
    case SHV_PART_COHESIVE:
        return "cohesive";
    case SHV_PART_BARS:
        return "bars";
    case SHV_PART_SHAPE:
        return "shape";
    case SHV_PART_CONTACT:
        return "contact";
    case SHV_PART_RIGID:
        return "rigid";
    case SHV_PART_RECORD:
        return "record";
    case SHV_PART_SCENE:
        return "scene";
    case SHV_PART_COUNT:
        return "total";
    }
    return "unknown part";
}

static void count_in(ShvMemory *memory, int slot, size_t bytes)
{
    const size_t now = atomic_fetch_add(&memory->bytes[slot], bytes) + bytes;
    size_t peak = atomic_load(&memory->peak[slot]);
    while (now > peak && !atomic_compare_exchange_weak(&memory->peak[slot], &peak, now)) {
    }
}

/* Whether this request may be served; counts it either way. */
static int admit(ShvMemory *memory)
{
    if (!memory) return 1;
    return atomic_fetch_add(&memory->requests, 1) < atomic_load(&memory->fail_from);
}

static _Thread_local bool missed;

bool shv_memory_missed(void)
{
    const bool now = missed;
    missed = false;
    return now;
}

/* Requests that are larger may come from a number of a damaged file. */
static const size_t ORDINARY = (size_t)256 << 20;

static void *miss(size_t bytes)
{
    missed |= bytes <= ORDINARY;
    return NULL;
}

/* Large pages where the system has them: what is read from all over a large block otherwise waits for addresses to be looked up. */
enum { PAGE = 2 << 20 };

static void ask_for_pages(void *start, size_t bytes)
{
#ifdef MADV_HUGEPAGE
    if (bytes >= PAGE) madvise(start, bytes / PAGE * PAGE, MADV_HUGEPAGE);
#else
    (void)start;
    (void)bytes;
#endif
}

/* An aligned block whose bytes are not yet set. */
static void *take(ShvMemory *memory, ShvPart part, size_t count, size_t size)
{
    const bool admitted = admit(memory) != 0;
    if (size != 0 && count > ((size_t)PTRDIFF_MAX - ALIGNMENT) / size) return NULL;
    const size_t bytes = count * size;
    void *start = NULL;
    if (!admitted || posix_memalign(&start, bytes < PAGE ? ALIGNMENT : PAGE, ALIGNMENT + bytes) != 0)
        return miss(bytes);
    ask_for_pages(start, bytes);
    *(Header *)start = (Header){memory, bytes, part};
    if (memory) {
        count_in(memory, (int)part, bytes);
        count_in(memory, SHV_PART_COUNT, bytes);
    }
    return (char *)start + ALIGNMENT;
}

void *shv_allocate(ShvMemory *memory, ShvPart part, size_t count, size_t size)
{
    void *block = take(memory, part, count, size);
    if (block) memset(block, 0, count * size);
    return block;
}

void *shv_reallocate(ShvMemory *memory, ShvPart part, void *block, size_t count, size_t size)
{
    if (!block) return shv_allocate(memory, part, count, size);
    char *moved = take(memory, part, count, size);
    if (!moved) return NULL;
    const size_t bytes = count * size, old = header_of(block)->bytes;
    const size_t kept = old < bytes ? old : bytes;
    memcpy(moved, block, kept);
    memset(moved + kept, 0, bytes - kept);
    shv_release(block);
    return moved;
}

void shv_release(void *block)
{
    if (!block) return;
    Header *header = header_of(block);
    if (header->owner) {
        atomic_fetch_sub(&header->owner->bytes[header->part], header->bytes);
        atomic_fetch_sub(&header->owner->bytes[SHV_PART_COUNT], header->bytes);
    }
    free(header);
}

char *shv_copy_text(ShvMemory *memory, ShvPart part, const char *text)
{
    const size_t bytes = strlen(text) + 1;
    char *copy = take(memory, part, bytes, 1);
    if (copy) memcpy(copy, text, bytes);
    return copy;
}

ShvStatus shv_fail_memory(ShvError *error, const char *what, size_t bytes)
{
    return shv_fail(error, SHV_NO_MEMORY, "out of memory for %s (%zu bytes)", what, bytes);
}

ShvStatus shv_reserve(ShvMemory *memory, ShvPart part, void **block, int32_t *capacity, int64_t wanted, size_t size,
                      const char *what, ShvError *error)
{
    if (wanted <= *capacity) return SHV_OK;
    if (wanted > INT32_MAX) return shv_fail(error, SHV_UNSUPPORTED, "too many %s: more than %d", what, INT32_MAX);
    const int64_t more = wanted + wanted / 2 + 16, larger = more < INT32_MAX ? more : INT32_MAX;
    void *grown = shv_reallocate(memory, part, *block, (size_t)larger, size);
    if (!grown) return shv_fail_memory(error, what, (size_t)larger * size);
    *block = grown;
    *capacity = (int32_t)larger;
    return SHV_OK;
}
