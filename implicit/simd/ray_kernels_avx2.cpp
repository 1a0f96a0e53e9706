// The ray kernels for avx2; implicit/CMakeLists.txt gives this file its instruction set.
#define RESTROKE_KERNELS kRayKernelsAvx2
#include "implicit/simd/ray_kernels.inc"
