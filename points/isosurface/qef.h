#pragma once
// Where planes meet best: the quadratic error function of dual contouring.

#include <array>
#include <cstddef>

#include "implicit/geometry/vec.h"

namespace restroke::points {

struct QefEigen;

/// Sum of the squared distances from x to planes, and the mean of the points that the planes were given by.
/// Lengths are in cells, counted from the cell's centre, so that nothing cancels far from the origin.
class Qef {
 public:
  /// The plane through p with unit normal n.
  void add(DVec3 p, DVec3 n);

  [[nodiscard]] int count() const { return count_; }
  /// Sum of the normals.
  [[nodiscard]] DVec3 normals() const { return normals_; }
  [[nodiscard]] DVec3 mean() const { return sum_ / static_cast<double>(count_); }
  [[nodiscard]] double errorAt(DVec3 x) const;

  struct Minimum {
    DVec3 position{0};
    int rank = 0;  ///< directions that the planes determine: 1 on a face, 2 on an edge, 3 in a corner
  };

  /// The point with the least error, and of all such points the one nearest the mean. Directions in which the
  /// planes differ too little (kRankRatio) count as undetermined. At least one plane must have been added.
  [[nodiscard]] Minimum minimum() const;
  /// The same among the points of the cube |x|, |y|, |z| <= half.
  [[nodiscard]] Minimum minimumWithin(double half) const;
  /// The same of several, in less time; bit for bit.
  static constexpr std::size_t kBatch = 8;
  using Batch = std::array<const Qef*, kBatch>;
  static void minimaWithin(double half, const Batch& batch, std::array<Minimum, kBatch>& out);

  /// Least ratio of an eigenvalue to the largest for its direction to count as determined: two equally strong
  /// planes whose normals differ by 15 degrees make an edge (tan^2 of half of that).
  static constexpr double kRankRatio = 0.0173;

 private:
  using Fixed = std::array<int, 3>;  // per axis: 0 free, -1 or 1 at that bound
  [[nodiscard]] Minimum solveFree(const QefEigen& eigen, double& least) const;
  [[nodiscard]] Minimum minimumWithin(const QefEigen& eigen, double half) const;
  [[nodiscard]] Minimum solve(const Fixed& fixed, double half, double least) const;

  std::array<double, 6> a_{};  // sum of n n^T: xx, xy, xz, yy, yz, zz
  DVec3 b_{0};                 // sum of n (n . p)
  double c_ = 0;               // sum of (n . p)^2
  DVec3 sum_{0};               // of p
  DVec3 normals_{0};
  int count_ = 0;
};

}  // namespace restroke::points
