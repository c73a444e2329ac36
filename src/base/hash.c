#include "base/hash.h"

#include <string.h>

uint64_t shv_hash_bytes(uint64_t hash, const void *data, size_t size)
{
    const unsigned char *bytes = data;
    for (size_t i = 0; i < size; i++) hash = (hash ^ bytes[i]) * UINT64_C(0x100000001b3);
    return hash;
}

uint64_t shv_hash_text(uint64_t hash, const char *text)
{
    /* A byte that no UTF-8 text contains. */
    static const unsigned char absent = 0xff;
    return text ? shv_hash_bytes(hash, text, strlen(text) + 1) : shv_hash_bytes(hash, &absent, 1);
}
