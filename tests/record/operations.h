/* Stands before the C library's calls that change files, so that a test can count, refuse, tear or note each of them. */
#ifndef SHV_TESTS_OPERATIONS_H
#define SHV_TESTS_OPERATIONS_H

#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

typedef enum OperationKind {
    OPERATION_WRITE,
    OPERATION_RESIZE, /* also posix_fallocate, which only lets a file grow */
    OPERATION_SYNC,
    OPERATION_NAME, /* link or rename: `path` gets the file */
    OPERATION_UNLINK
} OperationKind;

typedef struct Operation {
    OperationKind kind;
    uint64_t file; /* number of the file or folder (its inode) */
    const void *data;
    size_t size;     /* bytes that are written */
    uint64_t offset; /* where; or the new size of the file */
    const char *path, *from;
} Operation;

/* Called before each; what it returns is the errno with which the operation fails, 0: it is done. NULL: all are done. It may
   write less than was asked for by lowering *size, and end the process. */
typedef int (*OperationHook)(const Operation *operation, size_t *size);
void operations_hook(OperationHook hook);

#endif
