// The tail-first test against the definition of the shape (SPEC S1, S2, S4).

#include "implicit/side.h"

#include <gtest/gtest.h>

#include "tests/support/brute_force.h"

namespace restroke::implicit {
namespace {

TEST(SideOf, EmptyListIsOutsideEverywhere) {
  const PrimitiveList list;
  EXPECT_EQ(sideOf(list, {0, 0, 0}), Side::Outside);
  std::vector<Side> sides(1);
  sidesOf(list, std::vector<Point>{{0, 0, 0}}, sides);
  EXPECT_EQ(sides[0], Side::Outside);
  sidesOf(list, {}, {});
}

TEST(SideOf, S1TheBoundaryBelongsToThePrimitive) {
  PrimitiveList list;
  list.append({{{0, 0, 0}, 1}, Sign::Positive});
  EXPECT_EQ(sideOf(list, {1, 0, 0}), Side::Inside);
  EXPECT_EQ(sideOf(list, {0, 1.0000001f, 0}), Side::Outside);
  list.append({{{2, 0, 0}, 1}, Sign::Negative});
  EXPECT_EQ(sideOf(list, {1, 0, 0}), Side::Outside);
}

TEST(SideOf, NaNIsOutside) {
  PrimitiveList list;
  list.append({{{0, 0, 0}, 1}, Sign::Positive});
  EXPECT_EQ(sideOf(list, {std::nanf(""), 0, 0}), Side::Outside);
}

TEST(SideOf, S4EqualsTheDefinitionOnAllPrefixesInScalarAndBatchAtEverySimdLevel) {
  const SimdLevel before = simdLevel();
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    testing::Random random(seed);
    std::vector<Primitive> plain{{{{0, 0, 0}, 1}, Sign::Positive}};
    for (int i = 0; i < 150; ++i) plain.push_back(testing::randomPrimitive(random, plain));
    PrimitiveList list;
    for (const Primitive& p : plain) list.append(p);
    std::vector<Point> points;
    for (int k = 0; k < 40; ++k) {  // neighbours, then strays, then points on boundaries
      const Point c = random.inCube(1.2f);
      for (int i = 0; i < 16; ++i) points.push_back(c + random.inCube(0.05f));
    }
    for (int k = 0; k < 300; ++k) points.push_back(random.inCube(1.5f));
    for (const Primitive& p : plain)
      points.push_back(p.shape.ball().center + Point(p.shape.ball().radius, 0, 0));
    points.push_back({std::nanf(""), 0, 0});
    points.push_back({1e30f, 0, 0});
    std::vector<Side> sides(points.size());
    for (const std::size_t prefix : {std::size_t{0}, std::size_t{1}, std::size_t{70}, plain.size()}) {
      for (const SimdLevel level : supportedSimdLevels()) {
        useSimdLevel(level);
        sidesOf(list, points, sides, Prefix{prefix}, {.threads = 2});
        for (std::size_t i = 0; i < points.size(); ++i) {
          const Side truth = testing::sideByDefinition(plain, points[i], prefix);
          ASSERT_EQ(sideOf(list, points[i], Prefix{prefix}), truth) << "seed " << seed << " point " << i;
          ASSERT_EQ(sides[i], truth) << "seed " << seed << " point " << i << " " << nameOf(level);
        }
      }
    }
  }
  useSimdLevel(before);
}

}  // namespace
}  // namespace restroke::implicit
