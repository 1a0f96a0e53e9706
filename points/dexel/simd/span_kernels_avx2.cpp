// The span kernels for avx2; points/CMakeLists.txt gives this file its instruction set.
#define RESTROKE_KERNELS kSpanKernelsAvx2
#include "points/dexel/simd/span_kernels.inc"
