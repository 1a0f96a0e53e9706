// The ray kernels for avx512; implicit/CMakeLists.txt gives this file its instruction set.
#define RESTROKE_KERNELS kRayKernelsAvx512
#include "implicit/simd/ray_kernels.inc"
