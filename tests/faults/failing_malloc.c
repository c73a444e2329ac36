/* Loaded before the C library: allocation number SHIVER_FAIL_FROM fails, and with SHIVER_FAIL_ALL every later one; with SHIVER_FAIL_IN
   in the program of that name alone, not in those that it starts. SHIVER_FAIL_COUNT tells at the end how many there were. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static atomic_long count;
static long from = -1;
static bool all, started;
static void *(*own_malloc)(size_t), *(*own_calloc)(size_t, size_t), *(*own_realloc)(void *, size_t);
static int (*own_memalign)(void **, size_t, size_t);

/* What dlsym asks for while the functions are looked for; nothing of it comes back. */
static _Alignas(16) unsigned char first[65536];
static size_t first_used;

static void *take_first(size_t size)
{
    void *block = first + first_used;
    first_used += (size + 15) / 16 * 16;
    return first_used <= sizeof first ? block : NULL;
}

static bool start(void)
{
    static bool within;
    if (started) return true;
    if (within) return false;
    within = true;
    *(void **)(void *)&own_malloc = dlsym(RTLD_NEXT, "malloc");
    *(void **)(void *)&own_calloc = dlsym(RTLD_NEXT, "calloc");
    *(void **)(void *)&own_realloc = dlsym(RTLD_NEXT, "realloc");
    *(void **)(void *)&own_memalign = dlsym(RTLD_NEXT, "posix_memalign");
    const char *number = getenv("SHIVER_FAIL_FROM"), *name = getenv("SHIVER_FAIL_IN");
    if (number && (!name || strcmp(name, program_invocation_short_name) == 0)) from = atol(number);
    all = getenv("SHIVER_FAIL_ALL") != NULL;
    return started = true;
}

static bool fails(void)
{
    const long number = atomic_fetch_add(&count, 1);
    if (from < 0 || !(number == from || (all && number > from))) return false;
    errno = ENOMEM;
    return true;
}

void *malloc(size_t size)
{
    if (!start()) return take_first(size);
    return fails() ? NULL : own_malloc(size);
}

void *calloc(size_t number, size_t size)
{
    if (!start()) return take_first(number * size);
    return fails() ? NULL : own_calloc(number, size);
}

void *realloc(void *block, size_t size)
{
    if (!start()) return NULL;
    return fails() ? NULL : own_realloc(block, size);
}

int posix_memalign(void **block, size_t alignment, size_t size)
{
    if (!start() || fails()) return ENOMEM;
    return own_memalign(block, alignment, size);
}

__attribute__((destructor)) static void tell(void)
{
    if (getenv("SHIVER_FAIL_COUNT")) fprintf(stderr, "failing_malloc: %ld\n", atomic_load(&count));
}
