#include "points/images/simd/picture_kernels.h"

namespace restroke::points {

extern const PictureKernels kPictureKernelsSse2, kPictureKernelsAvx2, kPictureKernelsAvx512;

const PictureKernels& pictureKernels() {
  switch (implicit::simdLevel()) {
    case implicit::SimdLevel::Avx512:
      return kPictureKernelsAvx512;
    case implicit::SimdLevel::Avx2:
      return kPictureKernelsAvx2;
    case implicit::SimdLevel::Sse2:
      break;
  }
  return kPictureKernelsSse2;
}

}  // namespace restroke::points
