#pragma once
// Which of a million boxes are near a place: made once, never changed.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "implicit/geometry/box.h"

namespace restroke::points {

/// A packed tree of boxes (I. Kamel, C. Faloutsos, On Packing R-trees, CIKM 1993): the boxes by orders of
/// magnitude of size, and those of one magnitude along a curve through their middles; each eight neighbours
/// make a node, each eight nodes one above it. Small boxes are so never in a node with large ones that are
/// near by, and no list grows where many boxes lie on each other. 8 bytes a box; O(n log n).
class BoxTree {
 public:
  /// Empty boxes are left out; coordinates of others are finite. At most 2^32 - 1 boxes (InternalError).
  explicit BoxTree(std::span<const Box> boxes);

  /// Calls f(i) for each box i of those in nodes that have a point in common with `box`: all that have one
  /// themselves, and some more. Each at most once, in no order that means anything.
  template <class F>
  void forEachNear(const Box& box, const F& f) const {
    if (!levels_.empty()) visit(levels_.size() - 1, {0, levels_.back().size()}, box, f);
  }
  [[nodiscard]] std::size_t bytes() const;

 private:
  static constexpr std::size_t kChildren = 8;
  using Range = std::array<std::size_t, 2>;  // first, and the one after the last

  [[nodiscard]] static bool touch(const Box& a, const Box& b) {
    return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y &&
           a.min.z <= b.max.z && b.min.z <= a.max.z;
  }
  template <class F>
  void visit(std::size_t level, Range nodes, const Box& box, const F& f) const {
    for (std::size_t n = nodes[0]; n < nodes[1]; ++n) {
      if (!touch(levels_[level][n], box)) continue;
      const std::size_t below = level == 0 ? order_.size() : levels_[level - 1].size();
      const Range children{kChildren * n, std::min(kChildren * (n + 1), below)};
      if (level == 0)
        for (std::size_t i = children[0]; i < children[1]; ++i) f(order_[i]);
      else
        visit(level - 1, children, box, f);
    }
  }

  std::vector<std::uint32_t> order_;
  std::vector<std::vector<Box>> levels_;  // from the boxes of eight up to those that are no more than eight
};

}  // namespace restroke::points
