#include "points/dexel/tri_dexel.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <memory>
#include <vector>

#include "implicit/errors.h"
#include "implicit/parallel.h"
#include "points/dexel/line_changes.h"

namespace restroke::points {

namespace {

using implicit::Primitive;
using implicit::Shape;
using implicit::Sign;
using implicit::Sphere;

// Fewer lines than this are not worth waking other threads for.
constexpr double kFewLines = 20'000;
// Rows that one thread works on at a time: what they hold stays in its cache while primitives pass over them.
constexpr int kBand = 8;

constexpr std::size_t kLanes = LineChanges::kLanes;
constexpr float kInfinity = LineChanges::kInfinity;
constexpr std::uint32_t kNoMore = Dexels::kNoMore;

// One family's rows under a sequence of operations.
class FamilyRows {
 public:
  // `columns`: coordinates of the columns, and so many more as kernels may read.
  FamilyRows(const DexelGrid& grid, int axis, Dexels& dexels, std::span<const float> columns)
      : grid_(grid),
        axis_(axis),
        u_((axis + 1) % 3),
        v_((axis + 2) % 3),
        lines_(dexels),
        columns_(columns),
        perCell_(1 / grid.cell()) {}

  [[nodiscard]] Dexels& dexels() const { return lines_.dexels(); }
  [[nodiscard]] int height() const { return dexels().height(); }

  using Range = DexelGrid::Range;
  [[nodiscard]] Range rowsOf(const Box& box) const { return grid_.pointsIn(v_, box); }
  [[nodiscard]] Range columnsOf(const Box& box) const { return grid_.pointsIn(u_, box); }

  void apply(const Primitive& primitive, OperationId id, Range rows) {
    if (primitive.shape.isSphere())
      applyBall(primitive.shape.ball(), primitive.sign, id, rows);
    else
      applyVolume(*primitive.shape.volume(), primitive.sign, id, rows);
  }

  // Against the same lines of another solid.
  void apply(const Dexels& other, DexelOperation operation, OperationId id, int row) {
    const Dexels::ConstHulls tool = other.hulls();
    const std::size_t begin = dexels().lineAt(0, row),
                      end = begin + static_cast<std::size_t>(dexels().width());
    LineEnds toolEnds;
    for (std::size_t line = begin; line < end; line += kLanes) {
      const std::size_t count = std::min(kLanes, end - line);
      for (std::uint64_t bits = changed(operation, line, tool, count); bits != 0; bits &= bits - 1) {
        const std::size_t at = line + static_cast<std::size_t>(std::countr_zero(bits));
        if (tool.more[at] != kNoMore) {
          other.read(at, toolEnds);
          applyEnds(at, toolEnds, operation, id);
          continue;
        }
        const SpanEnd one[2] = {{tool.enter[at], tool.enterNormal[at]}, {tool.exit[at], tool.exitNormal[at]}};
        applyEnds(at, {one, one[0].depth < one[1].depth ? 2u : 0u}, operation, id);
      }
    }
  }

 private:
  // What applyToLine does, in place.
  void applyEnds(std::size_t line, std::span<const SpanEnd> tool, DexelOperation operation, OperationId id) {
    if (operation != DexelOperation::Intersection) {
      const bool fills = operation == DexelOperation::Union;
      for (std::size_t i = 0; i < tool.size(); i += 2)
        lines_.apply(line, {tool[i].depth, tool[i + 1].depth, fills, id}, [&](bool exit) {
          const PackedNormal own = tool[exit ? i + 1 : i].normal & ~kPackedFlag;
          return fills ? own : turnedAround(own);
        });
      return;
    }
    // What is between the tool's spans is cleared.
    for (std::size_t i = 0; i <= tool.size(); i += 2) {
      const float from = i == 0 ? -kInfinity : tool[i - 1].depth,
                  to = i == tool.size() ? kInfinity : tool[i].depth;
      // At infinity there is no end, and no normal.
      lines_.apply(line, {from, to, false, id}, [&](bool exit) -> PackedNormal {
        if (i == (exit ? tool.size() : 0)) return 0;
        return tool[exit ? i : i - 1].normal & ~kPackedFlag;
      });
    }
  }

