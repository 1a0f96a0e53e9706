#pragma once
// Where the lines of a tri-dexel model are.

#include <array>
#include <cstddef>
#include <optional>

#include "implicit/geometry/box.h"
#include "implicit/geometry/vec.h"

namespace restroke::points {

/// Number of points along each axis.
using GridCounts = std::array<int, 3>;

/// A uniform grid of points. The lines of family a run along axis a through the points of the two other axes,
/// u = (a + 1) % 3 in columns and v = (a + 2) % 3 in rows, so that each point is on one line of each family.
/// A line's depth is the coordinate along its axis. Coordinates are float32 numbers, all multiples of the
/// cell from one anchor: a grid that has grown has the same lines as before among its own.
class DexelGrid {
 public:
  /// Points in the middles of cells of size `cell` > 0 that cover `bounds`, about the bounds' middle (SPEC
  /// D2).
  DexelGrid(const Box& bounds, double cell);
  DexelGrid() = default;

  [[nodiscard]] double cell() const { return cell_; }
  [[nodiscard]] const GridCounts& counts() const { return counts_; }
  /// Coordinate of point i of an axis; i may be beyond the grid.
  [[nodiscard]] float at(int axis, int i) const {
    const auto a = static_cast<std::size_t>(axis);
    return static_cast<float>(anchor_[axis] + (first_[a] + i) * cell_);
  }
  [[nodiscard]] Point at(const GridCounts& index) const {
    return {at(0, index[0]), at(1, index[1]), at(2, index[2])};
  }
  /// The first point of an axis at `coordinate` or after it; may be beyond the grid.
  [[nodiscard]] int firstFrom(int axis, double coordinate) const;
  /// The point of the grid that is nearest to a coordinate.
  [[nodiscard]] int nearestTo(int axis, float coordinate) const;

  /// The points of an axis whose coordinates are within a box, faces included.
  struct Range {
    int begin = 0, end = 0;
  };
  [[nodiscard]] Range pointsIn(int axis, const Box& box) const;

  [[nodiscard]] int width(int family) const { return counts_[static_cast<std::size_t>((family + 1) % 3)]; }
  [[nodiscard]] int height(int family) const { return counts_[static_cast<std::size_t>((family + 2) % 3)]; }
  /// Of all three families.
  [[nodiscard]] std::size_t lineCount() const;

  /// The grid with as many more points on each side as it takes to have `bounds` within its cells. `before`
  /// becomes how many of them come before the old ones. Throws InputError as dexelGridFor does for lines that
  /// are too many or too far away; empty bounds change nothing.
  [[nodiscard]] DexelGrid grownTo(const Box& bounds, GridCounts& before) const;
  bool operator==(const DexelGrid&) const = default;

  /// What a file holds of it.
  struct Parts {
    DVec3 anchor{0};
    double cell = 0;
    std::array<int, 3> first{}, counts{};
  };
  [[nodiscard]] Parts parts() const { return {anchor_, cell_, first_, counts_}; }
  explicit DexelGrid(const Parts& parts)
      : anchor_(parts.anchor), cell_(parts.cell), first_(parts.first), counts_(parts.counts) {}

 private:
  DVec3 anchor_{0};
  double cell_ = 1;
  std::array<int, 3> first_{};
  GridCounts counts_{};
};

/// How fine: at most one of the two; with neither, kDefaultLines.
struct DexelGridOptions {
  /// Lines along the longest side of the bounds, 1 to kMostLines.
  std::optional<int> resolution = std::nullopt;
  /// From line to line, model units, finite and > 0.
  std::optional<double> cell = std::nullopt;
};
inline constexpr int kDefaultLines = 128;
inline constexpr int kMostLines = 8192;

/// The grid for a solid in `bounds`. Throws InputError when the bounds are empty or a point, an option is out
/// of range, both are given, float32 cannot tell neighbouring lines apart (64 numbers a cell), or the lines
/// alone would take more memory than the machine has free (the sentence says how much).
[[nodiscard]] DexelGrid dexelGridFor(const Box& bounds, const DexelGridOptions& options = {});

}  // namespace restroke::points
