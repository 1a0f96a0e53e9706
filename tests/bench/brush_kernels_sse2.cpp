// The rivals' kernels for sse2; tests/bench/CMakeLists.txt gives this file its instruction set.
#define RESTROKE_BRUSH_KERNELS kBrushKernelsSse2
#include "tests/bench/brush_kernels.inc"
