#include "points/dexel/dexel_grid.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "implicit/errors.h"
#include "implicit/process_memory.h"

namespace restroke::points {

namespace {

// 64 float32 numbers from line to line.
constexpr double kLeastCellOfCoordinate = 0x1p-18;
// What a line with one span takes (dexels.h).
constexpr double kBytesPerLine = 36;

double low(const Box& box, int axis) {
  return static_cast<double>(box.min[axis]);
}
double high(const Box& box, int axis) {
  return static_cast<double>(box.max[axis]);
}

int pointsFor(double size, double cell) {
  // The 1e-9 keeps a division that should be a whole number from adding a point.
  return std::max(1, static_cast<int>(std::ceil(size / cell - 1e-9)));
}

double cellFor(const Box& bounds, const DexelGridOptions& options) {
  if (options.resolution && options.cell)
    throw InputError("both a resolution and a cell size were given; they say the same thing, give one");
  if (options.resolution && (*options.resolution < 1 || *options.resolution > kMostLines))
    throw InputError(
        fmt::format("the resolution is {}; it must be 1 to {}", *options.resolution, kMostLines));
  if (options.cell && !(std::isfinite(*options.cell) && *options.cell > 0))
    throw InputError(fmt::format("the cell size is {}; it must be greater than 0", *options.cell));
  double longest = 0;
  for (int a = 0; a < 3; ++a) longest = std::max(longest, high(bounds, a) - low(bounds, a));
  if (!(longest > 0)) throw InputError("the solid is one point; there is nothing to lay lines through");
  return options.cell ? *options.cell : longest / options.resolution.value_or(kDefaultLines);
}

using Counts = std::array<double, 3>;

// Throws when so many points along the axes are more lines than can be.
void refuseTooMany(const Counts& points, double cell) {
  const double lines = points[0] * points[1] + points[1] * points[2] + points[2] * points[0];
  const double bytes = lines * kBytesPerLine;
  const std::optional<std::size_t> available = availableBytes();
  if (*std::max_element(points.begin(), points.end()) <= kMostLines && lines <= 0x1p31 &&
      !(available && bytes > static_cast<double>(*available)))
    return;
  throw InputError(fmt::format(
      "lines {:.6g} apart are {} x {} x {} of them along the three axes, {:.3g} in all, which take {:.3g} "
      "GB{}; at "
      "most {} along an axis are allowed",
      cell, points[0], points[1], points[2], lines, bytes * 1e-9,
      available ? fmt::format(" of the {:.3g} GB that are free", static_cast<double>(*available) * 1e-9) : "",
      kMostLines));
}

// Throws when float32 has too few numbers from line to line at such a coordinate.
void refuseTooFar(double coordinate, double cell) {
  if (cell >= kLeastCellOfCoordinate * coordinate) return;
  throw InputError(fmt::format(
      "lines {:.6g} apart were asked for; so far from the origin ({:.6g}) float32 needs {:.6g} at least",
      cell, coordinate, kLeastCellOfCoordinate * coordinate));
}

double largestCoordinate(const Box& box) {
  double largest = 0;
  for (int a = 0; a < 3; ++a) largest = std::max({largest, std::fabs(low(box, a)), std::fabs(high(box, a))});
  return largest;
}

}  // namespace

DexelGrid::DexelGrid(const Box& bounds, double cell) : cell_(cell) {
  for (int a = 0; a < 3; ++a) {
    const int n = pointsFor(high(bounds, a) - low(bounds, a), cell);
    counts_[static_cast<std::size_t>(a)] = n;
    anchor_[a] = (low(bounds, a) + high(bounds, a)) / 2 - (n - 1) * cell / 2;
  }
}

int DexelGrid::firstFrom(int axis, double coordinate) const {
  const auto a = static_cast<std::size_t>(axis);
  const double guess = std::ceil((coordinate - anchor_[axis]) / cell_) - first_[a];
  int i = static_cast<int>(std::clamp(guess, 0.0, static_cast<double>(counts_[a])));
  // Coordinates are rounded: at most one step off.
  while (i > 0 && static_cast<double>(at(axis, i - 1)) >= coordinate) --i;
  while (i < counts_[a] && static_cast<double>(at(axis, i)) < coordinate) ++i;
  return i;
}

int DexelGrid::nearestTo(int axis, float coordinate) const {
  const double steps = (static_cast<double>(coordinate) - static_cast<double>(at(axis, 0))) / cell_;
  return static_cast<int>(
      std::clamp(std::floor(steps + 0.5), 0.0, counts_[static_cast<std::size_t>(axis)] - 1.0));
}

DexelGrid::Range DexelGrid::pointsIn(int axis, const Box& box) const {
  Range range{firstFrom(axis, low(box, axis)), firstFrom(axis, high(box, axis))};
  if (range.end < counts_[static_cast<std::size_t>(axis)] && at(axis, range.end) == box.max[axis])
    ++range.end;
  return range;
}

std::size_t DexelGrid::lineCount() const {
  std::size_t lines = 0;
  for (int family = 0; family < 3; ++family)
    lines += static_cast<std::size_t>(width(family)) * static_cast<std::size_t>(height(family));
  return lines;
}

DexelGrid DexelGrid::grownTo(const Box& bounds, GridCounts& before) const {
  DexelGrid grown = *this;
  before = {};
  if (bounds.empty()) return grown;
  refuseTooFar(largestCoordinate(bounds), cell_);
  Counts more[2], points;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    const double first = static_cast<double>(at(axis, 0)) - cell_ / 2,
                 last = static_cast<double>(at(axis, counts_[a] - 1)) + cell_ / 2;
    more[0][a] = std::max(0.0, std::ceil((first - low(bounds, axis)) / cell_ - 1e-9));
    more[1][a] = std::max(0.0, std::ceil((high(bounds, axis) - last) / cell_ - 1e-9));
    points[a] = more[0][a] + counts_[a] + more[1][a];
  }
  if (more[0] == Counts{} && more[1] == Counts{}) return grown;
  refuseTooMany(points, cell_);
  for (std::size_t a = 0; a < 3; ++a) {
    before[a] = static_cast<int>(more[0][a]);
    grown.first_[a] -= before[a];
    grown.counts_[a] = static_cast<int>(points[a]);
  }
  return grown;
}

DexelGrid dexelGridFor(const Box& bounds, const DexelGridOptions& options) {
  if (bounds.empty()) throw InputError("the solid is empty; there is nothing to lay lines through");
  const double cell = cellFor(bounds, options);
  refuseTooFar(largestCoordinate(bounds), cell);
  Counts points;
  for (int a = 0; a < 3; ++a)
    points[static_cast<std::size_t>(a)] =
        std::max(1.0, std::ceil((high(bounds, a) - low(bounds, a)) / cell - 1e-9));
  refuseTooMany(points, cell);
  return DexelGrid(bounds, cell);
}

}  // namespace restroke::points
