#pragma once
// What every way of keeping a sculpture's history looks like to an experiment (DESIGN invariant 10).

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "implicit/execution.h"
#include "points/surfel.h"
#include "sculpt/command.h"

namespace restroke::experiments {

/// What the stored data suffices for.
struct Abilities {
  bool undoInOrder = true;    ///< the last step first, and redo
  bool undoAnywhere = false;  ///< take out one step in the middle; the later ones stay
  bool branch = false;        ///< keep what lies ahead when a new stroke is drawn after an undo
  bool retarget = false;      ///< apply a step again to another shape
  bool operator==(const Abilities&) const = default;
};

/// The shape before the first stroke. The spans need to live only during the call that they are passed to.
struct Start {
  const sculpt::LogHeader& header;
  std::span<const implicit::Primitive> list;  ///< the base
  std::span<const points::Surfel> surfels;
  Execution execution = {};
};

/// A shape: its list, and all its surfels.
struct ShapeView {
  std::span<const implicit::Primitive> list;
  std::span<const points::Surfel> surfels;
};

/// One stroke and the shape that it led to from the back end's current state. Back ends that keep strokes use
/// the command and make the shape themselves; those that keep shapes look at the shape only.
struct Step {
  const sculpt::Command& command;             ///< a StrokeCommand or a FixedCommand
  std::span<const implicit::Primitive> list;  ///< the whole list after the stroke
  std::span<const points::Surfel> surfels;    ///< all surfels after the stroke
};

/// A history with a cursor. Within a back end, the state after any walk of apply, undo and redo equals the
/// state that is built from scratch out of the strokes that lead to the cursor (tests/conformance).
class HistoryBackend {
 public:
  virtual ~HistoryBackend() = default;

  /// Short, unique, fit for a file: "strokes", "list-snapshots", ...
  [[nodiscard]] virtual std::string_view name() const = 0;
  /// One line for people.
  [[nodiscard]] virtual std::string_view title() const = 0;
  [[nodiscard]] virtual Abilities abilities() const = 0;

  /// Records a step at the cursor and moves there. A back end that cannot branch forgets what was ahead.
  virtual void apply(const Step& step) = 0;
  [[nodiscard]] virtual bool canUndo() const = 0;
  [[nodiscard]] virtual bool canRedo() const = 0;
  /// One step back. Throws InputError at the start.
  virtual void undo() = 0;
  /// One step ahead, the way that was last gone. Throws InputError with nothing ahead.
  virtual void redo() = 0;

  /// Hash of the state at the cursor, restored from what the back end holds.
  [[nodiscard]] virtual std::uint64_t stateHash() const = 0;
  /// The same of a shape that is given: of its surfels, where the back end does not hold shapes in another
  /// way.
  [[nodiscard]] virtual std::uint64_t hashOfShape(const ShapeView& shape) const;

  /// Bytes held for the history, from the containers' real capacity; the current shape is not part of it,
  /// except where it is itself one of the records (snapshots).
  [[nodiscard]] virtual std::size_t bytes() const = 0;
  /// Bytes of the current state that the back end holds besides: what any editor holds to show the shape at
  /// all.
  [[nodiscard]] virtual std::size_t stateBytes() const = 0;
  /// What the paper's arithmetic (experiments/paper_table.h) gives for the steps now held; nothing where it
  /// has none.
  [[nodiscard]] virtual std::optional<std::size_t> paperBytes() const { return std::nullopt; }
};

enum class BackendKind : std::uint8_t {
  Strokes,           ///< the project's way: strokes as drawn, packed, in a tree
  ListSnapshots,     ///< the whole primitive list after every step: the paper's rival
  SurfelSnapshots,   ///< all surfels after every step
  SurfelDeltas,      ///< per step, the surfels that went (with contents) and those that came
  SurfelDeltasZstd,  ///< the same, compressed step by step
  DexelDeltas        ///< a tri-dexel model; per step, the lines that changed, as they were and as they became
};
inline constexpr BackendKind kAllBackends[] = {BackendKind::Strokes,          BackendKind::ListSnapshots,
                                               BackendKind::SurfelSnapshots,  BackendKind::SurfelDeltas,
                                               BackendKind::SurfelDeltasZstd, BackendKind::DexelDeltas};

[[nodiscard]] std::unique_ptr<HistoryBackend> makeBackend(BackendKind kind, const Start& start);

/// XXH3 of the number of surfels and of every field of each (not of padding), in order.
[[nodiscard]] std::uint64_t hashOf(std::span<const points::Surfel> surfels);

}  // namespace restroke::experiments
