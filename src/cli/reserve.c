#define _GNU_SOURCE /* RTLD_NEXT */
#include "cli/reserve.h"

#ifdef SHIVER_SANITIZED

/* Sanitizers have an allocator of their own. */
bool shv_reserve_used(void)
{
    return false;
}

#else

#include <dlfcn.h>
#include <errno.h>
#include <malloc.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* Bytes: several times what HDF5 and Bullet were seen to ask for between two frames of 200,000 tets. UNIT: aligned for any type;
   in front of a block it holds the block's size. */
enum { RESERVE = 64 << 20, UNIT = 16 };

static _Alignas(UNIT) unsigned char reserve[RESERVE];
static atomic_size_t taken;
static atomic_bool used;

typedef enum Search { SEARCH_DUE, SEARCH_RUNS, SEARCH_DONE } Search;
static Search search = SEARCH_DUE;
static void *(*next_malloc)(size_t);
static void *(*next_calloc)(size_t, size_t);
static void *(*next_realloc)(void *, size_t);
static void (*next_free)(void *);

bool shv_reserve_used(void)
{
    return atomic_load(&used);
}

/* The functions that come after ours. Looking for them may allocate: that is served from the reserve. The first call comes before
   there is a second thread. */
static bool found_next(void)
{
    if (search == SEARCH_DUE) {
        search = SEARCH_RUNS;
        *(void **)(void *)&next_malloc = dlsym(RTLD_NEXT, "malloc");
        *(void **)(void *)&next_calloc = dlsym(RTLD_NEXT, "calloc");
        *(void **)(void *)&next_realloc = dlsym(RTLD_NEXT, "realloc");
        *(void **)(void *)&next_free = dlsym(RTLD_NEXT, "free");
        search = SEARCH_DONE;
    }
    return search == SEARCH_DONE;
}

/* Zeroed: no byte is given twice. */
static void *take(size_t size)
{
    if (size > RESERVE - UNIT) return NULL;
    const size_t bytes = (size + 2 * UNIT - 1) / UNIT * UNIT, begin = atomic_fetch_add(&taken, bytes);
    if (begin > RESERVE - bytes) {
        atomic_fetch_sub(&taken, bytes);
        errno = ENOMEM;
        return NULL;
    }
    memcpy(reserve + begin, &size, sizeof size);
    return reserve + begin + UNIT;
}

static void *take_in_need(size_t size)
{
    atomic_store(&used, true);
    return take(size);
}

static bool is_of_reserve(const void *block)
{
    return (uintptr_t)block - (uintptr_t)reserve < RESERVE;
}

void *malloc(size_t size)
{
    if (!found_next()) return take(size);
    void *block = next_malloc(size);
    return block ? block : take_in_need(size);
}

void *calloc(size_t count, size_t size)
{
    if (size != 0 && count > SIZE_MAX / size) return NULL;
    if (!found_next()) return take(count * size);
    void *block = next_calloc(count, size);
    return block ? block : take_in_need(count * size);
}

static size_t size_of(void *block)
{
    size_t size;
    if (!is_of_reserve(block)) return malloc_usable_size(block);
    memcpy(&size, (unsigned char *)block - UNIT, sizeof size);
    return size;
}

void *realloc(void *block, size_t size)
{
    if (!block) return malloc(size);
    void *moved = is_of_reserve(block) ? NULL : next_realloc(block, size);
    if (moved || size == 0) return moved;
    const size_t old = size_of(block);
    moved = is_of_reserve(block) ? malloc(size) : take_in_need(size);
    if (!moved) return NULL;
    memcpy(moved, block, old < size ? old : size);
    free(block);
    return moved;
}

void free(void *block)
{
    if (block && !is_of_reserve(block)) next_free(block);
}

#endif
