#include "points/images/simd/picture_kernels.h"

namespace restroke::points {

extern const PictureKernels kPictureKernelsSse2, kPictureKernelsAvx2, kPictureKernelsAvx512;

const PictureKernels& pictureKernels() {
  return implicit::chosen(implicit::simdLevel(), kPictureKernelsSse2, kPictureKernelsAvx2,
                          kPictureKernelsAvx512);
}

}  // namespace restroke::points