  [[nodiscard]] std::uint64_t changed(DexelOperation operation, std::size_t line,
                                      const Dexels::ConstHulls& tool, std::size_t count) const {
    std::uint64_t bits = 0;
    if (operation != DexelOperation::Intersection) {
      bits = lines_.changed(operation == DexelOperation::Union, line, tool.enter + line, tool.exit + line,
                            count);
    } else {
      const Dexels::Hulls& own = lines_.hulls();
      for (std::size_t i = 0, at = line; i < count; ++i, ++at)
        if (own.enter[at] <= own.exit[at] &&
            !(tool.enter[at] <= own.enter[at] && tool.exit[at] >= own.exit[at] && own.more[at] == kNoMore))
          bits |= std::uint64_t{1} << i;
    }
    for (std::size_t i = 0; i < count; ++i)
      if (tool.more[line + i] != kNoMore) bits |= std::uint64_t{1} << i;
    return bits;
  }

  // The columns of one row that a ball meets.
  struct BallSegment {
    BallRow ball;
    int row, begin;
    std::size_t count;
    std::uint64_t changed;
  };
  static constexpr std::size_t kSegments = 16;

  void applyBall(const Sphere& ball, Sign sign, OperationId id, Range rows) {
    const double r = static_cast<double>(ball.radius), cu = static_cast<double>(ball.center[u_]),
                 cv = static_cast<double>(ball.center[v_]), cz = static_cast<double>(ball.center[axis_]);
    const float side = sign == Sign::Positive ? 1.0f : -1.0f;
    const Dexels::Hulls& hulls = lines_.hulls();
    std::array<BallSegment, kSegments> segments;
    std::size_t n = 0;
    for (int v = rows.begin; v < rows.end; ++v) {
      const double dv = static_cast<double>(grid_.at(v_, v)) - cv, square = r * r - dv * dv;
      if (!(square > 0)) continue;
      const double chord = std::sqrt(square);
      const int begin = firstColumnFrom(cu - chord), end = firstColumnFrom(cu + chord);
      for (int u = begin; u < end; u += static_cast<int>(kLanes)) {
        const std::size_t count = std::min(kLanes, static_cast<std::size_t>(end - u));
        segments[n++] = {{cu, cz, square, static_cast<float>(dv), side, axis_}, v, u, count, 0};
        const std::size_t line = dexels().lineAt(u, v);
        fetch(hulls.enter + line, count);
        fetch(hulls.exit + line, count);
        fetch(hulls.more + line, count);
        if (n == kSegments) {
          applySegments({segments.data(), n}, sign, id);
          n = 0;
        }
      }
    }
    applySegments({segments.data(), n}, sign, id);
  }

  // DexelGrid::firstFrom of the columns, from the coordinates at hand.
  [[nodiscard]] int firstColumnFrom(double coordinate) const {
    const double guess = std::ceil((coordinate - static_cast<double>(columns_[0])) * perCell_);
    int i = static_cast<int>(std::clamp(guess, 0.0, static_cast<double>(dexels().width())));
    const auto at = [&](int k) { return static_cast<double>(columns_[static_cast<std::size_t>(k)]); };
    while (i > 0 && at(i - 1) >= coordinate) --i;
    while (i < dexels().width() && at(i) < coordinate) ++i;
    return i;
  }

  // Asks for the memory of neighbouring lines, which is on its way while others are worked on: strokes jump
  // about on models that no cache holds.
  template <class T>
  static void fetch(const T* first, std::size_t count) {
    for (std::size_t i = 0; i < count; i += 64 / sizeof(T)) __builtin_prefetch(first + i, 1);
    __builtin_prefetch(first + count - 1, 1);
  }

