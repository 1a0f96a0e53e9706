#pragma once
// A sculpture in memory: the history tree, the cursor in it, and the shape at the cursor (SPEC S5, S6, S8).

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "points/surfel_model.h"
#include "sculpt/command.h"
#include "sculpt/history.h"

namespace restroke::sculpt {

struct DocumentOptions {
  /// Cast strokes anew where the log holds a recorded outcome, and compare the two.
  bool recompute = false;
  /// Put stamps on the list one at a time and keep the time that each took (stampSeconds()). The result is
  /// the same.
  bool timeStamps = false;
  /// What the history keeps of strokes.
  HistoryOptions history = {};
};

/// What applying one command did.
struct CommandReport {
  NodeId node = kRootNode;  ///< the stroke's node; for undo the one left, for redo the one reached
  std::size_t primitivesAdded = 0;
  std::size_t primitivesRemoved = 0;
  std::size_t misses = 0;       ///< input points whose rays miss the shape
  std::size_t pieces = 0;       ///< runs of the stroke between misses and jumps
  double seconds = 0;           ///< wall time of casting and stamping
  bool outcomeDiffers = false;  ///< with recompute: the new outcome is not the recorded one
};

/// What is wrong with an undo at the root, and with a redo at a node without children.
inline constexpr const char* kNothingToUndo =
    "undo: the cursor is at the root, but there must be a stroke to undo";
inline constexpr const char* kNothingToRedo =
    "redo: nothing lies ahead of the cursor, but there must be an undone stroke";

/// Cluster cells that suit a base: a fifth of its radius.
[[nodiscard]] implicit::ClusterOptions clustersFor(const LogHeader& header);

/// Keeps nothing but the history and the model of the shape at the cursor: whatever undo, redo and branching
/// need is made again from the strokes. A method whose result depends on the machine has its outcome kept in
/// the history when it is first cast, so that redo brings back the same stamps.
class Document {
 public:
  /// Throws InputError when the header breaks a rule of sculpt/README.md.
  explicit Document(const LogHeader& header, DocumentOptions options = {}, const Execution& execution = {});

  /// Carries out one command, as replay does line by line. A stroke or fixed stamps become a child of the
  /// cursor's node (also when nothing was hit: the node is there, without primitives); undo goes to the
  /// parent, redo to the child last visited. Throws InputError, and then nothing has changed: undo at the
  /// root, redo with nothing ahead, a stroke or stamp out of range.
  CommandReport apply(const Command& command);

  [[nodiscard]] const LogHeader& header() const { return header_; }
  [[nodiscard]] const points::SurfelModel& model() const { return model_; }
  /// Nodes, cursor, and the strokes in compact form.
  [[nodiscard]] const History& history() const { return history_; }
  /// For each primitive of the list, in order, the history node that made it (0 is the base).
  [[nodiscard]] std::vector<std::uint32_t> nodeOfPrimitive() const;
  [[nodiscard]] bool canUndo() const { return history_.cursor() != kRootNode; }
  [[nodiscard]] bool canRedo() const { return history_.redoTarget(history_.cursor()) != history_.cursor(); }
  /// With timeStamps: wall time of each stamp's update of list, clusters and surfels, in order.
  [[nodiscard]] std::span<const float> stampSeconds() const { return stampSeconds_; }

 private:
  CommandReport addStroke(StrokeCommand stroke);
  CommandReport addFixed(const FixedCommand& fixed);
  CommandReport undo();
  CommandReport redo();
  [[nodiscard]] StrokeOutcome castStroke(const StrokeCommand& stroke) const;
  void appendStamps(std::span<const implicit::Primitive> stamps);

  LogHeader header_;
  DocumentOptions options_;
  Execution execution_;
  points::SurfelModel model_;
  History history_;
  std::vector<float> stampSeconds_;
};

/// Throws InputError (`where` begins the sentence) unless every field is in its range.
void validate(const LogHeader& header, const std::string& where);

/// The stamps as signed primitives.
[[nodiscard]] std::vector<implicit::Primitive> primitivesOf(const FixedCommand& fixed);

}  // namespace restroke::sculpt
