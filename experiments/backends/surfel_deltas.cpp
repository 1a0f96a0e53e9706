// Per-stroke deltas of the surfels: what went, with contents, and what came; plain, or compressed step by
// step. What point- and voxel-based editors keep to undo in order (SPEC X3).

#include "experiments/backends/kinds.h"
#include "experiments/backends/surfel_delta.h"
#include "implicit/errors.h"

namespace restroke::experiments {
namespace {

std::size_t bytesOf(const SurfelDelta& d) {
  return d.removedAt.capacity() * sizeof(std::uint32_t) +
         (d.removed.capacity() + d.added.capacity()) * sizeof(points::Surfel);
}
std::size_t bytesOf(const std::vector<char>& packed) {
  return packed.capacity();
}

/// How a delta is held between its steps.
struct Plain {
  using Held = SurfelDelta;
  static constexpr std::string_view kName = "surfel-deltas";
  static constexpr std::string_view kTitle = "Surfel deltas per stroke";
  static Held hold(SurfelDelta delta) { return delta; }
  // NOLINTNEXTLINE(bugprone-return-const-ref-from-parameter): what is held outlives the call
  static const SurfelDelta& get(const Held& held) { return held; }
};
struct Packed {
  using Held = std::vector<char>;
  static constexpr std::string_view kName = "surfel-deltas-zstd";
  static constexpr std::string_view kTitle = "Surfel deltas per stroke, zstd";
  static Held hold(const SurfelDelta& delta) { return compress(delta); }
  static SurfelDelta get(const Held& held) { return decompress(held); }
};

template <class Form>
class SurfelDeltas final : public HistoryBackend {
 public:
  explicit SurfelDeltas(const Start& start) : state_(start.surfels.begin(), start.surfels.end()) {}

  [[nodiscard]] std::string_view name() const override { return Form::kName; }
  [[nodiscard]] std::string_view title() const override { return Form::kTitle; }
  [[nodiscard]] Abilities abilities() const override { return {}; }

  void apply(const Step& step) override {
    deltas_.resize(cursor_);
    deltas_.push_back(Form::hold(difference(state_, step.surfels)));
    ++cursor_;
    state_.assign(step.surfels.begin(), step.surfels.end());
  }
  [[nodiscard]] bool canUndo() const override { return cursor_ > 0; }
  [[nodiscard]] bool canRedo() const override { return cursor_ < deltas_.size(); }
  void undo() override {
    if (!canUndo()) throw InputError("history: undo at the start; there must be a step to undo");
    applyBackward(Form::get(deltas_[--cursor_]), state_);
  }
  void redo() override {
    if (!canRedo()) throw InputError("history: redo with nothing ahead; there must be a step to redo");
    applyForward(Form::get(deltas_[cursor_++]), state_);
  }

  [[nodiscard]] std::uint64_t stateHash() const override { return hashOf(state_); }
  [[nodiscard]] std::size_t bytes() const override {
    std::size_t total = deltas_.capacity() * sizeof(typename Form::Held);
    for (const auto& held : deltas_) total += bytesOf(held);
    return total;
  }
  [[nodiscard]] std::size_t stateBytes() const override { return state_.capacity() * sizeof(points::Surfel); }

 private:
  std::vector<points::Surfel> state_;
  std::vector<typename Form::Held> deltas_;
  std::size_t cursor_ = 0;
};

}  // namespace

std::unique_ptr<HistoryBackend> makeSurfelDeltas(const Start& start) {
  return std::make_unique<SurfelDeltas<Plain>>(start);
}
std::unique_ptr<HistoryBackend> makeSurfelDeltasZstd(const Start& start) {
  return std::make_unique<SurfelDeltas<Packed>>(start);
}

}  // namespace restroke::experiments
