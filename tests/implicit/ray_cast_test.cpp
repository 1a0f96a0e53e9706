// Exact ray casting against a dense walk along the ray (SPEC S7).

#include "implicit/ray_cast.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "implicit/simd/ray_kernels.h"
#include "implicit/volume_kinds.h"
#include "tests/support/brute_force.h"
#include "tests/support/random_volumes.h"

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

/// Where one ray's line is inside of each primitive of a list: the definition's data.
struct Along {
  struct Stretch {
    std::size_t position;
    double enter, exit;
  };
  std::vector<Stretch> stretches;  // in list order
  std::vector<double> ends;        // of all, sorted

  Along(const std::vector<Primitive>& plain, const Ray& ray) {
    std::vector<RayInterval> intervals;
    for (std::size_t i = 0; i < plain.size(); ++i) {
      intervals.clear();
      intersect(plain[i].shape, ray, intervals);
      for (const RayInterval& in : intervals) {
        stretches.push_back({i, in.enter, in.exit});
        ends.insert(ends.end(), {in.enter, in.exit});
      }
    }
    std::sort(ends.begin(), ends.end());
  }

  /// The last of the prefix's stretches that satisfies `holds`; null for none.
  template <class F>
  [[nodiscard]] const Stretch* last(std::size_t prefix, const F& holds) const {
    for (std::size_t i = stretches.size(); i-- > 0;)
      if (stretches[i].position < prefix && holds(stretches[i])) return &stretches[i];
    return nullptr;
  }
};

/// The first crossing by definition: the first end of a stretch where the shape turns from outside to inside,
/// and the position of the primitive whose boundary that is: of the one that begins there, or of the carving
/// that ends there.
struct Crossing {
  double t;
  std::size_t position;
  bool uncovered;  // a carving's
};
std::optional<Crossing> firstCrossing(const std::vector<Primitive>& plain, const Along& along, const Ray& ray,
                                      std::size_t prefix) {
  const auto ownerAt = [&](double t) {
    return along.last(prefix, [&](const Along::Stretch& s) { return s.enter <= t && t < s.exit; });
  };
  const auto isInside = [&](const Along::Stretch* owner) {
    return owner && plain[owner->position].sign == Sign::Positive;
  };
  bool before = isInside(ownerAt(ray.tMin));
  for (const double t : along.ends) {
    if (!(t > ray.tMin && t < ray.tMax)) continue;
    const Along::Stretch* owner = ownerAt(t);
    const bool now = isInside(owner);
    if (now && !before) {
      const Along::Stretch* left =
          along.last(prefix, [&](const Along::Stretch& s) { return s.enter < t && t <= s.exit; });
      const bool uncovered = left && owner->enter != t;
      return Crossing{t, uncovered ? left->position : owner->position, uncovered};
    }
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
        const std::optional<Crossing> truth = firstCrossing(plain, Along(plain, ray), ray, prefix);
        const std::optional<RayHit> hit = castRay(list, ray, Prefix{prefix});
        ASSERT_EQ(hit.has_value(), truth.has_value()) << "seed " << seed << " ray " << k << " cell " << cell;
        if (!truth) continue;
        ++hits;
        EXPECT_EQ(hit->t, truth->t) << "seed " << seed << " ray " << k;
        EXPECT_NEAR(length(hit->normal), 1, 1e-12);
        // From outside to inside means against the normal.
        EXPECT_LE(dot(hit->normal, ray.direction), 1e-9);
      }
    }
    EXPECT_GT(hits, 300);
  }
}

/// Runs `f` at every SIMD level that the processor has.
template <class F>
void atEverySimdLevel(const F& f) {
  const SimdLevel before = simdLevel();
  for (const SimdLevel level : supportedSimdLevels()) {
    useSimdLevel(level);
    f(level);
  }
  useSimdLevel(before);
}

