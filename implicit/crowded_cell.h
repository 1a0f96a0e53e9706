#pragma once
// A cell in whose place very many primitives lie on each other (SPEC S4).

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "implicit/geometry/box.h"
#include "implicit/shapes/sphere.h"

namespace restroke::implicit {

/// What clusters know of the primitives that they list, by slot.
struct ClusterMembers {
  std::span<const std::uint64_t> labels;   ///< grow with the place in the list
  std::span<const Sphere> balls;           ///< spheres themselves, or balls around volumes
  std::span<const std::uint8_t> isSphere;  ///< not 0: the ball is all of it
};

/// Cuts a cell into eighths, and those again, where many primitives meet. A leaf lists the last primitive
/// that covers all of it and those after that which touch it: of a point in the leaf no earlier one decides
/// the side, and no earlier one has a visible sample in it. So the lists stay short however often a place is
/// stamped. They serve the whole list; for a prefix, ask the cell's own list.
class CrowdedCell {
 public:
  /// `box` holds the cell; `slots` are the primitives that touch it, in list order.
  CrowdedCell(const Box& box, std::span<const std::uint32_t> slots, const ClusterMembers& members);

  /// Cost: the leaves that the primitive touches.
  void insert(std::uint32_t slot, const ClusterMembers& members);
  /// `slots` is the cell's list without it. Leaves that it covered look there for what it hid.
  void remove(std::uint32_t slot, std::span<const std::uint32_t> slots, const ClusterMembers& members);

  /// Calls f(slots) for the list of every leaf that meets the box.
  template <class F>
  void forListsIn(const Box& box, const F& f) const {
    visit(0, box_, box, f);
  }
  [[nodiscard]] std::size_t bytes() const;

 private:
  static constexpr std::uint32_t kLeaf = 0;
  struct Node {
    std::uint32_t firstChild = kLeaf;  // of eight
    std::uint8_t depth = 0;
    bool covered = false;  // the list begins with a primitive that covers all of it
    std::vector<std::uint32_t> slots;
  };
  [[nodiscard]] static Box childOf(const Box& box, std::uint32_t i);
  [[nodiscard]] static bool overlap(const Box& a, const Box& b) {
    return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y &&
           a.min.z <= b.max.z && b.min.z <= a.max.z;
  }
  template <class F>
  void visit(std::uint32_t node, const Box& box, const Box& query, const F& f) const {
    if (!overlap(box, query)) return;
    const Node& n = nodes_[node];
    if (n.firstChild == kLeaf) {
      if (!n.slots.empty()) f(std::span<const std::uint32_t>(n.slots));
      return;
    }
    for (std::uint32_t i = 0; i < 8; ++i) visit(n.firstChild + i, childOf(box, i), query, f);
  }
  [[nodiscard]] bool touches(std::uint32_t slot, const Box& box, const ClusterMembers& members) const;
  [[nodiscard]] bool covers(std::uint32_t slot, const Box& box, const ClusterMembers& members) const;
  void fill(Node& leaf, const Box& box, std::span<const std::uint32_t> slots,
            const ClusterMembers& members) const;
  void insertIn(std::uint32_t node, const Box& box, std::uint32_t slot, const ClusterMembers& members);
  struct Removal;
  void removeIn(std::uint32_t node, const Box& box, const Removal& removal);
  void split(std::uint32_t node, const Box& box, const ClusterMembers& members);

  Box box_;
  float pad_;               // added to boxes: more than rounding can move a sample or a verdict
  std::size_t members_;     // primitives in the cell
  std::size_t listed_ = 0;  // entries of all leaves
  std::vector<Node> nodes_;
};

}  // namespace restroke::implicit
