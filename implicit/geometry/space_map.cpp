#include "implicit/geometry/space_map.h"

namespace restroke {

AffineMap::AffineMap(const Affine& affine) : affine_(affine) {
  // Cube root by Newton's method: libm's cbrt has other bits on other systems. From above it falls steadily;
  // it stops where rounding lets it fall no more.
  const double volume = std::fabs(affine.determinant());
  if (!(volume > 0) || volume == 1) return;
  double root = volume > 1 ? volume : 1;
  for (;;) {
    const double next = (2 * root + volume / (root * root)) / 3;
    if (!(next < root)) break;
    root = next;
  }
  scale_ = root;
}

}  // namespace restroke
