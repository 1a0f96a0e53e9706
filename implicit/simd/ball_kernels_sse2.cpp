// The ball kernels for sse2; implicit/CMakeLists.txt gives this file its instruction set.
#define RESTROKE_KERNELS kBallKernelsSse2
#include "implicit/simd/ball_kernels.inc"
