// The rivals' kernels for avx2; tests/bench/CMakeLists.txt gives this file its instruction set.
#define RESTROKE_BRUSH_KERNELS kBrushKernelsAvx2
#include "tests/bench/brush_kernels.inc"
