// The CPU splat renderer (SPEC S3, S7).

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "implicit/errors.h"
#include "points/images/cpu_renderer.h"
#include "points/surfel_model.h"
#include "tests/points/image_support.h"

namespace restroke::points {
namespace {

using implicit::Sign;
using restroke::testing::Random;
using testing::ballSurfels;
using testing::cameraAt;
using testing::DiscHit;
using testing::nearestDisc;
using testing::rayOfPixel;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A base with additions, carvings and creases.
SurfelModel sculpture(float density) {
  SurfelModel model({.density = density});
  const std::vector<implicit::Primitive> list = {
      {{{0, 0, 0}, 1.0f}, Sign::Positive},
      {{{0.4f, 0.5f, 0.8f}, 0.3f}, Sign::Positive},
      {{{-0.4f, 0.3f, 0.85f}, 0.3f}, Sign::Negative},
      {{{0.5f, 0.6f, 1.05f}, 0.15f}, Sign::Negative},
      {{{0.0f, -0.5f, 0.9f}, 0.2f}, Sign::Positive},
  };
  model.append(list);
  return model;
}

TEST(CpuRenderer, AnEmptySceneIsEmptyEverywhere) {
  const Camera camera = cameraAt(4, 70, 50);
  const DepthImage depth = renderDepth({}, camera);
  ASSERT_EQ(depth.depth.size(), 70u * 50u);
  for (const float z : depth.depth) ASSERT_EQ(z, kInfinity);
  const RenderedImage image = render({}, camera);
  EXPECT_EQ(image.depth, depth.depth);
  EXPECT_EQ(image.rgba, std::vector<float>(4 * 70 * 50, 0.0f));
  EXPECT_EQ(image.normal, std::vector<float>(3 * 70 * 50, 0.0f));
  EXPECT_EQ(image.primitive, std::vector<std::uint32_t>(70 * 50, kNoId));
  EXPECT_EQ(image.stroke, std::vector<std::uint32_t>(70 * 50, kNoId));
}

// The documented bound: 1e-5 of the depth. Pixels within 1e-3 radii of a rim may go either way.
void compareWithDefinition(const std::vector<Surfel>& surfels, const Camera& camera) {
  const DepthImage image = renderDepth(surfels, camera);
  std::size_t covered = 0, atRims = 0;
  for (std::size_t p = 0; p < image.depth.size(); ++p) {
    const DiscHit expected = nearestDisc(surfels, rayOfPixel(camera, p));
    covered += std::isfinite(expected.depth);
    if (expected.rimDistance < 1e-3 || expected.cosine < 0.01) {
      ++atRims;
      continue;
    }
    if (std::isfinite(expected.depth)) {
      ASSERT_NEAR(image.depth[p], expected.depth, 1e-5 * expected.depth) << "pixel " << p;
    } else {
      ASSERT_EQ(image.depth[p], kInfinity) << "pixel " << p;
    }
  }
  EXPECT_GT(covered, image.depth.size() / 10);
  EXPECT_LT(atRims, image.depth.size() / 5);  // so that the comparison means something
}

TEST(CpuRenderer, DepthIsThatOfTheNearestDiscOnEveryRayS7) {
  Random random(7);
  const std::vector<Surfel> surfels = testing::randomSurfels(random, 150, 1.5f);
  compareWithDefinition(surfels, cameraAt(6, 150, 110));
}

TEST(CpuRenderer, DiscsThroughAndBehindTheCameraAreDrawnWhereTheyAreInFrontOfIt) {
  Random random(8);
  const std::vector<Surfel> surfels = testing::randomSurfels(random, 150, 1.5f);
  Camera camera = cameraAt(0.1f, 150, 110);  // in the middle of them
  camera.halfHeight = 1.2f;
  compareWithDefinition(surfels, camera);
}

TEST(CpuRenderer, ObliqueCamerasAndOffCentreDiscsObeyTheDefinition) {
  Random random(9);
  const std::vector<Surfel> surfels = testing::randomSurfels(random, 120, 2.0f);
  Camera camera = cameraAt(3, 131, 67);
  camera.position = {1.5f, -2.0f, 2.5f};
  camera.view = {-2.0f, 2.5f, -3.0f};
  camera.up = {0.3f, 0.1f, 1.0f};
  compareWithDefinition(surfels, camera);
}

TEST(CpuRenderer, NearAndFarPlanesCutDiscsOff) {
  Random random(10);
  const std::vector<Surfel> surfels = testing::randomSurfels(random, 150, 1.5f);
  Camera camera = cameraAt(6, 150, 110);
  camera.near = 5.5f;
  camera.far = 6.5f;
  compareWithDefinition(surfels, camera);
}

TEST(CpuRenderer, DepthOfASphereIsExactWithinTheSagittaOfItsDiscs) {
  const int count = 20000;
  const std::vector<Surfel> surfels = ballSurfels({{0, 0, 0}, 1}, count);
  const Camera camera = cameraAt(4, 400, 300);
  const DepthImage image = renderDepth(surfels, camera);
  const implicit::Sphere sphere{{0, 0, 0}, 1};
  // A disc touches the sphere at its centre; its rim is this far outside.
  const double r = static_cast<double>(surfels[0].radius), sagitta = std::sqrt(1 + r * r) - 1;
  std::size_t compared = 0;
  for (std::size_t p = 0; p < image.depth.size(); ++p) {
    const Ray ray = rayOfPixel(camera, p);
    const auto interval = intersect(sphere, ray);
    if (!interval) continue;
    const DVec3 n = outwardNormal(sphere, ray.at(interval->enter));
    const double cosine = -dot(n, ray.direction) / length(ray.direction);
    if (cosine < 0.3) continue;
    ++compared;
    // Never behind the sphere (each pixel is covered: no gaps), and before it by the rim's height at that
    // slant at most.
    ASSERT_LT(image.depth[p], interval->enter * (1 + 1e-6)) << "pixel " << p;
    ASSERT_GT(image.depth[p], interval->enter - 1.3 * sagitta / cosine) << "pixel " << p;
  }
  EXPECT_GT(compared, 30000u);
}

TEST(CpuRenderer, NormalsAndIdsAreThoseOfTheNearestSurface) {
  std::vector<Surfel> surfels = ballSurfels({{0, 0, 0}, 1}, 8000, 0);
  const std::vector<Surfel> front = ballSurfels({{0, 0, 1.2f}, 0.4f}, 4000, 5, Sign::Negative);
  for (Surfel s : front) {
    s.normal = -s.normal;  // a carved primitive's discs, turned so that the camera sees them
    surfels.push_back(s);
  }
  const std::vector<std::uint32_t> strokes = {0, 11, 12, 13, 14, 15};
  const Camera camera = cameraAt(4, 200, 150);
  const RenderedImage image = render({.surfels = surfels, .strokeOfPrimitive = strokes}, camera);
  std::size_t onFront = 0, onBase = 0;
  for (std::size_t p = 0; p < image.pixels(); ++p) {
    const DVec3 n(image.normal[3 * p], image.normal[3 * p + 1], image.normal[3 * p + 2]);
    if (!std::isfinite(image.depth[p])) {
      EXPECT_EQ(image.primitive[p], kNoId);
      EXPECT_EQ(image.stroke[p], kNoId);
      EXPECT_EQ(length(n), 0);
      continue;
    }
    const DVec3 hit = rayOfPixel(camera, p).at(static_cast<double>(image.depth[p]));
    const bool isFront = image.primitive[p] == 5;
    (isFront ? onFront : onBase)++;
    ASSERT_EQ(image.primitive[p], isFront ? 5u : 0u);
    ASSERT_EQ(image.stroke[p], isFront ? 15u : 0u);
    // The disc touches its sphere within a radius of the hit: the normals differ by that angle at most.
    const DVec3 center(0, 0, isFront ? static_cast<double>(1.2f) : 0.0);
    const double r = static_cast<double>(isFront ? front[0].radius / 0.4f : surfels[0].radius);
    ASSERT_GT(dot(n, normalized(hit - center)), std::cos(1.1 * r)) << "pixel " << p;
  }
  EXPECT_GT(onFront, 1000u);
  EXPECT_GT(onBase, 1000u);
}

TEST(CpuRenderer, PrimitivesWithoutAStrokeHaveNoStrokeId) {
  const std::vector<Surfel> surfels = ballSurfels({{0, 0, 0}, 1}, 500, 3);
  const std::vector<std::uint32_t> tooShort = {0, 1};
  const RenderedImage image =
      render({.surfels = surfels, .strokeOfPrimitive = tooShort}, cameraAt(4, 20, 20));
  EXPECT_EQ(image.primitive[10 * 20 + 10], 3u);
  EXPECT_EQ(image.stroke[10 * 20 + 10], kNoId);
}

TEST(CpuRenderer, LayersAreBitForBitThoseOfTheDepthImage) {
  const std::vector<Surfel> surfels = sculpture(4000).surfels();
  for (const std::uint32_t width : {64u, 201u, 333u}) {
    const Camera camera = cameraAt(4, width, 150);
    EXPECT_EQ(render({.surfels = surfels}, camera).depth, renderDepth(surfels, camera).depth) << width;
  }
}

TEST(CpuRenderer, ThreadsChangeNoBit) {
  const SurfelModel model = sculpture(20000);
  const std::vector<Surfel> surfels = model.surfels();
  const Camera camera = cameraAt(4, 500, 400);
  for (const implicit::PrimitiveList* list :
       {static_cast<const implicit::PrimitiveList*>(nullptr), &model.list()}) {
    const Scene scene = {.surfels = surfels, .list = list};
    const RenderedImage one = render(scene, camera, {}, {.threads = 1});
    for (const int threads : {2, 8}) {
      const RenderedImage many = render(scene, camera, {}, {.threads = threads});
      EXPECT_EQ(many.rgba, one.rgba) << threads;
      EXPECT_EQ(many.depth, one.depth) << threads;
      EXPECT_EQ(many.normal, one.normal) << threads;
      EXPECT_EQ(many.primitive, one.primitive) << threads;
      EXPECT_EQ(many.stroke, one.stroke) << threads;
      EXPECT_EQ(renderDepth(surfels, camera, {.threads = threads}).depth, one.depth) << threads;
    }
  }
}

TEST(CpuRenderer, AmongEqualDepthsTheFirstDiscIsSeen) {
  std::vector<Surfel> surfels(3, Surfel{{0, 0, 0}, {0, 0, 1}, 1, 0, Sign::Positive});
  surfels[0].primitive = 7;
  surfels[1].primitive = 3;
  const RenderedImage image = render({.surfels = surfels}, cameraAt(4, 9, 9));
  EXPECT_EQ(image.primitive[4 * 9 + 4], 7u);
}

TEST(CpuRenderer, FacesTurnedAwayAreNotDrawn) {
  const std::vector<Surfel> surfels = ballSurfels({{0, 0, 0}, 2}, 2000);
  for (const float z : renderDepth(surfels, cameraAt(0.5f, 30, 30)).depth)
    ASSERT_EQ(z, kInfinity);  // from inside
  const std::vector<Surfel> behind = ballSurfels({{0, 0, 9}, 1}, 2000);
  for (const float z : renderDepth(behind, cameraAt(4, 30, 30)).depth) ASSERT_EQ(z, kInfinity);
}

TEST(CpuRenderer, ACarvedHollowIsSeenFromInside) {
  const std::vector<Surfel> surfels = ballSurfels({{0, 0, 0}, 2}, 20000, 1, Sign::Negative);
  const RenderedImage image = render({.surfels = surfels}, cameraAt(0, 40, 40));
  for (std::size_t p = 0; p < image.pixels(); ++p) {
    const Ray ray = rayOfPixel(cameraAt(0, 40, 40), p);
    ASSERT_NEAR(static_cast<double>(image.depth[p]) * length(ray.direction), 2.0, 0.01);
    ASSERT_EQ(image.rgba[4 * p + 3], 1.0f);
  }
}

TEST(CpuRenderer, AViewportOfOnePixelSeesTheMiddle) {
  const std::vector<Surfel> surfels = ballSurfels({{0, 0, 0}, 1}, 20000);
  const Camera camera = cameraAt(4, 1, 1);
  const DepthImage depth = renderDepth(surfels, camera);
  ASSERT_EQ(depth.depth.size(), 1u);
  EXPECT_NEAR(depth.at(0, 0), 3.0, 0.001);
  EXPECT_EQ(render({.surfels = surfels}, camera).depth, depth.depth);
}

TEST(CpuRenderer, SurfelsThatAreNotFiniteOrHaveNoSizeAreLeftOut) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Surfel> surfels = ballSurfels({{0, 0, 0}, 1}, 2000);
  const Camera camera = cameraAt(4, 60, 60);
  const RenderedImage expected = render({.surfels = surfels}, camera);
  surfels.push_back({{nan, 0, 2}, {0, 0, 1}, 0.5f});
  surfels.push_back({{0, 0, 2}, {0, nan, 1}, 0.5f});
  surfels.push_back({{0, 0, 2}, {0, 0, 1}, nan});
  surfels.push_back({{0, 0, 2}, {0, 0, 1}, 0});
  surfels.push_back({{0, 0, 2}, {0, 0, 1}, -1});
  surfels.push_back({{0, 0, 2}, {0, 0, 0}, 1});
  surfels.push_back({{0, 0, 2}, {1, 0, 0}, 1});  // edge-on
  surfels.push_back({{0, kInfinity, 2}, {0, 0, 1}, 1});
  const RenderedImage image = render({.surfels = surfels}, camera);
  EXPECT_EQ(image.depth, expected.depth);
  EXPECT_EQ(image.rgba, expected.rgba);
}

TEST(CpuRenderer, HugeDiscsCoverEverythingAndTinyOnesMayFallBetweenPixels) {
  const std::vector<Surfel> huge = {{{0, 0, 0}, {0, 0, 1}, 1e6f}};
  for (const float z : renderDepth(huge, cameraAt(4, 200, 130)).depth) ASSERT_NEAR(z, 4.0f, 4e-5f);
  const std::vector<Surfel> tiny = {{{0, 0, 0}, {0, 0, 1}, 1e-6f}};  // at a corner of four pixels
  for (const float z : renderDepth(tiny, cameraAt(4, 200, 130)).depth) ASSERT_EQ(z, kInfinity);
}

/// Sum of coverage as an area of the picture in pixels.
double coverage(const RenderedImage& image) {
  double sum = 0;
  for (std::size_t p = 0; p < image.pixels(); ++p) sum += static_cast<double>(image.rgba[4 * p + 3]);
  return sum;
}

TEST(CpuRenderer, SilhouettesAreSmoothAndInPlace) {
  SurfelModel model({.density = 8000});
  const implicit::Primitive ball{{{0, 0, 0}, 1.0f}, Sign::Positive};
  model.append(std::span(&ball, 1));
  const std::vector<Surfel> surfels = model.surfels();
  const Camera camera = cameraAt(4, 300, 200);
  const Scene scene = {.surfels = surfels, .list = &model.list()};
  const RenderedImage image = render(scene, camera, {.samples = 16});
  // A sphere of radius 1 at distance 4 on the axis is a disc of radius 1 / sqrt(15) at unit distance.
  const double radius = 1 / std::sqrt(15.0) * 100 / static_cast<double>(camera.halfHeight);
  EXPECT_NEAR(coverage(image), 3.14159265358979 * radius * radius, 0.0005 * radius * radius);
  std::size_t partial = 0;
  for (std::size_t p = 0; p < image.pixels(); ++p) {
    const float alpha = image.rgba[4 * p + 3];
    if (alpha > 0 && alpha < 1) ++partial;
    const double x = static_cast<double>(p % 300) + 0.5 - 150, y = static_cast<double>(p / 300) + 0.5 - 100;
    const double distance = std::sqrt(x * x + y * y);
    if (distance < radius - 1) {
      ASSERT_EQ(alpha, 1.0f) << p;
    } else if (distance > radius + 1.2) {
      ASSERT_EQ(alpha, 0.0f) << p;
    }
  }
  EXPECT_GT(partial, 400u);  // about 8 / pi pixels for each one of the radius
  // From the discs alone: outside by their sagitta at most.
  EXPECT_NEAR(coverage(render({.surfels = surfels}, camera, {.samples = 16})), coverage(image),
              0.005 * coverage(image));
  // One sample: every pixel is in or out.
  const RenderedImage hard = render(scene, camera, {.samples = 1});
  for (std::size_t p = 0; p < hard.pixels(); ++p)
    ASSERT_EQ(hard.rgba[4 * p + 3], std::isfinite(hard.depth[p]) ? 1.0f : 0.0f);
}

TEST(CpuRenderer, SamplesOcclusionAndListChangeOnlyTheColour) {
  const SurfelModel model = sculpture(6000);
  const std::vector<Surfel> surfels = model.surfels();
  const Camera camera = cameraAt(4, 160, 120);
  const RenderedImage plain =
      render({.surfels = surfels}, camera, {.samples = 1, .occlusion = Occlusion::None});
  const RenderedImage fine = render({.surfels = surfels, .list = &model.list()}, camera, {.samples = 16});
  EXPECT_EQ(plain.depth, fine.depth);
  EXPECT_EQ(plain.normal, fine.normal);
  EXPECT_EQ(plain.primitive, fine.primitive);
  EXPECT_NE(plain.rgba, fine.rgba);
}

TEST(CpuRenderer, CarvedAndAddedSurfacesDifferInColour) {
  const SurfelModel model = sculpture(20000);
  const std::vector<Surfel> surfels = model.surfels();
  const RenderedImage image = render({.surfels = surfels}, cameraAt(4, 300, 220), {.samples = 1});
  const auto warmth = [&](auto isWanted) {  // red less blue, relative to the sum
    double red = 0, blue = 0;
    std::size_t count = 0;
    for (std::size_t p = 0; p < image.pixels(); ++p) {
      if (image.primitive[p] == kNoId || !isWanted(image.primitive[p])) continue;
      red += static_cast<double>(image.rgba[4 * p]);
      blue += static_cast<double>(image.rgba[4 * p + 2]);
      ++count;
    }
    EXPECT_GT(count, 500u);
    return (red - blue) / (red + blue);
  };
  const double base = warmth([](std::uint32_t i) { return i == 0; });
  const double added = warmth([](std::uint32_t i) { return i == 1 || i == 4; });
  const double carved = warmth([](std::uint32_t i) { return i == 2 || i == 3; });
  EXPECT_GT(added, base + 0.1);
  EXPECT_GT(base, carved + 0.3);
}

TEST(CpuRenderer, ColoursAreFiniteAndPremultiplied) {
  const SurfelModel model = sculpture(6000);
  const std::vector<Surfel> surfels = model.surfels();
  const RenderedImage image = render({.surfels = surfels, .list = &model.list()}, cameraAt(3, 200, 150));
  for (std::size_t p = 0; p < image.pixels(); ++p) {
    const float alpha = image.rgba[4 * p + 3];
    ASSERT_TRUE(alpha >= 0 && alpha <= 1);
    for (std::size_t c = 0; c < 3; ++c)
      ASSERT_TRUE(image.rgba[4 * p + c] >= 0 && image.rgba[4 * p + c] <= 2 * alpha);
  }
}

TEST(CpuRenderer, RefusesOptionsAndViewportsOutOfRange) {
  const Camera camera = cameraAt(4, 10, 10);
  EXPECT_THROW((void)render({}, camera, {.samples = 0}), InputError);
  EXPECT_THROW((void)render({}, camera, {.samples = 17}), InputError);
  RenderOptions options;
  options.palette.added[1] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW((void)render({}, camera, options), InputError);
  EXPECT_THROW((void)renderDepth({}, cameraAt(4, 0, 10)), InputError);
  EXPECT_THROW((void)render({}, cameraAt(4, 10, 0)), InputError);
  EXPECT_THROW((void)renderDepth({}, cameraAt(4, 65536, 65536)), InputError);
  EXPECT_THROW((void)renderDepth({}, cameraAt(std::numeric_limits<float>::quiet_NaN(), 10, 10)), InputError);
}

}  // namespace
}  // namespace restroke::points
