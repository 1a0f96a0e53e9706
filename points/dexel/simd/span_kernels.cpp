#include "points/dexel/simd/span_kernels.h"

#include "implicit/simd/dispatch.h"

namespace restroke::points {

extern const SpanKernels kSpanKernelsSse2, kSpanKernelsAvx2, kSpanKernelsAvx512;

const SpanKernels& spanKernels() {
  return implicit::chosen(implicit::simdLevel(), kSpanKernelsSse2, kSpanKernelsAvx2, kSpanKernelsAvx512);
}

}  // namespace restroke::points
