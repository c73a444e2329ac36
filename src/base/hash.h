/* 64-bit FNV-1a (Fowler, Noll, Vo) of bytes: tells two scenes or two states apart, and pins a state in a test. It
   is no protection against intent. The bytes of numbers are hashed as they lie in memory. */
#ifndef SHV_BASE_HASH_H
#define SHV_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

#define SHV_HASH_START UINT64_C(0xcbf29ce484222325)

/* Goes on from `hash` (SHV_HASH_START at first) over `size` bytes; data may be NULL when size is 0. */
uint64_t shv_hash_bytes(uint64_t hash, const void *data, size_t size);
/* A text with its terminator, so that "ab", "c" differs from "a", "bc"; NULL differs from "". */
uint64_t shv_hash_text(uint64_t hash, const char *text);

#endif