  void applySegments(std::span<BallSegment> segments, Sign sign, OperationId id) {
    const bool fills = sign == Sign::Positive;
    const Dexels::Hulls& hulls = lines_.hulls();
    std::array<BallLanes, kSegments> lanes;
    for (std::size_t k = 0; k < segments.size(); ++k) {
      BallSegment& s = segments[k];
      const std::size_t line = dexels().lineAt(s.begin, s.row);
      lines_.kernels().ballRow(s.ball, columns_.data() + s.begin, s.count, lanes[k]);
      s.changed = lines_.changed(fills, line, lanes[k].enter, lanes[k].exit, s.count);
      if (s.changed == 0) continue;
      const auto from = static_cast<std::size_t>(std::countr_zero(s.changed)),
                 to = static_cast<std::size_t>(64 - std::countl_zero(s.changed));
      fetch(hulls.enterNormal + line + from, to - from);
      fetch(hulls.exitNormal + line + from, to - from);
      if (hulls.enterInner)
        for (const OperationId* of : {hulls.enterInner, hulls.enterOuter, hulls.exitInner, hulls.exitOuter})
          fetch(of + line + from, to - from);
      for (std::uint64_t bits = s.changed; bits != 0; bits &= bits - 1)
        dexels().fetchMore(line + static_cast<std::size_t>(std::countr_zero(bits)));
    }
    for (std::size_t k = 0; k < segments.size(); ++k) {
      const BallSegment& s = segments[k];
      const std::size_t line = dexels().lineAt(s.begin, s.row);
      for (std::uint64_t bits = s.changed; bits != 0; bits &= bits - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(bits));
        const auto normalAt = [&](bool exit) {
          return (exit ? lanes[k].exitNormal : lanes[k].enterNormal)[i];
        };
        lines_.apply(line + i, {lanes[k].enter[i], lanes[k].exit[i], fills, id}, normalAt);
      }
    }
  }

  void applyVolume(const implicit::PosedVolume& volume, Sign sign, OperationId id, Range rows) {
    const Range columns = columnsOf(volume.bounds());
    std::vector<RayInterval> intervals;
    const bool fills = sign == Sign::Positive;
    for (int v = rows.begin; v < rows.end; ++v)
      for (int u = columns.begin; u < columns.end; ++u) {
        DVec3 origin{0}, direction{0};
        origin[u_] = static_cast<double>(grid_.at(u_, u));
        origin[v_] = static_cast<double>(grid_.at(v_, v));
        direction[axis_] = 1;
        intervals.clear();
        const Ray ray{origin, direction};
        volume.intersect(ray, intervals);
        for (const RayInterval& in : intervals) {
          const auto normalAt = [&](bool exit) {
            const DVec3 n = volume.outwardNormal(ray.at(exit ? in.exit : in.enter));
            return packNormal(Vec3(fills ? n : -n));
          };
          const auto enter = static_cast<float>(in.enter), exit = static_cast<float>(in.exit);
          if (enter < exit) lines_.apply(dexels().lineAt(u, v), {enter, exit, fills, id}, normalAt);
        }
      }
  }

  const DexelGrid& grid_;
  int axis_, u_, v_;
  LineChanges lines_;
  std::span<const float> columns_;
  double perCell_;
};

}  // namespace

TriDexel::TriDexel(const DexelGrid& grid, Dexels::Options options) : grid_(grid) {
  for (int axis = 0; axis < 3; ++axis) family(axis) = Dexels(grid.width(axis), grid.height(axis), options);
  findCoordinates();
}

void TriDexel::findCoordinates() {
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    coordinates_[a].resize(static_cast<std::size_t>(grid_.counts()[a]) + kLanes);
    for (std::size_t i = 0; i < coordinates_[a].size(); ++i)
      coordinates_[a][i] = grid_.at(axis, static_cast<int>(i));
  }
}

