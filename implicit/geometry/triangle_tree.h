#pragma once
// A tree of boxes over the triangles of a mesh.

#include <cstdint>
#include <span>
#include <vector>

#include "implicit/geometry/box.h"
#include "implicit/geometry/triangle_mesh.h"

namespace restroke {

/// Boxes that halve the triangles again and again, by the median along the longest side. The same mesh gives
/// the same tree with every compiler: no decision depends on how a library orders equals. O(n log n) time,
/// O(n) memory; a mesh without triangles has no nodes.
class TriangleTree {
 public:
  static constexpr std::uint32_t kLeafTriangles = 8;

  /// Node 0 is the root. The left child of an inner node follows it, the right one is `right`.
  struct Node {
    Box box;                  ///< of the triangles below, not widened
    std::uint32_t first = 0;  ///< triangles below: order()[first .. first + count)
    std::uint32_t count = 0;
    std::uint32_t right = 0;  ///< 0: a leaf
  };

  /// The mesh's indices must be in range and its coordinates finite.
  explicit TriangleTree(const TriangleMesh& mesh);

  [[nodiscard]] std::span<const Node> nodes() const { return nodes_; }
  /// Triangles of the mesh in the order of the leaves, ascending within each leaf.
  [[nodiscard]] std::span<const std::uint32_t> order() const { return order_; }
  /// Box of triangle t of the mesh.
  [[nodiscard]] const Box& boxOf(std::uint32_t t) const { return boxes_[t]; }

  /// Calls f(t) for each triangle whose box has a point in common with `box`, faces included, in the order of
  /// the leaves.
  template <class F>
  void forEachTouching(const Box& box, const F& f) const {
    for (std::uint32_t n = 0; n < nodes_.size();) {
      const Node& node = nodes_[n];
      const bool touching = touch(node.box, box);
      if (touching && node.right == 0)
        for (const std::uint32_t t : std::span(order_).subspan(node.first, node.count))
          if (touch(boxes_[t], box)) f(t);
      n = touching ? n + 1 : skip_[n];
    }
  }

 private:
  [[nodiscard]] static bool touch(const Box& a, const Box& b) {
    return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y &&
           a.min.z <= b.max.z && b.min.z <= a.max.z;
  }
  void build(std::uint32_t first, std::uint32_t count);

  std::vector<Box> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> skip_;  ///< the node after the last one below each node
};

}  // namespace restroke
