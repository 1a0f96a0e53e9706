#include "implicit/crowded_cell.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "tests/support/brute_force.h"

namespace restroke::implicit {
namespace {

const Box kBox{Point(0), Point(1)};

struct Stamps {
  explicit Stamps(std::size_t count) {
    testing::Random random(23);
    for (std::size_t i = 0; i < count; ++i) {
      balls.push_back({Point(0.5f) + random.inCube(0.6f), random.between(0.1f, 0.4f)});
      labels.push_back(10 * (i + 1));
      isSphere.push_back(1);
      slots.push_back(static_cast<std::uint32_t>(i));
    }
  }
  [[nodiscard]] ClusterMembers members() const { return {labels, balls, isSphere}; }
  /// The last of the stamps in `among` that contains the point; none: the number of stamps.
  [[nodiscard]] std::size_t ownerOf(Point p, std::span<const std::uint32_t> among) const {
    for (std::size_t i = among.size(); i-- > 0;)
      if (contains(balls[among[i]], p)) return among[i];
    return balls.size();
  }
  std::vector<Sphere> balls;
  std::vector<std::uint64_t> labels;
  std::vector<std::uint8_t> isSphere;
  std::vector<std::uint32_t> slots;
};

/// Checks at random points that the leaves' lists are in order and name who decides; returns the mean length.
double meanLength(const CrowdedCell& cell, const Stamps& stamps, std::span<const std::uint32_t> in) {
  testing::Random random(29);
  std::size_t listed = 0;
  constexpr int kPoints = 2000;
  for (int i = 0; i < kPoints; ++i) {
    const Point p = Point(0.5f) + random.inCube(0.5f);
    std::vector<std::uint32_t> all;
    cell.forListsIn({p, p}, [&](std::span<const std::uint32_t> slots) {
      EXPECT_TRUE(std::is_sorted(slots.begin(), slots.end()));
      all.insert(all.end(), slots.begin(), slots.end());
    });
    std::sort(all.begin(), all.end());
    listed += all.size();
    EXPECT_EQ(stamps.ownerOf(p, all), stamps.ownerOf(p, in)) << i;
  }
  return static_cast<double>(listed) / kPoints;
}

TEST(CrowdedCell, NamesWhoDecidesInListsThatStayShort) {
  const Stamps stamps(3000);
  const std::span<const std::uint32_t> slots = stamps.slots;
  CrowdedCell cell(kBox, slots.first(600), stamps.members());
  EXPECT_LT(meanLength(cell, stamps, slots.first(600)), 100);
  for (std::size_t i = 600; i < slots.size(); ++i) cell.insert(slots[i], stamps.members());
  EXPECT_LT(meanLength(cell, stamps, slots), 100);
}

TEST(CrowdedCell, FindsAgainWhatARemovedOneHid) {
  const Stamps stamps(1500);
  std::vector<std::uint32_t> left = stamps.slots;
  CrowdedCell cell(kBox, left, stamps.members());
  testing::Random random(31);
  while (left.size() > 100) {
    // From the tail more often than not: these are the ones that cover.
    const std::size_t i =
        random.below(3) == 0 ? random.below(left.size()) : left.size() - 1 - random.below(20);
    const std::uint32_t gone = left[i];
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(i));
    cell.remove(gone, left, stamps.members());
    if (left.size() % 350 == 0) meanLength(cell, stamps, left);
  }
  meanLength(cell, stamps, left);
}

TEST(CrowdedCell, TakesInsertionsInTheMiddleOfTheList) {
  const Stamps stamps(1200);
  std::vector<std::uint32_t> even, all = stamps.slots;
  for (const std::uint32_t slot : all)
    if (slot % 2 == 0) even.push_back(slot);
  CrowdedCell cell(kBox, even, stamps.members());
  for (const std::uint32_t slot : all)
    if (slot % 2 == 1) cell.insert(slot, stamps.members());
  meanLength(cell, stamps, all);
}

TEST(CrowdedCell, IsBoundedWhereAllBoundTheSamePlace) {
  Stamps stamps(2000);
  std::fill(stamps.balls.begin(), stamps.balls.end(), Sphere{Point(0.5f), 0.4f});
  CrowdedCell cell(kBox, std::span(stamps.slots).first(600), stamps.members());
  for (std::size_t i = 600; i < 2000; ++i) cell.insert(stamps.slots[i], stamps.members());
  EXPECT_LT(cell.bytes(), std::size_t{2000} * 100);
  meanLength(cell, stamps, stamps.slots);
}

}  // namespace
}  // namespace restroke::implicit
