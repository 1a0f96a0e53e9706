#include "points/dexel/solid_tool.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "implicit/parallel.h"

namespace restroke::points {

namespace {

// Fewer lines than this are not worth waking other threads for.
constexpr double kFewLines = 4'000;
// Rows that one thread works on at a time.
constexpr int kBand = 8;

// The lines of one family under solids. Each thread has its own.
class FamilyUnderSolids {
 public:
  FamilyUnderSolids(TriDexel& model, int axis)
      : grid_(model.grid()),
        axis_(axis),
        u_((axis + 1) % 3),
        v_((axis + 2) % 3),
        dexels_(model.family(axis)),
        hulls_(dexels_.hulls()) {}

  [[nodiscard]] int height() const { return dexels_.height(); }
  using Range = DexelGrid::Range;
  [[nodiscard]] double linesUnder(const SolidStep& step) const {
    if (step.operation == DexelOperation::Intersection) return static_cast<double>(dexels_.lineCount());
    const Range rows = grid_.pointsIn(v_, step.solid->bounds()),
                columns = grid_.pointsIn(u_, step.solid->bounds());
    return static_cast<double>(rows.end - rows.begin) * (columns.end - columns.begin);
  }

  void apply(const SolidStep& step, int firstRow, int endRow) {
    const Box& box = step.solid->bounds();
    const Range rows = grid_.pointsIn(v_, box), columns = grid_.pointsIn(u_, box);
    const bool keeps = step.operation == DexelOperation::Intersection;
    const int begin = keeps ? firstRow : std::max(firstRow, rows.begin),
              end = keeps ? endRow : std::min(endRow, rows.end);
    for (int row = begin; row < end; ++row) {
      if (!keeps) {
        for (int column = columns.begin; column < columns.end; ++column) change(step, column, row);
        continue;
      }
      const bool isMet = row >= rows.begin && row < rows.end;
      for (int column = 0; column < dexels_.width(); ++column)
        keep(step, column, row, isMet && column >= columns.begin && column < columns.end);
    }
  }

 private:
  void findSpans(const SolidStep& step, int column, int row) {
    Ray line{DVec3(0), DVec3(0)};
    line.origin[u_] = static_cast<double>(grid_.at(u_, column));
    line.origin[v_] = static_cast<double>(grid_.at(v_, row));
    line.direction[axis_] = 1;
    solidSpans_.clear();
    step.solid->intersect(line, solidSpans_);
    spans_.clear();
    for (const SolidSpan& s : solidSpans_) {
      const ToolSpan span{static_cast<float>(s.enter), static_cast<float>(s.exit), packNormal(s.enterNormal),
                          packNormal(s.exitNormal)};
      if (!(span.enter < span.exit)) continue;
      if (!spans_.empty() && !(spans_.back().exit < span.enter)) {
        spans_.back().exit = span.exit;
        spans_.back().exitNormal = span.exitNormal;
      } else {
        spans_.push_back(span);
      }
    }
  }

  void change(const SolidStep& step, int column, int row) {
    const std::size_t line = dexels_.lineAt(column, row);
    const Box& box = step.solid->bounds();
    const float enter = hulls_.enter[line], exit = hulls_.exit[line];
    const bool fills = step.operation == DexelOperation::Union;
    // Nothing to cut, or nothing to add, wherever in its bounds the solid is.
    if (fills ? !dexels_.hasMore(line) && enter <= box.min[axis_] && box.max[axis_] <= exit
              : !(box.min[axis_] < exit && enter < box.max[axis_]))
      return;
    findSpans(step, column, row);
    for (const ToolSpan& s : spans_) {
      if (fills)
        dexels_.change(line, s, true, step.id);
      else if (s.enter < hulls_.exit[line] && hulls_.enter[line] < s.exit)
        dexels_.change(line, {s.enter, s.exit, turnedAround(s.enterNormal), turnedAround(s.exitNormal)},
                       false, step.id);
    }
  }

  void keep(const SolidStep& step, int column, int row, bool isMet) {
    const std::size_t line = dexels_.lineAt(column, row);
    if (dexels_.isEmpty(line)) return;
    spans_.clear();
    if (isMet) findSpans(step, column, row);
    dexels_.read(line, ends_);
    if (applyToLine(ends_, spans_, DexelOperation::Intersection, step.id)) dexels_.write(line, ends_);
  }

  const DexelGrid& grid_;
  int axis_, u_, v_;
  Dexels& dexels_;
  Dexels::Hulls hulls_;
  std::vector<SolidSpan> solidSpans_;
  std::vector<ToolSpan> spans_;
  LineEnds ends_;
};

}  // namespace

void apply(TriDexel& model, std::span<const SolidStep> steps, const Execution& execution) {
  for (int axis = 0; axis < 3; ++axis) {
    FamilyUnderSolids family(model, axis);
    double lines = 0;
    for (const SolidStep& step : steps) lines += family.linesUnder(step);
    if (lines < kFewLines) {
      for (const SolidStep& step : steps) family.apply(step, 0, family.height());
      continue;
    }
    inArena(execution, [&] {
      const int bands = (family.height() + kBand - 1) / kBand;
      tbb::parallel_for(0, bands, [&](int b) {
        FamilyUnderSolids own(model, axis);
        for (const SolidStep& step : steps)
          own.apply(step, b * kBand, std::min(own.height(), (b + 1) * kBand));
      });
    });
  }
}

}  // namespace restroke::points
