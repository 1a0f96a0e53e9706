#include "points/dexel/refine/line_replay.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "implicit/errors.h"
#include "implicit/parallel.h"
#include "points/dexel/line_changes.h"
#include "points/dexel/refine/family_raster.h"

namespace restroke::points {

namespace {

using implicit::Sphere;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
// Rows that one thread works on at a time, and columns that are worked on together: what they hold stays in
// its cache while operations pass over them.
constexpr int kBand = 8;
constexpr int kTile = static_cast<int>(LineChanges::kLanes);
constexpr int kPadding = 16;  // of kernels

float roundedUp(double x) {
  const auto near = static_cast<float>(x);
  return static_cast<double>(near) >= x ? near : std::nextafter(near, kInfinity);
}
float roundedDown(double x) {
  return -roundedUp(-x);
}

// What a step does to one line, by what its solid says of the line. `Apply` takes (Stretch, normalAt).
class StepOnLine {
 public:
  /// from < to: the line's depths that count.
  template <class Apply>
  void operator()(const HistoryStep& step, const Ray& line, float from, float to, const Apply& apply) {
    spans_.clear();
    if (step.ball)
      addBall(*step.ball, line);
    else
      step.solid->intersect(line, spans_);
    if (step.operation != DexelOperation::Intersection) {
      const bool fills = step.operation == DexelOperation::Union;
      for (const SolidSpan& span : spans_)
        put(step, {span.enter, span.exit}, from, to, apply, fills, [&](bool exit) {
          const Vec3 n = exit ? span.exitNormal : span.enterNormal;
          return packNormal(fills ? n : -n);
        });
      return;
    }
    // What is between the spans is cleared.
    const double infinity = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i <= spans_.size(); ++i) {
      const double begin = i == 0 ? -infinity : spans_[i - 1].exit,
                   end = i == spans_.size() ? infinity : spans_[i].enter;
      put(step, {begin, end}, from, to, apply, false, [&](bool exit) -> PackedNormal {
        // At infinity there is no end, and no normal.
        if (i == (exit ? spans_.size() : 0)) return 0;
        return packNormal(exit ? spans_[i].enterNormal : spans_[i - 1].exitNormal);
      });
    }
  }

 private:
  void addBall(const Sphere& ball, const Ray& line) {
    if (const auto in = intersect(ball, line))
      spans_.push_back({in->enter, in->exit, Vec3(outwardNormal(ball, line.at(in->enter))),
                        Vec3(outwardNormal(ball, line.at(in->exit)))});
  }

  template <class Apply, class Normal>
  static void put(const HistoryStep& step, RayInterval in, float from, float to, const Apply& apply,
                  bool fills, const Normal& normalAt) {
    const float enter = std::max(static_cast<float>(in.enter), from),
                exit = std::min(static_cast<float>(in.exit), to);
    if (enter < exit) apply(Stretch{enter, exit, fills, step.id}, normalAt);
  }

  std::vector<SolidSpan> spans_;
};

// A step, and the lines that it may change.
struct PlacedStep {
  HistoryStep step;
  LineRectangle lines;
};

// A tile of a band: lines as kernels take them.
class Tile {
 public:
  Tile(const LinesInZone& lines, const Dexels& dexels, int firstRow, int endRow, int firstColumn)
      : lines_(lines), dexels_(dexels), firstRow_(firstRow), firstColumn_(firstColumn) {
    endColumn_ = std::min(firstColumn + kTile, lines.family.width);
    for (int row = firstRow; row < endRow; ++row) fill(row);
  }
  [[nodiscard]] int firstColumn() const { return firstColumn_; }
  [[nodiscard]] int endColumn() const { return endColumn_; }
  /// Some line of the tile meets the zone.
  [[nodiscard]] bool isUsed() const { return used_; }
  [[nodiscard]] LineLanes lanes(int column, int row) const {
    const std::size_t at = indexOf(column, row);
    return {{&o_[0][at], &o_[1][at], &o_[2][at]}, {&d_[0][at], &d_[1][at], &d_[2][at]}, &from_[at], &to_[at]};
  }
  [[nodiscard]] Ray line(int column, int row) const {
    const std::size_t at = indexOf(column, row);
    return {{o_[0][at], o_[1][at], o_[2][at]}, {d_[0][at], d_[1][at], d_[2][at]}};
  }
  [[nodiscard]] float from(int column, int row) const { return from_[indexOf(column, row)]; }
  [[nodiscard]] float to(int column, int row) const { return to_[indexOf(column, row)]; }

