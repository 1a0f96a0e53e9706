#pragma once
// What a tri-dexel's own lines know of the cells between them. Internal to points/dexel.

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "implicit/execution.h"
#include "points/dexel/refine/zone.h"
#include "points/dexel/tri_dexel.h"

namespace restroke::points {

/// The cubes between eight neighbouring points of a tri-dexel's grid. Their twelve edges are stretches of the
/// model's lines.
class ModelCells {
 public:
  enum class Kind : std::uint8_t {
    Empty = 1,  ///< no edge has a point in the solid
    Full = 2,   ///< all edges are wholly in it
    Mixed = 3   ///< neither, or a cell at the border of the grid, whose edges are not all lines
  };

  /// Those that meet a box. O(lines + cells there).
  ModelCells(const TriDexel& model, const Box& box, const Execution& execution);

  [[nodiscard]] std::size_t count() const { return kinds_.size(); }
  /// By the grid points before it.
  [[nodiscard]] Kind at(const std::array<int, 3>& cell) const;

  /// Which row of cells a line along a coordinate axis runs in; nothing for lines in other directions. Lines
  /// in one row with one origin along the axis have the same stretches.
  [[nodiscard]] std::optional<std::array<int, 3>> rowOf(const Ray& line) const;

  /// Calls f(kind, from, to) for the stretches of a line (of unit direction) between two parameters, in
  /// order: neighbours differ in kind. Beyond the grid all is empty.
  template <class F>
  void forStretches(const Ray& line, RayInterval in, const F& f) const;

 private:
  [[nodiscard]] std::size_t strideOf(std::size_t axis) const {
    std::size_t stride = 1;
    for (std::size_t a = 0; a < axis; ++a) stride *= static_cast<std::size_t>(counts_[a]);
    return stride;
  }
  /// The kept cell of an axis in which a coordinate is; those at the border beyond it.
  [[nodiscard]] int cellAlong(int axis, double coordinate) const;
  /// Where the line is among the kept cells; enter >= exit: nowhere.
  [[nodiscard]] RayInterval within(const Ray& line, RayInterval in) const;

  // Cells that are kept, from cell first_ of the grid on; cell i of them is between planes i and i + 1.
  std::array<int, 3> first_{}, counts_{};  // of the cells that are kept; cell i is between points i and i + 1
  std::array<std::vector<double>, 3> planes_;
  std::vector<Kind> kinds_;
};

template <class F>
void ModelCells::forStretches(const Ray& line, RayInterval in, const F& f) const {
  const RayInterval kept = within(line, in);
  if (!(kept.enter < kept.exit)) {
    f(Kind::Empty, in.enter, in.exit);
    return;
  }
  // J. Amanatides, A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", Eurographics 1987; crossings
  // from the planes themselves, not summed up.
  constexpr double kNever = std::numeric_limits<double>::infinity();
  std::array<const double*, 3> plane{};  // the next one
  std::array<int, 3> left{};             // cells after this one, the way that the line goes
  std::array<std::ptrdiff_t, 3> stride{};
  std::array<double, 3> next{};
  const DVec3 start = line.at(kept.enter);
  std::size_t at = 0;
  for (int a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(a);
    const int cell = cellAlong(a, start[a]);
    const double rate = line.direction[a];
    at += static_cast<std::size_t>(cell) * strideOf(i);
    stride[i] =
        rate > 0 ? static_cast<std::ptrdiff_t>(strideOf(i)) : -static_cast<std::ptrdiff_t>(strideOf(i));
    left[i] = rate > 0 ? counts_[i] - 1 - cell : cell;
    plane[i] = &planes_[i][static_cast<std::size_t>(rate > 0 ? cell + 1 : cell)];
    next[i] = rate == 0 ? kNever : (*plane[i] - line.origin[a]) / rate;
  }
  Kind kind = Kind::Empty;
  double from = in.enter;
  const auto enter = [&](Kind entered, double t) {
    if (entered == kind) return;
    if (from < t) f(kind, from, t);
    from = from < t ? t : from;
    kind = entered;
  };
  double t = kept.enter;
  enter(kinds_[at], t);
  for (;;) {
    const std::size_t i = next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : (next[1] <= next[2] ? 1 : 2);
    if (!(next[i] < kept.exit) || left[i] == 0) break;
    t = next[i] > t ? next[i] : t;
    --left[i];
    at = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(at) + stride[i]);
    plane[i] += stride[i] > 0 ? 1 : -1;
    next[i] = (*plane[i] - line.origin[static_cast<int>(i)]) / line.direction[static_cast<int>(i)];
    enter(kinds_[at], t);
  }
  if (kept.exit < in.exit) enter(Kind::Empty, kept.exit);
  if (from < in.exit) f(kind, from, in.exit);
}

}  // namespace restroke::points
