#include "points/dexel/solid_tool.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

#include "implicit/parallel.h"
#include "points/dexel/line_changes.h"

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
        changes_(dexels_) {}

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
  // Ascending and apart from each other, with the solid's own normals.
  struct Span {
    float enter, exit;
    Vec3 enterNormal, exitNormal;
  };
  void findSpans(const SolidStep& step, int column, int row) {
    Ray line{DVec3(0), DVec3(0)};
    line.origin[u_] = static_cast<double>(grid_.at(u_, column));
    line.origin[v_] = static_cast<double>(grid_.at(v_, row));
    line.direction[axis_] = 1;
    found_.clear();
    step.solid->intersect(line, found_);
    spans_.clear();
    for (const SolidSpan& s : found_) {
      const auto enter = static_cast<float>(s.enter), exit = static_cast<float>(s.exit);
      if (!(enter < exit)) continue;
      if (spans_.empty() || spans_.back().exit < enter) {
        spans_.push_back({enter, exit, s.enterNormal, s.exitNormal});
      } else {
        spans_.back().exit = exit;
        spans_.back().exitNormal = s.exitNormal;
      }
    }
  }

  void change(const SolidStep& step, int column, int row) {
    const std::size_t line = dexels_.lineAt(column, row);
    const Box& box = step.solid->bounds();
    const float enter = changes_.hulls().enter[line], exit = changes_.hulls().exit[line];
    const bool fills = step.operation == DexelOperation::Union;
    // Nothing to cut, or nothing to add, wherever in its bounds the solid is.
    if (fills ? !dexels_.hasMore(line) && enter <= box.min[axis_] && box.max[axis_] <= exit
              : !(box.min[axis_] < exit && enter < box.max[axis_]))
      return;
    findSpans(step, column, row);
    for (const Span& s : spans_)
      changes_.apply(line, {s.enter, s.exit, fills, step.id}, [&](bool isExit) {
        const Vec3 n = isExit ? s.exitNormal : s.enterNormal;
        return packNormal(fills ? n : -n);
      });
  }

  void keep(const SolidStep& step, int column, int row, bool isMet) {
    const std::size_t line = dexels_.lineAt(column, row);
    if (dexels_.isEmpty(line)) return;
    spans_.clear();
    if (isMet) findSpans(step, column, row);
    kept_.clear();
    for (const Span& s : spans_)
      kept_.push_back({s.enter, s.exit, packNormal(s.enterNormal), packNormal(s.exitNormal)});
    dexels_.read(line, ends_);
    if (!applyToLine(ends_, kept_, DexelOperation::Intersection, step.id)) return;
    dexels_.write(line, ends_);
    if (dexels_.keepsHistory()) dexels_.noteChange(line, step.id);
  }

  const DexelGrid& grid_;
  int axis_, u_, v_;
  Dexels& dexels_;
  LineChanges changes_;
  std::vector<SolidSpan> found_;
  std::vector<Span> spans_;
  std::vector<ToolSpan> kept_;
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