 private:
  static constexpr std::size_t kStride = kTile + kPadding;
  [[nodiscard]] std::size_t indexOf(int column, int row) const {
    return static_cast<std::size_t>(row - firstRow_) * kStride +
           static_cast<std::size_t>(column - firstColumn_);
  }
  void fill(int row) {
    for (int i = 0; i < static_cast<int>(kStride); ++i) {
      const std::size_t at = indexOf(firstColumn_ + i, row);
      if (firstColumn_ + i >= endColumn_) {
        from_[at] = kInfinity;
        to_[at] = -kInfinity;
        d_[0][at] = 1;
        continue;
      }
      const std::size_t line = dexels_.lineAt(firstColumn_ + i, row);
      from_[at] = lines_.from[line];
      to_[at] = lines_.to[line];
      used_ = used_ || from_[at] < to_[at];
      const Ray ray = lines_.family.line(firstColumn_ + i, row);
      for (int a = 0; a < 3; ++a) {
        o_[a][at] = ray.origin[a];
        d_[a][at] = ray.direction[a];
      }
    }
  }

  const LinesInZone& lines_;
  const Dexels& dexels_;
  int firstRow_, firstColumn_, endColumn_;
  bool used_ = false;
  double o_[3][kBand * kStride] = {}, d_[3][kBand * kStride] = {};
  float from_[kBand * kStride], to_[kBand * kStride];
};

// Steps on the lines of a tile.
class TileReplay {
 public:
  TileReplay(Dexels& dexels, const Tile& tile) : changes_(dexels), tile_(tile) {}

  void apply(const HistoryStep& step, const LineRectangle& lines) {
    const bool asksAll = step.operation == DexelOperation::Intersection || !step.ball;
    for (int row = lines.firstRow; row < lines.endRow; ++row)
      if (asksAll)
        for (int column = lines.firstColumn; column < lines.endColumn; ++column) applyTo(step, column, row);
      else
        applyBall(step, row, lines.firstColumn, lines.endColumn);
  }

 private:
  void applyTo(const HistoryStep& step, int column, int row) {
    const float from = tile_.from(column, row), to = tile_.to(column, row);
    if (!(from < to)) return;
    const std::size_t line = changes_.dexels().lineAt(column, row);
    onLine_(step, tile_.line(column, row), from, to,
            [&](const Stretch& stretch, const auto& normalAt) { changes_.apply(line, stretch, normalAt); });
  }

  void applyBall(const HistoryStep& step, int row, int begin, int end) {
    const Sphere& ball = *step.ball;
    const double r = static_cast<double>(ball.radius);
    const BallPlace place{static_cast<double>(ball.center.x), static_cast<double>(ball.center.y),
                          static_cast<double>(ball.center.z), r * r};
    const auto count = static_cast<std::size_t>(end - begin);
    changes_.kernels().ballOnLines(place, tile_.lanes(begin, row), count, enter_.data(), exit_.data());
    const bool fills = step.operation == DexelOperation::Union;
    const std::size_t first = changes_.dexels().lineAt(begin, row);
    for (std::uint64_t bits = changes_.changed(fills, first, enter_.data(), exit_.data(), count); bits != 0;
         bits &= bits - 1) {
      const auto i = static_cast<std::size_t>(std::countr_zero(bits));
      changes_.apply(first + i, {enter_[i], exit_[i], fills, step.id}, [&](bool exit) {
        // The kernel's depth before it was rounded.
        const Ray line = tile_.line(begin + static_cast<int>(i), row);
        const auto in = intersect(ball, line);
        const DVec3 n = outwardNormal(ball, line.at(exit ? in->exit : in->enter));
        return packNormal(Vec3(fills ? n : -n));
      });
    }
  }

