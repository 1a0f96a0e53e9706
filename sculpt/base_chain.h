#pragma once
// Which base a place in the history tree stands on: the last base on the path, and the transforms since.

#include <map>
#include <span>
#include <vector>

#include "sculpt/history.h"

namespace restroke::sculpt {

/// Bases by the nodes that made them. Shapes are made once and kept.
class BaseChains {
 public:
  explicit BaseChains(const implicit::Shape& header) : header_(header) {}

  struct Base {
    BaseHistory history;
    implicit::Shape shape;
  };
  /// The base at the end of a path (History::pathTo); cancelled nodes contribute nothing. Throws InputError
  /// when a transform cannot be carried out on the base that it meets. O(path), and making the shape once.
  [[nodiscard]] Base at(const History& history, std::span<const NodeId> path);
  /// The base as it was: its own node's shape, transformed by what it went through. Throws InputError.
  [[nodiscard]] implicit::Shape shapeOf(const History& history, const BaseHistory& base) const;

 private:
  implicit::Shape header_;
  std::map<std::vector<NodeId>, Base> known_;  // by the nodes on the path that change the base
};

}  // namespace restroke::sculpt
