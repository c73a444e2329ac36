/* Fuzzers: each hands what libFuzzer makes up to one reader of the program, which must end in SHV_OK or in a message. */
#ifndef SHV_TESTS_FUZZ_H
#define SHV_TESTS_FUZZ_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "shiver/status.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A name of this process's own with an ending, in memory where there is such a folder. */
static inline const char *fuzz_path(const char *ending)
{
    static char path[8][64];
    static int next;
    const char *folder = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : "/tmp";
    char *made = path[next++ % 8];
    snprintf(made, sizeof path[0], "%s/shiver-fuzz-%ld%s", folder, (long)getpid(), ending);
    return made;
}

static inline void fuzz_write(const char *path, const void *data, size_t size)
{
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file) != 0) abort();
}

/* A failure says why. */
static inline void fuzz_judge(ShvStatus status, const ShvError *error)
{
    if (status != SHV_OK && error->message[0] == '\0') abort();
}

#endif
