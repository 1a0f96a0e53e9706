#include "implicit/geometry/similarity.h"

#include <gtest/gtest.h>

#include "tests/support/brute_force.h"

namespace restroke {
namespace {

using testing::Random;

double uniform(Random& random, float a, float b) {
  return static_cast<double>(random.between(a, b));
}

Similarity anyMotion(Random& random) {
  DVec3 axis(0);
  while (!(length(axis) > 0.1)) axis = DVec3(random.inCube(1));
  return {rotationAbout(normalized(axis), uniform(random, -3, 3)), uniform(random, 0.2f, 5),
          DVec3(random.inCube(10))};
}

void expectNear(DVec3 a, DVec3 b, double tolerance) {
  EXPECT_LE(length(a - b), tolerance)
      << a.x << ' ' << a.y << ' ' << a.z << " and " << b.x << ' ' << b.y << ' ' << b.z;
}

TEST(Similarity, TheIdentityChangesNoBit) {
  Random random{1};
  for (int k = 0; k < 100; ++k) {
    const DVec3 p(random.inCube(1e6f));
    EXPECT_EQ(moved(Similarity{}, p), p);
    Camera camera;
    camera.position = random.inCube(100);
    camera.view = random.inCube(3);
    camera.up = random.inCube(1);
    EXPECT_EQ(moved(Similarity{}, camera), camera);
  }
}

TEST(Similarity, AQuarterTurnAboutZTakesXToY) {
  expectNear(turned(rotationAbout({0, 0, 1}, 1), {1, 0, 0}), {0, 1, 0}, 1e-15);
  expectNear(turned(rotationAbout({1, 0, 0}, -1), {0, 1, 0}), {0, 0, -1}, 1e-15);
}

TEST(Similarity, TurningKeepsLengthsAnglesAndHandedness) {
  Random random{2};
  for (int k = 0; k < 100; ++k) {
    const Rotation q = anyMotion(random).rotation;
    const DVec3 a(random.inCube(1)), b(random.inCube(1));
    EXPECT_NEAR(dot(turned(q, a), turned(q, b)), dot(a, b), 1e-14);
    expectNear(cross(turned(q, a), turned(q, b)), turned(q, cross(a, b)), 1e-14);
  }
}

TEST(Similarity, ComposedDoesTheInnerMotionFirst) {
  Random random{3};
  for (int k = 0; k < 100; ++k) {
    const Similarity a = anyMotion(random), b = anyMotion(random);
    const DVec3 p(random.inCube(10));
    expectNear(moved(composed(a, b), p), moved(a, moved(b, p)), 1e-11);
  }
}

TEST(Similarity, TheInverseUndoes) {
  Random random{4};
  for (int k = 0; k < 100; ++k) {
    const Similarity a = anyMotion(random);
    const DVec3 p(random.inCube(10));
    expectNear(moved(inverted(a), moved(a, p)), p, 1e-11);
    expectNear(moved(a, moved(inverted(a), p)), p, 1e-11);
  }
}

TEST(Similarity, TheMovedCameraSeesTheMovedShapeAtTheSamePixels) {
  Random random{5};
  for (int k = 0; k < 50; ++k) {
    const Similarity m = anyMotion(random);
    Camera camera;
    camera.position = random.inCube(3) + Point(0, 0, 8);
    camera.view = Vec3(0, 0, -2) + random.inCube(0.5f);
    camera.up = Vec3(0, 1, 0) + random.inCube(0.3f);
    const Camera after = moved(m, camera);
    validate(after, "the moved camera");
    EXPECT_EQ(after.halfHeight, camera.halfHeight);
    EXPECT_EQ(after.width, camera.width);
    EXPECT_EQ(after.height, camera.height);
    EXPECT_FLOAT_EQ(after.near, static_cast<float>(m.scale) * camera.near);
    EXPECT_FLOAT_EQ(after.far, static_cast<float>(m.scale) * camera.far);
    for (int i = 0; i < 20; ++i) {
      const DVec3 p(random.inCube(1));
      const Projection here = project(frameOf(camera), camera, p);
      const Projection there = project(frameOf(after), after, moved(m, p));
      ASSERT_GT(here.depth, 0);
      // float32 rounding of a position of size 60 is 4e-6, of some 1,400 pixels a unit at depth 1.
      EXPECT_NEAR(there.x, here.x, 0.02);
      EXPECT_NEAR(there.y, here.y, 0.02);
      EXPECT_NEAR(there.depth, m.scale * here.depth, 1e-4);
    }
  }
}

TEST(Similarity, ARayThroughAPixelOfTheMovedCameraIsTheMovedRay) {
  Random random{6};
  const Camera camera;
  const Similarity m = anyMotion(random);
  const Ray before = rayThrough(camera, {3000, 9000}), after = rayThrough(moved(m, camera), {3000, 9000});
  for (const double t : {1.0, 4.0, 50.0})
    expectNear(after.origin + (m.scale * t) * after.direction, moved(m, before.origin + t * before.direction),
               1e-5 * m.scale * t + 1e-5);
  EXPECT_NEAR(after.tMin, m.scale * before.tMin, 1e-6 * m.scale);
}

}  // namespace
}  // namespace restroke
