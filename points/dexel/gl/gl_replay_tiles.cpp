#include "points/dexel/gl/gl_replay_tiles.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace restroke::points {

namespace {

LineRectangle both(const LineRectangle& a, const LineRectangle& b) {
  return {std::max(a.firstColumn, b.firstColumn), std::min(a.endColumn, b.endColumn),
          std::max(a.firstRow, b.firstRow), std::min(a.endRow, b.endRow)};
}

}  // namespace

LineRectangle tilesOf(const LineRectangle& lines) {
  const auto tileAfter = [](int end) { return (end + kReplayTile - 1) / kReplayTile; };
  return {lines.firstColumn / kReplayTile, tileAfter(lines.endColumn), lines.firstRow / kReplayTile,
          tileAfter(lines.endRow)};
}

StepsOfTiles::StepsOfTiles(std::span<const PlacedStep> placed, const LineRectangle& tiles) : tiles_(tiles) {
  for (const PlacedStep& step : placed) {
    const LineRectangle here = both(tilesOf(step.lines), tiles);
    if (here.empty()) continue;
    steps_.push_back(step);
    pairCount_ += static_cast<std::size_t>(here.endColumn - here.firstColumn) *
                  static_cast<std::size_t>(here.endRow - here.firstRow);
  }
}

std::size_t StepsOfTiles::tileCount() const {
  return width() * static_cast<std::size_t>(tiles_.endRow - tiles_.firstRow);
}

void StepsOfTiles::makeLists() {
  rows_.resize(static_cast<std::size_t>(tiles_.endRow - tiles_.firstRow));
  tbb::parallel_for(tiles_.firstRow, tiles_.endRow,
                    [&](int row) { rows_[static_cast<std::size_t>(row - tiles_.firstRow)] = rowOf(row); });
}

// By counting.
StepsOfTiles::Row StepsOfTiles::rowOf(int row) const {
  Row out;
  const LineRectangle tiles{tiles_.firstColumn, tiles_.endColumn, row, row + 1};
  const auto forPairs = [&](const auto& f) {
    for (std::size_t i = steps_.size(); i-- > 0;) {
      const LineRectangle here = both(tilesOf(steps_[i].lines), tiles);
      if (here.empty()) continue;
      for (int column = here.firstColumn; column < here.endColumn; ++column)
        f(i, static_cast<std::size_t>(column - tiles.firstColumn));
    }
  };
  out.offsets.assign(width() + 1, 0);
  forPairs([&](std::size_t, std::size_t tile) { ++out.offsets[tile + 1]; });
  for (std::size_t tile = 0; tile < width(); ++tile) out.offsets[tile + 1] += out.offsets[tile];
  out.numbers.resize(out.offsets.back());
  std::vector<std::size_t> next(out.offsets.begin(), out.offsets.end() - 1);
  forPairs(
      [&](std::size_t i, std::size_t tile) { out.numbers[next[tile]++] = static_cast<std::uint32_t>(i); });
  return out;
}

std::span<const std::uint32_t> StepsOfTiles::of(std::size_t tile) const {
  const Row& row = rows_[tile / width()];
  const std::size_t column = tile % width();
  return std::span(row.numbers).subspan(row.offsets[column], row.offsets[column + 1] - row.offsets[column]);
}

}  // namespace restroke::points
