#pragma once
// The history with its strokes packed: all that is held in memory to undo, redo, branch and retarget (SPEC
// S5, S6, S8).

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sculpt/command.h"
#include "sculpt/history_tree.h"
#include "sculpt/original.h"

namespace restroke::sculpt {

/// What is wrong with an undo at the root, and with a redo at a node without children.
inline constexpr const char* kNothingToUndo =
    "undo: the cursor is at the root, but there must be a stroke to undo";
inline constexpr const char* kNothingToRedo =
    "redo: nothing lies ahead of the cursor, but there must be an undone stroke";

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

enum class NodeKind : std::uint8_t { Stroke, Fixed, Base, Transform };

/// What a stroke became, for methods whose result depends on the machine: used again while the shape before
/// it is the same.
struct KeptRecast {
  std::uint64_t shapeBefore = 0;  ///< hash of the list that it was cast on
  Recast recast;
};

/// A tree, and the command of every node. It holds no shape: the state at the cursor is what the commands on
/// the path from the root make of the base, in order. Commands lie one behind the other in one append-only
/// buffer; what is appended is never rewritten, and a copied node refers to the bytes of its source.
///
/// Bytes: 32 a node; cameras (56 each) and brushes (32 each, a tip its parameters more) once while they recur
/// among the last kReuseWindow different ones; points as in retarget/stroke_codec.h; bases, other volumes,
/// originals and recorded outcomes on top. Buffers grow by an eighth, so at most 12.5 % of them is unused.
class History {
 public:
  /// How many of the latest cameras and brushes are compared before another is stored.
  static constexpr std::size_t kReuseWindow = 16;

  explicit History(HistoryOptions options = {});

  [[nodiscard]] const HistoryTree& tree() const { return tree_; }

  /// Packs a command that is a node as a new child of the cursor, and moves the cursor there. Anything else
  /// is an InternalError. O(points).
  NodeId add(const Command& command, NodeResult result = {});
  /// Carries out a command that edits the tree or moves its cursor; anything else is an InternalError. Throws
  /// InputError, and then nothing has changed.
  void edit(const Command& command);
  /// Puts the tree back as it was: for edits whose consequences cannot be carried out. Nodes that were copied
  /// since are forgotten.
  void restoreTree(const HistoryTree& tree);

  /// Unpacks the command again, equal in every field that the options keep. Not for the root. O(points).
  [[nodiscard]] Command command(NodeId node) const;
  /// Not for the root.
  [[nodiscard]] NodeKind kind(NodeId node) const;
  /// Of a stroke. O(1).
  [[nodiscard]] retarget::Method method(NodeId node) const;

  // The tree's, for short.
  [[nodiscard]] NodeId cursor() const { return tree_.cursor(); }
  [[nodiscard]] NodeId parent(NodeId node) const { return tree_.parent(node); }
  [[nodiscard]] NodeId redoTarget(NodeId node) const { return tree_.redoTarget(node); }
  [[nodiscard]] std::size_t size() const { return tree_.size(); }
  [[nodiscard]] std::vector<NodeId> pathTo(NodeId node) const { return tree_.pathTo(node); }
  void moveCursor(NodeId node) { tree_.moveCursor(node); }

  [[nodiscard]] NodeResult result(NodeId node) const { return records_[indexOf(node)].result; }
  void setResult(NodeId node, NodeResult result) { records_[indexOf(node)].result = result; }

  /// Where the stroke was when it was first applied; null for methods that need no such thing.
  [[nodiscard]] std::shared_ptr<const Original> original(NodeId node) const;
  void setOriginal(NodeId node, std::shared_ptr<const Original> original);
  /// The latest of the node, where one is kept. O(stamps).
  [[nodiscard]] std::optional<KeptRecast> keptRecast(NodeId node) const;
  void keepRecast(const KeptRecast& kept);

  /// Bytes held, from the containers' real capacity (DESIGN invariant 11).
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Record {
    NodeResult result;
    std::uint64_t place = 0;  // of its command in packed_; its kind in the top byte
  };
  static_assert(sizeof(Record) == 16);
  template <class T>
  struct OfNode {
    NodeId node;
    T value;
  };

  struct PackedRecast {
    std::uint64_t shapeBefore = 0;
    std::vector<std::uint8_t> packed;
  };

  [[nodiscard]] std::span<const std::uint8_t> packed(NodeId node) const;  // to the buffer's end
  [[nodiscard]] const Brush& brush(NodeId node) const;
  void packStroke(const StrokeCommand& drawn, std::vector<std::uint8_t>& out);
  void packFixed(const FixedCommand& fixed, std::vector<std::uint8_t>& out);
  [[nodiscard]] StrokeCommand unpackStroke(std::span<const std::uint8_t> in) const;
  [[nodiscard]] FixedCommand unpackFixed(std::span<const std::uint8_t> in) const;

  HistoryOptions options_;
  HistoryTree tree_;
  std::vector<Record> records_;  // by node
  std::vector<Camera> cameras_;
  std::vector<Brush> brushes_;
  std::vector<implicit::Shape> shapes_;  // of bases, and of fixed commands those that are no spheres
  std::vector<std::uint8_t> packed_;
  std::vector<OfNode<std::shared_ptr<const Original>>> originals_;  // by node
  std::vector<OfNode<PackedRecast>> kept_;                          // by node
};

}  // namespace restroke::sculpt
