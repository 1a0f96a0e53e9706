#pragma once
// One stroke applied to the shape before it (SPEC S7): cast for the first time, found again where it was
// recorded, or retargeted from where it was. A pure function of the history and of the list before the
// stroke, but for what depends on the machine, which comes back to be recorded.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "implicit/execution.h"
#include "points/surfel_model.h"
#include "sculpt/base_chain.h"
#include "sculpt/history.h"
#include "sculpt/stroke_reads.h"

namespace restroke::sculpt {

/// What a node has put on the list.
struct PlacedNode {
  NodeId node = kRootNode;
  std::uint32_t count = 0;                  ///< primitives
  std::unique_ptr<StrokeReads> reads = {};  ///< null for fixed stamps
  Box readBounds = {};                      ///< the reads' bounds, at hand when many nodes are looked through
  void setReads(std::unique_ptr<StrokeReads> made) {
    reads = std::move(made);
    readBounds = reads->bounds();
  }
};

/// The state that a stroke is applied to.
struct StrokeSite {
  const points::SurfelModel& model;
  std::span<const PlacedNode> before;  ///< what stands on the list behind the base, in order
  std::size_t prefix = 1;              ///< primitives before the stroke, the base included
  const BaseHistory& base;
  float grid = 0x1p-16f;
  Execution execution = {};
  retarget::KeptDiscs* discs = nullptr;  ///< as in retarget::CasterInput
};

/// What may be used instead of casting anew.
struct Shortcuts {
  const StrokeReads* former = nullptr;  ///< casts of the same stroke that still hold; of methods that cast
  const Recast* recorded = nullptr;     ///< what the log says
  bool recompute = false;               ///< pass over the log's and the history's records
  bool keepTrail = false;               ///< give AppliedStroke::trail
};

struct AppliedStroke {
  StrokeOutcome outcome;
  retarget::Trail trail;  ///< with keepTrail: what was hit; empty where a recorded outcome was used
  std::unique_ptr<StrokeReads> reads;
  std::shared_ptr<const Original> original;  ///< made now; null otherwise
  std::optional<KeptRecast> kept;            ///< to be kept in the history
  bool isNew = false;                        ///< `kept` was made now, and is to be recorded
  std::string note;                          ///< one sentence where a method fell back to casting
};

/// Applies strokes of one history.
class Evaluation {
 public:
  Evaluation(const History& history, const BaseChains& bases) : history_(history), bases_(bases) {}
  /// `stroke` is the node's command. A node that is not in the history yet (kRootNode) is applied for the
  /// first time. Throws InputError where the method cannot be carried out.
  [[nodiscard]] AppliedStroke apply(NodeId node, const StrokeCommand& stroke, const StrokeSite& site,
                                    const Shortcuts& shortcuts = {}) const;

 private:
  [[nodiscard]] AppliedStroke cast(const StrokeCommand& stroke, const retarget::CasterInput& input,
                                   const StrokeSite& site, const Shortcuts& shortcuts) const;
  [[nodiscard]] AppliedStroke follow(NodeId node, const StrokeCommand& stroke, const StrokeSite& site,
                                     const Shortcuts& shortcuts) const;
  [[nodiscard]] AppliedStroke first(const StrokeCommand& stroke, const StrokeSite& site,
                                    const Shortcuts& shortcuts) const;
  [[nodiscard]] AppliedStroke recordedOrCast(NodeId node, const StrokeCommand& stroke, const StrokeSite& site,
                                             const Shortcuts& shortcuts) const;
  [[nodiscard]] AppliedStroke aligned(NodeId node, const StrokeCommand& stroke, const StrokeSite& site,
                                      const Shortcuts& shortcuts) const;

  const History& history_;
  const BaseChains& bases_;
};

}  // namespace restroke::sculpt
