#pragma once
// A family of a grid's lines as a lattice with a frame of its own. Internal to points/dexel.

#include <span>
#include <vector>

#include "points/dexel/dexel_grid.h"
#include "points/dexel/mesh_scan.h"

namespace restroke::points {

/// Some columns or rows of a family.
struct IndexRange {
  int begin = 0, end = 0;
  [[nodiscard]] int size() const { return end - begin; }
};

/// The lines of a family along an axis: columns along the axis that follows it, rows along the one after
/// that.
class AxisFrame {
 public:
  AxisFrame(const DexelGrid& grid, int axis)
      : AxisFrame(grid, axis, {0, grid.width(axis)}, {0, grid.height(axis)}) {}
  /// Of some of them, which count from 0 here.
  AxisFrame(const DexelGrid& grid, int axis, IndexRange columns, IndexRange rows) {
    for (int i = columns.begin; i < columns.end; ++i)
      columns_.push_back(static_cast<double>(grid.at((axis + 1) % 3, i)));
    for (int i = rows.begin; i < rows.end; ++i)
      rows_.push_back(static_cast<double>(grid.at((axis + 2) % 3, i)));
    Vec3 direction(0);
    direction[axis] = 1;
    along_ = packNormal(direction);
  }

  [[nodiscard]] LineLattice lattice() const { return {columns_, rows_}; }
  /// The direction of the lines.
  [[nodiscard]] PackedNormal along() const { return along_; }

 private:
  std::vector<double> columns_, rows_;
  PackedNormal along_ = 0;
};

/// Points as a family along the axis sees them: column, row, depth.
[[nodiscard]] inline std::vector<DVec3> inFrameOf(int axis, std::span<const DVec3> points) {
  std::vector<DVec3> seen;
  seen.reserve(points.size());
  for (const DVec3& p : points) seen.emplace_back(p[(axis + 1) % 3], p[(axis + 2) % 3], p[axis]);
  return seen;
}

}  // namespace restroke::points
