// The rivals' kernels for avx512; tests/bench/CMakeLists.txt gives this file its instruction set.
#define RESTROKE_BRUSH_KERNELS kBrushKernelsAvx512
#include "tests/bench/brush_kernels.inc"
