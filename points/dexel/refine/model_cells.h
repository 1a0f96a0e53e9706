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

  [[nodiscard]] std::size_t count() const { return cells_.kinds.size(); }
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
  // Blocks of so many cells along each axis are passed over at once where they are of one kind.
  static constexpr int kBlock = 8;

  /// Cells, or blocks of them, between planes: cell i of an axis is between planes i and i + 1.
  struct Level {
    std::array<int, 3> counts{};
    std::array<std::vector<double>, 3> planes;
    std::array<double, 3> perUnit{};  // cells a model unit, about
    std::vector<Kind> kinds;          // x fastest
  };
  /// Some of them: from first to before end.
  struct Range {
    std::array<int, 3> first, end;
  };
  /// A line, and what it takes to find where it passes planes.
  struct Way {
    const Ray& ray;
    DVec3 inverse;  // of the direction; 0 where that is
    explicit Way(const Ray& line) : ray(line), inverse(0) {
      for (int a = 0; a < 3; ++a)
        if (line.direction[a] != 0) inverse[a] = 1 / line.direction[a];
    }
  };
  /// The cell of a range in which a coordinate is; those at its border beyond it.
  [[nodiscard]] static int cellAlong(const Level& level, const Range& range, int axis, double coordinate);
  /// Where the line is among the kept cells; enter >= exit: nowhere.
  [[nodiscard]] RayInterval within(const Ray& line, RayInterval in) const;
  void makeBlocks();
  /// Calls f(cell, enter, exit) for the cells of a range that the line passes between two parameters, which
  /// are within the range.
  template <class F>
  static void walk(const Level& level, const Range& range, const Way& line, RayInterval in, const F& f);

  std::array<int, 3> first_{};  // of the cells that are kept, in the grid
  Level cells_, blocks_;
};

// J. Amanatides, A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", Eurographics 1987; crossings
// from the planes themselves, not summed up.
template <class F>
void ModelCells::walk(const Level& level, const Range& range, const Way& way, RayInterval in, const F& f) {
  const Ray& line = way.ray;
  std::array<const double*, 3> plane{};  // the next one
  std::array<int, 3> cell{}, left{};     // left: cells after this one, the way that the line goes
  std::array<double, 3> next{};
  const DVec3 start = line.at(in.enter);
  for (int a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(a);
    const double rate = line.direction[a];
    cell[i] = cellAlong(level, range, a, start[a]);
    left[i] = rate > 0 ? range.end[i] - 1 - cell[i] : cell[i] - range.first[i];
    plane[i] = &level.planes[i][static_cast<std::size_t>(rate > 0 ? cell[i] + 1 : cell[i])];
    next[i] =
        rate == 0 ? std::numeric_limits<double>::infinity() : (*plane[i] - line.origin[a]) * way.inverse[a];
  }
  double t = in.enter;
  for (;;) {
    const std::size_t i = next[0] <= next[1] ? (next[0] <= next[2] ? 0 : 2) : (next[1] <= next[2] ? 1 : 2);
    if (!(next[i] < in.exit) || left[i] == 0) break;
    const double out = next[i] > t ? next[i] : t;
    f(cell, t, out);
    t = out;
    --left[i];
    const bool up = line.direction[static_cast<int>(i)] > 0;
    cell[i] += up ? 1 : -1;
    plane[i] += up ? 1 : -1;
    next[i] = (*plane[i] - line.origin[static_cast<int>(i)]) * way.inverse[static_cast<int>(i)];
  }
  f(cell, t, in.exit);
}

template <class F>
void ModelCells::forStretches(const Ray& line, RayInterval in, const F& f) const {
  const RayInterval kept = within(line, in);
  if (!(kept.enter < kept.exit)) {
    f(Kind::Empty, in.enter, in.exit);
    return;
  }
  Kind kind = Kind::Empty;
  double from = in.enter;
  const auto enter = [&](Kind entered, double t) {
    if (entered == kind) return;
    if (from < t) f(kind, from, t);
    from = from < t ? t : from;
    kind = entered;
  };
  const auto kindAt = [](const Level& level, const std::array<int, 3>& cell) {
    return level.kinds[(static_cast<std::size_t>(cell[2]) * static_cast<std::size_t>(level.counts[1]) +
                        static_cast<std::size_t>(cell[1])) *
                           static_cast<std::size_t>(level.counts[0]) +
                       static_cast<std::size_t>(cell[0])];
  };
  const Way way(line);
  walk(blocks_, {{0, 0, 0}, blocks_.counts}, way, kept,
       [&](const std::array<int, 3>& block, double t, double out) {
         if (const Kind all = kindAt(blocks_, block); all != Kind::Mixed) {
           enter(all, t);
           return;
         }
         Range range{};
         for (std::size_t a = 0; a < 3; ++a) {
           range.first[a] = block[a] * kBlock;
           range.end[a] =
               range.first[a] + kBlock < cells_.counts[a] ? range.first[a] + kBlock : cells_.counts[a];
         }
         walk(cells_, range, way, {t, out}, [&](const std::array<int, 3>& cell, double begin, double) {
           enter(kindAt(cells_, cell), begin);
         });
       });
  if (kept.exit < in.exit) enter(Kind::Empty, kept.exit);
  if (from < in.exit) f(kind, from, in.exit);
}

}  // namespace restroke::points
