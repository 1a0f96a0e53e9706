#include "points/dexel/refine/line_replay.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "implicit/errors.h"
#include "implicit/parallel.h"
#include "points/dexel/refine/line_start.h"
#include "points/dexel/refine/model_cells.h"
#include "points/dexel/refine/placed_steps.h"
#include "points/dexel/refine/steps_on_line.h"
#include "points/dexel/simd/span_kernels.h"

namespace restroke::points {

namespace {

using implicit::Sphere;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// Rows that one thread works on at a time, and columns that are worked on together: what they hold stays in
// its cache while operations pass over them, and is done as soon as its own lines are decided.
constexpr int kBand = 8;
constexpr int kTile = static_cast<int>(SpanKernels::kLanes);
constexpr int kPadding = 16;  // of kernels

float roundedUp(double x) {
  const auto near = static_cast<float>(x);
  return static_cast<double>(near) >= x ? near : std::nextafter(near, kInfinity);
}
float roundedDown(double x) {
  return -roundedUp(-x);
}

// Some neighbouring lines of some rows, as kernels take them; columns and rows count from the tile's first.
class Tile {
 public:
  static constexpr std::size_t kStride = kTile + kPadding;

  void take(const LinesInZone& lines, const LineRectangle& part) {
    columns_ = part.endColumn - part.firstColumn;
    used_ = false;
    for (int row = 0; row < part.endRow - part.firstRow; ++row)
      for (int column = 0; column < static_cast<int>(kStride); ++column) {
        const std::size_t at = indexOf(column, row);
        if (column >= columns_) {
          from_[at] = kInfinity;
          to_[at] = -kInfinity;
          d_[0][at] = 1;
          continue;
        }
        const std::size_t line =
            static_cast<std::size_t>(part.firstRow + row) * static_cast<std::size_t>(lines.family.width) +
            static_cast<std::size_t>(part.firstColumn + column);
        from_[at] = lines.from[line];
        to_[at] = lines.to[line];
        used_ = used_ || from_[at] < to_[at];
        const Ray ray = lines.family.line(part.firstColumn + column, part.firstRow + row);
        for (int a = 0; a < 3; ++a) {
          o_[a][at] = ray.origin[a];
          d_[a][at] = ray.direction[a];
        }
      }
  }
  [[nodiscard]] static std::size_t indexOf(int column, int row) {
    return static_cast<std::size_t>(row) * kStride + static_cast<std::size_t>(column);
  }
  [[nodiscard]] int columns() const { return columns_; }
  /// Some line of the tile meets the zone.
  [[nodiscard]] bool isUsed() const { return used_; }
  [[nodiscard]] LineLanes lanes(int column, int row) const {
    const std::size_t at = indexOf(column, row);
    return {{&o_[0][at], &o_[1][at], &o_[2][at]}, {&d_[0][at], &d_[1][at], &d_[2][at]}, &from_[at], &to_[at]};
  }
  [[nodiscard]] CutLine line(int column, int row) const {
    const std::size_t at = indexOf(column, row);
    return {{{o_[0][at], o_[1][at], o_[2][at]}, {d_[0][at], d_[1][at], d_[2][at]}}, from_[at], to_[at]};
  }
  [[nodiscard]] float from(int column, int row) const { return from_[indexOf(column, row)]; }
  [[nodiscard]] float to(int column, int row) const { return to_[indexOf(column, row)]; }

 private:
  int columns_ = 0;
  bool used_ = false;
  double o_[3][kBand * kStride] = {}, d_[3][kBand * kStride] = {};
  float from_[kBand * kStride], to_[kBand * kStride];
};

// The lines of a tile under steps, the last one first.
class TileReplay {
 public:
  explicit TileReplay(std::span<const HistoryStep> steps) : onLine_(steps) { several_.fill(~0u); }

  /// The tile at hand becomes another one. False: no line of it meets the zone.
  bool start(const LinesInZone& lines, LineRectangle part, const ReplayBasis& basis) {
    tile_.take(lines, part);
    rows_ = part.endRow - part.firstRow;
    basis_ = basis;
    open_ = 0;
    low_.fill(kInfinity);
    high_.fill(-kInfinity);
    if (!tile_.isUsed()) return false;
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < tile_.columns(); ++column) {
        const std::size_t at = Tile::indexOf(column, row);
        if (!startLikeNeighbour(column, row)) startLine(painters_[at], tile_.line(column, row), basis_.known);
        low_[at] = painters_[at].low();
        high_[at] = painters_[at].high();
        open_ += low_[at] < high_[at] ? 1 : 0;
      }
    return true;
  }

