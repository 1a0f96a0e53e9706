#pragma once
// The rivals' kernels of the instruction set that Restroke uses: both sides of the table have the same.

#include "implicit/simd/dispatch.h"
#include "tests/bench/brush_kernels.h"

namespace restroke::bench {

[[nodiscard]] inline const BrushKernels& brushKernels() {
  switch (implicit::simdLevel()) {
    case implicit::SimdLevel::Avx512:
      return kBrushKernelsAvx512;
    case implicit::SimdLevel::Avx2:
      return kBrushKernelsAvx2;
    case implicit::SimdLevel::Sse2:
      break;
  }
  return kBrushKernelsSse2;
}

}  // namespace restroke::bench