/// Spheres and volumes of every kind, crowded about a few places: some cells list hundreds, some of sizes far
/// from the others', a few primitives hold most of the rest.
std::vector<Primitive> crowdedList(testing::Random& random, std::size_t count) {
  std::vector<Primitive> plain{add({0, 0, 0}, 1)};
  while (plain.size() < count) {
    Primitive p = random.below(6) == 0 ? testing::randomMixedPrimitive(random, plain)
                                       : testing::randomPrimitive(random, plain);
    if (p.shape.isSphere() && random.below(3) != 0) {
      const Sphere& s = p.shape.ball();
      const float shrink = random.below(4) == 0 ? 0.05f : 1;
      p.shape = {Point(0.3f, 0.2f, 0.9f) + 0.2f * s.center, std::fmax(0.002f, 0.4f * shrink * s.radius)};
    }
    plain.push_back(p);
  }
  return plain;
}

TEST(CastRay, S7EqualsTheDefinitionOnCrowdedMixedListsAtEverySimdLevelAndManyPrefixes) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    testing::Random random(900 + seed);
    const std::vector<Primitive> plain = crowdedList(random, 500);
    const PrimitiveList lists[] = {listOf(plain, 0.2f), listOf(plain, 0.05f), listOf(plain, 1.5f)};
    int hits = 0, uncovered = 0;
    for (int k = 0; k < 150; ++k) {
      const DVec3 to =
          k % 3 == 0 ? DVec3(random.inCube(1)) : DVec3(0.3, 0.2, 0.9) + 0.2 * DVec3(random.inCube(1));
      Ray ray = through(to + DVec3(random.inCube(k % 4 == 0 ? 100 : 3)), to);
      if (k % 5 == 0) ray.direction = normalized(ray.direction);
      if (k % 7 == 0) ray.tMin = -1e6;
      if (k % 11 == 0) ray.tMax = static_cast<double>(random.between(0.5f, 1.5f));
      const Along along(plain, ray);
      for (std::size_t prefix :
           {random.below(20), random.below(plain.size()), plain.size() / 2, plain.size()}) {
        const std::optional<Crossing> truth = firstCrossing(plain, along, ray, prefix);
        if (truth) ++(truth->uncovered ? uncovered : hits);
        atEverySimdLevel([&](SimdLevel level) {
          for (const PrimitiveList& list : lists) {
            const auto where = [&] {
              return fmt::format("seed {} ray {} prefix {} {}", seed, k, prefix, nameOf(level));
            };
            const std::optional<RayHit> hit = castRay(list, ray, Prefix{prefix});
            ASSERT_EQ(hit.has_value(), truth.has_value()) << where();
            if (!truth) continue;
            EXPECT_EQ(hit->t, truth->t) << where();
            EXPECT_EQ(list.positionOf(hit->primitive), truth->position) << where();
            EXPECT_EQ(hit->position, ray.at(truth->t)) << where();
            const DVec3 normal = outwardNormal(plain[truth->position].shape, hit->position);
            EXPECT_EQ(hit->normal, truth->uncovered ? -normal : normal) << where();
          }
        });
      }
    }
    EXPECT_GT(hits, 100);
    EXPECT_GT(uncovered, 20);
  }
}

TEST(RayKernels, SpheresAreIntersectedBitForBitAsOneByOneAtEverySimdLevel) {
  testing::Random random(5);
  RayBatch batch;
  for (int round = 0; round < 300; ++round) {
    const Ray ray = through(DVec3(random.inCube(round % 3 == 0 ? 1e6f : 3)), DVec3(random.inCube(1)));
    const DVec3 &o = ray.origin, &d = ray.direction;
    const std::size_t count = 1 + random.below(RayBatch::kSize);
    std::vector<Sphere> spheres;
    for (std::size_t i = 0; i < count; ++i) {
      const Sphere& s = spheres.emplace_back(Sphere{random.inCube(1), random.between(0.01f, 1)});
      batch.x[i] = static_cast<double>(s.center.x);
      batch.y[i] = static_cast<double>(s.center.y);
      batch.z[i] = static_cast<double>(s.center.z);
      batch.r[i] = static_cast<double>(s.radius);
    }
    atEverySimdLevel([&](SimdLevel level) {
      rayKernels(level).intersect({o.x, o.y, o.z, d.x, d.y, d.z, dot(d, d)}, batch, count);
      for (std::size_t i = 0; i < count; ++i) {
        const std::optional<RayInterval> truth = intersect(spheres[i], ray);
        ASSERT_EQ(batch.enter[i] <= batch.exit[i], truth.has_value()) << nameOf(level);
        if (!truth) continue;
        EXPECT_EQ(batch.enter[i], truth->enter) << nameOf(level);
        EXPECT_EQ(batch.exit[i], truth->exit) << nameOf(level);
      }
    });
  }
}

