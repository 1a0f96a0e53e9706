#include "points/dexel/refine/box_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "tests/support/brute_force.h"

namespace restroke::points {
namespace {

using restroke::testing::Random;

bool touch(const Box& a, const Box& b) {
  for (int k = 0; k < 3; ++k)
    if (a.min[k] > b.max[k] || b.min[k] > a.max[k]) return false;
  return true;
}

std::vector<std::uint32_t> near(const BoxTree& tree, const Box& box) {
  std::vector<std::uint32_t> found;
  tree.forEachNear(box, [&](std::uint32_t i) { found.push_back(i); });
  std::sort(found.begin(), found.end());
  return found;
}

// None is missed, none is given twice, and of the others few are given.
void expectFinds(const std::vector<Box>& boxes, const Box& asked, std::size_t mostOthers) {
  const auto found = near(BoxTree(boxes), asked);
  EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
  std::size_t touching = 0;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].empty() || !touch(boxes[i], asked)) continue;
    ++touching;
    ASSERT_TRUE(std::binary_search(found.begin(), found.end(), i)) << "box " << i;
  }
  EXPECT_LE(found.size(), touching + mostOthers);
}

TEST(BoxTree, FindsAllThatTouchAndFewOthersWhateverTheSizes) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    SCOPED_TRACE(seed);
    Random random(seed);
    std::vector<Box> boxes;
    const std::size_t count = 30'000;
    for (std::size_t i = 0; i < count; ++i) {
      // From 0.0003 to 0.3, as many of each order of magnitude.
      const float scale = std::array{0.0003f, 0.003f, 0.03f, 0.3f}[random.below(4)];
      const Point middle = random.inCube(1);
      const Vec3 half = Vec3(scale) * random.between(0.5f, 1.0f);
      boxes.push_back(random.below(50) == 0 ? Box{} : Box{middle - half, middle + half});
    }
    for (int k = 0; k < 5; ++k) {
      const Point at = random.inCube(1);
      expectFinds(boxes, {at, at}, count / 20);
      expectFinds(boxes, {at - Vec3(0.1f), at + Vec3(0.1f)}, count / 10);
    }
    expectFinds(boxes, {Point(-2), Point(2)}, 0);
    expectFinds(boxes, {Point(2), Point(3)}, 0);
  }
}

TEST(BoxTree, OfManyBoxesInOnePlaceTakesNoMoreMemory) {
  const std::vector<Box> boxes(5000, Box{Point(1), Point(2)});
  const BoxTree tree(boxes);
  EXPECT_EQ(near(tree, {Point(2), Point(5)}).size(), 5000u) << "faces belong to boxes";
  EXPECT_EQ(near(tree, {Point(2.5f), Point(5)}).size(), 0u);
  EXPECT_LE(tree.bytes(), 5000u * 8);
}

TEST(BoxTree, TakesPointsAndWhatIsAsLargeAsNumbersAre) {
  const float most = std::numeric_limits<float>::max();
  const std::vector<Box> boxes = {{Point(-most), Point(most)},
                                  {Point(1, 2, 3), Point(1, 2, 3)},
                                  {},
                                  {Point(most), Point(most)},
                                  {Point(-3, 0, 0), Point(-1, 0, 0)}};
  for (const Box& asked : {Box{Point(1, 2, 3), Point(1, 2, 3)}, Box{Point(-most), Point(most)},
                           Box{Point(-1, 0, 0), Point(0, 0, 0)}, Box{Point(most), Point(most)}})
    expectFinds(boxes, asked, boxes.size());
}

TEST(BoxTree, OfNothingFindsNothing) {
  for (const std::vector<Box>& boxes : {std::vector<Box>{}, std::vector<Box>(3)}) {
    const BoxTree tree(boxes);
    EXPECT_TRUE(near(tree, {Point(-1), Point(1)}).empty());
    EXPECT_TRUE(
        near(tree, {Point(-std::numeric_limits<float>::max()), Point(std::numeric_limits<float>::max())})
            .empty());
  }
}

}  // namespace
}  // namespace restroke::points
