#pragma once
// What steps of a history do to one line, and what ends that leaves. Internal to points/dexel.

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "points/dexel/packed_normal.h"
#include "points/dexel/refine/history.h"
#include "points/dexel/refine/line_painter.h"
#include "points/dexel/span_end.h"

namespace restroke::points {

/// A line between two depths.
struct CutLine {
  Ray ray;  ///< of unit direction
  float from, to;
};

/// Asks steps where they are on lines. Keeps memory for the next one; one thread at a time.
class StepsOnLine {
 public:
  /// `steps` in order; `start` is what the line held before them.
  explicit StepsOnLine(std::span<const HistoryStep> steps) : steps_(steps) {}

  [[nodiscard]] static bool isStep(std::uint32_t owner) { return owner < LinePainter::kKnownEmpty; }
  [[nodiscard]] bool fills(std::uint32_t step) const {
    return steps_[step].operation == DexelOperation::Union;
  }
  [[nodiscard]] OperationId idOf(std::uint32_t owner) const {
    return isStep(owner) ? steps_[owner].id : OperationId::None;
  }
  [[nodiscard]] std::span<const HistoryStep> steps() const { return steps_; }

  /// Paints what the step decides of the line.
  void paint(std::uint32_t step, const CutLine& line, LinePainter& painter) {
    forStretches(step, line.ray, [&](double enter, double exit, auto) {
      const float first = std::max(static_cast<float>(enter), line.from),
                  last = std::min(static_cast<float>(exit), line.to);
      if (first < last) painter.paint(first, last, step);
    });
  }

  /// A stretch of the whole line that a step decides.
  struct Stretch {
    float enter, exit;
  };
  /// Appends them, ascending.
  void stretchesOf(std::uint32_t step, const Ray& line, std::vector<Stretch>& stretches) {
    forStretches(step, line, [&](double enter, double exit, auto) {
      stretches.push_back({static_cast<float>(enter), static_cast<float>(exit)});
    });
  }

  /// Where an owner gives way to another on a line, and the solid begins or ends.
  struct Border {
    float depth;
    std::uint32_t before, after;
    bool begins;
  };
  /// The normal of its end; at least one of the owners is a step.
  [[nodiscard]] PackedNormal normalAt(const Border& border, const Ray& line) {
    return normalAt({border.depth, border.before, !border.begins},
                    {border.depth, border.after, border.begins}, line, {});
  }

  /// The ends of a painted line; `start`: what the line held where no step has decided.
  void endsOf(const LinePainter& painter, const CutLine& line, const LineEnds& start, LineEnds& ends) {
    ends.clear();
    pieces_.clear();
    const auto& painted = painter.pieces();
    for (std::size_t i = 0; i < painted.size(); ++i) {
      const float end = i + 1 < painted.size() ? painted[i + 1].begin : painter.to();
      if (painted[i].owner == LinePainter::kUndecided && !start.empty())
        addStart(painted[i].begin, end, start);
      else
        pieces_.push_back({painted[i].begin, painted[i].owner, isSolid(painted[i].owner)});
    }
    const Vec3 along(line.ray.direction);
    for (std::size_t i = 0; i <= pieces_.size(); ++i) {
      const bool before = i > 0 && pieces_[i - 1].solid, after = i < pieces_.size() && pieces_[i].solid;
      if (before == after) continue;
      if (i == 0) {
        ends.push_back({line.from, packNormal(-along), idOf(pieces_[i].owner), OperationId::None});
      } else if (i == pieces_.size()) {
        ends.push_back({line.to, packNormal(along), idOf(pieces_[i - 1].owner), OperationId::None});
      } else {
        const Piece &inner = pieces_[before ? i - 1 : i], &outer = pieces_[before ? i : i - 1];
        ends.push_back({pieces_[i].begin, normalAt(pieces_[i - 1], pieces_[i], line.ray, start),
                        idOf(inner.owner), idOf(outer.owner)});
      }
    }
  }

 private:
  struct Piece {
    float begin;
    std::uint32_t owner;
    bool solid;
  };

  [[nodiscard]] bool isSolid(std::uint32_t owner) const {
    return isStep(owner) ? fills(owner) : owner == LinePainter::kKnownFull;
  }

