// The volumetric rival (SPEC X1, X3): the shape is a tri-dexel model, and every step keeps the lines that it
// changed, as they were and as they became. Undo and redo put them back.
//
// Lines are as far apart as the log's surfels are: a line for each sample of a face that it meets squarely.

#include <cmath>
#include <memory>
#include <vector>

#include "experiments/backends/kinds.h"
#include "implicit/errors.h"
#include "points/dexel/tri_dexel.h"

namespace restroke::experiments {
namespace {

using points::DexelGrid;
using points::Dexels;
using points::LineEnds;
using points::OperationId;
using points::SpanEnd;
using points::TriDexel;

/// Names a line whatever the grid has grown to: the family, and how far the line is from the first grid's.
struct LineKey {
  std::int32_t column = 0, row = 0;
  std::uint32_t axis = 0;
};

/// A line before and after a step: so many ends each, one after the other among the step's.
struct LineChange {
  LineKey line;
  std::uint32_t before = 0, after = 0;
};

struct Delta {
  std::vector<LineChange> lines;
  std::vector<SpanEnd> ends;
  std::size_t primitives = 0;  // of the list after the step
};

class DexelDeltas final : public HistoryBackend {
 public:
  explicit DexelDeltas(const Start& start)
      : execution_(start.execution), primitives_(start.list.size()), model_(gridFor(start)) {
    start_ = model_.grid();
    model_.apply(start.list, OperationId::Initial, execution_);
  }

  [[nodiscard]] std::string_view name() const override { return "dexel-deltas"; }
  [[nodiscard]] std::string_view title() const override { return "Tri-dexel lines per stroke"; }
  [[nodiscard]] Abilities abilities() const override { return {}; }

  void apply(const Step& step) override {
    const auto added = step.list.subspan(primitives_);
    Box all, positive;
    for (const implicit::Primitive& primitive : added) {
      all.add(boundsOf(primitive.shape));
      if (primitive.sign == implicit::Sign::Positive) positive.add(boundsOf(primitive.shape));
    }
    model_.growTo(positive);
    std::array<std::vector<LineEnds>, 3> before;
    forLinesIn(all, [&](std::uint32_t axis, std::size_t line) {
      before[axis].emplace_back();
      model_.family(static_cast<int>(axis)).read(line, before[axis].back());
    });
    model_.apply(added, static_cast<OperationId>(primitives_), execution_);

    Delta delta{.lines = {}, .ends = {}, .primitives = step.list.size()};
    std::array<std::size_t, 3> next{};
    LineEnds after;
    forLinesIn(all, [&](std::uint32_t axis, std::size_t line) {
      const LineEnds& was = before[axis][next[axis]++];
      model_.family(static_cast<int>(axis)).read(line, after);
      if (after == was) return;
      delta.lines.push_back({keyOf(axis, line), static_cast<std::uint32_t>(was.size()),
                             static_cast<std::uint32_t>(after.size())});
      delta.ends.insert(delta.ends.end(), was.begin(), was.end());
      delta.ends.insert(delta.ends.end(), after.begin(), after.end());
    });
    // Cut to size: it never grows.
    delta.lines.shrink_to_fit();
    delta.ends.shrink_to_fit();
    deltas_.resize(cursor_++);
    deltas_.push_back(std::move(delta));
    primitives_ = step.list.size();
  }
  [[nodiscard]] bool canUndo() const override { return cursor_ > 0; }
  [[nodiscard]] bool canRedo() const override { return cursor_ < deltas_.size(); }
  void undo() override {
    if (!canUndo()) throw InputError("history: undo at the start; there must be a step to undo");
    --cursor_;
    restore(deltas_[cursor_], false);
    primitives_ = cursor_ == 0 ? startPrimitives_ : deltas_[cursor_ - 1].primitives;
  }
  void redo() override {
    if (!canRedo()) throw InputError("history: redo with nothing ahead; there must be a step to redo");
    restore(deltas_[cursor_], true);
    primitives_ = deltas_[cursor_++].primitives;
  }

  [[nodiscard]] std::uint64_t stateHash() const override { return model_.stateHash(); }
  [[nodiscard]] std::uint64_t hashOfShape(const ShapeView& shape) const override {
    TriDexel model(start_);
    Box positive;
    for (const implicit::Primitive& primitive : shape.list)
      if (primitive.sign == implicit::Sign::Positive) positive.add(boundsOf(primitive.shape));
    model.growTo(positive);
    model.apply(shape.list, OperationId::Initial, execution_);
    return model.stateHash();
  }
  [[nodiscard]] std::size_t bytes() const override {
    std::size_t total = deltas_.capacity() * sizeof(Delta);
    for (const Delta& delta : deltas_)
      total += delta.lines.capacity() * sizeof(LineChange) + delta.ends.capacity() * sizeof(SpanEnd);
    return total;
  }
  [[nodiscard]] std::size_t stateBytes() const override { return model_.bytes(); }

 private:
  static DexelGrid gridFor(const Start& start) {
    Box bounds;
    for (const implicit::Primitive& primitive : start.list) bounds.add(boundsOf(primitive.shape));
    return points::dexelGridFor(bounds, {.cell = 1 / std::sqrt(static_cast<double>(start.header.density))});
  }

  template <class F>
  void forLinesIn(const Box& box, const F& f) const {
    if (box.empty()) return;
    for (int axis = 0; axis < 3; ++axis) {
      const DexelGrid::Range columns = model_.grid().pointsIn((axis + 1) % 3, box),
                             rows = model_.grid().pointsIn((axis + 2) % 3, box);
      for (int row = rows.begin; row < rows.end; ++row)
        for (int column = columns.begin; column < columns.end; ++column)
          f(static_cast<std::uint32_t>(axis), model_.family(axis).lineAt(column, row));
    }
  }

  [[nodiscard]] LineKey keyOf(std::uint32_t axis, std::size_t line) const {
    const auto width = static_cast<std::size_t>(model_.family(static_cast<int>(axis)).width());
    const std::array<int, 3> first = model_.grid().parts().first;
    return {first[(axis + 1) % 3] + static_cast<std::int32_t>(line % width),
            first[(axis + 2) % 3] + static_cast<std::int32_t>(line / width), axis};
  }

  void restore(const Delta& delta, bool forwards) {
    const std::array<int, 3> first = model_.grid().parts().first;
    std::span<const SpanEnd> ends = delta.ends;
    for (const LineChange& change : delta.lines) {
      Dexels& dexels = model_.family(static_cast<int>(change.line.axis));
      const std::size_t line = dexels.lineAt(change.line.column - first[(change.line.axis + 1) % 3],
                                             change.line.row - first[(change.line.axis + 2) % 3]);
      dexels.write(line, forwards ? ends.subspan(change.before, change.after) : ends.first(change.before));
      ends = ends.subspan(change.before + change.after);
    }
  }

  Execution execution_;
  std::size_t primitives_;  // of the list at the cursor
  const std::size_t startPrimitives_ = primitives_;
  TriDexel model_;
  DexelGrid start_;
  std::vector<Delta> deltas_;
  std::size_t cursor_ = 0;
};

}  // namespace

std::unique_ptr<HistoryBackend> makeDexelDeltas(const Start& start) {
  return std::make_unique<DexelDeltas>(start);
}

}  // namespace restroke::experiments
