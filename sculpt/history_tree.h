#pragma once
// The shape of a history (SPEC S8; DESIGN invariant 7): which command follows which, which are cancelled, and
// where the cursor is. What the commands are is History's business.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace restroke::sculpt {

/// Node 0 is the root (the base); the commands that change the shape are numbered from 1 in the order in
/// which they were recorded or copied, and numbers never change.
enum class NodeId : std::uint32_t {};

/// The root of every tree: the base before the first stroke.
inline constexpr NodeId kRootNode{0};

[[nodiscard]] constexpr std::uint32_t indexOf(NodeId node) {
  return static_cast<std::uint32_t>(node);
}

/// What an edit takes along.
enum class Extent : std::uint8_t {
  Branch,  ///< the node and all that descends from it
  Single   ///< the node alone: its children go to its parent
};

/// 16 bytes a node. Every function that edits throws InputError, in one sentence, and then changes nothing.
class HistoryTree {
 public:
  HistoryTree();

  /// Nodes, the root included. Node numbers are less than this.
  [[nodiscard]] std::size_t size() const { return nodes_.size(); }
  [[nodiscard]] NodeId cursor() const { return cursor_; }
  /// The root is its own parent.
  [[nodiscard]] NodeId parent(NodeId node) const { return NodeId{at(node).parent}; }
  [[nodiscard]] bool isCancelled(NodeId node) const { return cancelled_[indexOf(node)]; }
  /// Child with the lowest number; the root where there is none.
  [[nodiscard]] NodeId firstChild(NodeId node) const { return NodeId{at(node).firstChild}; }
  /// The parent's child with the next higher number; the root where there is none.
  [[nodiscard]] NodeId nextSibling(NodeId node) const { return NodeId{at(node).nextSibling}; }
  /// The child that redo goes to: the one last visited, else the oldest (lowest number); the node itself when
  /// it has none.
  [[nodiscard]] NodeId redoTarget(NodeId node) const;
  /// Nodes from below the root down to `node`, `node` included; empty for the root. O(depth).
  [[nodiscard]] std::vector<NodeId> pathTo(NodeId node) const;
  /// `node` itself or what descends from it. O(depth).
  [[nodiscard]] bool isInBranch(NodeId node, NodeId branch) const;
  /// The branch's nodes, parents before children, elder children first.
  [[nodiscard]] std::vector<NodeId> branch(NodeId node) const;

  /// A new child of the cursor, to which the cursor moves.
  NodeId add();
  /// Redo then goes back along the path on which the cursor last came. O(1) for a step to the parent or to a
  /// child, else O(depth). Refuses nodes that do not exist.
  void moveCursor(NodeId node);

  /// A cancelled node stays where it is and contributes nothing; what descends from it still does. Refuses
  /// the root, and what is cancelled already. Of a branch those that are not are cancelled, one at least.
  void cancel(NodeId node, Extent extent = Extent::Single);
  void restore(NodeId node, Extent extent = Extent::Single);
  /// Makes the node a child of `to`, ahead of the cursor: a cursor in what is moved goes to the former
  /// parent. Refuses the root, and going below itself.
  void move(NodeId node, NodeId to, Extent extent = Extent::Branch);
  /// Makes a copy of the node a child of `to`. Returns the nodes that were copied; the copies have the
  /// numbers from the former size() on, in this order. Cancelled nodes have cancelled copies.
  std::vector<NodeId> copy(NodeId node, NodeId to, Extent extent = Extent::Branch);

  [[nodiscard]] std::size_t bytes() const {
    return nodes_.capacity() * sizeof(Node) + cancelled_.capacity() / 8;
  }

 private:
  struct Node {
    std::uint32_t parent = 0;
    std::uint32_t firstChild = 0;   // 0, which is no node's child: none
    std::uint32_t nextSibling = 0;  // by number
    std::uint32_t lastVisited = 0;  // child
  };
  static_assert(sizeof(Node) == 16);

  [[nodiscard]] const Node& at(NodeId node) const { return nodes_[indexOf(node)]; }
  [[nodiscard]] Node& at(NodeId node) { return nodes_[indexOf(node)]; }
  void require(NodeId node, const char* verb) const;
  void requireNoRoot(NodeId node, const char* verb) const;
  void setCancelled(NodeId node, Extent extent, bool cancelled);
  void attach(NodeId node, NodeId parent);
  void detach(NodeId node);

  std::vector<Node> nodes_;
  std::vector<bool> cancelled_;
  NodeId cursor_ = kRootNode;
};

}  // namespace restroke::sculpt
