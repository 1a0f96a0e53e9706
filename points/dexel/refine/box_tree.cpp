#include "points/dexel/refine/box_tree.h"

#include <bit>
#include <limits>
#include <utility>

#include "implicit/errors.h"
#include "implicit/geometry/morton.h"

namespace restroke::points {

namespace {

// Magnitudes are powers of 4.
std::uint64_t magnitudeOf(const Box& box) {
  const Vec3 size = box.max - box.min;
  return std::bit_cast<std::uint32_t>(std::max(size.x, std::max(size.y, size.z))) >> 24;
}

// Cells along each axis of the curve, from -2^20 on.
constexpr double kCells = 0x1p21;

}  // namespace

BoxTree::BoxTree(std::span<const Box> boxes) {
  RESTROKE_CHECK_LT(boxes.size(), std::size_t{std::numeric_limits<std::uint32_t>::max()});
  Box hull;
  for (const Box& box : boxes)
    if (!box.empty()) hull.add(box);
  const DVec3 low(hull.min), size = DVec3(hull.max) - low;
  const double largest = std::max(size.x, std::max(size.y, size.z));
  const double scale = largest > 0 ? kCells / largest : 0;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
  keys.reserve(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const Box& box = boxes[i];
    if (box.empty()) continue;
    const DVec3 middle = ((DVec3(box.min) + DVec3(box.max)) * 0.5 - low) * scale - DVec3(kCells / 2);
    // Of the code's 63 bits those that matter most.
    keys.emplace_back(magnitudeOf(box) << 56 | implicit::mortonCode(Point(middle)) >> 7,
                      static_cast<std::uint32_t>(i));
  }
  std::sort(keys.begin(), keys.end());
  order_.reserve(keys.size());
  for (const auto& [key, i] : keys) order_.push_back(i);
  // Boxes of eight each, then of eight of these, until few are left.
  const auto addLevel = [&](std::size_t below, const auto& boxBelow) {
    std::vector<Box> nodes((below + kChildren - 1) / kChildren);
    for (std::size_t i = 0; i < below; ++i) nodes[i / kChildren].add(boxBelow(i));
    levels_.push_back(std::move(nodes));
  };
  if (order_.empty()) return;
  addLevel(order_.size(), [&](std::size_t i) -> const Box& { return boxes[order_[i]]; });
  while (levels_.back().size() > kChildren) {
    const std::size_t level = levels_.size() - 1;
    addLevel(levels_[level].size(), [&](std::size_t i) -> const Box& { return levels_[level][i]; });
  }
}

std::size_t BoxTree::bytes() const {
  std::size_t bytes = order_.capacity() * sizeof(std::uint32_t);
  for (const auto& level : levels_) bytes += level.capacity() * sizeof(Box);
  return bytes;
}

}  // namespace restroke::points
