#pragma once
// A ray's way through the cells of a hash grid. Part of castRay (ray_cast.cpp).

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "implicit/clusters.h"
#include "implicit/geometry/ray.h"

namespace restroke::implicit {

inline constexpr double kRayInfinity = std::numeric_limits<double>::infinity();

[[nodiscard]] inline double sumOfMagnitudes(DVec3 a) {
  return std::fabs(a.x) + std::fabs(a.y) + std::fabs(a.z);
}

/// A ray's numbers, axis by axis.
struct RayAxes {
  explicit RayAxes(const Ray& ray)
      : origin{ray.origin.x, ray.origin.y, ray.origin.z},
        inverse{1 / ray.direction.x, 1 / ray.direction.y, 1 / ray.direction.z},
        speed(sumOfMagnitudes(ray.direction)) {
    for (int a = 0; a < 3; ++a) ahead[a] = ray.direction[a] > 0 ? 1 : 0;
  }

  /// Where the ray leaves a cell through a face across the axis.
  [[nodiscard]] double face(int axis, std::int32_t index, double size) const {
    if (std::fabs(inverse[axis]) == kRayInfinity) return kRayInfinity;
    return ((index + ahead[axis]) * size - origin[axis]) * inverse[axis];
  }

  double origin[3], inverse[3];  // infinite where the direction has no such component
  double speed;                  // cell faces that are passed, for each unit of t and cells of size 1
  std::int32_t ahead[3];         // 1 where indices grow along the ray, else 0
};

/// Parameters between which the ray is in the box; enter > exit when it misses. The box is widened a little.
[[nodiscard]] inline RayInterval clip(const Ray& ray, const RayAxes& axes, const Box& box, double pad) {
  double enter = ray.tMin, exit = ray.tMax;
  for (int a = 0; a < 3; ++a) {
    const double o = axes.origin[a];
    const double t0 = (static_cast<double>(box.min[a]) - pad - o) * axes.inverse[a];
    const double t1 = (static_cast<double>(box.max[a]) + pad - o) * axes.inverse[a];
    // A NaN is of a ray in the plane of a widened face, where nothing is: either outcome is right.
    enter = std::max(enter, std::min(t0, t1));
    exit = std::min(exit, std::max(t0, t1));
  }
  return {enter, exit};
}

/// One grid's cells along the ray. The first reaches back to the ray's start, where the grid has nothing, and
/// after all of them an empty one lasts to the ray's end. The traversal is Amanatides and Woo, "A fast voxel
/// traversal algorithm for ray tracing", Eurographics 1987.
class CellWalk {
 public:
  /// False when the ray misses all that the grid has.
  bool start(const ClusterGrid& grid, const Ray& ray, const RayAxes& axes) {
    size_ = static_cast<double>(grid.cell());
    const RayInterval in = clip(ray, axes, grid.hull(), 1e-4 * size_);
    if (!(in.enter < in.exit)) return false;
    grid_ = &grid;
    axes_ = &axes;
    enter_ = in.enter;
    exit_ = in.exit;
    end_ = ray.tMax;
    cellStart_ = ray.tMin;
    const double used = 4 * static_cast<double>(grid.usedCells());
    // So many cells on the way that it is quicker to look through all that are in use: small primitives far
    // apart.
    sparse_ = (exit_ - enter_) * axes.speed > used * size_;
    if (sparse_) {
      slots_ = {};
      cellEnd_ = end_;
      return true;
    }
    // No more, and a few for rounding: where t has too few digits left to tell cells apart (an origin
    // absurdly far away), the walk still ends.
    stepsLeft_ = static_cast<std::int64_t>(used) + 12;
    const Cell first = grid.cellAt(ray.at(enter_));
    index_[0] = first.x;
    index_[1] = first.y;
    index_[2] = first.z;
    for (int a = 0; a < 3; ++a) faces_[a] = axes.face(a, index_[a], size_);
    arrive();
    return true;
  }

  [[nodiscard]] double cellStart() const { return cellStart_; }
  [[nodiscard]] double cellEnd() const { return cellEnd_; }
  /// The part of the present cell where the grid may have something.
  [[nodiscard]] RayInterval stretch() const {
    const double enter = std::max(cellStart_, enter_);
    return {enter, std::max(enter, std::min(cellEnd_, exit_))};
  }
  [[nodiscard]] double exit() const { return exit_; }
  [[nodiscard]] const ClusterGrid& grid() const { return *grid_; }
  /// The present cell's list. When sparse, all of the grid's lists count instead, and there is only one cell.
  [[nodiscard]] std::span<const std::uint32_t> slots() const { return slots_; }
  [[nodiscard]] bool sparse() const { return sparse_; }

  /// Goes on to the next cell, and through empty ones that end no later than `limit`.
  void next(double limit = -kRayInfinity) {
    do {
      cellStart_ = cellEnd_;
      if (--stepsLeft_ <= 0 || !(cellStart_ < exit_)) {
        slots_ = {};
        cellEnd_ = end_;
        return;
      }
      index_[axis_] += 2 * axes_->ahead[axis_] - 1;
      faces_[axis_] = axes_->face(axis_, index_[axis_], size_);
      arrive();
    } while (slots_.empty() && cellEnd_ <= limit);
  }

  /// Takes the following cells into the present one as long as they have the same few primitives, and in the
  /// end what lies behind all cells.
  void widen(std::size_t few) {
    while (stepsLeft_ > 1 && cellEnd_ < exit_ && slots_.size() <= few) {
      std::int32_t ahead[3] = {index_[0], index_[1], index_[2]};
      ahead[axis_] += 2 * axes_->ahead[axis_] - 1;
      if (!sameSlots(grid_->at({ahead[0], ahead[1], ahead[2]}), slots_)) return;
      const double start = cellStart_;
      next();
      cellStart_ = start;
    }
    if (!(cellEnd_ < exit_)) {
      stepsLeft_ = 0;
      cellEnd_ = end_;
    }
  }

  static bool sameSlots(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i)
      if (a[i] != b[i]) return false;
    return true;
  }

 private:
  void arrive() {
    const double xy = std::min(faces_[0], faces_[1]);
    axis_ = faces_[1] < faces_[0] ? 1 : 0;
    axis_ = faces_[2] < xy ? 2 : axis_;
    cellEnd_ = std::min(std::max(std::min(xy, faces_[2]), cellStart_), exit_);
    slots_ = grid_->at({index_[0], index_[1], index_[2]});
  }

  const ClusterGrid* grid_;
  const RayAxes* axes_;
  double size_;
  double enter_, exit_, end_;  // where the ray enters and leaves what the grid has, and where it ends
  double cellStart_, cellEnd_;
  double faces_[3];  // parameters of the next faces
  std::int32_t index_[3];
  int axis_;  // of the nearest face
  std::int64_t stepsLeft_;
  bool sparse_;
  std::span<const std::uint32_t> slots_;
};

}  // namespace restroke::implicit
