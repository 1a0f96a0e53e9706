// The ray kernels for sse2; implicit/CMakeLists.txt gives this file its instruction set.
#define RESTROKE_KERNELS kRayKernelsSse2
#include "implicit/simd/ray_kernels.inc"
