/* The tests of test_kernel_plain.c on the path of four doubles (plain loops where the compiler has no AVX2). */
#define SHV_SIMD_AVX2
#include "test_kernel_plain.c"
