#pragma once
// What a stroke log is made of (DESIGN invariants 7 and 8). One Command is one line.

#include <array>
#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include "implicit/primitive.h"
#include "retarget/method.h"
#include "retarget/stroke.h"
#include "sculpt/brush.h"
#include "sculpt/history_tree.h"

namespace restroke::sculpt {

/// First line of a log: all that its commands rest on.
struct LogHeader {
  int version = 1;
  std::string unit = "mm";  ///< mm, cm or m: what one model unit means in exports; changes no coordinate
  float density = 8000;     ///< samples per square model unit, finite, > 0
  float grid = 0x1p-16f;    ///< stamp centres are rounded to multiples of it (model units, a power of two)
  implicit::Shape base;     ///< the shape before the first stroke: one positive primitive
};

/// A stroke, as drawn. Re-projected whenever it is applied, from this input (SPEC S7).
struct StrokeCommand {
  retarget::Stroke stroke;
  Brush brush;
  retarget::Method method = retarget::Method::Exact;
  /// The recorded outcome, when the method is one whose result depends on the machine. Used by replay, remade
  /// by --recompute.
  std::optional<StrokeOutcome> outcome;
};

/// Primitives without input or camera (of a stamp list, or set by a script). They stay where they are.
struct FixedCommand {
  Mode mode = Mode::Add;
  std::vector<implicit::Sphere> stamps = {};
  std::vector<implicit::Shape> shapes = {};  ///< after the stamps: volumes of any other kind
  [[nodiscard]] std::size_t size() const { return stamps.size() + shapes.size(); }
};

/// What a stroke became when a command made it be cast anew, of methods whose result depends on the machine.
struct Recast {
  NodeId node = kRootNode;
  /// Of `depth` and `embree`.
  std::optional<StrokeOutcome> outcome = {};
  /// Of `aligned`: the camera that the stroke was cast from, and how much bigger things are there than where
  /// it was drawn.
  std::optional<Camera> camera = {};
  float scale = 1;
  bool operator==(const Recast&) const = default;
};

/// What may follow from a command beyond its own words: strokes cast anew. Made when the command is carried
/// out for the first time, and used by replay.
struct Consequences {
  std::vector<Recast> recasts = {};
};

/// Another base under all strokes before and after. A node of the tree.
struct BaseCommand : Consequences {
  implicit::Shape base;
};

/// The base moved, turned, scaled, sheared. A node of the tree. Numbers are float32, since that is what the
/// log holds.
struct TransformCommand : Consequences {
  std::array<float, 12> matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};  ///< 3 x 4, rows first; model units
};

struct UndoCommand : Consequences {};
struct RedoCommand : Consequences {};
struct GotoCommand : Consequences {
  NodeId node = kRootNode;
};
struct CancelCommand : Consequences {
  NodeId node = kRootNode;
  Extent extent = Extent::Single;
};
struct RestoreCommand : Consequences {
  NodeId node = kRootNode;
  Extent extent = Extent::Single;
};
struct MoveCommand : Consequences {
  NodeId node = kRootNode, to = kRootNode;
  Extent extent = Extent::Branch;
};
/// Copies lie ahead of the cursor until redone, so nothing else follows.
struct CopyCommand {
  NodeId node = kRootNode, to = kRootNode;
  Extent extent = Extent::Branch;
};

using Command =
    std::variant<StrokeCommand, FixedCommand, BaseCommand, TransformCommand, UndoCommand, RedoCommand,
                 GotoCommand, CancelCommand, RestoreCommand, MoveCommand, CopyCommand>;

/// Whether the command is a node of the tree: what changes the shape. The others edit the tree, or move its
/// cursor.
[[nodiscard]] inline bool isNode(const Command& command) {
  return std::holds_alternative<StrokeCommand>(command) || std::holds_alternative<FixedCommand>(command) ||
         std::holds_alternative<BaseCommand>(command) || std::holds_alternative<TransformCommand>(command);
}

/// What follows from the command; null where nothing can.
[[nodiscard]] Consequences* consequencesOf(Command& command);
[[nodiscard]] const Consequences* consequencesOf(const Command& command);

}  // namespace restroke::sculpt
