// The generalised winding number, and the arctangent that it is made of.

#include "implicit/geometry/winding_number.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <random>

#include "implicit/geometry/det_math.h"
#include "tests/support/meshes.h"

namespace restroke {
namespace {

using testing::ballMesh;
using testing::boxMesh;
using testing::insideOut;
using testing::together;

class RandomPoints {
 public:
  explicit RandomPoints(std::uint64_t seed) : random_(seed) {}
  /// From -1 to 1.
  double next() { return static_cast<double>(random_() >> 11) * 0x1p-52 - 1; }
  DVec3 in(double halfSize) {
    const double x = next(), y = next(), z = next();
    return DVec3(x, y, z) * halfSize;
  }

 private:
  std::mt19937_64 random_;
};

TEST(DetMath, ArctangentAgreesWithLibm) {
  RandomPoints random(11);
  double worst = 0;
  for (int i = 0; i < 200000; ++i) {
    const double scale = std::ldexp(1.0, i % 120 - 60);
    const double y = random.next() * scale, x = random.next();
    worst = std::fmax(worst, std::fabs(detAtan2(y, x) - std::atan2(y, x)));
  }
  RecordProperty("worst", fmt::format("{:.2e}", worst));
  EXPECT_LT(worst, 1e-15);
  // Where the table changes.
  for (int k = 0; k <= 16; ++k)
    for (const double e : {-1e-9, 0.0, 1e-9})
      EXPECT_NEAR(detAtan2(k / 16.0 + e, 1), std::atan2(k / 16.0 + e, 1), 3e-16);
}

TEST(DetMath, ArctangentKnowsAxesDiagonalsAndExtremes) {
  EXPECT_EQ(detAtan2(0, 0), 0);
  EXPECT_EQ(detAtan2(0, 2), 0);
  EXPECT_EQ(detAtan2(0, -2), kPi);
  EXPECT_EQ(detAtan2(-0.0, -2), kPi);
  EXPECT_EQ(detAtan2(3, 0), kPi / 2);
  EXPECT_EQ(detAtan2(-3, 0), -kPi / 2);
  EXPECT_EQ(detAtan2(1, 1), kPi / 4);
  EXPECT_EQ(detAtan2(-1, -1), -3 * kPi / 4);
  constexpr double kLargest = std::numeric_limits<double>::max(),
                   kSmallest = std::numeric_limits<double>::min();
  EXPECT_EQ(detAtan2(kLargest, kLargest), kPi / 4);
  EXPECT_EQ(detAtan2(kSmallest, kLargest), 0);
  EXPECT_EQ(detAtan2(kLargest, kSmallest), kPi / 2);
  static_assert(detAtan2(1, 0) == kPi / 2);
}

TEST(WindingNumber, IsOneInsideAndZeroOutsideOfClosedMeshes) {
  const WindingNumber box(boxMesh({-1, -1, -1}, {1, 1, 1})),
      turned(insideOut(boxMesh({-1, -1, -1}, {1, 1, 1})));
  RandomPoints random(1);
  for (int i = 0; i < 2000; ++i) {
    const DVec3 p = random.in(1.5);
    const double expected = std::fmax(std::fabs(p.x), std::fmax(std::fabs(p.y), std::fabs(p.z))) < 1 ? 1 : 0;
    EXPECT_NEAR(box.exactAt(p), expected, 1e-12);
    EXPECT_NEAR(box.at(p), expected, WindingNumber::kFastError);
    EXPECT_NEAR(turned.exactAt(p), -expected, 1e-12);
    EXPECT_EQ(box.isInside(p), expected == 1);
    EXPECT_FALSE(turned.isInside(p));
  }
}

TEST(WindingNumber, OfATriangleIsItsSolidAngle) {
  TriangleMesh mesh;
  mesh.vertices = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}};
  const WindingNumber octant(mesh);
  EXPECT_NEAR(octant.exactAt({0, 0, 0}), 1 / 8., 1e-15);
  EXPECT_NEAR(octant.at({0, 0, 0}), 1 / 8., WindingNumber::kFastError);
  // Just behind it and just before it: half of all directions.
  EXPECT_NEAR(octant.exactAt(DVec3(1 / 3. - 1e-12)), 0.5, 1e-9);
  EXPECT_NEAR(octant.exactAt(DVec3(1 / 3. + 1e-12)), -0.5, 1e-9);
}

