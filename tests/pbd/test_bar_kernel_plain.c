/* The tests of the bar kernel on the path without intrinsics. */
#define SHV_SIMD_PLAIN
#include "test_bar_kernel.c"