void TriDexel::apply(std::span<const Primitive> primitives, OperationId first, const Execution& execution) {
  using Range = FamilyRows::Range;
  for (int axis = 0; axis < 3; ++axis) {
    FamilyRows rows(grid_, axis, family(axis), coordinates_[static_cast<std::size_t>((axis + 1) % 3)]);
    std::vector<Range> ranges;
    ranges.reserve(primitives.size());
    double lines = 0;
    for (const Primitive& primitive : primitives) {
      const Box box = boundsOf(primitive.shape);
      ranges.push_back(rows.rowsOf(box));
      const Range columns = rows.columnsOf(box);
      lines += static_cast<double>(ranges.back().end - ranges.back().begin) * (columns.end - columns.begin);
    }
    const auto band = [&](int begin, int end) {
      FamilyRows own = rows;
      for (std::size_t i = 0; i < primitives.size(); ++i) {
        const Range part{std::max(begin, ranges[i].begin), std::min(end, ranges[i].end)};
        if (part.begin < part.end)
          own.apply(primitives[i], static_cast<OperationId>(static_cast<std::uint32_t>(first) + i), part);
      }
    };
    if (lines < kFewLines) {
      band(0, rows.height());
      continue;
    }
    inArena(execution, [&] {
      const int bands = (rows.height() + kBand - 1) / kBand;
      tbb::parallel_for(0, bands, [&](int b) { band(b * kBand, std::min(rows.height(), (b + 1) * kBand)); });
    });
  }
}

void TriDexel::intersect(const Shape& shape, OperationId id, const Execution& execution) {
  TriDexel kept(grid_, {.operations = false});
  const Primitive primitive{shape, Sign::Positive};
  kept.apply({&primitive, 1}, OperationId::Initial, execution);
  apply(kept, DexelOperation::Intersection, id, execution);
}

void TriDexel::apply(const TriDexel& other, DexelOperation operation, OperationId id,
                     const Execution& execution) {
  RESTROKE_CHECK_EQ(grid_ == other.grid_, true);
  inArena(execution, [&] {
    for (int axis = 0; axis < 3; ++axis) {
      const FamilyRows rows(grid_, axis, family(axis),
                            coordinates_[static_cast<std::size_t>((axis + 1) % 3)]);
      const Dexels& tool = other.family(axis);
      tbb::parallel_for(tbb::blocked_range<int>(0, rows.height(), kBand),
                        [&](const tbb::blocked_range<int>& range) {
                          FamilyRows own = rows;
                          for (int row = range.begin(); row < range.end(); ++row)
                            own.apply(tool, operation, id, row);
                        });
    }
  });
}

void TriDexel::growTo(const Box& bounds) {
  GridCounts before;
  const DexelGrid grown = grid_.grownTo(bounds, before);
  if (grown == grid_) return;
  LineEnds ends;
  for (int axis = 0; axis < 3; ++axis) {
    Dexels old = std::move(family(axis));
    Dexels& fresh = family(axis) =
        Dexels(grown.width(axis), grown.height(axis), {old.keepsOperations(), old.keepsHistory()});
    const int right = before[static_cast<std::size_t>((axis + 1) % 3)],
              down = before[static_cast<std::size_t>((axis + 2) % 3)];
    for (int row = 0; row < old.height(); ++row)
      for (int column = 0; column < old.width(); ++column) {
        old.read(old.lineAt(column, row), ends);
        if (!ends.empty()) fresh.write(fresh.lineAt(column + right, row + down), ends);
      }
    if (old.keepsHistory()) fresh.takeHistory(old, right, down);
  }
  grid_ = grown;
  findCoordinates();
}

