#include "points/dexel/refine/model_cells.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "implicit/parallel.h"

namespace restroke::points {

namespace {

constexpr std::uint8_t kOutside = 1, kInside = 2;

// The edges of one family that belong to the cells of a region, each with what it has points of.
class Edges {
 public:
  Edges(const TriDexel& model, int axis, const std::array<int, 3>& first, const std::array<int, 3>& counts)
      : model_(model), axis_(axis), first_(first) {
    // Along the axis as many as cells, across one more.
    for (std::size_t a = 0; a < 3; ++a) size_[a] = counts[a] + (static_cast<int>(a) == axis ? 0 : 1);
    edges_.assign(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
                      static_cast<std::size_t>(size_[2]),
                  kOutside | kInside);
    const std::array<std::size_t, 3> strides{
        1, static_cast<std::size_t>(size_[0]),
        static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1])};
    strides_ = strides;
  }

  void fill() {
    const int u = (axis_ + 1) % 3, v = (axis_ + 2) % 3;
    tbb::parallel_for(0, sizeOf(v), [&](int row) {
      LineEnds ends;
      for (int column = 0; column < sizeOf(u); ++column) fillLine(column, row, ends);
    });
  }

  /// Edge of cell (x, y, z) of the region.
  [[nodiscard]] const std::uint8_t* row(int y, int z) const {
    return &edges_[static_cast<std::size_t>(y) * strides_[1] + static_cast<std::size_t>(z) * strides_[2]];
  }

 private:
  [[nodiscard]] int sizeOf(int axis) const { return size_[static_cast<std::size_t>(axis)]; }
  [[nodiscard]] int firstOf(int axis) const { return first_[static_cast<std::size_t>(axis)]; }

  void fillLine(int column, int row, LineEnds& ends) {
    const int u = (axis_ + 1) % 3, v = (axis_ + 2) % 3;
    const Dexels& dexels = model_.family(axis_);
    const int c = firstOf(u) + column, r = firstOf(v) + row;
    if (c < 0 || r < 0 || c >= dexels.width() || r >= dexels.height()) return;  // no line: not known
    dexels.read(dexels.lineAt(c, r), ends);
    const std::size_t stride = strides_[static_cast<std::size_t>(axis_)];
    std::uint8_t* const edges =
        &edges_[static_cast<std::size_t>(column) * strides_[static_cast<std::size_t>(u)] +
                static_cast<std::size_t>(row) * strides_[static_cast<std::size_t>(v)]];
    const int last = model_.grid().counts()[static_cast<std::size_t>(axis_)] - 1;
    std::size_t passed = 0;  // ends up to the edge's beginning
    for (int i = 0; i < sizeOf(axis_); ++i) {
      const int point = firstOf(axis_) + i;
      if (point < 0 || point >= last) continue;  // half of it lies beyond the grid
      const float from = model_.grid().at(axis_, point), to = model_.grid().at(axis_, point + 1);
      while (passed < ends.size() && ends[passed].depth <= from) ++passed;
      std::uint8_t has = passed % 2 == 1 ? kInside : kOutside;
      // An end at the edge's end belongs to the next one.
      if (passed < ends.size() && ends[passed].depth < to) has = kInside | kOutside;
      edges[static_cast<std::size_t>(i) * stride] = has;
    }
  }

  const TriDexel& model_;
  int axis_;
  std::array<int, 3> first_, size_{};
  std::array<std::size_t, 3> strides_{};
  std::vector<std::uint8_t> edges_;
};

}  // namespace

ModelCells::ModelCells(const TriDexel& model, const Box& box, const Execution& execution) {
  const DexelGrid& grid = model.grid();
  std::array<int, 3>& counts = cells_.counts;
  for (int a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(a);
    const int points = grid.counts()[i];
    // From the cell before the first point to the one after the last.
    const int low = std::clamp(grid.firstFrom(a, static_cast<double>(box.min[a])) - 1, -1, points - 1),
              high = std::clamp(grid.firstFrom(a, static_cast<double>(box.max[a])), 0, points);
    first_[i] = low;
    counts[i] = std::max(0, high - low);
    for (int k = 0; k <= counts[i]; ++k) cells_.planes[i].push_back(static_cast<double>(grid.at(a, low + k)));
  }
  const auto count = [&](std::size_t a) { return static_cast<std::size_t>(counts[a]); };
  cells_.kinds.resize(count(0) * count(1) * count(2));
  if (cells_.kinds.empty()) return;
  inArena(execution, [&] {
    Edges x(model, 0, first_, counts), y(model, 1, first_, counts), z(model, 2, first_, counts);
    x.fill();
    y.fill();
    z.fill();
    tbb::parallel_for(0, counts[2], [&](int k) {
      for (int j = 0; j < counts[1]; ++j) {
        Kind* const kinds =
            &cells_.kinds[(static_cast<std::size_t>(k) * count(1) + static_cast<std::size_t>(j)) * count(0)];
        const std::uint8_t *x0 = x.row(j, k), *x1 = x.row(j + 1, k), *x2 = x.row(j, k + 1),
                           *x3 = x.row(j + 1, k + 1), *y0 = y.row(j, k), *y1 = y.row(j, k + 1),
                           *z0 = z.row(j, k), *z1 = z.row(j + 1, k);
        for (std::size_t i = 0; i < count(0); ++i)
          kinds[i] = static_cast<Kind>(x0[i] | x1[i] | x2[i] | x3[i] | y0[i] | y0[i + 1] | y1[i] | y1[i + 1] |
                                       z0[i] | z0[i + 1] | z1[i] | z1[i + 1]);
      }
    });
  });
  makeBlocks();
  for (Level* level : {&cells_, &blocks_})
    for (std::size_t a = 0; a < 3; ++a) level->perUnit[a] = 1 / (level->planes[a][1] - level->planes[a][0]);
}

