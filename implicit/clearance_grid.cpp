#include "implicit/clearance_grid.h"

#include <algorithm>
#include <cmath>

#include "implicit/errors.h"
#include "implicit/volume.h"

namespace restroke::implicit {

namespace {

// Along the longest side of the box: a byte for each of its cells stays in the cache, and about one sample in
// ten is left undecided.
constexpr int kCells = 32;
constexpr double kHalfDiagonal = 0.8660254037844387;

}  // namespace

GridGeometry::GridGeometry(const Volume& volume) {
  DVec3 extent;
  for (int a = 0; a < 3; ++a) {
    DVec3 axis(0);
    axis[a] = 1;
    low[a] = -volume.support(-axis);
    extent[a] = volume.support(axis) - low[a];
  }
  cell = std::max({extent.x, extent.y, extent.z}) / kCells;
  low -= DVec3(cell);
  for (int a = 0; a < 3; ++a) size[static_cast<std::size_t>(a)] = static_cast<int>(extent[a] / cell) + 3;
}

std::vector<std::int8_t> sidesOfCells(const Volume& volume) {
  const GridGeometry grid(volume);
  RESTROKE_CHECK_LE(grid.cells(), kMostGridCells);
  const double sure = (kHalfDiagonal + kGridMargin) * grid.cell;
  std::vector<std::int8_t> sides;
  sides.reserve(grid.cells());
  for (int z = 0; z < grid.size[2]; ++z)
    for (int y = 0; y < grid.size[1]; ++y)
      for (int x = 0; x < grid.size[0]; ++x) {
        const double c = volume.clearance(grid.low + grid.cell * DVec3(x + 0.5, y + 0.5, z + 0.5));
        sides.push_back(c > sure ? 1 : c < -sure ? -1 : 0);
      }
  return sides;
}

}  // namespace restroke::implicit
