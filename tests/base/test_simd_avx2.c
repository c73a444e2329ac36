/* The tests of simd.h on its AVX2 path (plain C where the processor has none). */
#define SHV_SIMD_AVX2
#include "test_simd.c"
