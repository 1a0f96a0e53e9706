// Whole copies of the shape after every step: of the primitive list (the rival in the paper's Table 2, SPEC
// S12), and of the surfels (what a point-based editor without a list would keep).
//
// The copy of the state at the cursor is counted, as in the paper, and so is that of the start, without which
// the first step could not be undone. An editor that shares the copy at the cursor with its working shape
// would hold one copy less.

#include "experiments/backends/kinds.h"
#include "experiments/paper_table.h"
#include "implicit/errors.h"
#include "points/surfel_model.h"

namespace restroke::experiments {
namespace {

/// A row of states with a cursor. Records are cut to their size: a snapshot never grows.
template <class Record>
class SnapshotRow {
 public:
  explicit SnapshotRow(std::span<const Record> start) { rows_.emplace_back(start.begin(), start.end()); }

  void add(std::span<const Record> state) {
    rows_.resize(cursor_ + 1);
    rows_.emplace_back(state.begin(), state.end());
    ++cursor_;
  }
  [[nodiscard]] bool canUndo() const { return cursor_ > 0; }
  [[nodiscard]] bool canRedo() const { return cursor_ + 1 < rows_.size(); }
  void undo() {
    if (!canUndo()) throw InputError("history: undo at the start; there must be a step to undo");
    --cursor_;
  }
  void redo() {
    if (!canRedo()) throw InputError("history: redo with nothing ahead; there must be a step to redo");
    ++cursor_;
  }
  [[nodiscard]] const std::vector<Record>& current() const { return rows_[cursor_]; }
  [[nodiscard]] const std::vector<std::vector<Record>>& rows() const { return rows_; }
  [[nodiscard]] std::size_t bytes() const {
    std::size_t total = rows_.capacity() * sizeof(rows_[0]);
    for (const auto& row : rows_) total += row.capacity() * sizeof(Record);
    return total;
  }

 private:
  std::vector<std::vector<Record>> rows_;
  std::size_t cursor_ = 0;
};

class ListSnapshots final : public HistoryBackend {
 public:
  explicit ListSnapshots(const Start& start)
      : row_(start.list), sampling_{.density = start.header.density}, execution_(start.execution) {}

  [[nodiscard]] std::string_view name() const override { return "list-snapshots"; }
  [[nodiscard]] std::string_view title() const override { return "Snapshots of the primitive list"; }
  [[nodiscard]] Abilities abilities() const override { return {}; }

  void apply(const Step& step) override { row_.add(step.list); }
  [[nodiscard]] bool canUndo() const override { return row_.canUndo(); }
  [[nodiscard]] bool canRedo() const override { return row_.canRedo(); }
  void undo() override { row_.undo(); }
  void redo() override { row_.redo(); }

  [[nodiscard]] std::uint64_t stateHash() const override {
    points::SurfelModel model(sampling_);
    model.append(row_.current(), execution_);
    return hashOf(model.surfels(execution_));
  }
  [[nodiscard]] std::size_t bytes() const override { return row_.bytes(); }
  [[nodiscard]] std::size_t stateBytes() const override { return 0; }
  [[nodiscard]] std::optional<std::size_t> paperBytes() const override {
    // The paper counts neither the start nor the foundation that the strokes are drawn on.
    const std::size_t base = row_.rows().front().size();
    std::size_t total = 0;
    for (std::size_t i = 1; i < row_.rows().size(); ++i)
      total += paperSnapshotBytes(row_.rows()[i].size() - base);
    return total;
  }

 private:
  SnapshotRow<implicit::Primitive> row_;
  points::SamplingOptions sampling_;
  Execution execution_;
};

class SurfelSnapshots final : public HistoryBackend {
 public:
  explicit SurfelSnapshots(const Start& start) : row_(start.surfels) {}

  [[nodiscard]] std::string_view name() const override { return "surfel-snapshots"; }
  [[nodiscard]] std::string_view title() const override { return "Snapshots of all surfels"; }
  [[nodiscard]] Abilities abilities() const override { return {}; }

  void apply(const Step& step) override { row_.add(step.surfels); }
  [[nodiscard]] bool canUndo() const override { return row_.canUndo(); }
  [[nodiscard]] bool canRedo() const override { return row_.canRedo(); }
  void undo() override { row_.undo(); }
  void redo() override { row_.redo(); }

  [[nodiscard]] std::uint64_t stateHash() const override { return hashOf(row_.current()); }
  [[nodiscard]] std::size_t bytes() const override { return row_.bytes(); }
  [[nodiscard]] std::size_t stateBytes() const override { return 0; }

 private:
  SnapshotRow<points::Surfel> row_;
};

}  // namespace

std::unique_ptr<HistoryBackend> makeListSnapshots(const Start& start) {
  return std::make_unique<ListSnapshots>(start);
}
std::unique_ptr<HistoryBackend> makeSurfelSnapshots(const Start& start) {
  return std::make_unique<SurfelSnapshots>(start);
}

}  // namespace restroke::experiments
