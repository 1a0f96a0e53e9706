// The project's way (SPEC S5, S6): what the user drew, packed, in a tree. Shapes are made again by applying
// strokes.

#include "experiments/backends/kinds.h"
#include "experiments/paper_table.h"
#include "implicit/errors.h"
#include "sculpt/document.h"

namespace restroke::experiments {
namespace {

class Strokes final : public HistoryBackend {
 public:
  explicit Strokes(const Start& start)
      : execution_(start.execution), document_(start.header, {}, start.execution) {}

  [[nodiscard]] std::string_view name() const override { return "strokes"; }
  [[nodiscard]] std::string_view title() const override { return "Strokes as drawn (packed tree)"; }
  [[nodiscard]] Abilities abilities() const override {
    // Stamps that came without input or camera can be taken out and put back, but not cast onto another
    // shape.
    return {.undoInOrder = true, .undoAnywhere = true, .branch = true, .retarget = !anyFixed_};
  }

  void apply(const Step& step) override {
    const std::size_t before = document_.model().list().size();
    document_.apply(step.command);
    anyFixed_ = anyFixed_ || std::holds_alternative<sculpt::FixedCommand>(step.command);
    paperBytes_ += paperStrokeBytes(document_.model().list().size() - before);
  }
  [[nodiscard]] bool canUndo() const override { return document_.canUndo(); }
  [[nodiscard]] bool canRedo() const override { return document_.canRedo(); }
  void undo() override { document_.apply(sculpt::UndoCommand{}); }
  void redo() override { document_.apply(sculpt::RedoCommand{}); }

  [[nodiscard]] std::uint64_t stateHash() const override {
    return hashOf(document_.model().surfels(execution_));
  }
  [[nodiscard]] std::size_t bytes() const override { return document_.history().bytes(); }
  [[nodiscard]] std::size_t stateBytes() const override { return document_.model().bytes().total(); }
  [[nodiscard]] std::optional<std::size_t> paperBytes() const override { return paperBytes_; }

 private:
  Execution execution_;
  sculpt::Document document_;
  std::size_t paperBytes_ = 0;  // of every node of the tree: branches are kept
  bool anyFixed_ = false;
};

}  // namespace

std::unique_ptr<HistoryBackend> makeStrokes(const Start& start) {
  return std::make_unique<Strokes>(start);
}

}  // namespace restroke::experiments
