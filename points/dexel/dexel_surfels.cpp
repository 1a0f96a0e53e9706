#include "points/dexel/dexel_surfels.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "implicit/errors.h"
#include "implicit/parallel.h"
#include "points/dexel/end_maker.h"

namespace restroke::points {

namespace {

// A family's ends are kept where its axis is at least so close to the normal, compared with the best axis.
// Where two families take turns on a curved surface, both are then kept over a strip as wide as a cell if
// the surface's radius is 3 cells or more.
constexpr float kSeesWell = 0.5f;
// More than rounding takes from where two discs just touch.
constexpr float kOverlap = 1.02f;
// Discs are no larger than what a plane needs that no family sees better than this one, in cells.
constexpr float kLargest = 1.25f;

// One family's ends as surfels, row by row.
class FamilySurfels {
 public:
  FamilySurfels(const TriDexel& model, int axis, const DexelSurfelOptions& options)
      : model_(model),
        grid_(model.grid()),
        dexels_(model.family(axis)),
        axis_(axis),
        u_((axis + 1) % 3),
        v_((axis + 2) % 3),
        cell_(static_cast<float>(grid_.cell())),
        choosy_(!options.family && options.ends == DexelEnds::Seen) {}

  [[nodiscard]] int height() const { return dexels_.height(); }

  void addRow(int row, std::vector<Surfel>& out) const {
    LineEnds ends;
    for (int column = 0; column < dexels_.width(); ++column) {
      const std::size_t line = dexels_.lineAt(column, row);
      if (dexels_.isEmpty(line)) continue;
      dexels_.read(line, ends);
      for (std::size_t i = 0; i < ends.size(); ++i) {
        const Vec3 n = unpackNormal(ends[i].normal);
        const float best = std::max({std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)});
        if (choosy_ && std::fabs(n[axis_]) < kSeesWell * best) continue;
        Surfel surfel;
        surfel.position[axis_] = ends[i].depth;
        surfel.position[u_] = grid_.at(u_, column);
        surfel.position[v_] = grid_.at(v_, row);
        surfel.normal = n;
        surfel.radius = radiusOf({column, row, i % 2 == 0}, ends[i].depth, n);
        const EndMaker maker = makerOf(ends[i], dexels_.keepsOperations());
        surfel.primitive = maker.operation;
        surfel.sign = maker.sign;
        out.push_back(surfel);
      }
    }
  }

 private:
  struct Place {
    int column, row;
    bool isEntry;
  };

  // On a plane with this normal the lines stand in a stretched square lattice. A disc reaches the middle of
  // the four around, or the solid's edge where the surface ends before the next line.
  [[nodiscard]] float radiusOf(const Place& place, float depth, Vec3 n) const {
    const float along = std::max(std::fabs(n[axis_]), 1e-6f);
    const float slopes[2] = {n[u_] / along, n[v_] / along};
    const float sum = std::fabs(slopes[0]) + std::fabs(slopes[1]);
    float square = cell_ * cell_ * (2 + sum * sum) / 4;
    const float sign = n[axis_] < 0 ? -1.0f : 1.0f;
    for (int side = 0; side < 4; ++side) {
      const int direction = side % 2 == 0 ? 1 : -1;
      const bool inRow = side < 2;
      const float slope = slopes[inRow ? 0 : 1];
      const Place next{place.column + (inRow ? direction : 0), place.row + (inRow ? 0 : direction),
                       place.isEntry};
      const float predicted = depth - sign * slope * static_cast<float>(direction) * cell_;
      if (goesOn(next, predicted)) continue;
      const float reach = reachTowards(place, depth, inRow ? u_ : v_, direction);
      square = std::max(square, (reach * reach + cell_ * cell_ / 4) * (1 + slope * slope));
    }
    return std::min(kOverlap * std::sqrt(square), kLargest * cell_);
  }

  // Has that line an end of the same direction about there?
  [[nodiscard]] bool goesOn(const Place& place, float depth) const {
    if (place.column < 0 || place.row < 0 || place.column >= dexels_.width() || place.row >= dexels_.height())
      return false;
    const std::size_t line = dexels_.lineAt(place.column, place.row);
    if (dexels_.isEmpty(line)) return false;
    const Dexels::ConstHulls hulls = dexels_.hulls();
    if (!dexels_.hasMore(line))
      return std::fabs((place.isEntry ? hulls.enter : hulls.exit)[line] - depth) <= cell_ / 2;
    thread_local LineEnds ends;
    dexels_.read(line, ends);
    for (std::size_t i = place.isEntry ? 0 : 1; i < ends.size(); i += 2)
      if (std::fabs(ends[i].depth - depth) <= cell_ / 2) return true;
    return false;
  }

  // How far the surface may go on towards the next line: to the first end along the line between grid points
  // just inside (an outer edge), or just outside (an inner one).
  [[nodiscard]] float reachTowards(const Place& place, float depth, int across, int direction) const {
    const Dexels& lines = model_.family(across);
    const int p = (across + 1) % 3;
    const int after = grid_.firstFrom(axis_, static_cast<double>(depth));
    const float from = grid_.at(across, across == u_ ? place.column : place.row);
    float reach = cell_;
    thread_local LineEnds ends;
    for (const int k : {after - 1, after}) {
      if (k < 0 || k >= grid_.counts()[static_cast<std::size_t>(axis_)]) continue;
      // A line of family `across` has two coordinates: this family's axis, and the one that stays.
      const int other = across == u_ ? place.row : place.column;
      const std::size_t line = lines.lineAt(p == axis_ ? k : other, p == axis_ ? other : k);
      if (lines.isEmpty(line)) continue;
      lines.read(line, ends);
      for (const SpanEnd& end : ends) {
        const float distance = (end.depth - from) * static_cast<float>(direction);
        if (distance >= 0) reach = std::min(reach, distance);
      }
    }
    return reach;
  }

  const TriDexel& model_;
  const DexelGrid& grid_;
  const Dexels& dexels_;
  int axis_, u_, v_;
  float cell_;
  bool choosy_;
};

}  // namespace

std::vector<Surfel> surfelsOf(const TriDexel& model, const DexelSurfelOptions& options,
                              const Execution& execution) {
  if (options.family && (*options.family < 0 || *options.family > 2))
    throw InputError(fmt::format("the family of lines is {}; it must be 0, 1 or 2", *options.family));
  std::vector<Surfel> surfels;
  inArena(execution, [&] {
    for (int axis = 0; axis < 3; ++axis) {
      if (options.family && *options.family != axis) continue;
      const FamilySurfels family(model, axis, options);
      std::vector<std::vector<Surfel>> rows(static_cast<std::size_t>(family.height()));
      tbb::parallel_for(0, family.height(),
                        [&](int row) { family.addRow(row, rows[static_cast<std::size_t>(row)]); });
      for (const std::vector<Surfel>& row : rows) surfels.insert(surfels.end(), row.begin(), row.end());
    }
  });
  return surfels;
}

}  // namespace restroke::points
