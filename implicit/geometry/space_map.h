#pragma once
// Maps of space: what is known of how a base became another one (SPEC S7, X2).

#include <array>
#include <cmath>

#include "implicit/geometry/ray.h"
#include "implicit/geometry/vec.h"

namespace restroke {

/// x goes to matrix * x + offset, in double.
struct Affine {
  std::array<double, 9> matrix{1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< rows first
  DVec3 offset{0};

  [[nodiscard]] DVec3 direction(DVec3 v) const {
    return {matrix[0] * v.x + matrix[1] * v.y + matrix[2] * v.z,
            matrix[3] * v.x + matrix[4] * v.y + matrix[5] * v.z,
            matrix[6] * v.x + matrix[7] * v.y + matrix[8] * v.z};
  }
  [[nodiscard]] DVec3 point(DVec3 p) const { return direction(p) + offset; }
  /// Where a surface's normal goes (by the cofactor matrix), of any length; towards the same side.
  [[nodiscard]] DVec3 normal(DVec3 n) const {
    const DVec3 a(matrix[0], matrix[3], matrix[6]), b(matrix[1], matrix[4], matrix[7]),
        c(matrix[2], matrix[5], matrix[8]);
    const DVec3 mapped = cross(b, c) * n.x + cross(c, a) * n.y + cross(a, b) * n.z;
    return determinant() < 0 ? -mapped : mapped;
  }
  [[nodiscard]] double determinant() const {
    const DVec3 a(matrix[0], matrix[3], matrix[6]), b(matrix[1], matrix[4], matrix[7]),
        c(matrix[2], matrix[5], matrix[8]);
    return dot(a, cross(b, c));
  }
  /// The map of a ray's line; t stays the same parameter.
  [[nodiscard]] Ray ray(const Ray& r) const {
    return {point(r.origin), direction(r.direction), r.tMin, r.tMax};
  }
  bool operator==(const Affine&) const = default;
};

/// First `inner`, then `outer`.
[[nodiscard]] inline Affine composed(const Affine& outer, const Affine& inner) {
  Affine both;
  for (std::size_t column = 0; column < 3; ++column) {
    const DVec3 image =
        outer.direction({inner.matrix[column], inner.matrix[3 + column], inner.matrix[6 + column]});
    both.matrix[column] = image.x;
    both.matrix[3 + column] = image.y;
    both.matrix[6 + column] = image.z;
  }
  both.offset = outer.point(inner.offset);
  return both;
}

/// The map must not make anything flat.
[[nodiscard]] inline Affine inverse(const Affine& map) {
  const std::array<double, 9>& m = map.matrix;
  const double d = 1 / map.determinant();
  Affine back;
  back.matrix = {
      (m[4] * m[8] - m[5] * m[7]) * d, (m[2] * m[7] - m[1] * m[8]) * d, (m[1] * m[5] - m[2] * m[4]) * d,
      (m[5] * m[6] - m[3] * m[8]) * d, (m[0] * m[8] - m[2] * m[6]) * d, (m[2] * m[3] - m[0] * m[5]) * d,
      (m[3] * m[7] - m[4] * m[6]) * d, (m[1] * m[6] - m[0] * m[7]) * d, (m[0] * m[4] - m[1] * m[3]) * d};
  back.offset = -back.direction(map.offset);
  return back;
}

/// Any smooth invertible map that keeps sides apart.
class SpaceMap {
 public:
  virtual ~SpaceMap() = default;
  [[nodiscard]] virtual DVec3 point(DVec3 p) const = 0;
  /// Where the normal at p of a surface through p goes: towards the same side, of any length but 0.
  [[nodiscard]] virtual DVec3 normal(DVec3 p, DVec3 n) const = 0;
  /// How lengths near p grow, on average: the cube root of the map's change of volume there.
  [[nodiscard]] virtual double scaleAt(DVec3 p) const = 0;
  /// The map itself where it is affine, else null.
  [[nodiscard]] virtual const Affine* affine() const { return nullptr; }
};

class AffineMap final : public SpaceMap {
 public:
  explicit AffineMap(const Affine& affine);
  [[nodiscard]] DVec3 point(DVec3 p) const override { return affine_.point(p); }
  [[nodiscard]] DVec3 normal(DVec3, DVec3 n) const override { return affine_.normal(n); }
  [[nodiscard]] double scaleAt(DVec3) const override { return scale_; }
  [[nodiscard]] const Affine* affine() const override { return &affine_; }

 private:
  Affine affine_;
  double scale_ = 1;
};

}  // namespace restroke
