// The paper's method (SPEC S7) against the exact one, and OpenGL against the CPU.

#include "retarget/methods/depth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <utility>

#include "implicit/errors.h"
#include "points/images/gl_renderer.h"
#include "tests/retarget/test_shapes.h"

namespace restroke::retarget {
namespace {

constexpr float kNone = std::numeric_limits<float>::infinity();

points::DepthImage imageOf(const Camera& camera, float depth) {
  return {camera.width, camera.height, std::vector<float>(std::size_t{camera.width} * camera.height, depth)};
}

float& at(points::DepthImage& image, std::uint32_t x, std::uint32_t y) {
  return image.depth[std::size_t{y} * image.width + x];
}

TEST(DepthMethod, PutsThePointOnItsOwnRayAtItsPixelsDepth) {
  const Camera camera{.width = 8, .height = 4};
  auto image = imageOf(camera, 2);
  at(image, 3, 2) = 3;
  const auto caster = makeDepthImageCaster(image, camera);
  for (std::int32_t y = 0; y < 4 * kSubPixels; ++y)
    for (std::int32_t x = 0; x < 8 * kSubPixels; ++x) {
      const bool special = x / kSubPixels == 3 && y / kSubPixels == 2;
      const auto hit = caster->cast(ScreenPoint{x, y});
      ASSERT_TRUE(hit);
      EXPECT_EQ(hit->position, Point(rayThrough(camera, {x, y}).at(special ? 3 : 2)));
    }
}

TEST(DepthMethod, OutsideTheViewportIsAMiss) {
  const Camera camera{.width = 8, .height = 4};
  const auto caster = makeDepthImageCaster(imageOf(camera, 2), camera);
  for (const ScreenPoint p : {ScreenPoint{-1, 0}, {0, -1}, {128, 0}, {0, 64}, {-(1 << 24), 1 << 24}})
    EXPECT_FALSE(caster->cast(p)) << p.x << ", " << p.y;
  for (const ScreenPoint p : {ScreenPoint{0, 0}, {127, 63}})
    EXPECT_TRUE(caster->cast(p)) << p.x << ", " << p.y;
}

TEST(DepthMethod, APixelWithoutSurfaceIsAMiss) {
  const Camera camera{.width = 8, .height = 4};
  auto image = imageOf(camera, 2);
  at(image, 5, 1) = kNone;
  const auto caster = makeDepthImageCaster(image, camera);
  EXPECT_FALSE(caster->cast(ScreenPoint{5 * 16, 16}));
  EXPECT_FALSE(caster->cast(ScreenPoint{5 * 16 + 15, 31}));
  EXPECT_TRUE(caster->cast(ScreenPoint{5 * 16 + 16, 16}));
}

TEST(DepthMethod, NormalIsThatOfThePlaneThroughNeighbours) {
  // A plane n.p = 0.5 of a tilt in both directions, and a step at the right that must not bend the normal.
  const Camera camera{.width = 64, .height = 48};
  const DVec3 n = normalized({0.4, -0.3, 1});
  auto image = imageOf(camera, kNone);
  for (std::uint32_t y = 0; y < camera.height; ++y)
    for (std::uint32_t x = 0; x < camera.width; ++x) {
      const Ray ray =
          rayThrough(camera, {static_cast<std::int32_t>(16 * x + 8), static_cast<std::int32_t>(16 * y + 8)});
      at(image, x, y) =
          static_cast<float>((0.5 - dot(n, ray.origin)) / dot(n, ray.direction)) + (x >= 40 ? 1.0f : 0.0f);
    }
  const auto caster = makeDepthImageCaster(std::move(image), camera);
  for (const ScreenPoint p : {ScreenPoint{0, 0}, {300, 300}, {39 * 16 + 3, 100}, {500, 47 * 16}}) {
    const auto hit = caster->cast(p);
    ASSERT_TRUE(hit);
    if (p.x < 40 * kSubPixels) {
      EXPECT_LT(length(DVec3(hit->normal) - n), 1e-3) << p.x;
    }
    EXPECT_NEAR(length(DVec3(hit->normal)), 1, 1e-6);
  }
}

TEST(DepthMethod, ALonePixelLooksBackAtTheCamera) {
  const Camera camera{.width = 3, .height = 3};
  auto image = imageOf(camera, kNone);
  at(image, 1, 1) = 2;
  const auto hit = makeDepthImageCaster(std::move(image), camera)->cast(ScreenPoint{24, 24});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->normal, Vec3(0, 0, 1));
}

TEST(DepthMethod, AnImageOfAnotherSizeIsABug) {
  const Camera camera{.width = 8, .height = 4};
  EXPECT_THROW(static_cast<void>(makeDepthImageCaster(imageOf({.width = 4, .height = 8}, 1), camera)),
               InternalError);
}

TEST(DepthMethod, CpuDepthIsWithinItsBoundOfTheExactSphere) {
  // depth.h: footprint / sqrt(2) * slope + sag * sqrt(1 + slope^2), first order; 10 % more for the second.
  for (const float density : {1000.0f, 8000.0f}) {
    const auto model = sphereModel(density);
    const Camera camera = smallCamera();
    const auto caster = makeCaster(Method::DepthCpu, model, camera);
    const double discRadius = static_cast<double>(model.surfels()[0].radius);
    std::size_t compared = 0;
    double largestShare = 0, largestError = 0, sum = 0;
    for (const ScreenPoint p : screenGrid(camera, 17)) {
      const Ray ray = rayThrough(camera, p);
      const auto truth = unitSphereAt(ray);
      if (!truth) continue;
      const double cosine = -dot(truth->place, normalized(ray.direction));
      const double slope = std::sqrt(1 - cosine * cosine) / cosine;
      if (slope > 4) continue;  // silhouettes: other pieces of surface, and discs that overhang
      const auto hit = caster->cast(p);
      ASSERT_TRUE(hit) << p.x << ", " << p.y;
      const double footprint = truth->depth * 2 * static_cast<double>(camera.halfHeight) / camera.height;
      const double bound =
          footprint / std::sqrt(2) * slope + discRadius * discRadius / 2 * std::sqrt(1 + slope * slope);
      const double error = length(DVec3(hit->position) - truth->place);
      ++compared;
      sum += error;
      largestError = std::max(largestError, error);
      largestShare = std::max(largestShare, error / bound);
      ASSERT_LE(error, 1.1 * bound + 1e-5) << p.x << ", " << p.y << ", slope " << slope;
      // Two planes of discs may meet between the neighbours: a rough normal.
      EXPECT_GT(dot(DVec3(hit->normal), truth->place), 0.3);
    }
    EXPECT_GT(compared, 20000u);
    std::printf("density %5.0f: error %.5f mean, %.5f largest; %.2f of the bound at most\n",
                static_cast<double>(density), sum / static_cast<double>(compared), largestError,
                largestShare);
  }
}

TEST(DepthMethod, CpuDepthAndExactDifferInHitOrMissNearSilhouettesOnly) {
  const auto model = sphereModel(8000);
  const Camera camera = smallCamera();
  const auto depth = makeCaster(Method::DepthCpu, model, camera);
  const double discRadius = static_cast<double>(model.surfels()[0].radius);
  std::size_t disagreements = 0;
  for (const ScreenPoint p : screenGrid(camera, 17)) {
    const Ray ray = rayThrough(camera, p);
    if (depth->cast(p).has_value() == unitSphereAt(ray).has_value()) continue;
    ++disagreements;
    // How far the ray passes the centre: within a pixel and an overhanging disc of the rim.
    const DVec3 along = normalized(ray.direction);
    const double distance = length(ray.origin - dot(ray.origin, along) * along);
    const double footprint = 4 * 2 * static_cast<double>(camera.halfHeight) / camera.height;
    EXPECT_NEAR(distance, 1, footprint + discRadius * discRadius / 2 + 1e-3) << p.x << ", " << p.y;
  }
  std::printf("%zu points near the silhouette are hits of one and misses of the other\n", disagreements);
}

bool haveOpenGl() {
  try {
    static_cast<void>(points::GlRenderer());
    return true;
  } catch (const InputError& error) {
    std::printf("%s\n", error.what());
    return false;
  }
}

TEST(DepthMethod, OpenGlAndCpuAgreeWithinTheRenderersBound) {
  if (!haveOpenGl()) GTEST_SKIP() << "no OpenGL context on this machine";
  const auto model = bumpyModel(8000);
  const Camera camera = smallCamera();
  const auto screen = screenGrid(camera, 17);
  const auto gl = castAll(*makeCaster(Method::Depth, model, camera), screen);
  const auto cpu = castAll(*makeCaster(Method::DepthCpu, model, camera), screen);
  std::size_t both = 0, one = 0, apart = 0;
  double largest = 0;
  for (std::size_t i = 0; i < screen.size(); ++i) {
    if (gl[i].has_value() != cpu[i].has_value()) ++one;
    if (!gl[i] || !cpu[i]) continue;
    ++both;
    const double difference = length(DVec3(gl[i]->position) - DVec3(cpu[i]->position));
    const double distance = length(DVec3(cpu[i]->position) - DVec3(camera.position));
    if (difference > points::kGlDepthBound * distance + 1e-6)
      ++apart;  // a pixel where they disagree on which disc is nearest
    else
      largest = std::max(largest, difference);
  }
  std::printf(
      "%zu hits of both, %zu of one only, %zu of different discs; largest difference of the others %.2g\n",
      both, one, apart, largest);
  EXPECT_GT(both, 30000u);
  EXPECT_LE(one + apart, both / 1000);
}

TEST(DepthMethod, OpenGlSeesAPrefixAsTheListThatHasOnlyThat) {
  if (!haveOpenGl()) GTEST_SKIP() << "no OpenGL context on this machine";
  const auto model = bumpyModel(2000);
  const auto screen = screenGrid(smallCamera(), 61);
  EXPECT_EQ(castAll(*makeCaster(Method::Depth, model, smallCamera(), {.count = 1}), screen),
            castAll(*makeCaster(Method::Depth, sphereModel(2000), smallCamera()), screen));
}

TEST(DepthMethodDeathTest, WithoutOpenGlTheSentenceNamesDepthCpu) {
  GTEST_FLAG_SET(death_test_style,
                 "threadsafe");  // a process of its own, in which nothing has touched EGL yet
  EXPECT_EXIT(
      {
        // libglvnd finds no driver, and neither would Mesa.
        setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nonexistent.json", 1);
        setenv("EGL_PLATFORM", "nonexistent", 1);
        try {
          static_cast<void>(makeCaster(Method::Depth, sphereModel(100), smallCamera()));
        } catch (const InputError& error) {
          std::fprintf(stderr, "%s\n", error.what());
          std::_Exit(2);
        }
        std::_Exit(0);
      },
      testing::ExitedWithCode(2), "method depth: .*depth-cpu");
}

}  // namespace
}  // namespace restroke::retarget