  // Most lines of a solid's rectangle on the raster miss it: sweeps are long and thin.
  [[nodiscard]] static bool meets(const Ray& line, const Box& box) {
    double enter = -std::numeric_limits<double>::infinity(), exit = -enter;
    for (int a = 0; a < 3; ++a) {
      const double low = static_cast<double>(box.min[a]) - line.origin[a],
                   high = static_cast<double>(box.max[a]) - line.origin[a], rate = line.direction[a];
      if (rate == 0) {
        if (low > 0 || high < 0) return false;
        continue;
      }
      enter = std::max(enter, (rate > 0 ? low : high) / rate);
      exit = std::min(exit, (rate > 0 ? high : low) / rate);
    }
    return enter <= exit;
  }

  // spans_ become those of the step's solid. A solid with many of them makes many ends of a line: it is met
  // with the line once.
  void findSpans(std::uint32_t number, const Ray& line) {
    if (number == spansOf_ && line.origin == spansOn_.origin && line.direction == spansOn_.direction) return;
    const HistoryStep& step = steps_[number];
    spans_.clear();
    if (!step.ball) {
      if (meets(line, step.solid->bounds())) step.solid->intersect(line, spans_);
    } else if (const auto in = intersect(*step.ball, line)) {
      spans_.push_back({in->enter, in->exit, Vec3(outwardNormal(*step.ball, line.at(in->enter))),
                        Vec3(outwardNormal(*step.ball, line.at(in->exit)))});
    }
    spansOf_ = number;
    spansOn_ = line;
  }

  // Calls f(enter, exit, normalAt) for the stretches of the whole line that the step decides; normalAt(false)
  // is the solid's normal at the beginning, that of the model's surface there.
  template <class F>
  void forStretches(std::uint32_t number, const Ray& line, const F& f) {
    const HistoryStep& step = steps_[number];
    if (step.operation != DexelOperation::Intersection && step.ball) {
      const auto in = intersect(*step.ball, line);
      if (!in) return;
      const bool fills = step.operation == DexelOperation::Union;
      f(in->enter, in->exit, [&](bool exit) {
        const DVec3 n = outwardNormal(*step.ball, line.at(exit ? in->exit : in->enter));
        return packNormal(Vec3(fills ? n : -n));
      });
      return;
    }
    findSpans(number, line);
    if (step.operation != DexelOperation::Intersection) {
      const bool fills = step.operation == DexelOperation::Union;
      for (const SolidSpan& span : spans_)
        f(span.enter, span.exit, [&](bool exit) {
          const Vec3 n = exit ? span.exitNormal : span.enterNormal;
          return packNormal(fills ? n : -n);
        });
      return;
    }
    // What is between the spans is cleared.
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i <= spans_.size(); ++i)
      f(i == 0 ? -kInfinity : spans_[i - 1].exit, i == spans_.size() ? kInfinity : spans_[i].enter,
        [&](bool exit) { return packNormal(exit ? spans_[i].enterNormal : spans_[i - 1].exitNormal); });
  }

  // The start's spans between two depths, as pieces that no step has decided.
  void addStart(float begin, float end, const LineEnds& start) {
    std::size_t passed = 0;
    while (passed < start.size() && start[passed].depth <= begin) ++passed;
    pieces_.push_back({begin, LinePainter::kUndecided, passed % 2 == 1});
    for (; passed < start.size() && start[passed].depth < end; ++passed)
      pieces_.push_back({start[passed].depth, LinePainter::kUndecided, passed % 2 == 0});
  }

  // Between two pieces, one of them solid: the later owner made the border, where the second one begins.
  [[nodiscard]] PackedNormal normalAt(const Piece& before, const Piece& after, const Ray& line,
                                      const LineEnds& start) {
    const float depth = after.begin;
    const auto order = [](std::uint32_t owner) { return owner + 1; };  // undecided: 0
    if (order(before.owner) == 0 && order(after.owner) == 0) {
      for (const SpanEnd& end : start)
        if (end.depth == depth) return end.normal & ~kPackedFlag;
    }
    const bool begins = order(after.owner) > order(before.owner);
    const std::uint32_t owner = begins ? after.owner : before.owner;
    PackedNormal found = packNormal(Vec3((before.solid ? 1.0 : -1.0) * line.direction));
    if (!isStep(owner)) return found;
    forStretches(owner, line, [&](double enter, double exit, const auto& normal) {
      if (static_cast<float>(begins ? enter : exit) == depth) found = normal(!begins);
    });
    return steps_[owner].id == OperationId::Initial ? found : found | kPackedFlag;
  }

  std::span<const HistoryStep> steps_;
  std::vector<SolidSpan> spans_;  // of a step on a line
  std::uint32_t spansOf_ = LinePainter::kUndecided;
  Ray spansOn_;
  std::vector<Piece> pieces_;
};

}  // namespace restroke::points