  LineChanges changes_;
  const Tile& tile_;
  StepOnLine onLine_;
  std::array<float, kTile + kPadding> enter_, exit_;
};

std::vector<HistoryStep> stepsOf(const DexelHistory& history, std::span<const OperationId> ids) {
  std::vector<HistoryStep> steps;
  steps.reserve(ids.size());
  for (const OperationId id : ids) history.stepsOf(id, steps);
  return steps;
}

void replayBand(Dexels& dexels, const LinesInZone& lines, std::span<const PlacedStep> steps, int firstRow) {
  const int endRow = std::min(firstRow + kBand, lines.family.height);
  std::vector<PlacedStep> here;
  for (const PlacedStep& placed : steps)
    if (placed.lines.firstRow < endRow && placed.lines.endRow > firstRow) here.push_back(placed);
  if (here.empty()) return;
  for (int column = 0; column < lines.family.width; column += kTile) {
    const Tile tile(lines, dexels, firstRow, endRow, column);
    if (!tile.isUsed()) continue;
    TileReplay replay(dexels, tile);
    for (const PlacedStep& placed : here) {
      const LineRectangle part{
          std::max(placed.lines.firstColumn, column), std::min(placed.lines.endColumn, tile.endColumn()),
          std::max(placed.lines.firstRow, firstRow), std::min(placed.lines.endRow, endRow)};
      if (!part.empty()) replay.apply(placed.step, part);
    }
  }
}

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

void replayOn(Dexels& dexels, const DexelHistory& history, std::span<const OperationId> ids,
              const LinesInZone& lines, const Execution& execution) {
  RESTROKE_CHECK_EQ(dexels.lineCount(), lines.from.size());
  const FamilyRaster raster(lines.family);
  std::vector<PlacedStep> placed;
  for (const HistoryStep& step : stepsOf(history, ids)) {
    const LineRectangle rectangle = step.operation == DexelOperation::Intersection ? raster.whole()
                                    : step.ball                                    ? raster.of(*step.ball)
                                                : raster.of(step.solid->bounds());
    if (!rectangle.empty()) placed.push_back({step, rectangle});
  }
  const int bands = (lines.family.height + kBand - 1) / kBand;
  inArena(execution,
          [&] { tbb::parallel_for(0, bands, [&](int b) { replayBand(dexels, lines, placed, b * kBand); }); });
}

void closeAtBorders(Dexels& dexels, const LinesInZone& lines) {
  LineEnds ends;
  for (int row = 0; row < lines.family.height; ++row)
    for (int column = 0; column < lines.family.width; ++column) {
      const std::size_t line = dexels.lineAt(column, row);
      if (dexels.isEmpty(line)) continue;
      const Dexels::Hulls hulls = dexels.hulls();
      const bool first = hulls.enter[line] == lines.from[line], last = hulls.exit[line] == lines.to[line];
      if (!first && !last) continue;
      const Vec3 along(lines.family.line(column, row).direction);
      dexels.read(line, ends);
      if (first) {
        ends.front().normal = packNormal(-along);
        ends.front().outer = OperationId::None;
      }
      if (last) {
        ends.back().normal = packNormal(along);
        ends.back().outer = OperationId::None;
      }
      dexels.write(line, ends);
    }
}

Dexels replay(const DexelHistory& history, std::span<const OperationId> ids, const LinesInZone& lines,
              const Execution& execution) {
  Dexels out(lines.family.width, lines.family.height, {.operations = true});
  replayOn(out, history, ids, lines, execution);
  closeAtBorders(out, lines);
  return out;
}

Dexels replayPlainly(const DexelHistory& history, std::span<const OperationId> ids, const LinesInZone& lines,
                     const Execution& execution) {
  Dexels out(lines.family.width, lines.family.height, {.operations = true});
  const std::vector<HistoryStep> steps = stepsOf(history, ids);
  inArena(execution, [&] {
    tbb::parallel_for(0, lines.family.height, [&](int row) {
      StepOnLine onLine;
      LineEnds ends;
      for (int column = 0; column < lines.family.width; ++column) {
        const std::size_t line = out.lineAt(column, row);
        const float from = lines.from[line], to = lines.to[line];
        if (!(from < to)) continue;
        const Ray ray = lines.family.line(column, row);
        ends.clear();
        for (const HistoryStep& step : steps)
          onLine(step, ray, from, to, [&](const Stretch& s, const auto& normalAt) {
            changeLine(ends, {s.enter, s.exit, normalAt(false), normalAt(true)}, s.fills, s.id);
          });
        out.write(line, ends);
      }
    });
  });
  closeAtBorders(out, lines);
  return out;
}

}  // namespace restroke::points