  /// No line has anything left to decide.
  [[nodiscard]] bool isDone() const { return open_ == 0; }

  /// `part`: columns and rows of the tile.
  void apply(std::uint32_t step, const LineRectangle& part) {
    const HistoryStep& what = onLine_.steps()[step];
    const bool asksEach = what.operation == DexelOperation::Intersection || !what.ball;
    for (int row = part.firstRow; row < part.endRow; ++row)
      if (asksEach)
        for (int column = part.firstColumn; column < part.endColumn; ++column) {
          const std::size_t at = Tile::indexOf(column, row);
          if (!(low_[at] < high_[at])) continue;
          onLine_.paint(step, tile_.line(column, row), painters_[at]);
          note(at);
        }
      else
        applyBall(step, *what.ball, row, part);
  }

  void write(Dexels& dexels, int firstColumn, int firstRow) {
    LineEnds ends, before;
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < tile_.columns(); ++column) {
        if (!(tile_.from(column, row) < tile_.to(column, row))) continue;
        const std::size_t line = dexels.lineAt(firstColumn + column, firstRow + row);
        if (basis_.start) basis_.start->read(line, before);
        onLine_.endsOf(painters_[Tile::indexOf(column, row)], tile_.line(column, row), before, ends);
        dexels.write(line, ends);
      }
  }

 private:
  // Several lines share a row of cells: what cells know of one of them they know of all.
  bool startLikeNeighbour(int column, int row) {
    if (!basis_.known) return false;
    const std::size_t at = Tile::indexOf(column, row);
    rowsOfCells_[at] = basis_.known->rowOf(tile_.line(column, row).ray);
    if (!rowsOfCells_[at]) return false;
    const auto isLike = [&](int otherColumn, int otherRow) {
      const std::size_t other = Tile::indexOf(otherColumn, otherRow);
      if (rowsOfCells_[other] != rowsOfCells_[at] ||
          tile_.from(otherColumn, otherRow) != tile_.from(column, row) ||
          tile_.to(otherColumn, otherRow) != tile_.to(column, row))
        return false;
      painters_[at] = painters_[other];
      return true;
    };
    return (column > 0 && isLike(column - 1, row)) || (row > 0 && isLike(column, row - 1));
  }
  // Where a painter stands, for kernels.
  void note(std::size_t at) {
    const bool wasOpen = low_[at] < high_[at];
    low_[at] = painters_[at].low();
    high_[at] = painters_[at].high();
    if (wasOpen && !(low_[at] < high_[at])) --open_;
  }

  void applyBall(std::uint32_t step, const Sphere& ball, int row, const LineRectangle& part) {
    const double r = static_cast<double>(ball.radius);
    const BallPlace place{static_cast<double>(ball.center.x), static_cast<double>(ball.center.y),
                          static_cast<double>(ball.center.z), r * r};
    const auto count = static_cast<std::size_t>(part.endColumn - part.firstColumn);
    const std::size_t first = Tile::indexOf(part.firstColumn, row);
    kernels_.ballOnLines(place, tile_.lanes(part.firstColumn, row), count, enter_.data(), exit_.data());
    // What is undecided lies between two depths, so that it may change as if it were one span.
    const SpanLanes lanes{&low_[first], &high_[first], several_.data(), enter_.data(), exit_.data()};
    for (std::uint64_t bits = kernels_.changedBySubtraction(lanes, count); bits != 0; bits &= bits - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(bits));
      painters_[first + i].paint(enter_[i], exit_[i], step);
      note(first + i);
    }
  }

  StepsOnLine onLine_;
  Tile tile_;
  ReplayBasis basis_;
  int rows_ = 0;
  const SpanKernels& kernels_ = spanKernels();
  std::size_t open_ = 0;
  std::array<LinePainter, kBand * Tile::kStride> painters_;
  std::array<std::optional<std::array<int, 3>>, kBand * Tile::kStride> rowsOfCells_;
  std::array<float, kBand * Tile::kStride> low_ = {}, high_ = {};
  std::array<std::uint32_t, kTile + kPadding> several_;  // no line has: kernels ask
  std::array<float, kTile + kPadding> enter_, exit_;
};

