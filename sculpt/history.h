#pragma once
// The history tree with its strokes packed: all that is held in memory to undo, redo, branch and retarget
// (SPEC S5, S6).

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sculpt/command.h"

namespace restroke::sculpt {

/// Node 0 is the root (the base); the nodes of strokes are numbered from 1 in the order in which they were
/// recorded, and numbers never change.
enum class NodeId : std::uint32_t {};

/// The root of every tree: the base before the first stroke.
inline constexpr NodeId kRootNode{0};

/// What is kept of a stroke besides its places on the screen. Leaving something out is for measuring what it
/// costs: command() then gives 0 ms, or full pressure, for every point.
struct HistoryOptions {
  bool times = true;
  bool pressures = true;
};

/// What the node's stroke did when it was last applied.
struct NodeResult {
  std::uint32_t stamps = 0;  ///< primitives that it put on the list
  std::uint32_t misses = 0;  ///< input points whose rays missed the shape
};

/// The tree holds no shape: the state at the cursor is what the strokes on the path from the root make of the
/// base, in order. Strokes lie one behind the other in one append-only buffer; what is appended is never
/// rewritten.
///
/// Bytes: 24 a node; cameras (56 each) and brushes (32 each, a tip its parameters more) once while they recur
/// among the last kReuseWindow different ones; points as in retarget/stroke_codec.h. Buffers grow by an
/// eighth, so at most 12.5 % of them is unused.
class History {
 public:
  /// How many of the latest cameras and brushes are compared before another is stored.
  static constexpr std::size_t kReuseWindow = 16;

  explicit History(HistoryOptions options = {});

  /// Packs the command (a StrokeCommand or a FixedCommand; anything else is an InternalError) as a new child
  /// of the cursor, and moves the cursor there. A recorded outcome is kept with it. O(points).
  NodeId add(const Command& command, NodeResult result = {});
  /// Unpacks the command again, equal in every field that the options keep. Not for the root. O(points).
  [[nodiscard]] Command command(NodeId node) const;

  [[nodiscard]] NodeId cursor() const { return cursor_; }
  /// The root is its own parent.
  [[nodiscard]] NodeId parent(NodeId node) const;
  /// The child that redo goes to: the one last visited, else the oldest; the node itself when it has none.
  [[nodiscard]] NodeId redoTarget(NodeId node) const;
  /// Nodes, the root included. Node numbers are less than this.
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] NodeResult result(NodeId node) const;
  void setResult(NodeId node, NodeResult result);

  /// Moves the cursor; redo then goes back along the path on which it last came. O(1) for a step to the
  /// parent or to a child, else O(depth).
  void moveCursor(NodeId node);
  /// Nodes from below the root down to `node`, `node` included; empty for the root. O(depth).
  [[nodiscard]] std::vector<NodeId> pathTo(NodeId node) const;

  /// Bytes held, from the containers' real capacity (DESIGN invariant 11).
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Node {
    std::uint32_t parent = 0;
    std::uint32_t redo = 0;  // last visited child; 0 (which is no node's child) while there is none
    NodeResult result;
    std::uint64_t offset = 0;  // of its command in packed_; it ends where the next node's begins
  };
  static_assert(sizeof(Node) == 24);

  [[nodiscard]] std::span<const std::uint8_t> packed(NodeId node) const;

  HistoryOptions options_;
  NodeId cursor_ = kRootNode;
  std::vector<Node> nodes_;
  std::vector<Camera> cameras_;
  std::vector<Brush> brushes_;
  std::vector<implicit::Shape> shapes_;  // of fixed commands, those that are no spheres
  std::vector<std::uint8_t> packed_;
};

}  // namespace restroke::sculpt
