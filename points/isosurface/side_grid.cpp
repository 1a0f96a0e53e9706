#include "points/isosurface/side_grid.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "implicit/errors.h"

namespace restroke::points {

namespace {

using implicit::Side;

// A block of points is asked at once: a word of bits in each of 8 x 8 rows, in bricks of 16 neighbours.
constexpr int kBlockX = 64, kBlockYZ = 8;
constexpr int kBrickX = 4, kBrickYZ = 2;

}  // namespace

std::array<double, 3> SideGrid::pointsFor(const Box& bounds, double cell) {
  std::array<double, 3> points{};
  for (int a = 0; a < 3; ++a) {
    const double size = static_cast<double>(bounds.max[a]) - static_cast<double>(bounds.min[a]);
    // The 1e-9 keeps a division that should be a whole number from adding a cell.
    points[static_cast<std::size_t>(a)] = std::ceil(size / cell - 1e-9) + 4;
  }
  return points;
}

SideGrid::SideGrid(const ContourSource& source, const Box& bounds, double cell) : cell_(cell) {
  const std::array<double, 3> counts = pointsFor(bounds, cell);
  for (std::size_t a = 0; a < 3; ++a) {
    points_[a] = static_cast<int>(counts[a]);
    const int axis = static_cast<int>(a);
    const double middle = (static_cast<double>(bounds.min[axis]) + static_cast<double>(bounds.max[axis])) / 2;
    for (int i = 0; i < points_[a]; ++i)
      coordinates_[a].push_back(static_cast<float>(middle + (i - (counts[a] - 1) / 2) * cell));
  }
  measure();
  ask(source);
  refuseInsideBorder();
  number();
}

SideGrid::SideGrid(const GridSource& source) {
  GridSource::Grid grid = source.grid();
  cell_ = grid.cell;
  coordinates_ = std::move(grid.coordinates);
  for (std::size_t a = 0; a < 3; ++a) {
    RESTROKE_CHECK_LE(2u, coordinates_[a].size());
    points_[a] = static_cast<int>(coordinates_[a].size());
  }
  measure();
  source.fillSides(words_, bits_);
  refuseInsideBorder();
  number();
}

void SideGrid::measure() {
  words_ = static_cast<std::size_t>(points_[0] + 63) / 64;
  rowCount_ = static_cast<std::size_t>(points_[1]) * static_cast<std::size_t>(points_[2]);
  bits_.assign(rowCount_ * words_, 0);
}

Point SideGrid::at(GridIndex i) const {
  return {coordinates_[0][static_cast<std::size_t>(i[0])], coordinates_[1][static_cast<std::size_t>(i[1])],
          coordinates_[2][static_cast<std::size_t>(i[2])]};
}

void SideGrid::ask(const ContourSource& source) {
  const int blocksY = (points_[1] + kBlockYZ - 1) / kBlockYZ,
            blocksZ = (points_[2] + kBlockYZ - 1) / kBlockYZ;
  const int blocks = static_cast<int>(words_) * blocksY * blocksZ;
  tbb::parallel_for(tbb::blocked_range<int>(0, blocks), [&](const tbb::blocked_range<int>& range) {
    for (int b = range.begin(); b < range.end(); ++b) {
      const int w = static_cast<int>(words_);
      askBlock(source, {b % w * kBlockX, b / w % blocksY * kBlockYZ, b / w / blocksY * kBlockYZ});
    }
  });
}

void SideGrid::askBlock(const ContourSource& source, GridIndex first) {
  thread_local std::vector<GridIndex> indices;
  thread_local std::vector<Point> places;
  thread_local std::vector<Side> sides;
  indices.clear();
  places.clear();
  const GridIndex end{std::min(first[0] + kBlockX, points_[0]), std::min(first[1] + kBlockYZ, points_[1]),
                      std::min(first[2] + kBlockYZ, points_[2])};
  GridIndex brick{};
  for (brick[2] = first[2]; brick[2] < end[2]; brick[2] += kBrickYZ)
    for (brick[1] = first[1]; brick[1] < end[1]; brick[1] += kBrickYZ)
      for (brick[0] = first[0]; brick[0] < end[0]; brick[0] += kBrickX)
        for (int z = brick[2]; z < std::min(brick[2] + kBrickYZ, end[2]); ++z)
          for (int y = brick[1]; y < std::min(brick[1] + kBrickYZ, end[1]); ++y)
            for (int x = brick[0]; x < std::min(brick[0] + kBrickX, end[0]); ++x) {
              indices.push_back({x, y, z});
              places.push_back(at({x, y, z}));
            }
  sides.assign(places.size(), Side::Outside);
  source.sides(places, sides);
  for (std::size_t i = 0; i < indices.size(); ++i)
    if (sides[i] == Side::Inside)
      bits_[rowOf(indices[i]) * words_ + static_cast<std::size_t>(indices[i][0] / 64)] |=
          std::uint64_t{1} << indices[i][0] % 64;
}

void SideGrid::refuseInsideBorder() const {
  const auto ny = static_cast<std::size_t>(points_[1]), nz = static_cast<std::size_t>(points_[2]);
  const int last = points_[0] - 1;
  for (std::size_t row = 0; row < rowCount_; ++row) {
    const std::size_t y = row % ny, z = row / ny;
    const bool isBorder = y == 0 || y == ny - 1 || z == 0 || z == nz - 1;
    const auto onBorder = [&](int w) {
      std::uint64_t ends = w == 0 ? 1 : 0;
      if (w == last / 64) ends |= std::uint64_t{1} << last % 64;
      return wordAt(row, w) & (isBorder ? ~std::uint64_t{0} : ends);
    };
    forBits(onBorder, row, [&](GridIndex i) {
      throw InternalError(
          fmt::format("the grid point ({}, {}, {}) is inside the solid but not within its bounds", at(i).x,
                      at(i).y, at(i).z));
    });
  }
}

std::uint64_t SideGrid::edgeWord(int axis, std::size_t row, int w) const {
  const std::size_t ny = static_cast<std::size_t>(points_[1]);
  const std::uint64_t here = wordAt(row, w);
  if (axis == 0) {
    const std::uint64_t next = static_cast<std::size_t>(w) + 1 < words_ ? wordAt(row, w + 1) : 0;
    return here ^ (here >> 1 | next << 63);  // the last point is outside, as is what stands beyond it
  }
  const std::size_t other = row + (axis == 1 ? 1 : ny);
  if (axis == 1 ? other % ny == 0 : other >= rowCount_) return 0;
  return here ^ wordAt(other, w);
}

std::uint64_t SideGrid::cellWord(std::size_t row, int w) const {
  const std::size_t ny = static_cast<std::size_t>(points_[1]);
  if ((row + 1) % ny == 0 || row + ny >= rowCount_) return 0;
  const auto any = [&](int i) {
    return wordAt(row, i) | wordAt(row + 1, i) | wordAt(row + ny, i) | wordAt(row + ny + 1, i);
  };
  const auto all = [&](int i) {
    return wordAt(row, i) & wordAt(row + 1, i) & wordAt(row + ny, i) & wordAt(row + ny + 1, i);
  };
  const bool more = static_cast<std::size_t>(w) + 1 < words_;
  const std::uint64_t or0 = any(w), and0 = all(w), or1 = more ? any(w + 1) : 0, and1 = more ? all(w + 1) : 0;
  return (or0 | or0 >> 1 | or1 << 63) & ~(and0 & (and0 >> 1 | and1 << 63));
}

void SideGrid::number() {
  // Counted row by row in parallel, then summed.
  edgesBefore_.assign(3 * rowCount_ + 1, 0);
  cellsBefore_.assign(rowCount_ + 1, 0);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rowCount_, 64),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t row = range.begin(); row < range.end(); ++row)
                        for (int w = 0; w < static_cast<int>(words_); ++w) {
                          for (int axis = 0; axis < 3; ++axis)
                            edgesBefore_[static_cast<std::size_t>(axis) * rowCount_ + row + 1] +=
                                static_cast<std::size_t>(std::popcount(edgeWord(axis, row, w)));
                          cellsBefore_[row + 1] += static_cast<std::size_t>(std::popcount(cellWord(row, w)));
                        }
                    });
  for (std::size_t i = 1; i < edgesBefore_.size(); ++i) edgesBefore_[i] += edgesBefore_[i - 1];
  for (std::size_t i = 1; i < cellsBefore_.size(); ++i) cellsBefore_[i] += cellsBefore_[i - 1];
}

