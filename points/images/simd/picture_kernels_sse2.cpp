// The picture kernels for sse2; points/CMakeLists.txt gives this file its instruction set.
#define RESTROKE_KERNELS kPictureKernelsSse2
#include "points/images/simd/picture_kernels.inc"
