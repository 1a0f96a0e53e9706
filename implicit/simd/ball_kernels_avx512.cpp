// The ball kernels for avx512; implicit/CMakeLists.txt gives this file its instruction set.
#define RESTROKE_KERNELS kBallKernelsAvx512
#include "implicit/simd/ball_kernels.inc"
