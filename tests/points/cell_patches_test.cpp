// The topology of a cell, tried for every cell and every reading of its faces.

#include "points/isosurface/cell_patches.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "implicit/geometry/vec.h"

namespace restroke::points {
namespace {

template <class F>
void forEveryReading(const F& f) {
  for (unsigned corners = 0; corners < 256; ++corners)
    for (unsigned joined = 0; joined < 64; ++joined) {
      const auto c = static_cast<std::uint8_t>(corners), j = static_cast<std::uint8_t>(joined);
      if ((j & ~ambiguousFacesOf(c)) == 0) f(c, j);
    }
}

bool isCrossed(std::uint8_t corners, int edge) {
  const int low = lowCornerOf(edge), high = low | 1 << edge / 4;
  return (corners >> low & 1) != (corners >> high & 1);
}

TEST(CellPatches, EveryCrossedEdgeAndNoOtherBelongsToAPatch) {
  int readings = 0;
  forEveryReading([&](std::uint8_t corners, std::uint8_t joined) {
    ++readings;
    const CellPatches patches = patchesOf(corners, joined);
    std::array<int, 4> edges{};
    for (int e = 0; e < 12; ++e) {
      const std::uint8_t patch = patches.ofEdge[static_cast<std::size_t>(e)];
      ASSERT_EQ(patch != kNoPatch, isCrossed(corners, e));
      if (patch == kNoPatch) continue;
      ASSERT_LT(patch, patches.count);
      ++edges[patch];
    }
    ASSERT_LE(patches.count, 4);
    for (std::uint8_t p = 0; p < patches.count; ++p) ASSERT_GE(edges[p], 3);
  });
  EXPECT_EQ(readings, 656);
}

TEST(CellPatches, SegmentsJoinEdgesOfTheSamePatchAndBothEndsAgree) {
  forEveryReading([&](std::uint8_t corners, std::uint8_t joined) {
    const CellPatches patches = patchesOf(corners, joined);
    for (std::uint8_t face = 0; face < 6; ++face)
      for (std::uint8_t e = 0; e < 12; ++e) {
        const int other = otherEnd(corners, joined, {face, e});
        if (other < 0) continue;
        EXPECT_NE(other, e);
        EXPECT_EQ(otherEnd(corners, joined, {face, static_cast<std::uint8_t>(other)}), e);
        EXPECT_EQ(patches.ofEdge[e], patches.ofEdge[static_cast<std::size_t>(other)]);
      }
  });
}

TEST(CellPatches, ACellWithOneCornerInsideHasOnePatchOfItsThreeEdges) {
  const CellPatches patches = patchesOf(0b1, 0);
  EXPECT_EQ(patches.count, 1);
  EXPECT_EQ(patches.ofEdge[0], 0);
  EXPECT_EQ(patches.ofEdge[4], 0);
  EXPECT_EQ(patches.ofEdge[8], 0);
  EXPECT_EQ(patches.doubleFaces, 0);
}

TEST(CellPatches, TwoCornersAcrossAFaceAreTwoPatchesOrOneThatIsThereTwice) {
  const std::uint8_t corners = 0b1001;  // of face 4, z = 0
  EXPECT_EQ(ambiguousFacesOf(corners), 1 << 4);
  EXPECT_EQ(patchesOf(corners, 0).count, 2);
  EXPECT_EQ(patchesOf(corners, 1 << 4).count, 1);
  EXPECT_EQ(patchesOf(corners, 1 << 4).doubleFaces, 1 << 4);
}

// The argument of DualMesh: whatever the crossings are, a plane stands between the convex hulls of any two
// patches of a cell. Its normal is looked for among small whole numbers, with the crossings anywhere but at
// the very ends.
TEST(CellPatches, APlaneSeparatesAnyTwoPatchesOfACellThatIsNotACheckerboard) {
  int pairs = 0, inseparable = 0;
  forEveryReading([&](std::uint8_t corners, std::uint8_t joined) {
    const CellPatches patches = patchesOf(corners, joined);
    const auto rangeAlong = [&](DVec3 normal, std::uint8_t patch) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      for (int e = 0; e < 12; ++e) {
        if (patches.ofEdge[static_cast<std::size_t>(e)] != patch) continue;
        for (const double t : {1.0 / 64, 63.0 / 64}) {
          const int c = lowCornerOf(e);
          DVec3 p(c & 1, c >> 1 & 1, c >> 2);
          p[e / 4] = t;
          low = std::min(low, dot(normal, p));
          high = std::max(high, dot(normal, p));
        }
      }
      return std::pair(low, high);
    };
    for (std::uint8_t p = 0; p < patches.count; ++p)
      for (std::uint8_t q = 0; q < p; ++q) {
        ++pairs;
        bool found = false;
        for (int n = 0; n < 125 && !found; ++n) {
          const DVec3 normal(n % 5 - 2, n / 5 % 5 - 2, n / 25 - 2);
          found = rangeAlong(normal, p).second < rangeAlong(normal, q).first;
        }
        if (found) continue;
        ++inseparable;
        EXPECT_TRUE(isCheckerboard(corners)) << int{corners} << " read as " << int{joined};
        EXPECT_NE(joined, 0);
      }
  });
  EXPECT_GT(pairs, 300);
  EXPECT_EQ(inseparable, 12);
}

}  // namespace
}  // namespace restroke::points
