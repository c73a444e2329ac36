#include "scene/pool.h"

#include <string.h>

enum { FIRST_BLOCK = 4096, LARGEST_BLOCK = 1 << 20, ALIGNMENT = 16, HEAD = 32 };

struct ShvPoolBlock {
    struct ShvPoolBlock *next;
    size_t used, size;
};
_Static_assert(sizeof(struct ShvPoolBlock) <= HEAD, "the head of a block leaves its content aligned");

/* Blocks double, so that a large scene takes few of them. */
static struct ShvPoolBlock *add_block(ShvPool *pool, size_t wanted)
{
    size_t size = pool->blocks ? 2 * (pool->blocks->size + HEAD) - HEAD : FIRST_BLOCK - HEAD;
    if (size > LARGEST_BLOCK - HEAD) size = LARGEST_BLOCK - HEAD;
    if (size < wanted) size = wanted;
    struct ShvPoolBlock *block = shv_allocate(pool->memory, SHV_PART_SCENE, size + HEAD, 1);
    if (!block) {
        pool->failed = true;
        return NULL;
    }
    block->size = size;
    block->next = pool->blocks;
    pool->blocks = block;
    return block;
}

void *shv_pool_take(ShvPool *pool, size_t count, size_t size)
{
    if (size > 0 && count > (SIZE_MAX - 2 * HEAD) / size) {
        pool->failed = true;
        return NULL;
    }
    const size_t bytes = (count * size + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    struct ShvPoolBlock *block = pool->blocks;
    if (!block || block->size - block->used < bytes) block = add_block(pool, bytes);
    if (!block) return NULL;
    void *taken = (char *)block + HEAD + block->used;
    block->used += bytes;
    return taken;
}

char *shv_pool_text(ShvPool *pool, const char *text, size_t length)
{
    char *copy = shv_pool_take(pool, length + 1, 1);
    if (copy && length > 0) memcpy(copy, text, length);
    return copy;
}

void shv_pool_release(ShvPool *pool)
{
    while (pool->blocks) {
        struct ShvPoolBlock *next = pool->blocks->next;
        shv_release(pool->blocks);
        pool->blocks = next;
    }
}
