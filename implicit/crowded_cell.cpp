#include "implicit/crowded_cell.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace restroke::implicit {

namespace {

// A leaf with more than this is cut, where that helps.
constexpr std::size_t kLongLeaf = 64;
constexpr int kMaxDepth = 6;
// Cutting stops when the leaves list this many times what the cell does: primitives that all bound the same
// place cannot be told apart.
constexpr std::size_t kMaxListed = 4;

float greatestCoordinate(const Box& box) {
  float m = 0;
  for (int a = 0; a < 3; ++a) m = std::fmax(m, std::fmax(std::fabs(box.min[a]), std::fabs(box.max[a])));
  return m;
}

}  // namespace

struct CrowdedCell::Removal {
  std::uint32_t slot;
  std::span<const std::uint32_t> earlier;  // of the cell, in list order, up to the one that goes
  const ClusterMembers& members;
};

CrowdedCell::CrowdedCell(const Box& box, std::span<const std::uint32_t> slots, const ClusterMembers& members)
    : box_(box),
      pad_(1e-4f * (box.max.x - box.min.x) + 0x1p-15f * greatestCoordinate(box)),
      members_(slots.size()) {
  nodes_.emplace_back();
  fill(nodes_[0], box_, slots, members);
  listed_ = nodes_[0].slots.size();
  split(0, box_, members);
}

Box CrowdedCell::childOf(const Box& box, std::uint32_t i) {
  const Point middle = box.min + (box.max - box.min) * 0.5f;
  Box child;
  for (int a = 0; a < 3; ++a) {
    const bool upper = (i >> a & 1) != 0;
    child.min[a] = upper ? middle[a] : box.min[a];
    child.max[a] = upper ? box.max[a] : middle[a];
  }
  return child;
}

bool CrowdedCell::touches(std::uint32_t slot, const Box& box, const ClusterMembers& members) const {
  const Sphere& b = members.balls[slot];
  float d2 = 0;
  for (int a = 0; a < 3; ++a) {
    const float below = (box.min[a] - pad_) - b.center[a], above = b.center[a] - (box.max[a] + pad_);
    const float d = std::fmax(std::fmax(below, above), 0.0f);
    d2 += d * d;
  }
  return d2 <= b.radius * b.radius * 1.0001f;
}

bool CrowdedCell::covers(std::uint32_t slot, const Box& box, const ClusterMembers& members) const {
  if (members.isSphere[slot] == 0) return false;
  const Sphere& b = members.balls[slot];
  float d2 = 0;
  for (int a = 0; a < 3; ++a) {
    const float d = std::fmax(b.center[a] - box.min[a], box.max[a] - b.center[a]) + pad_;
    d2 += d * d;
  }
  return d2 <= b.radius * b.radius * 0.9999f;
}

// The leaf's list from `slots`, from the tail, up to the first that covers all.
void CrowdedCell::fill(Node& leaf, const Box& box, std::span<const std::uint32_t> slots,
                       const ClusterMembers& members) const {
  leaf.covered = false;
  for (std::size_t i = slots.size(); i-- > 0 && !leaf.covered;) {
    if (!touches(slots[i], box, members)) continue;
    leaf.slots.push_back(slots[i]);
    leaf.covered = covers(slots[i], box, members);
  }
  std::reverse(leaf.slots.begin(), leaf.slots.end());
}

void CrowdedCell::split(std::uint32_t node, const Box& box, const ClusterMembers& members) {
  if (nodes_[node].slots.size() <= kLongLeaf || nodes_[node].depth == kMaxDepth) return;
  std::vector<Node> children(8);
  std::size_t listed = 0;  // more than now
  for (std::uint32_t i = 0; i < 8; ++i) {
    children[i].depth = static_cast<std::uint8_t>(nodes_[node].depth + 1);
    fill(children[i], childOf(box, i), nodes_[node].slots, members);
    listed += children[i].slots.size();
  }
  listed -= nodes_[node].slots.size();
  if (listed_ + listed > kMaxListed * members_) return;
  listed_ += listed;
  const auto first = static_cast<std::uint32_t>(nodes_.size());
  nodes_[node].firstChild = first;
  nodes_[node].slots = {};
  for (Node& child : children) nodes_.push_back(std::move(child));
  for (std::uint32_t i = 0; i < 8; ++i) split(first + i, childOf(box, i), members);
}

void CrowdedCell::insert(std::uint32_t slot, const ClusterMembers& members) {
  ++members_;
  insertIn(0, box_, slot, members);
}

void CrowdedCell::insertIn(std::uint32_t node, const Box& box, std::uint32_t slot,
                           const ClusterMembers& members) {
  if (!touches(slot, box, members)) return;
  if (const std::uint32_t first = nodes_[node].firstChild; first != kLeaf) {
    for (std::uint32_t i = 0; i < 8; ++i) insertIn(first + i, childOf(box, i), slot, members);
    return;
  }
  Node& leaf = nodes_[node];
  const auto earlier = [&](std::uint32_t a, std::uint32_t b) {
    return members.labels[a] < members.labels[b];
  };
  auto place = std::upper_bound(leaf.slots.begin(), leaf.slots.end(), slot, earlier);
  if (place == leaf.slots.begin() && leaf.covered) return;
  if (covers(slot, box, members)) {
    listed_ -= static_cast<std::size_t>(place - leaf.slots.begin());
    place = leaf.slots.erase(leaf.slots.begin(), place);
    leaf.covered = true;
  }
  leaf.slots.insert(place, slot);
  ++listed_;
  // Looked at again when it has doubled, where cutting did not help before.
  const std::size_t n = leaf.slots.size();
  if (n > kLongLeaf && (n & (n - 1)) == 1) split(node, box, members);
}

void CrowdedCell::remove(std::uint32_t slot, std::span<const std::uint32_t> slots,
                         const ClusterMembers& members) {
  --members_;
  const auto end = std::partition_point(
      slots.begin(), slots.end(), [&](std::uint32_t s) { return members.labels[s] < members.labels[slot]; });
  removeIn(0, box_, {slot, slots.first(static_cast<std::size_t>(end - slots.begin())), members});
}

void CrowdedCell::removeIn(std::uint32_t node, const Box& box, const Removal& removal) {
  if (!touches(removal.slot, box, removal.members)) return;
  if (const std::uint32_t first = nodes_[node].firstChild; first != kLeaf) {
    for (std::uint32_t i = 0; i < 8; ++i) removeIn(first + i, childOf(box, i), removal);
    return;
  }
  Node& leaf = nodes_[node];
  const auto found = std::find(leaf.slots.begin(), leaf.slots.end(), removal.slot);
  if (found == leaf.slots.end()) return;  // it was hidden
  const bool wasCover = leaf.covered && found == leaf.slots.begin();
  leaf.slots.erase(found);
  --listed_;
  if (!wasCover) return;
  const std::vector<std::uint32_t> after = std::move(leaf.slots);
  leaf.slots = {};
  fill(leaf, box, removal.earlier, removal.members);
  listed_ += leaf.slots.size();
  leaf.slots.insert(leaf.slots.end(), after.begin(), after.end());
  split(node, box, removal.members);
}

std::size_t CrowdedCell::bytes() const {
  std::size_t bytes = sizeof(*this) + nodes_.capacity() * sizeof(Node);
  for (const Node& node : nodes_) bytes += node.slots.capacity() * sizeof(std::uint32_t);
  return bytes;
}

}  // namespace restroke::implicit
