/* The table of shots of one task: a line each, on the disk before the next one begins. */
#ifndef SHV_SURVIVE_SHOTS_H
#define SHV_SURVIVE_SHOTS_H

#include <stdio.h>

#include "base/memory.h"
#include "shiver/survive.h"

typedef struct ShvShots {
    ShvMemory *memory;
    ShvShot *items;
    int32_t count, capacity;
} ShvShots;

void shv_shots_release(ShvShots *shots);
ShvStatus shv_shots_add(ShvShots *shots, const ShvShot *shot, ShvError *error);

/* Adds the shots of a table; of a last line that was not written whole nothing is taken. `whole` (may be NULL): bytes of all that is.
   SHV_FILE_ERROR when there is no such file, SHV_BAD_INPUT for one with another key or that is no table. */
ShvStatus shv_shots_read(ShvShots *shots, const char *path, uint64_t key, size_t *whole, ShvError *error);

/* A table that is being written; nobody else may write it meanwhile. */
typedef struct ShvShotTable {
    FILE *stream;
    const char *path; /* the caller's */
} ShvShotTable;
/* Reads what is there, unless `anew`, and goes on behind it. */
ShvStatus shv_shot_table_open(ShvShotTable *table, ShvShots *shots, const char *path, uint64_t key, bool anew,
                              ShvError *error);
ShvStatus shv_shot_table_append(ShvShotTable *table, const ShvShot *shot, ShvError *error);
void shv_shot_table_close(ShvShotTable *table);

/* The names of the columns, and a line, each with its line break. */
void shv_shot_put_heads(FILE *stream);
void shv_shot_put(FILE *stream, const ShvShot *shot);

#endif
