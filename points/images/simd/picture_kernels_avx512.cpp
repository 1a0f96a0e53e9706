// The picture kernels for avx512; points/CMakeLists.txt gives this file its instruction set.
#define RESTROKE_KERNELS kPictureKernelsAvx512
#include "points/images/simd/picture_kernels.inc"
