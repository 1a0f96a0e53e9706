// The span kernels for avx512; points/CMakeLists.txt gives this file its instruction set.
#define RESTROKE_KERNELS kSpanKernelsAvx512
#include "points/dexel/simd/span_kernels.inc"
