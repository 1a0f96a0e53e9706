// Exact ray casting against a dense walk along the ray (SPEC S7).

#include "implicit/ray_cast.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "implicit/side.h"
#include "tests/support/brute_force.h"

namespace restroke::implicit {
namespace {

Primitive add(Point c, float r) {
  return {{c, r}, Sign::Positive};
}
Primitive carve(Point c, float r) {
  return {{c, r}, Sign::Negative};
}

PrimitiveList listOf(const std::vector<Primitive>& plain, float cell = 0.1f) {
  PrimitiveList list({.cell = cell});
  for (const Primitive& p : plain) list.append(p);
  return list;
}

/// The definition in double: all crossings of all primitives, sorted, and the side just after each.
std::optional<double> firstCrossing(const std::vector<Primitive>& plain, const Ray& ray, std::size_t prefix) {
  std::vector<double> events;
  std::vector<std::vector<RayInterval>> intervals;
  for (std::size_t i = 0; i < prefix && i < plain.size(); ++i) {
    intersect(plain[i].shape, ray, intervals.emplace_back());
    for (const RayInterval& in : intervals.back()) events.insert(events.end(), {in.enter, in.exit});
  }
  std::sort(events.begin(), events.end());
  const auto inside = [&](double t) {
    for (std::size_t i = intervals.size(); i-- > 0;)
      for (const RayInterval& in : intervals[i])
        if (in.enter <= t && t < in.exit) return plain[i].sign == Sign::Positive;
    return false;
  };
  bool before = inside(ray.tMin);
  for (const double t : events) {
    if (!(t > ray.tMin && t < ray.tMax)) continue;
    const bool now = inside(t);
    if (now && !before) return t;
    before = now;
  }
  return std::nullopt;
}

Ray through(DVec3 from, DVec3 to) {
  return {from, to - from, 0, 1e6};
}

TEST(CastRay, EmptyListIsMissed) {
  EXPECT_FALSE(castRay(PrimitiveList(), through({0, 0, 5}, {0, 0, 0})));
}

TEST(CastRay, HitsTheNearSideOfASphereWithItsOutwardNormal) {
  const auto hit = castRay(listOf({add({0, 0, 0}, 1)}), through({0, 0, 5}, {0, 0, 0}));
  ASSERT_TRUE(hit);
  EXPECT_DOUBLE_EQ(hit->position.z, 1);
  EXPECT_DOUBLE_EQ(hit->normal.z, 1);
}

TEST(CastRay, ACarvedHollowIsHitOnItsFarWallWithTheNormalIntoIt) {
  const PrimitiveList list = listOf({add({0, 0, 0}, 1), carve({0, 0, 1}, 0.5f)});
  const auto hit = castRay(list, through({0, 0, 5}, {0, 0, 0}));
  ASSERT_TRUE(hit);
  EXPECT_DOUBLE_EQ(hit->position.z, 0.5);
  EXPECT_DOUBLE_EQ(hit->normal.z, 1);
  EXPECT_EQ(list.positionOf(hit->primitive), 1u);
}

TEST(CastRay, ARayThatStartsInsideMustFirstLeave) {
  const PrimitiveList list = listOf({add({0, 0, 0}, 1), add({0, 0, -5}, 1)});
  const auto hit = castRay(list, through({0, 0, 0}, {0, 0, -1}));
  ASSERT_TRUE(hit);
  EXPECT_DOUBLE_EQ(hit->position.z, -4);
  EXPECT_FALSE(castRay(listOf({add({0, 0, 0}, 1)}), through({0, 0, 0}, {0, 0, -1})));
}

TEST(CastRay, TouchesDoNotCount) {
  EXPECT_FALSE(castRay(listOf({add({0, 0, 0}, 1)}), through({1, 0, 5}, {1, 0, 0})));
}

TEST(CastRay, StopsAtItsRange) {
  const PrimitiveList list = listOf({add({0, 0, 0}, 1)});
  Ray ray = through({0, 0, 5}, {0, 0, 4});
  ray.tMax = 3.9;
  EXPECT_FALSE(castRay(list, ray));
  ray.tMax = 4.1;
  EXPECT_TRUE(castRay(list, ray));
  ray.tMin = 4.05;
  EXPECT_FALSE(castRay(list, ray));
}

TEST(CastRay, WhatWasCarvedExactlyIsNotHit) {
  EXPECT_FALSE(castRay(listOf({add({0.3f, 0, 0}, 0.7f), carve({0.3f, 0, 0}, 0.7f)}),
                       through({0, 0, 5}, {0.1, 0.2, 0})));
}

TEST(CastRay, EndsWhereAnAbsurdOriginLeavesNoDigits) {
  const PrimitiveList list = listOf({add({0, 0, 0}, 1), add({0, 0, 1}, 0.05f)});
  for (const double far : {1e9, 1e15, 1e18, 1e30}) {
    Ray ray = through({far, far, far}, {0, 0, 0});
    (void)castRay(list, ray);
    ray.direction = {-1, -1, -1};
    ray.tMax = 4 * far;
    (void)castRay(list, ray);
  }
}

TEST(CastRay, S7EqualsTheDefinitionOnRandomListsRaysPrefixesAndCells) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    testing::Random random(seed);
    std::vector<Primitive> plain{add({0, 0, 0}, 1)};
    for (int i = 0; i < 120; ++i) plain.push_back(testing::randomPrimitive(random, plain));
    int hits = 0;
    for (const float cell : {0.1f, 0.03f, 0.7f}) {
      const PrimitiveList list = listOf(plain, cell);
      for (int k = 0; k < 400; ++k) {
        DVec3 from = DVec3(random.inCube(3)), to = DVec3(random.inCube(1));
        if (k % 5 == 0) from.x = to.x;                    // along a coordinate plane
        if (k % 10 == 0) from.y = to.y = 0.1 * k * 0.01;  // and on a cell's face
        Ray ray = through(from, to);
        if (k % 7 == 0) ray.tMax = static_cast<double>(random.between(0.5f, 1.5f));
        const std::size_t prefix = k % 3 == 0 ? random.below(plain.size()) : plain.size();
        const std::optional<double> truth = firstCrossing(plain, ray, prefix);
        const std::optional<RayHit> hit = castRay(list, ray, Prefix{prefix});
        ASSERT_EQ(hit.has_value(), truth.has_value()) << "seed " << seed << " ray " << k << " cell " << cell;
        if (!truth) continue;
        ++hits;
        EXPECT_EQ(hit->t, *truth) << "seed " << seed << " ray " << k;
        EXPECT_NEAR(length(hit->normal), 1, 1e-12);
        // From outside to inside means against the normal.
        EXPECT_LE(dot(hit->normal, ray.direction), 1e-9);
      }
    }
    EXPECT_GT(hits, 300);
  }
}

}  // namespace
}  // namespace restroke::implicit