// Rows of a family under steps.
class BandReplay {
 public:
  BandReplay(const LinesInZone& lines, std::span<const HistoryStep> steps, const ReplayBasis& basis)
      : lines_(lines), basis_(basis), tiles_([steps] { return std::make_unique<TileReplay>(steps); }) {}

  void run(std::span<const PlacedStep> placed, int firstRow, Dexels& dexels) {
    const int endRow = std::min(firstRow + kBand, lines_.family.height);
    std::vector<PlacedStep> here;  // the last one first
    for (std::size_t i = placed.size(); i-- > 0;)
      if (placed[i].lines.firstRow < endRow && placed[i].lines.endRow > firstRow) here.push_back(placed[i]);
    if (here.empty() && !basis_.start && !basis_.known) return;
    TileReplay& replay = *tiles_.local();
    for (int column = 0; column < lines_.family.width; column += kTile) {
      const int endColumn = std::min(column + kTile, lines_.family.width);
      if (!replay.start(lines_, {column, endColumn, firstRow, endRow}, basis_)) continue;
      for (const PlacedStep& step : here) {
        if (replay.isDone()) break;
        const LineRectangle part{std::max(step.lines.firstColumn, column) - column,
                                 std::min(step.lines.endColumn, endColumn) - column,
                                 std::max(step.lines.firstRow, firstRow) - firstRow,
                                 std::min(step.lines.endRow, endRow) - firstRow};
        if (!part.empty()) replay.apply(step.step, part);
      }
      replay.write(dexels, column, firstRow);
    }
  }

 private:
  const LinesInZone& lines_;
  ReplayBasis basis_;
  tbb::enumerable_thread_specific<std::unique_ptr<TileReplay>> tiles_;
};

}  // namespace

std::size_t LinesInZone::count() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < from.size(); ++i) count += from[i] < to[i] ? 1 : 0;
  return count;
}

LinesInZone linesInZone(const LineFamily& family, const Zone& zone, const Execution& execution) {
  LinesInZone out;
  out.family = family;
  const auto width = static_cast<std::size_t>(family.width);
  out.from.assign(width * static_cast<std::size_t>(family.height), kInfinity);
  out.to.assign(out.from.size(), -kInfinity);
  inArena(execution, [&] {
    tbb::parallel_for(0, family.height, [&](int row) {
      for (int column = 0; column < family.width; ++column) {
        const auto in = zone.clip(family.line(column, row));
        if (!in) continue;
        // Inwards: nothing beyond the zone is to be within the depths.
        const float from = roundedUp(std::max(in->enter, family.from)), to = roundedDown(in->exit);
        if (!(from < to)) continue;
        const std::size_t at = static_cast<std::size_t>(row) * width + static_cast<std::size_t>(column);
        out.from[at] = from;
        out.to[at] = to;
      }
    });
  });
  return out;
}

Dexels replay(const ReplayInput& input, const LinesInZone& lines, const Execution& execution) {
  Dexels out(lines.family.width, lines.family.height, {.operations = true});
  RESTROKE_CHECK_EQ(out.lineCount(), lines.from.size());
  const std::vector<HistoryStep> steps = stepsOf(input.history, input.ids);
  const std::vector<PlacedStep> placed = placedSteps(steps, lines.family);
  BandReplay bands(lines, steps, input.basis);
  const int count = (lines.family.height + kBand - 1) / kBand;
  inArena(execution, [&] { tbb::parallel_for(0, count, [&](int b) { bands.run(placed, b * kBand, out); }); });
  return out;
}

Dexels replayPlainly(const ReplayInput& input, const LinesInZone& lines, const Execution& execution) {
  Dexels out(lines.family.width, lines.family.height, {.operations = true});
  const std::vector<HistoryStep> steps = stepsOf(input.history, input.ids);
  inArena(execution, [&] {
    tbb::parallel_for(0, lines.family.height, [&](int row) {
      StepsOnLine onLine(steps);
      LinePainter painter;
      LineEnds ends;
      for (int column = 0; column < lines.family.width; ++column) {
        const std::size_t at = out.lineAt(column, row);
        if (!(lines.from[at] < lines.to[at])) continue;
        const CutLine line{lines.family.line(column, row), lines.from[at], lines.to[at]};
        painter.start(line.from, line.to);
        for (auto step = static_cast<std::uint32_t>(steps.size()); step-- > 0;)
          onLine.paint(step, line, painter);
        onLine.endsOf(painter, line, {}, ends);
        out.write(at, ends);
      }
    });
  });
  return out;
}

}  // namespace restroke::points
