#include "mesh/hilbert.h"

uint64_t shv_hilbert_place(uint32_t x[3])
{
    for (uint32_t bit = 1u << (SHV_HILBERT_BITS - 1); bit > 1; bit >>= 1)
        for (int i = 0; i < 3; i++) {
            const uint32_t swap = (x[0] ^ x[i]) & (bit - 1);
            if (x[i] & bit) {
                x[0] ^= bit - 1;
            } else {
                x[0] ^= swap;
                x[i] ^= swap;
            }
        }
    x[1] ^= x[0];
    x[2] ^= x[1];
    uint32_t gray = 0;
    for (uint32_t bit = 1u << (SHV_HILBERT_BITS - 1); bit > 1; bit >>= 1)
        if (x[2] & bit) gray ^= bit - 1;
    uint64_t key = 0;
    for (int bit = SHV_HILBERT_BITS - 1; bit >= 0; bit--)
        for (int i = 0; i < 3; i++) key = key << 1 | ((x[i] ^ gray) >> bit & 1);
    return key;
}
