/* The tests of simd.h on its path without intrinsics. */
#define SHV_SIMD_PLAIN
#include "test_simd.c"
