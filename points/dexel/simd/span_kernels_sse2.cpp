// The span kernels for sse2; points/CMakeLists.txt gives this file its instruction set.
#define RESTROKE_KERNELS kSpanKernelsSse2
#include "points/dexel/simd/span_kernels.inc"
