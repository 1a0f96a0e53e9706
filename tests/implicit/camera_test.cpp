#include "implicit/geometry/camera.h"

#include <gtest/gtest.h>

#include <cmath>

#include "implicit/errors.h"
#include "tests/support/brute_force.h"

namespace restroke {
namespace {

TEST(Camera, RayThroughTheMiddleRunsAlongTheView) {
  Camera c;
  c.view = {0.3f, -0.2f, -1};
  const Ray ray = rayThrough(c, {static_cast<int>(c.width) * 8, static_cast<int>(c.height) * 8});
  const DVec3 forward = normalized(DVec3(c.view));
  EXPECT_LT(length(ray.direction - forward), 1e-15);
  EXPECT_EQ(ray.tMin, static_cast<double>(c.near));
  EXPECT_EQ(ray.tMax, static_cast<double>(c.far));
}

TEST(Camera, ProjectUndoesRayThrough) {
  testing::Random random(1);
  for (int i = 0; i < 200; ++i) {
    Camera c;
    c.position = random.inCube(5);
    c.view = random.inCube(1) + Vec3(0, 0, 2);
    c.up = {random.between(-0.5f, 0.5f), 1, 0};
    c.width = 1 + static_cast<unsigned>(random.below(2000));
    c.height = 1 + static_cast<unsigned>(random.below(2000));
    c.halfHeight = random.between(0.05f, 2);
    const ScreenPoint p{static_cast<int>(random.below(c.width * 16)),
                        static_cast<int>(random.below(c.height * 16))};
    const double depth = 0.5 + static_cast<double>(random.between(0, 10));
    const Projection q = project(frameOf(c), c, rayThrough(c, p).at(depth));
    EXPECT_NEAR(q.x * 16, p.x, 1e-7);
    EXPECT_NEAR(q.y * 16, p.y, 1e-7);
    EXPECT_NEAR(q.depth, depth, 1e-9);
  }
}

TEST(Camera, BehindTheCameraHasNoPositiveDepth) {
  const Camera c;
  EXPECT_LE(project(frameOf(c), c, DVec3(c.position) - DVec3(c.view)).depth, 0);
}

TEST(Camera, FrameSphereMakesTheSilhouetteSpanTheAskedPartOfTheShorterSide) {
  const Point center(1, 0, 0.5f);
  for (const auto& [w, h] : {std::pair{1280u, 720u}, {500u, 900u}, {64u, 64u}}) {
    const Camera c = frameSphere(center, 2.5f, {.view = {1, -1, -2}, .width = w, .height = h, .fill = 0.8f});
    validate(c, "test");
    const CameraFrame f = frameOf(c);
    const double d = length(DVec3(center) - f.position), r = 2.5;
    const double tangent = r / std::sqrt(d * d - r * r);
    EXPECT_NEAR(tangent / std::fmin(f.halfWidth, f.halfHeight), 0.8, 1e-5);
    EXPECT_LT(static_cast<double>(c.near), d - r);
    EXPECT_GT(static_cast<double>(c.far), d + r);
  }
}

TEST(Camera, FrameSphereTakesAnyDirectionAndAnEmptySphere) {
  for (const Vec3 v : {Vec3(0, 1, 0), Vec3(0, -1, 0), Vec3(1, 0, 0), Vec3(0, 0, 5)})
    validate(frameSphere({}, 0, {.view = v}), "test");
}

TEST(Camera, RefusesWhatNoRayCanBeCastThrough) {
  const float nan = std::nanf("");
  const auto refused = [](auto change) {
    Camera c;
    change(c);
    EXPECT_THROW(validate(c, "stroke 3"), InputError);
  };
  refused([&](Camera& c) { c.position.x = nan; });
  refused([&](Camera& c) { c.position.y = 2e7f; });
  refused([&](Camera& c) { c.view = {0, 0, 0}; });
  refused([&](Camera& c) { c.up = c.view; });
  refused([&](Camera& c) { c.up = {0, nan, 0}; });
  refused([&](Camera& c) { c.halfHeight = 0; });
  refused([&](Camera& c) { c.halfHeight = nan; });
  refused([&](Camera& c) { c.width = 0; });
  refused([&](Camera& c) { c.height = 70000; });
  refused([&](Camera& c) { c.near = 0; });
  refused([&](Camera& c) { c.far = c.near; });
  validate(Camera{}, "the default");
}

}  // namespace
}  // namespace restroke