bool TriDexel::isInside(const GridCounts& point) const {
  int votes = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto u = static_cast<std::size_t>((axis + 1) % 3), v = static_cast<std::size_t>((axis + 2) % 3);
    const Dexels& dexels = family(axis);
    const bool beyond =
        point[u] < 0 || point[v] < 0 || point[u] >= dexels.width() || point[v] >= dexels.height();
    if (!beyond && dexels.contains(dexels.lineAt(point[u], point[v]),
                                   grid_.at(axis, point[static_cast<std::size_t>(axis)])))
      ++votes;
  }
  return votes >= 2;
}

double TriDexel::volumeOf(int axis) const {
  return family(axis).totalLength() * grid_.cell() * grid_.cell();
}

double TriDexel::volume() const {
  return (volumeOf(0) + volumeOf(1) + volumeOf(2)) / 3;
}

Box TriDexel::bounds() const {
  Box box;
  LineEnds ends;
  for (int axis = 0; axis < 3; ++axis) {
    const Dexels& dexels = family(axis);
    for (int row = 0; row < dexels.height(); ++row)
      for (int column = 0; column < dexels.width(); ++column) {
        dexels.read(dexels.lineAt(column, row), ends);
        if (ends.empty()) continue;
        Point p;
        p[(axis + 1) % 3] = grid_.at((axis + 1) % 3, column);
        p[(axis + 2) % 3] = grid_.at((axis + 2) % 3, row);
        for (const float depth : {ends.front().depth, ends.back().depth}) {
          p[axis] = depth;
          box.add({p, p});
        }
      }
  }
  return box;
}

std::size_t TriDexel::endCount() const {
  return family(0).endCount() + family(1).endCount() + family(2).endCount();
}

std::size_t TriDexel::bytes() const {
  std::size_t bytes = 0;
  for (const Dexels& dexels : families_) bytes += dexels.bytes();
  for (const auto& of : coordinates_) bytes += of.capacity() * sizeof(float);
  return bytes;
}

TriDexel::HistorySize TriDexel::historySize() const {
  HistorySize size;
  for (const Dexels& dexels : families_) {
    size.entries += dexels.histories().entryCount();
    size.bytes += dexels.histories().bytes();
  }
  return size;
}

std::uint64_t TriDexel::stateHash() const {
  // What is hashed as it lies in memory has no gaps.
  struct Key {
    std::int32_t column, row, axis, ends;
  };
  static_assert(sizeof(Key) == 16 && sizeof(SpanEnd) == 16);
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                              XXH3_freeState);
  const DexelGrid::Parts parts = grid_.parts();
  const double frame[4] = {parts.anchor.x, parts.anchor.y, parts.anchor.z, parts.cell};
  XXH3_64bits_reset(state.get());
  XXH3_64bits_update(state.get(), frame, sizeof frame);
  LineEnds ends;
  for (int axis = 0; axis < 3; ++axis) {
    const Dexels& dexels = family(axis);
    const int left = parts.first[static_cast<std::size_t>((axis + 1) % 3)],
              top = parts.first[static_cast<std::size_t>((axis + 2) % 3)];
    for (int row = 0; row < dexels.height(); ++row)
      for (int column = 0; column < dexels.width(); ++column) {
        dexels.read(dexels.lineAt(column, row), ends);
        if (ends.empty()) continue;
        const Key key{left + column, top + row, axis, static_cast<std::int32_t>(ends.size())};
        XXH3_64bits_update(state.get(), &key, sizeof key);
        XXH3_64bits_update(state.get(), ends.data(), ends.size() * sizeof(SpanEnd));
      }
  }
  return XXH3_64bits_digest(state.get());
}

TriDexel triDexelOf(const implicit::PrimitiveList& list, const DexelGrid& grid,
                    const ListDexelOptions& options, const Execution& execution) {
  std::vector<Primitive> primitives;
  const std::size_t count = std::min(options.prefix.count, list.size());
  primitives.reserve(count);
  for (std::size_t i = 0; i < count; ++i) primitives.push_back(list.at(i));
  TriDexel out(grid, options.lines);
  out.apply(primitives, OperationId::Initial, execution);
  return out;
}

}  // namespace restroke::points
