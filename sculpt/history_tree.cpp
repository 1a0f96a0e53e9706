#include "sculpt/history_tree.h"

#include <algorithm>

#include "implicit/errors.h"
#include "sculpt/lean_vector.h"

namespace restroke::sculpt {

HistoryTree::HistoryTree() {
  makeRoom(nodes_, 1);
  nodes_.push_back({});
  cancelled_.push_back(false);
}

void HistoryTree::require(NodeId node, const char* verb) const {
  if (indexOf(node) < nodes_.size()) return;
  throw InputError(fmt::format("{}: node {} does not exist, but must be one of 0 to {}", verb, indexOf(node),
                               nodes_.size() - 1));
}

void HistoryTree::requireNoRoot(NodeId node, const char* verb) const {
  require(node, verb);
  if (node == kRootNode)
    throw InputError(fmt::format(
        "{}: node 0 is the root, which is the base and no command, but a node from 1 on is needed", verb));
}

NodeId HistoryTree::redoTarget(NodeId node) const {
  if (at(node).lastVisited != 0) return NodeId{at(node).lastVisited};
  return at(node).firstChild != 0 ? firstChild(node) : node;
}

std::vector<NodeId> HistoryTree::pathTo(NodeId node) const {
  std::vector<NodeId> path;
  for (; node != kRootNode; node = parent(node)) path.push_back(node);
  std::reverse(path.begin(), path.end());
  return path;
}

bool HistoryTree::isInBranch(NodeId node, NodeId branch) const {
  for (;; node = parent(node)) {
    if (node == branch) return true;
    if (node == kRootNode) return false;
  }
}

std::vector<NodeId> HistoryTree::branch(NodeId node) const {
  std::vector<NodeId> nodes, open{node};
  while (!open.empty()) {
    const NodeId next = open.back();
    open.pop_back();
    nodes.push_back(next);
    const std::size_t first = open.size();
    for (NodeId child = firstChild(next); child != kRootNode; child = nextSibling(child))
      open.push_back(child);
    std::reverse(open.begin() + static_cast<std::ptrdiff_t>(first), open.end());
  }
  return nodes;
}

NodeId HistoryTree::add() {
  makeRoom(nodes_, 1);
  const NodeId node{static_cast<std::uint32_t>(nodes_.size())};
  nodes_.push_back({});
  cancelled_.push_back(false);
  attach(node, cursor_);
  at(cursor_).lastVisited = indexOf(node);
  cursor_ = node;
  return node;
}

void HistoryTree::moveCursor(NodeId node) {
  require(node, "goto");
  if (node != parent(cursor_)) {
    // Stops at the cursor: above it, the marks already lead here.
    for (NodeId below = node; below != kRootNode && below != cursor_; below = parent(below))
      at(parent(below)).lastVisited = indexOf(below);
  }
  cursor_ = node;
}

void HistoryTree::cancel(NodeId node, Extent extent) {
  requireNoRoot(node, "cancel");
  setCancelled(node, extent, true);
}

void HistoryTree::restore(NodeId node, Extent extent) {
  requireNoRoot(node, "restore");
  setCancelled(node, extent, false);
}

void HistoryTree::setCancelled(NodeId node, Extent extent, bool cancelled) {
  const std::vector<NodeId> nodes = extent == Extent::Branch ? branch(node) : std::vector<NodeId>{node};
  bool changes = false;
  for (const NodeId n : nodes) changes = changes || isCancelled(n) != cancelled;
  if (!changes)
    throw InputError(
        fmt::format("{}: node {}{} is {}", cancelled ? "cancel" : "restore", indexOf(node),
                    nodes.size() > 1 ? " with all that descends from it" : "",
                    cancelled ? "cancelled already, but must not be" : "not cancelled, but must be"));
  for (const NodeId n : nodes) cancelled_[indexOf(n)] = cancelled;
}

void HistoryTree::move(NodeId node, NodeId to, Extent extent) {
  requireNoRoot(node, "move");
  require(to, "move");
  if (extent == Extent::Branch && isInBranch(to, node))
    throw InputError(
        fmt::format("move: node {} lies in the branch of node {}, but a branch cannot hang from itself",
                    indexOf(to), indexOf(node)));
  if (node == to)
    throw InputError(fmt::format("move: node {} cannot become a child of itself", indexOf(node)));
  const NodeId former = parent(node);
  const bool takesCursor = extent == Extent::Branch ? isInBranch(cursor_, node) : cursor_ == node;
  if (takesCursor) cursor_ = former;
  const bool visited = at(former).lastVisited == indexOf(node);
  if (extent == Extent::Single) {
    const std::uint32_t next = at(node).lastVisited;
    while (at(node).firstChild != 0) {
      const NodeId child = firstChild(node);
      detach(child);
      attach(child, former);
    }
    if (visited) at(former).lastVisited = next;
    at(node).lastVisited = 0;
  } else if (visited) {
    at(former).lastVisited = 0;
  }
  detach(node);
  attach(node, to);
}

std::vector<NodeId> HistoryTree::copy(NodeId node, NodeId to, Extent extent) {
  requireNoRoot(node, "copy");
  require(to, "copy");
  std::vector<NodeId> sources = extent == Extent::Branch ? branch(node) : std::vector<NodeId>{node};
  makeRoom(nodes_, sources.size());
  const auto first = static_cast<std::uint32_t>(nodes_.size());
  for (const NodeId source : sources) {
    nodes_.push_back({});
    cancelled_.push_back(isCancelled(source));
  }
  std::vector<std::pair<NodeId, std::uint32_t>> copies;  // by source
  for (std::uint32_t i = 0; i < sources.size(); ++i) copies.emplace_back(sources[i], first + i);
  std::sort(copies.begin(), copies.end());
  for (std::uint32_t i = 0; i < sources.size(); ++i) {
    NodeId parentOfCopy = to;
    if (i > 0)
      parentOfCopy = NodeId{
          std::lower_bound(copies.begin(), copies.end(), std::pair(parent(sources[i]), std::uint32_t{0}))
              ->second};
    attach(NodeId{first + i}, parentOfCopy);
  }
  return sources;
}

void HistoryTree::attach(NodeId node, NodeId parent) {
  at(node).parent = indexOf(parent);
  std::uint32_t* link = &at(parent).firstChild;
  while (*link != 0 && *link < indexOf(node)) link = &nodes_[*link].nextSibling;
  at(node).nextSibling = *link;
  *link = indexOf(node);
}

void HistoryTree::detach(NodeId node) {
  std::uint32_t* link = &at(parent(node)).firstChild;
  while (*link != indexOf(node)) link = &nodes_[*link].nextSibling;
  *link = at(node).nextSibling;
  at(node).nextSibling = 0;
}

}  // namespace restroke::sculpt
