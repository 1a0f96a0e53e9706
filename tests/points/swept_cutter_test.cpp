// Sweeps of cutters against the definition: the cutter in all places on its way (R8).

#include "points/dexel/toolpath/swept_cutter.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "implicit/errors.h"
#include "tests/points/sweep_oracle.h"
#include "tests/support/brute_force.h"
#include "tests/support/effort.h"

namespace restroke::points {
namespace {

using restroke::testing::kSanitized;
using restroke::testing::Random;
using restroke::testing::SweepOracle;
using Kind = Cutter::Kind;

constexpr std::array kKinds{Kind::Flat, Kind::Ball, Kind::BullNose};

Cutter cutterOf(Kind kind, double radius = 1, double length = 4) {
  Cutter cutter{.kind = kind, .radius = radius, .length = length};
  if (kind == Kind::BullNose) cutter.cornerRadius = 0.375 * radius;
  return cutter;
}
PathElement lineOf(DVec3 from, DVec3 to) {
  return {.from = from, .to = to};
}
PathElement arcOf(DVec3 from, DVec3 to, DVec3 center, int axis = 2, bool clockwise = false) {
  return {.kind = PathElement::Kind::Arc,
          .from = from,
          .to = to,
          .center = center,
          .axis = axis,
          .clockwise = clockwise};
}

double uniform(Random& random, double a, double b) {
  return static_cast<double>(random.between(static_cast<float>(a), static_cast<float>(b)));
}
DVec3 randomDirection(Random& random) {
  for (;;) {
    const DVec3 d(random.inCube(1));
    if (const double l = length(d); l > 0.1 && l <= 1) return d / l;
  }
}
void turnAtRandom(Cutter& cutter, Random& random) {
  const DVec3 z = randomDirection(random);
  DVec3 x = randomDirection(random);
  while (std::fabs(dot(x, z)) > 0.9) x = randomDirection(random);
  x = normalized(x - dot(x, z) * z);
  const DVec3 y = cross(z, x);
  cutter.orientation = {x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z};
}

struct Tolerances {
  double place = 1e-9;
  int lines = kSanitized ? 20 : 200;
};

// Random lines against the definition, in any direction and along the axes: what is inside, where the ends
// are, and their normals.
void expectSweep(const Cutter& cutter, const PathElement& element, Random& random,
                 const Tolerances& tolerances = {}, const SweepOptions& options = {}) {
  const SweptCutter sweep(cutter, element, options);
  const SweepOracle oracle(cutter, element);
  const Box& box = sweep.bounds();
  const DVec3 low(box.min), high(box.max);
  int checkedNormals = 0, allEnds = 0;
  std::vector<SolidSpan> spans;
  for (int i = 0; i < tolerances.lines; ++i) {
    DVec3 direction = randomDirection(random);
    if (i % 3 == 1) {
      direction = DVec3(0);
      direction[i / 3 % 3] = i % 2 == 0 ? 1 : -1;
    }
    // Through a place on the way as often as through one in the box.
    DVec3 through(uniform(random, low.x, high.x), uniform(random, low.y, high.y),
                  uniform(random, low.z, high.z));
    if (i % 2 == 0) through = oracle.tip(uniform(random, 0, 1)) + DVec3(random.inCube(1)) * cutter.radius;
    const Ray line{through - uniform(random, -20, 20) * direction, direction};
    spans.clear();
    sweep.intersect(line, spans);
    SCOPED_TRACE(i);
    double before = -std::numeric_limits<double>::infinity();
    for (const SolidSpan& s : spans) {
      ASSERT_GT(s.enter, before);
      ASSERT_GT(s.exit, s.enter);
      before = s.exit;
      for (const double t : {s.enter, s.exit}) {
        const DVec3 p = line.at(t);
        ++allEnds;
        const Vec3 normal = t == s.enter ? s.enterNormal : s.exitNormal;
        ASSERT_NEAR(length(normal), 1, 1e-6);
        ASSERT_NEAR(oracle.gap(p), 0, tolerances.place)
            << (t == s.enter ? "enters" : "leaves") << " at " << t;
        const bool isWithin =
            p.x >= low.x && p.y >= low.y && p.z >= low.z && p.x <= high.x && p.y <= high.y && p.z <= high.z;
        ASSERT_TRUE(isWithin);
        // At edges the gap has a kink, and no gradient.
        const DVec3 near = oracle.gradient(p, 2e-6), far = oracle.gradient(p, 1e-4);
        if (tolerances.place > 1e-8 || std::fabs(length(near) - 1) > 1e-3 || length(near - far) > 1e-2)
          continue;
        ++checkedNormals;
        ASSERT_GT(dot(DVec3(normal), near), (1 - 1e-5) * length(near))
            << "normal " << normal.x << " " << normal.y << " " << normal.z << ", gap grows along " << near.x
            << " " << near.y << " " << near.z;
      }
    }
    constexpr int kPlaces = 12;
    for (int k = 0; k < kPlaces; ++k) {
      const double t = uniform(random, -8, 8) + dot(through - line.origin, direction);
      const double gap = oracle.gap(line.at(t));
      bool isInside = false;
      for (const SolidSpan& s : spans) isInside |= s.enter <= t && t <= s.exit;
      if (std::fabs(gap) <= tolerances.place) continue;
      ASSERT_EQ(isInside, gap < 0) << "at " << t << ", gap " << gap;
      ASSERT_EQ(sweep.contains(line.at(t)), gap < 0) << "at " << t << ", gap " << gap;
    }
  }
  // Not all of them are at edges.
  if (tolerances.place < 1e-8 && allEnds > 40) {
    EXPECT_GT(3 * checkedNormals, allEnds);
  }
}

TEST(SweptCutter, R8StraightMovesAreTheUnionOfAllPlaces) {
  Random random(0x5001);
  RecordProperty("seed", "0x5001");
  const std::array<DVec3, 12> moves{DVec3{0, 0, 0}, {3, 0, 0},     {0, -2.5, 0},     {0, 0, 2},
                                    {0, 0, -5},     {2, 1, -1.5},  {0.5, 0.25, 3},   {0.125, 0, -0.0625},
                                    {6, -2, 0.001}, {-1, 3, 1e-7}, {1e-3, 1e-3, -1}, {1e-9, 0, 1}};
  for (const Kind kind : kKinds)
    for (std::size_t k = 0; k < moves.size(); ++k) {
      SCOPED_TRACE(::testing::Message() << "kind " << static_cast<int>(kind) << ", move " << k);
      const DVec3 from(random.inCube(5));
      expectSweep(cutterOf(kind), lineOf(from, from + moves[k]), random, {.lines = kSanitized ? 6 : 60});
    }
}

TEST(SweptCutter, R8ShortCuttersEndWhereTheirRoundPartEnds) {
  Random random(0x5002);
  RecordProperty("seed", "0x5002");
  for (const Kind kind : {Kind::Ball, Kind::BullNose})
    for (const double more : {0.0, 0.2, 0.9})
      for (const DVec3 move :
           {DVec3(0), DVec3(3, 0, 0), DVec3(1, 0, 2), DVec3(1, 1, -0.75), DVec3(0, 0, -1)}) {
        Cutter cutter = cutterOf(kind);
        cutter.length = (kind == Kind::Ball ? 1 : cutter.cornerRadius) * (1 + more);
        SCOPED_TRACE(::testing::Message() << "kind " << static_cast<int>(kind) << ", length " << cutter.length
                                          << ", move " << move.x << " " << move.y << " " << move.z);
        expectSweep(cutter, lineOf({0, 0, 0}, move), random, {.lines = kSanitized ? 6 : 60});
      }
}

TEST(SweptCutter, R8RandomMovesOfCuttersThatStandInAnyWay) {
  Random random(0x5003);
  RecordProperty("seed", "0x5003");
  for (int k = 0; k < (kSanitized ? 6 : 60); ++k) {
    SCOPED_TRACE(k);
    Cutter cutter = cutterOf(kKinds[random.below(3)], uniform(random, 0.1, 3), uniform(random, 3, 20));
    cutter.cornerRadius = cutter.kind == Kind::BullNose ? uniform(random, 0.01, 0.99) * cutter.radius : 0;
    if (k % 2 == 0) turnAtRandom(cutter, random);
    const DVec3 from(random.inCube(10)), to = from + uniform(random, 0, 10) * randomDirection(random);
    expectSweep(cutter, lineOf(from, to), random, {.lines = 20});
  }
}

TEST(SweptCutter, R8PlaneArcsAboutTheCutterAreExact) {
  Random random(0x5004);
  RecordProperty("seed", "0x5004");
  struct Case {
    DVec3 from, to, center;
    bool clockwise;
  };
  const std::vector<Case> cases{
      {{3, 0, 0}, {0, 3, 0}, {0, 0, 0}, false},               // a quarter
      {{3, 0, 0}, {0, 3, 0}, {0, 0, 0}, true},                // three quarters
      {{3, 0, 0}, {-3, 0, 0}, {0, 0, 0}, false},              // a half
      {{3, 1, 0}, {3, 1, 0}, {0, 0, 0}, false},               // all of it
      {{0.5, 0, 1}, {0, 0.5, 1}, {0, 0, 7}, false},           // within the cutter's radius
      {{0.5, 0, 0}, {0.5, 0, 0}, {0, 0, 0}, true},            // a whole turn there
      {{0.25, 0, 0}, {0, -0.25, 0}, {0, 0, 0}, false},        // more than half there
      {{1, 0, 0}, {1, 0, 0}, {0, 0, 0}, false},               // through the centre, just
      {{50, 0, 0}, {49.9, 3.1606, 0}, {0, 0, 0}, false},      // nearly straight
      {{3, 0, 0}, {2.9999, 0.0244947, 0}, {0, 0, 0}, false},  // tiny
      {{3, 0, 0}, {2.9999, 0.0244947, 0}, {0, 0, 0}, true},   // nearly whole
  };
  for (const Kind kind : kKinds)
    for (std::size_t k = 0; k < cases.size(); ++k) {
      const Case& c = cases[k];
      SCOPED_TRACE(::testing::Message() << "kind " << static_cast<int>(kind) << ", case " << k);
      expectSweep(cutterOf(kind), arcOf(c.from, c.to, c.center, 2, c.clockwise), random,
                  {.lines = kSanitized ? 2 : 12});
      Cutter down = cutterOf(kind);
      down.orientation = {1, 0, 0, 0, -1, 0, 0, 0, -1};
      expectSweep(down, arcOf(c.from, c.to, c.center, 2, c.clockwise), random, {.lines = kSanitized ? 1 : 4});
      Cutter least = cutterOf(kind);
      if (kind == Kind::Ball) least.length = 1;
      if (kind == Kind::BullNose) least.length = least.cornerRadius;
      expectSweep(least, arcOf(c.from, c.to, c.center, 2, c.clockwise), random,
                  {.lines = kSanitized ? 1 : 4});
    }
}

TEST(SweptCutter, R8OtherArcsAreWithinTheirTolerance) {
  Random random(0x5005);
  RecordProperty("seed", "0x5005");
  for (const Kind kind : kKinds)
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k < 4; ++k) {
        SCOPED_TRACE(::testing::Message()
                     << "kind " << static_cast<int>(kind) << ", axis " << axis << ", case " << k);
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        DVec3 from{0}, to{0};
        from[u] = 3;
        to[v] = k == 1 ? 0 : 3;
        to[u] = k == 1 ? 3 : 0;
        to[axis] = k == 2 ? 2.5 : k == 1 && axis == 2 ? -1 : 0;
        Cutter cutter = cutterOf(kind);
        if (k == 3) turnAtRandom(cutter, random);
        if (k == 2) cutter.length = 1.5;
        const SweepOptions options{.tolerance = 1e-3};
        expectSweep(cutter, arcOf(from, to, DVec3(0), axis, k == 0), random,
                    {.place = 1.001e-3, .lines = kSanitized ? 3 : 20}, options);
      }
}

TEST(SweptCutter, R8ArcsOfStraightPartsComeToTheExactOnes) {
  Random random(0x5006);
  RecordProperty("seed", "0x5006");
  for (const Kind kind : kKinds)
    for (const double tolerance : {1e-2, 1e-4}) {
      const SweepOptions options{.tolerance = tolerance, .onlyStraightParts = true};
      expectSweep(cutterOf(kind, 2, 7), arcOf({5, 0, 0}, {0, -5, 0}, {0, 0, 0}), random,
                  {.place = 2.001 * tolerance, .lines = kSanitized ? 4 : 40}, options);
    }
}

TEST(SweptCutter, R8ArcsThatAreNearlyStraight) {
  Random random(0x5008);
  RecordProperty("seed", "0x5008");
  for (const Kind kind : kKinds)
    for (const double radius : {1e3, 3e4, 9e4, 2e5}) {
      SCOPED_TRACE(::testing::Message() << "kind " << static_cast<int>(kind) << ", radius " << radius);
      const DVec3 center(1, 2 - radius, 0);
      const auto at = [&](double x) {
        return DVec3(1 + x, 2 - radius + std::sqrt(radius * radius - x * x), 3);
      };
      // The last are of straight parts.
      expectSweep(cutterOf(kind), arcOf(at(-4), at(5), center, 2, true), random,
                  {.place = radius > 1e5 ? 1.001e-4 : 1e-9 * radius, .lines = kSanitized ? 3 : 30});
    }
}

TEST(SweptCutter, R8RandomArcs) {
  Random random(0x5007);
  RecordProperty("seed", "0x5007");
  for (int k = 0; k < (kSanitized ? 6 : 40); ++k) {
    SCOPED_TRACE(k);
    Cutter cutter = cutterOf(kKinds[random.below(3)], uniform(random, 0.1, 3), uniform(random, 3, 20));
    cutter.cornerRadius = cutter.kind == Kind::BullNose ? uniform(random, 0.01, 0.99) * cutter.radius : 0;
    const double radius = std::exp(uniform(random, -3, 3));
    const double a = uniform(random, 0, 6.28), b = uniform(random, 0, 6.28);
    const DVec3 center(random.inCube(10));
    const DVec3 from = center + radius * DVec3(std::cos(a), std::sin(a), 0),
                to = center + radius * DVec3(std::cos(b), std::sin(b), 0);
    expectSweep(cutter, arcOf(from, to, center, 2, random.below(2) == 0), random, {.lines = 15});
  }
}

// The one span of a sweep on a line.
SolidSpan onlySpan(const SweptCutter& sweep, DVec3 origin, DVec3 direction) {
  std::vector<SolidSpan> spans;
  sweep.intersect({origin, direction}, spans);
  EXPECT_EQ(spans.size(), 1u);
  return spans.empty() ? SolidSpan{} : spans.front();
}

TEST(SweptCutter, R8LinesThroughTheAxisAndAlongFaces) {
  for (const Kind kind : kKinds) {
    const SweptCutter still(cutterOf(kind), lineOf({1, 2, 3}, {1, 2, 3}));
    const SolidSpan along = onlySpan(still, {1, 2, 0}, {0, 0, 1});
    EXPECT_DOUBLE_EQ(along.enter, 3);
    EXPECT_DOUBLE_EQ(along.exit, 7);
    EXPECT_EQ(along.enterNormal, Vec3(0, 0, -1));
    EXPECT_EQ(along.exitNormal, Vec3(0, 0, 1));
    const SolidSpan across = onlySpan(still, {0, 2, 5}, {1, 0, 0});
    EXPECT_DOUBLE_EQ(across.enter, 0);
    EXPECT_DOUBLE_EQ(across.exit, 2);
    EXPECT_EQ(across.enterNormal, Vec3(-1, 0, 0));
    EXPECT_EQ(across.exitNormal, Vec3(1, 0, 0));
    // Along the middle of a move, and squarely across its middle and its ends.
    const SweptCutter moved(cutterOf(kind), lineOf({0, 0, 0}, {4, 0, 0}));
    const SolidSpan lengthwise = onlySpan(moved, {0, 0, 2}, {1, 0, 0});
    EXPECT_DOUBLE_EQ(lengthwise.enter, -1);
    EXPECT_DOUBLE_EQ(lengthwise.exit, 5);
    for (const double x : {0.0, 2.0, 4.0}) {
      const SolidSpan s = onlySpan(moved, {x, 0, 2}, {0, -1, 0});
      EXPECT_DOUBLE_EQ(s.enter, -1);
      EXPECT_DOUBLE_EQ(s.exit, 1);
      EXPECT_EQ(s.enterNormal, Vec3(0, 1, 0));
      EXPECT_EQ(s.exitNormal, Vec3(0, -1, 0));
      const SolidSpan up = onlySpan(moved, {x, 0, -9}, {0, 0, 1});
      EXPECT_NEAR(up.enter, 9, 1e-14);
      EXPECT_DOUBLE_EQ(up.exit, 13);
      EXPECT_EQ(up.enterNormal, Vec3(0, 0, -1));
      EXPECT_EQ(up.exitNormal, Vec3(0, 0, 1));
    }
  }
}

TEST(SweptCutter, R8LinesThatTouchOrMissDoNoHarm) {
  std::vector<SolidSpan> spans;
  for (const Kind kind : kKinds)
    for (const PathElement& element : {lineOf({0, 0, 0}, {4, 0, 0}), lineOf({0, 0, 0}, {4, 0, 1}),
                                       arcOf({4, 0, 0}, {-4, 0, 0}, {0, 0, 0})}) {
      const SweptCutter sweep(cutterOf(kind), element);
      for (const auto& [origin, direction] : std::vector<std::pair<DVec3, DVec3>>{{{-20, 1, 2}, {1, 0, 0}},
                                                                                  {{-20, 0, 0}, {1, 0, 0}},
                                                                                  {{2, 1, -20}, {0, 0, 1}},
                                                                                  {{0, 5, 2}, {1, 0, 0}},
                                                                                  {{5, 0, -20}, {0, 0, 1}}}) {
        spans.clear();
        sweep.intersect({origin, direction}, spans);
        for (const SolidSpan& s : spans) {
          EXPECT_LT(s.enter, s.exit);
          EXPECT_NEAR(length(s.enterNormal), 1, 1e-6);
        }
      }
      for (const DVec3 origin : {DVec3(0, 30, 0), DVec3(0, 0, 90)}) {
        spans.clear();
        sweep.intersect({origin, {1, 0, 0}}, spans);
        EXPECT_TRUE(spans.empty());
      }
    }
}

TEST(SweptCutter, R8AnArcAboutItsOwnBeginningIsAStraightLine) {
  for (const Kind kind : kKinds) {
    const SweptCutter arc(cutterOf(kind), arcOf({1, 1, 0}, {2, 1, 0}, {1, 1, 0}));
    const SweptCutter line(cutterOf(kind), lineOf({1, 1, 0}, {2, 1, 0}));
    const SolidSpan a = onlySpan(arc, {-5, 1.25, 2}, {1, 0, 0}), b = onlySpan(line, {-5, 1.25, 2}, {1, 0, 0});
    EXPECT_EQ(a.enter, b.enter);
    EXPECT_EQ(a.exit, b.exit);
  }
}

TEST(SweptCutter, R8WhatCannotBeIsRefused) {
  const auto refuses = [](const Cutter& cutter, const PathElement& element, const char* says,
                          const SweepOptions& options = {}) {
    try {
      const SweptCutter sweep(cutter, element, options);
      ADD_FAILURE() << "accepted; expected: " << says;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(says), std::string::npos) << error.what();
    }
  };
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               infinity = std::numeric_limits<double>::infinity();
  const PathElement still = lineOf({0, 0, 0}, {0, 0, 0});
  for (const double bad : {0.0, -1.0, nan, infinity}) {
    refuses(cutterOf(Kind::Flat, bad), still, "radius");
    refuses(cutterOf(Kind::Ball, 1, bad), still, "length");
    Cutter cutter = cutterOf(Kind::BullNose);
    cutter.cornerRadius = bad;
    refuses(cutter, still, "corner radius");
  }
  refuses(cutterOf(Kind::Ball, 1, 0.5), still, "at least as long");
  Cutter cutter = cutterOf(Kind::BullNose, 1, 0.25);
  refuses(cutter, still, "at least as long");
  cutter.cornerRadius = 1;
  refuses(cutter, still, "smaller");
  cutter = cutterOf(Kind::Flat);
  cutter.cornerRadius = 0.5;
  refuses(cutter, still, "bull nose");
  cutter = cutterOf(Kind::Flat);
  cutter.orientation = {2, 0, 0, 0, 2, 0, 0, 0, 2};
  refuses(cutter, still, "rotation");
  cutter.orientation = {1, 0, 0, 0, 1, 0, 0, 0, -1};
  refuses(cutter, still, "rotation");
  refuses(cutterOf(Kind::Flat), lineOf({nan, 0, 0}, {0, 0, 0}), "coordinate");
  refuses(cutterOf(Kind::Flat), lineOf({0, 0, 0}, {0, 2e6, 0}), "coordinate");
  refuses(cutterOf(Kind::Flat), arcOf({1, 0, 0}, {0, 1, 0}, {0, 0, 0}, 3), "axis");
  refuses(cutterOf(Kind::Flat, 1e39), still, "float32");
  refuses(cutterOf(Kind::Flat), still, "tolerance", {.tolerance = 0});
  refuses(cutterOf(Kind::Flat, 1e-5), arcOf({1e5, 0, 0}, {-1e5, 0, 1}, {0, 0, 0}), "straight moves");
}

}  // namespace
}  // namespace restroke::points
