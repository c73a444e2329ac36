/* A temporary folder for what is made for another program. It goes with this process, and so do the programs that have joined it,
   whatever ends the process: a child of its own, the keeper, waits for that. */
#ifndef SHV_BASE_TEMPORARY_H
#define SHV_BASE_TEMPORARY_H

#include <sys/types.h>

#include "base/memory.h"

enum { SHV_TEMPORARY_PATH = 4096 };

typedef struct ShvTemporary {
    char folder[SHV_TEMPORARY_PATH];
    pid_t keeper; /* 0: there is none */
    int line;     /* to the keeper */
} ShvTemporary;

/* Makes the folder, in $TMPDIR where that is an absolute path, else in /tmp. `file` (may be NULL): is removed with it, should it be
   there still. */
ShvStatus shv_temporary_open(ShvTemporary *temporary, const char *file, ShvError *error);
/* In a child that will become another program: makes it the first of a process group that ends with this process. The
   folder becomes its $TMPDIR. */
void shv_temporary_join(const ShvTemporary *temporary);
/* Ends the group of a child that has been waited for: its helpers, too, are gone when this returns (or after two seconds). */
void shv_temporary_end(const ShvTemporary *temporary, pid_t child);
/* Removes the folder and all that is in it. Nothing happens where none was opened. */
void shv_temporary_close(ShvTemporary *temporary);

#endif
