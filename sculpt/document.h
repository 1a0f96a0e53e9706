#pragma once
// A sculpture in memory: the history tree, the cursor in it, and the shape at the cursor (SPEC S5 to S8).

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "points/surfel_model.h"
#include "retarget/methods/kept_discs.h"
#include "sculpt/base_chain.h"
#include "sculpt/command.h"
#include "sculpt/evaluation.h"
#include "sculpt/history.h"

namespace restroke::sculpt {

struct DocumentOptions {
  /// Cast strokes anew where the log holds a recorded outcome, and compare the two.
  bool recompute = false;
  /// Put stamps on the list one at a time and keep the time that each took (stampSeconds()). The result is
  /// the same.
  bool timeStamps = false;
  /// Keep where each stroke met the shape (trailOf), for measuring.
  bool keepTrails = false;
  /// What the history keeps of strokes.
  HistoryOptions history = {};
};

/// What applying one command did.
struct CommandReport {
  NodeId node = kRootNode;  ///< the new node; for undo the one left, for redo and goto the one reached; else
                            ///< the one that was edited
  std::size_t primitivesAdded = 0;
  std::size_t primitivesRemoved = 0;
  std::size_t misses = 0;       ///< input points whose rays miss the shape, of strokes that were cast
  std::size_t pieces = 0;       ///< runs of the stroke between misses and jumps
  std::size_t retargeted = 0;   ///< strokes that stood on the list and were cast anew, in full or in part
  std::size_t changed = 0;      ///< of these: whose stamps became others
  double seconds = 0;           ///< wall time of casting and stamping
  bool outcomeDiffers = false;  ///< with recompute: a new outcome is not the recorded one
  /// Made now, by methods whose result depends on the machine: to be recorded with the command.
  std::vector<Recast> recasts = {};
  /// A sentence for each stroke whose method had to fall back to casting.
  std::vector<std::string> notes = {};
};

/// Cluster cells that suit a base: a fifth of its radius.
[[nodiscard]] implicit::ClusterOptions clustersFor(const LogHeader& header);

/// Keeps nothing but the history, the model of the shape at the cursor, and what each stroke on it read:
/// whatever undo, redo and branching need is made again from the strokes. When something before a stroke
/// changes, the stroke is cast anew from its original input if it read what has changed, and what follows it
/// in turn; the result is the one that a replay of everything gives (SPEC S7; DESIGN invariant 6).
class Document {
 public:
  /// Throws InputError when the header breaks a rule of sculpt/README.md.
  explicit Document(const LogHeader& header, DocumentOptions options = {}, const Execution& execution = {});

  /// Carries out one command, as replay does line by line (sculpt/README.md says what each does). Throws
  /// InputError, and then nothing has changed.
  CommandReport apply(const Command& command);

  [[nodiscard]] const LogHeader& header() const { return header_; }
  [[nodiscard]] const points::SurfelModel& model() const { return model_; }
  /// Nodes, cursor, and the strokes in compact form.
  [[nodiscard]] const History& history() const { return history_; }
  /// The base at the cursor.
  [[nodiscard]] const implicit::Shape& base() const { return base_.shape; }
  /// For each primitive of the list, in order, the history node that made it (0 is the base).
  [[nodiscard]] std::vector<std::uint32_t> nodeOfPrimitive() const;
  [[nodiscard]] bool canUndo() const { return history_.cursor() != kRootNode; }
  [[nodiscard]] bool canRedo() const { return history_.redoTarget(history_.cursor()) != history_.cursor(); }
  /// With timeStamps: wall time of each stamp's update of list, clusters and surfels, in order.
  [[nodiscard]] std::span<const float> stampSeconds() const { return stampSeconds_; }

  /// With keepTrails: where a stroke on the shape meets what is before it; null where it was not cast, but
  /// taken from a record.
  [[nodiscard]] const retarget::Trail* trailOf(NodeId node) const;
  /// The strokes on the path to the cursor that are not cancelled, in order, and how many primitives come
  /// before each.
  struct StrokePlaceOnList {
    NodeId node = kRootNode;
    std::size_t prefix = 1;
  };
  [[nodiscard]] std::vector<StrokePlaceOnList> strokesOnList() const;

  /// The definition that apply is held to: everything on the path to the cursor applied anew, in order, to an
  /// empty list, with nothing used of what stands on the list now.
  [[nodiscard]] points::SurfelModel replayedFromScratch() const;
  /// Bytes of what is kept to avoid casting: no part of history or model. O(strokes on the path).
  [[nodiscard]] std::size_t cacheBytes() const;

 private:
  struct Walk;

  // document.cpp: what happens at the end of the list.
  CommandReport addStroke(StrokeCommand stroke);
  CommandReport addFixed(const FixedCommand& fixed);
  CommandReport addBaseChange(const Command& command);
  CommandReport edit(const Command& command);
  void undoStep(CommandReport& report);
  void redoStep(const Consequences& recorded, CommandReport& report);
  AppliedStroke appendStroke(NodeId node, const StrokeCommand& stroke, const Recast* recorded,
                             CommandReport& report);
  void appendStamps(std::span<const implicit::Primitive> stamps);
  void place(NodeId node, std::size_t primitives, AppliedStroke& applied);
  void store(NodeId node, AppliedStroke& applied);
  [[nodiscard]] StrokeSite site(std::span<const PlacedNode> before, std::size_t prefix) const;
  [[nodiscard]] static const Recast* recastOf(NodeId node, const Consequences& recorded);
  static void noteRecast(NodeId node, const AppliedStroke& applied, const Recast* recorded,
                         CommandReport& report);

  // incremental_replay.cpp: what happens in its middle.
  void realizeOr(const HistoryTree& before, const Consequences& recorded, CommandReport& report);
  void realize(const Consequences& recorded, CommandReport& report);
  void realizeFromScratch();
  void changeBase(Walk& walk, const BaseChains::Base& base);
  void discard(Walk& walk, const PlacedNode& placed);
  void insertNode(Walk& walk, NodeId node);
  void keepNode(Walk& walk, PlacedNode placed);
  /// True when its primitives are others than before.
  bool applyInPlace(Walk& walk, PlacedNode& placed, const StrokeCommand& stroke);
  bool replacePrimitives(Walk& walk, PlacedNode& placed, std::span<const implicit::Primitive> primitives);
  [[nodiscard]] static std::string noteOf(NodeId node, const AppliedStroke& applied);

  LogHeader header_;
  DocumentOptions options_;
  Execution execution_;
  points::SurfelModel model_;
  History history_;
  BaseChains chains_;
  BaseChains::Base base_;
  // For strokes cast by `embree`; a pointer, so that documents can be moved.
  std::unique_ptr<retarget::KeptDiscs> discs_ = std::make_unique<retarget::KeptDiscs>();
  std::vector<PlacedNode> placed_;  // behind the base, in list order
  std::vector<float> stampSeconds_;
  std::map<NodeId, retarget::Trail> trails_;  // with keepTrails
};

/// Throws InputError (`where` begins the sentence) unless every field is in its range.
void validate(const LogHeader& header, const std::string& where);

/// The stamps as signed primitives.
[[nodiscard]] std::vector<implicit::Primitive> primitivesOf(const FixedCommand& fixed);

}  // namespace restroke::sculpt