std::uint8_t SideGrid::cornersOf(GridIndex cell) const {
  unsigned corners = 0;
  for (int c = 0; c < 8; ++c) {
    const GridIndex i{cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2)};
    bool within = true;
    for (std::size_t a = 0; a < 3; ++a) within = within && i[a] >= 0 && i[a] < points_[a];
    if (within && inside(i)) corners |= 1u << c;
  }
  return static_cast<std::uint8_t>(corners);
}

namespace {

// Bits of the words [0, bit / 64] that stand before `bit`.
template <class Word>
std::size_t bitsBefore(const Word& word, int bit) {
  std::size_t count = 0;
  for (int w = 0; w < bit / 64; ++w) count += static_cast<std::size_t>(std::popcount(word(w)));
  return count +
         static_cast<std::size_t>(std::popcount(word(bit / 64) & ((std::uint64_t{1} << bit % 64) - 1)));
}

}  // namespace

std::size_t SideGrid::numberOf(const GridEdge& edge) const {
  const std::size_t row = rowOf(edge.low);
  return edgesBefore_[static_cast<std::size_t>(edge.axis) * rowCount_ + row] +
         bitsBefore([&](int w) { return edgeWord(edge.axis, row, w); }, edge.low[0]);
}

std::size_t SideGrid::numberOf(GridIndex cell) const {
  const std::size_t row = rowOf(cell);
  return cellsBefore_[row] + bitsBefore([&](int w) { return cellWord(row, w); }, cell[0]);
}

}  // namespace restroke::points
