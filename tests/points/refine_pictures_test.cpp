// Pictures from rays, and of lines themselves (SPEC R3, R9).

#include <gtest/gtest.h>

#include <cmath>

#include "implicit/errors.h"
#include "points/dexel/refine/ray_picture.h"
#include "points/dexel/refine/refined_surfels.h"
#include "points/dexel/span_rods.h"
#include "tests/points/refine_support.h"

namespace restroke::points {
namespace {

using implicit::Sign;

// A unit ball with a hollow on the side of the camera, which looks along -z from z = 4.
struct Hollowed {
  TriDexelDocument document;
  Camera camera;
  Hollowed() {
    document.initial = std::vector<implicit::Primitive>{{{{0, 0, 0}, 1.0f}, Sign::Positive}};
    document.operations.push_back(testing::operationOf({{{0, 0, 1}, 0.5f}, Sign::Negative}));
    document.operations.push_back(testing::operationOf({{{0.7f, 0.7f, 0}, 0.3f}, Sign::Positive}));
    testing::makeModel(document, 24);
    camera.width = 80;
    camera.height = 60;
  }
  [[nodiscard]] Dexels rays(int across, Camera seen) const {
    const DexelHistory history(document);
    const Zone zone(withRays(seen, across));
    return refine({document, history}, {zone, newLines(zone, {.perPixel = true})},
                  {.method = RefineMethod::All})
        .families[0]
        .dexels;
  }
};

TEST(RayPicture, R9ShowsWhatTheRaysMeetFirst) {
  const Hollowed made;
  const RenderedImage image = pictureOf(made.rays(1, made.camera), made.camera);
  const auto at = [&](std::uint32_t x, std::uint32_t y) { return std::size_t{y} * image.width + x; };
  // The middle: the hollow's bottom at z = 0.5, made by operation 1, facing the camera.
  const std::size_t middle = at(40, 30);
  EXPECT_NEAR(image.depth[middle], 3.5f, 2e-3f);
  EXPECT_EQ(image.primitive[middle], 1u);
  EXPECT_NEAR(image.normal[3 * middle + 2], 1, 2e-3f);
  EXPECT_EQ(image.rgba[4 * middle + 3], 1);
  // A corner: nothing.
  EXPECT_TRUE(std::isinf(image.depth[0]));
  EXPECT_EQ(image.primitive[0], kNoId);
  EXPECT_EQ(image.rgba[3], 0);
  std::size_t base = 0, added = 0;
  for (std::size_t p = 0; p < image.pixels(); ++p) {
    base += image.primitive[p] == 0 ? 1 : 0;
    added += image.primitive[p] == 2 ? 1 : 0;
  }
  EXPECT_GT(base, 300u);
  EXPECT_GT(added, 30u);
}

TEST(RayPicture, R9SeveralRaysAPixelCoverEdgesInParts) {
  const Hollowed made;
  const Dexels rays = made.rays(3, made.camera);
  EXPECT_EQ(rays.width(), 240);
  const RenderedImage image = pictureOf(rays, made.camera),
                      again = pictureOf(rays, made.camera, {}, {.threads = 3});
  EXPECT_EQ(image.rgba, again.rgba);
  EXPECT_EQ(image.depth, again.depth);
  std::size_t parts = 0;
  for (std::size_t p = 0; p < image.pixels(); ++p)
    parts += image.rgba[4 * p + 3] > 0 && image.rgba[4 * p + 3] < 1 ? 1 : 0;
  EXPECT_GT(parts, 50u);
  // The middle ray is that of the picture with one.
  const RenderedImage one = pictureOf(made.rays(1, made.camera), made.camera);
  for (std::size_t p = 0; p < image.pixels(); ++p)
    if (std::isfinite(one.depth[p])) {
      EXPECT_NEAR(image.depth[p], one.depth[p], 1e-5f);
    }
}

TEST(RayPicture, R9ACutByTheNearPlaneFacesTheCamera) {
  const Hollowed made;
  Camera camera = made.camera;
  camera.near = 4;  // through the middle of the ball
  const RenderedImage image = pictureOf(made.rays(1, camera), camera);
  const std::size_t middle = std::size_t{30} * image.width + 40;
  EXPECT_NEAR(image.depth[middle], 4, 1e-4f);
  EXPECT_GT(image.normal[3 * middle + 2], 0.99f);
}

TEST(RayPicture, RefusesRaysThatNoPixelHas) {
  Camera camera;
  EXPECT_THROW((void)withRays(camera, 0), InputError);
  EXPECT_THROW((void)withRays(camera, kMostRaysAcross + 1), InputError);
  camera.width = 60'000;
  EXPECT_THROW((void)withRays(camera, 2), InputError);
}

TEST(RefinedSurfels, LieOnTheSurfaceAndFaceOutOfIt) {
  const Hollowed made;
  const DexelHistory history(made.document);
  std::size_t onBall = 0;
  for (const Zone& zone : testing::someZones()) {
    const RefinedModel refined = refine({made.document, history}, {zone, newLines(zone, {.resolution = 30})});
    const std::vector<Surfel> surfels = surfelsOf(refined);
    std::size_t ends = 0;
    for (const RefinedFamily& family : refined.families) ends += family.dexels.endCount();
    EXPECT_EQ(surfels.size(), ends);
    for (const Surfel& surfel : surfels) {
      EXPECT_GT(surfel.radius, 0);
      if (std::fabs(length(surfel.position) - 1) > 1e-5f || surfel.primitive != 0) continue;
      ++onBall;
      EXPECT_GT(dot(surfel.normal, surfel.position), 0.999f);
      EXPECT_EQ(surfel.sign, Sign::Positive);
    }
  }
  EXPECT_GT(onBall, 500u);
}

TEST(SpanRods, ReachFromEndToEnd) {
  Dexels dexels(2, 1, {});
  dexels.write(1, std::vector<SpanEnd>{{1, 0}, {3, 0}});
  const LineFamily lines{
      .width = 2, .height = 1, .direction = {0, 0, 1}, .originStep = {5, 0, 0}, .originRowStep = {0, 1, 0}};
  std::vector<Surfel> rods;
  appendRods(dexels, lines, {.radius = 0.1f, .primitive = 7}, rods);
  ASSERT_GT(rods.size(), 200u);
  float low = 9, high = -9;
  for (const Surfel& surfel : rods) {
    EXPECT_EQ(surfel.primitive, 7u);
    EXPECT_LE(std::hypot(surfel.position.x - 5, surfel.position.y), 0.1001f);
    EXPECT_NEAR(length(surfel.normal), 1, 1e-5f);
    low = std::min(low, surfel.position.z);
    high = std::max(high, surfel.position.z);
  }
  EXPECT_EQ(low, 1);
  EXPECT_EQ(high, 3);
  rods.clear();
  for (const Zone& zone : testing::someZones()) {
    appendEdges(zone, {.radius = 0.01f}, rods);
    EXPECT_GT(rods.size(), 1000u);
    for (const Surfel& surfel : rods) EXPECT_TRUE(zone.widened(0.011).contains(DVec3(surfel.position)));
    rods.clear();
  }
  EXPECT_THROW(appendRods(dexels, lines, {.radius = 1e-7f}, rods), InputError);
}

}  // namespace
}  // namespace restroke::points
