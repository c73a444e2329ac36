/* The tests of the bar kernel on the AVX2 path. */
#define SHV_SIMD_AVX2
#include "test_bar_kernel.c"
