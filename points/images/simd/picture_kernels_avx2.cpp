// The picture kernels for avx2; points/CMakeLists.txt gives this file its instruction set.
#define RESTROKE_KERNELS kPictureKernelsAvx2
#include "points/images/simd/picture_kernels.inc"