TEST(RayKernels, NoBallThatTheStretchMeetsIsLeftOutAtAnyPlaceAndScale) {
  testing::Random random(6);
  std::size_t met = 0, grazed = 0, left = 0;
  for (int round = 0; round < 2000; ++round) {
    // A stretch of a cell's size somewhere, and balls that it meets or nearly meets, many just so.
    const float scale = std::ldexp(1.0f, static_cast<int>(random.below(24)) - 8);
    const DVec3 middle = DVec3(random.inCube(round % 2 == 0 ? scale : std::fmin(1e6f, 4096 * scale)));
    const DVec3 unit = normalized(DVec3(random.inCube(1)) + DVec3(0, 0, 1e-3));
    const double half = static_cast<double>(scale * random.between(0, 1));
    const float pad = static_cast<float>(
        0x1p-19 * (std::fabs(middle.x) + std::fabs(middle.y) + std::fabs(middle.z) + half));
    const auto f = [](double a) { return static_cast<float>(a); };
    const RayStretch stretch{f(middle.x), f(middle.y), f(middle.z), f(unit.x),
                             f(unit.y),   f(unit.z),   f(half),     pad};
    const std::size_t count = 1 + random.below(RayBatch::kSize);
    std::vector<float> balls;
    std::vector<std::uint32_t> slots;
    std::uint64_t must = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const float reach = scale * random.between(0.01f, 2);
      DVec3 aside = cross(unit, DVec3(random.inCube(1)));
      if (length(aside) == 0) aside = cross(unit, DVec3(1, 2, 3));
      const double far =
          static_cast<double>(reach) * (i % 2 == 0 ? 0.9999999 : static_cast<double>(random.between(0, 3)));
      const double t = half * static_cast<double>(random.between(-1, 1));
      const DVec3 c = middle + t * unit + far * normalized(aside);
      const float rounded[] = {f(c.x), f(c.y), f(c.z)};
      balls.insert(balls.end(), {rounded[0], rounded[1], rounded[2], reach});
      slots.push_back(static_cast<std::uint32_t>(count - 1 - i));
      const DVec3 v = DVec3(static_cast<double>(rounded[0]), static_cast<double>(rounded[1]),
                            static_cast<double>(rounded[2])) -
                      middle;
      const double along = std::clamp(dot(v, unit), -half, half);
      const bool meets = length(v - along * unit) <= static_cast<double>(reach);
      if (meets) must |= std::uint64_t{1} << (count - 1 - i);
      grazed += meets && i % 2 == 0;
    }
    std::optional<std::uint64_t> first;
    atEverySimdLevel([&](SimdLevel level) {
      const std::uint64_t may = rayKernels(level).meeting(stretch, balls.data(), slots.data(), count);
      EXPECT_EQ(must & ~may, 0u) << "round " << round << " " << nameOf(level);
      EXPECT_EQ(count == 64 ? 0 : may >> count, 0u) << nameOf(level);
      if (!first) first = may;
      EXPECT_EQ(may, *first) << "round " << round << " " << nameOf(level);
    });
    met += static_cast<std::size_t>(std::popcount(*first));
    left += count - static_cast<std::size_t>(std::popcount(*first));
  }
  EXPECT_GT(grazed, 5000u);
  EXPECT_GT(met, 10000u);
  EXPECT_GT(left, 10000u);  // and most that lie beside it are
}

}  // namespace
}  // namespace restroke::implicit