void ModelCells::makeBlocks() {
  for (std::size_t a = 0; a < 3; ++a) {
    const int cells = cells_.counts[a];
    blocks_.counts[a] = (cells + kBlock - 1) / kBlock;
    for (int i = 0; i <= blocks_.counts[a]; ++i)
      blocks_.planes[a].push_back(cells_.planes[a][static_cast<std::size_t>(std::min(i * kBlock, cells))]);
  }
  const auto count = [](const Level& level, std::size_t a) {
    return static_cast<std::size_t>(level.counts[a]);
  };
  blocks_.kinds.assign(count(blocks_, 0) * count(blocks_, 1) * count(blocks_, 2), Kind{});
  for (std::size_t z = 0; z < count(cells_, 2); ++z)
    for (std::size_t y = 0; y < count(cells_, 1); ++y) {
      const Kind* const row = &cells_.kinds[(z * count(cells_, 1) + y) * count(cells_, 0)];
      Kind* const blocks = &blocks_.kinds[(z / kBlock * count(blocks_, 1) + y / kBlock) * count(blocks_, 0)];
      for (std::size_t x = 0; x < count(cells_, 0); ++x) {
        Kind& block = blocks[x / kBlock];
        block = static_cast<Kind>(static_cast<std::uint8_t>(block) | static_cast<std::uint8_t>(row[x]));
      }
    }
}

int ModelCells::cellAlong(const Level& level, const Range& range, int axis, double coordinate) {
  const auto a = static_cast<std::size_t>(axis);
  const std::vector<double>& planes = level.planes[a];
  const double guess = (coordinate - planes[0]) * level.perUnit[a];
  int cell = static_cast<int>(
      std::clamp(guess, static_cast<double>(range.first[a]), static_cast<double>(range.end[a] - 1)));
  while (cell > range.first[a] && planes[static_cast<std::size_t>(cell)] > coordinate) --cell;
  while (cell + 1 < range.end[a] && planes[static_cast<std::size_t>(cell) + 1] <= coordinate) ++cell;
  return cell;
}

std::optional<std::array<int, 3>> ModelCells::rowOf(const Ray& line) const {
  if (cells_.kinds.empty()) return std::nullopt;
  for (int a = 0; a < 3; ++a) {
    const int u = (a + 1) % 3, v = (a + 2) % 3;
    if (line.direction[u] != 0 || line.direction[v] != 0) continue;
    const auto at = [&](int axis) {
      const std::vector<double>& planes = cells_.planes[static_cast<std::size_t>(axis)];
      const double x = line.origin[axis];
      return x < planes.front() || x > planes.back() ? -1
                                                     : cellAlong(cells_, {{0, 0, 0}, cells_.counts}, axis, x);
    };
    return std::array<int, 3>{a, at(u), at(v)};
  }
  return std::nullopt;
}

RayInterval ModelCells::within(const Ray& line, RayInterval in) const {
  if (cells_.kinds.empty()) return {in.enter, in.enter};
  for (int a = 0; a < 3; ++a) {
    const std::vector<double>& planes = cells_.planes[static_cast<std::size_t>(a)];
    const double low = planes.front() - line.origin[a], high = planes.back() - line.origin[a],
                 rate = line.direction[a];
    if (rate == 0) {
      if (low > 0 || high < 0) return {in.enter, in.enter};
      continue;
    }
    in.enter = std::max(in.enter, (rate > 0 ? low : high) / rate);
    in.exit = std::min(in.exit, (rate > 0 ? high : low) / rate);
  }
  return in;
}

ModelCells::Kind ModelCells::at(const std::array<int, 3>& cell) const {
  std::size_t index = 0;
  for (std::size_t a = 3; a-- > 0;) {
    const int i = cell[a] - first_[a];
    if (i < 0 || i >= cells_.counts[a]) return Kind::Empty;
    index = index * static_cast<std::size_t>(cells_.counts[a]) + static_cast<std::size_t>(i);
  }
  return cells_.kinds[index];
}

}  // namespace restroke::points
