#pragma once
// The rivals' kernels of the instruction set that Restroke uses: both sides of the table have the same.

#include "implicit/simd/dispatch.h"
#include "tests/bench/brush_kernels.h"

namespace restroke::bench {

[[nodiscard]] inline const BrushKernels& brushKernels() {
  return implicit::chosen(implicit::simdLevel(), kBrushKernelsSse2, kBrushKernelsAvx2, kBrushKernelsAvx512);
}

}  // namespace restroke::bench