TEST(WindingNumber, FastAndExactAgreeWithinTheStatedBound) {
  RandomPoints random(5);
  TriangleMesh soup;
  for (std::uint32_t t = 0; t < 3000; ++t) {
    const Point p(random.in(1));
    for (int i = 0; i < 3; ++i) soup.vertices.push_back(p + Point(random.in(0.1)));
    soup.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  TriangleMesh half = ballMesh(5);
  std::erase_if(half.triangles, [&](const auto& t) { return half.vertices[t[0]].z > 0; });
  double worst = 0;
  for (const TriangleMesh& mesh : {ballMesh(5), half, soup}) {
    const WindingNumber winding(mesh);
    for (int i = 0; i < 600; ++i) {
      DVec3 p = random.in(1.3);
      if (i % 2 == 0) p = p / length(p) * (1 + random.next() * 0.01);  // close to the ball's surface
      const double error = std::fabs(winding.at(p) - winding.exactAt(p));
      worst = std::fmax(worst, error);
    }
  }
  RecordProperty("worst", fmt::format("{:.2e}", worst));
  EXPECT_LT(worst, WindingNumber::kFastError / 2);
  EXPECT_GT(worst, 1e-6) << "the fast way was not taken";
}

TEST(WindingNumber, FarAwayOneTermOfTheSeriesIsEnough) {
  const WindingNumber ball(ballMesh(3));
  TriangleMesh half = ballMesh(3);
  std::erase_if(half.triangles, [&](const auto& t) { return half.vertices[t[0]].z > 0; });
  const WindingNumber bowl(half);
  for (const double distance : {10.0, 1e3, 1e6, 1e12}) {
    const DVec3 p = DVec3(0.3, -0.5, 0.8) * distance;
    EXPECT_NEAR(ball.at(p), 0, 1e-6);
    EXPECT_NEAR(bowl.at(p) / bowl.exactAt(p), 1, 1e-2 / distance + 1e-12) << distance;
  }
}

TEST(WindingNumber, CrossesOneHalfInTheMiddleOfAHole) {
  // A box without its lid: seen from the middle of the opening, the rest is half of all directions.
  TriangleMesh mesh = boxMesh({-1, -1, -1}, {1, 1, 1});
  std::erase_if(mesh.triangles, [&](const auto& t) {
    return mesh.vertices[t[0]].z + mesh.vertices[t[1]].z + mesh.vertices[t[2]].z == 3;
  });
  ASSERT_EQ(mesh.triangles.size(), 10u);
  const WindingNumber open(mesh);
  EXPECT_NEAR(open.exactAt({0, 0, 1}), 0.5, 1e-12);
  EXPECT_NEAR(open.exactAt({0.7, -0.3, 1}), 0.5, 1e-12);
  EXPECT_TRUE(open.isInside({0.7, -0.3, 0.999}));
  EXPECT_FALSE(open.isInside({0.7, -0.3, 1.001}));
  EXPECT_NEAR(open.exactAt({0, 0, 0}), 5 / 6., 1e-12);
}

TEST(WindingNumber, IsTwoWhereShellsOverlapAndCountsDegenerateTrianglesAsNothing) {
  TriangleMesh mesh = together(boxMesh({0, 0, 0}, {2, 2, 2}), boxMesh({1, 1, 1}, {3, 3, 3}));
  mesh.triangles.push_back({0, 0, 9});
  mesh.triangles.push_back({3, 3, 3});
  const WindingNumber two(mesh);
  EXPECT_NEAR(two.exactAt({1.5, 1.25, 1.75}), 2, 1e-12);
  EXPECT_NEAR(two.exactAt({0.5, 0.25, 0.75}), 1, 1e-12);
  EXPECT_NEAR(two.at({0.5, 0.25, 0.75}), 1, WindingNumber::kFastError);
}

TEST(WindingNumber, OnTheSurfaceIsHalfway) {
  const WindingNumber box(boxMesh({-1, -1, -1}, {1, 1, 1}));
  EXPECT_NEAR(box.exactAt({1, 0.25, 0.5}), 0.5, 1e-12);
  EXPECT_NEAR(box.exactAt({0.25, 0.5, -1}), 0.5, 1e-12);
}

TEST(WindingNumber, HasTheSameBitsOnEveryMachine) {
  const WindingNumber ball(ballMesh(4));
  RandomPoints random(9);
  std::uint64_t hash = 0;
  for (int i = 0; i < 500; ++i) {
    const DVec3 p = random.in(1.2);
    for (const double winding : {ball.at(p), ball.exactAt(p)})
      hash = (hash ^ std::bit_cast<std::uint64_t>(winding)) * 0x100000001b3u;
  }
  EXPECT_EQ(hash, 5464103157108272530u);
}

TEST(WindingNumber, OfNothingIsZero) {
  const WindingNumber none{TriangleMesh{}};
  EXPECT_EQ(none.at({0, 0, 0}), 0);
  EXPECT_EQ(none.exactAt({1, 2, 3}), 0);
  EXPECT_FALSE(none.isInside({0, 0, 0}));
}

}  // namespace
}  // namespace restroke
