/* Memory of a scene: many small blocks that are all released together. A failure sticks, so that a long reading need not
   carry a status through every function: takers leave quietly on NULL and the one who began asks `failed` at the end. */
#ifndef SHV_SCENE_POOL_H
#define SHV_SCENE_POOL_H

#include <stdbool.h>

#include "base/memory.h"

typedef struct ShvPool {
    ShvMemory *memory;
    struct ShvPoolBlock *blocks;
    bool failed;
} ShvPool;

/* `count` zeroed elements of `size` bytes, aligned to 16 bytes, or NULL. */
void *shv_pool_take(ShvPool *pool, size_t count, size_t size);
/* A terminated copy of `length` bytes, or NULL. */
char *shv_pool_text(ShvPool *pool, const char *text, size_t length);
void shv_pool_release(ShvPool *pool);

#endif
