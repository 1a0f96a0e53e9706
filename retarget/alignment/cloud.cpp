#include "retarget/alignment/cloud.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

namespace restroke::retarget::alignment {

namespace {

/// SplitMix64 (Steele, Lea, Flood: Fast splittable pseudorandom number generators, 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  /// Below `bound`, which is far below 2^32.
  std::size_t below(std::size_t bound) { return static_cast<std::size_t>(((next() >> 32) * bound) >> 32); }

 private:
  std::uint64_t next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ull);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

using Order = std::vector<std::uint32_t>;

/// Moves to the front of `order` the first point of each cell of a grid, with cells of such a size that there
/// are at most about `limit` of them, and returns their number. Both parts keep their order.
std::size_t spreadFirst(std::span<const OrientedPoint> points, Order& order, std::size_t limit) {
  if (order.size() <= limit) return order.size();
  Box box;
  for (const std::uint32_t i : order) box.add({points[i].position, points[i].position});
  const DVec3 low(box.min), size = DVec3(box.max) - low;
  // Of a surface of about the box's area.
  const double area = 2 * (size.x * size.y + size.y * size.z + size.z * size.x);
  double cell = std::sqrt(area / static_cast<double>(limit));
  if (!(cell > 0)) return std::min<std::size_t>(limit, order.size());  // all at one place or on a line
  std::vector<std::pair<std::uint64_t, std::uint32_t>> cells(order.size());
  // The number of cells goes about with 1 / cell^2, so that a few rounds bring it near to the limit.
  for (int round = 0;; ++round) {
    constexpr double kMostCells = 2097151;  // on an axis: 21 bits
    cell = std::fmax(cell, std::fmax(size.x, std::fmax(size.y, size.z)) / kMostCells);
    for (std::uint32_t k = 0; k < order.size(); ++k) {
      const DVec3 at = (DVec3(points[order[k]].position) - low) / cell;
      const auto x = static_cast<std::uint64_t>(at.x), y = static_cast<std::uint64_t>(at.y),
                 z = static_cast<std::uint64_t>(at.z);
      cells[k] = {x << 42 | y << 21 | z, k};
    }
    std::sort(cells.begin(), cells.end());
    std::size_t count = 0;
    for (std::size_t k = 0; k < cells.size(); ++k)
      count += k == 0 || cells[k].first != cells[k - 1].first ? 1 : 0;
    const double excess = static_cast<double>(count) / static_cast<double>(limit);
    if (round == 5 || (excess <= 1 && (excess > 0.8 || round >= 3))) break;
    cell *= std::sqrt(excess) * 1.02;
  }
  std::vector<bool> isFirst(order.size(), false);
  for (std::size_t k = 0; k < cells.size(); ++k)
    if (k == 0 || cells[k].first != cells[k - 1].first) isFirst[cells[k].second] = true;
  Order firsts, others;
  for (std::size_t k = 0; k < order.size(); ++k) (isFirst[k] ? firsts : others).push_back(order[k]);
  const std::size_t count = firsts.size();
  firsts.insert(firsts.end(), others.begin(), others.end());
  order = std::move(firsts);
  return count;
}

}  // namespace

std::vector<std::uint32_t> drawn(std::size_t size, std::size_t count, std::uint64_t seed) {
  Order order(size);
  std::iota(order.begin(), order.end(), 0u);
  Random random(seed);
  count = std::min(count, size);
  for (std::size_t k = 0; k < count; ++k) std::swap(order[k], order[k + random.below(size - k)]);
  order.resize(count);
  return order;
}

Cloud cloudOf(std::span<const OrientedPoint> points, const CloudSizes& sizes, std::uint64_t seed) {
  Order order = drawn(points.size(), points.size(), seed);
  order.resize(spreadFirst(points, order, sizes.all));
  Cloud cloud;
  cloud.spread = spreadFirst(points, order, std::min(sizes.spread, (order.size() + 1) / 2));
  DVec3 sum{0};
  for (std::size_t k = 0; k < cloud.spread; ++k) sum += DVec3(points[order[k]].position);
  cloud.center = sum / static_cast<double>(cloud.spread);
  double squares = 0;
  for (std::size_t k = 0; k < cloud.spread; ++k) {
    const DVec3 d = DVec3(points[order[k]].position) - cloud.center;
    squares += dot(d, d);
  }
  cloud.radius = std::sqrt(squares / static_cast<double>(cloud.spread));
  if (!(cloud.radius > 0)) cloud.radius = 1;
  cloud.samples.reserve(order.size());
  for (const std::uint32_t i : order)
    cloud.samples.push_back(
        {(DVec3(points[i].position) - cloud.center) / cloud.radius, normalized(DVec3(points[i].normal))});
  return cloud;
}

}  // namespace restroke::retarget::alignment
