#pragma once
// What a tri-dexel's own lines know of the cells between them. Internal to points/dexel.

#include <array>
#include <cstdint>
#include <limits>
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
  [[nodiscard]] Kind at(const std::array<int, 3>& cell) const;

  /// Calls f(kind, from, to) for the stretches of a line (of unit direction) between two parameters, in
  /// order: neighbours differ in kind. Beyond the grid all is empty.
  template <class F>
  void forStretches(const Ray& line, RayInterval in, const F& f) const;

 private:
  [[nodiscard]] double planeAt(int axis, int i) const {
    // Points of the grid; one more on each side.
    return planes_[static_cast<std::size_t>(axis)]
                  [static_cast<std::size_t>(i - first_[static_cast<std::size_t>(axis)])];
  }

  std::array<int, 3> first_{}, counts_{};  // of the cells that are kept; cell i is between points i and i + 1
  std::array<std::vector<double>, 3> planes_;
  std::vector<Kind> kinds_;
};

template <class F>
void ModelCells::forStretches(const Ray& line, RayInterval in, const F& f) const {
  // J. Amanatides, A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", Eurographics 1987; crossings
  // from the planes themselves, not summed up.
  std::array<int, 3> cell{}, step{};
  std::array<double, 3> next{};
  const DVec3 start = line.at(in.enter);
  for (int a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(a);
    const std::vector<double>& planes = planes_[i];
    int k = first_[i] - 1;
    for (const double plane : planes) {
      if (!(plane <= start[a])) break;
      ++k;
    }
    cell[i] = k;
    step[i] = line.direction[a] > 0 ? 1 : line.direction[a] < 0 ? -1 : 0;
  }
  const auto crossing = [&](int a) {
    const auto i = static_cast<std::size_t>(a);
    const int plane = step[i] > 0 ? cell[i] + 1 : cell[i];
    if (step[i] == 0 || plane < first_[i] || plane > first_[i] + counts_[i])
      return std::numeric_limits<double>::infinity();
    return (planeAt(a, plane) - line.origin[a]) / line.direction[a];
  };
  for (int a = 0; a < 3; ++a) next[static_cast<std::size_t>(a)] = crossing(a);
  double from = in.enter, at = in.enter;
  Kind kind = this->at(cell);
  while (at < in.exit) {
    const std::size_t i = next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : (next[1] <= next[2] ? 1 : 2);
    const double to = next[i] < in.exit ? next[i] : in.exit;
    at = to > at ? to : at;
    if (!(next[i] < in.exit)) break;
    cell[i] += step[i];
    next[i] = crossing(static_cast<int>(i));
    if (const Kind entered = this->at(cell); entered != kind) {
      if (from < at) f(kind, from, at);
      from = at;
      kind = entered;
    }
  }
  if (from < in.exit) f(kind, from, in.exit);
}

}  // namespace restroke::points
