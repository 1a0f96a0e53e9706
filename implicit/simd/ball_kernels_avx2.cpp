// The ball kernels for avx2; implicit/CMakeLists.txt gives this file its instruction set.
#define RESTROKE_KERNELS kBallKernelsAvx2
#include "implicit/simd/ball_kernels.inc"
