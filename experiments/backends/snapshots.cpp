// Whole copies of the shape after every step: of the primitive list (the rival in the paper's Table 2, SPEC
// S12), and of the surfels (what a point-based editor without a list would keep).
//
// The copy of the state at the cursor is counted, as in the paper, and so is that of the start, without which
// the first step could not be undone. An editor that shares the copy at the cursor with its working shape
// would hold one copy less.

#include <map>
#include <memory>
#include <vector>

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

/// A primitive as an editor would store a list of them: spheres as they are, other volumes by reference,
/// since no snapshot changes them.
struct StoredPrimitive {
  implicit::Sphere ball;
  std::uint32_t signAndVolume = 0;  // bit 0: carves; the rest: 0, or 1 + the volume's place among those kept
};

class VolumeStore {
 public:
  [[nodiscard]] std::vector<StoredPrimitive> stored(std::span<const implicit::Primitive> list) {
    std::vector<StoredPrimitive> out;
    out.reserve(list.size());
    for (const implicit::Primitive& p : list) {
      std::uint32_t volume = 0;
      if (!p.shape.isSphere()) {
        const auto [place, isNew] =
            places_.try_emplace(p.shape.volume(), static_cast<std::uint32_t>(volumes_.size() + 1));
        if (isNew) volumes_.push_back(p.shape.sharedVolume());
        volume = place->second;
      }
      out.push_back({p.shape.ball(), volume << 1 | (p.sign == implicit::Sign::Negative ? 1u : 0u)});
    }
    return out;
  }
  [[nodiscard]] std::vector<implicit::Primitive> restored(const std::vector<StoredPrimitive>& row) const {
    std::vector<implicit::Primitive> out;
    out.reserve(row.size());
    for (const StoredPrimitive& p : row) {
      const auto sign = (p.signAndVolume & 1) != 0 ? implicit::Sign::Negative : implicit::Sign::Positive;
      const std::uint32_t volume = p.signAndVolume >> 1;
      out.push_back({volume == 0 ? implicit::Shape(p.ball) : implicit::Shape(volumes_[volume - 1]), sign});
    }
    return out;
  }
  /// The places are for storing quickly, and not counted to the rival.
  [[nodiscard]] std::size_t bytes() const {
    return volumes_.capacity() * sizeof(volumes_[0]) + volumes_.size() * sizeof(implicit::PosedVolume);
  }

 private:
  std::vector<std::shared_ptr<const implicit::PosedVolume>> volumes_;
  std::map<const implicit::PosedVolume*, std::uint32_t> places_;
};

class ListSnapshots final : public HistoryBackend {
 public:
  explicit ListSnapshots(const Start& start)
      : row_(volumes_.stored(start.list)),
        sampling_{.density = start.header.density},
        execution_(start.execution) {}

  [[nodiscard]] std::string_view name() const override { return "list-snapshots"; }
  [[nodiscard]] std::string_view title() const override { return "Snapshots of the primitive list"; }
  [[nodiscard]] Abilities abilities() const override { return {}; }

  void apply(const Step& step) override { row_.add(volumes_.stored(step.list)); }
  [[nodiscard]] bool canUndo() const override { return row_.canUndo(); }
  [[nodiscard]] bool canRedo() const override { return row_.canRedo(); }
  void undo() override { row_.undo(); }
  void redo() override { row_.redo(); }

  [[nodiscard]] std::uint64_t stateHash() const override {
    points::SurfelModel model(sampling_);
    model.append(volumes_.restored(row_.current()), execution_);
    return hashOf(model.surfels(execution_));
  }
  [[nodiscard]] std::size_t bytes() const override { return row_.bytes() + volumes_.bytes(); }
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
  VolumeStore volumes_;  // before the row, which is made through it
  SnapshotRow<StoredPrimitive> row_;
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
