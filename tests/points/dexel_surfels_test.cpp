// What tri-dexels look like: pictures of their surfels against rays cast into the list.

#include "points/dexel/dexel_surfels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <vector>

#include "implicit/errors.h"
#include "implicit/ray_cast.h"
#include "implicit/shapes/kinds.h"
#include "points/files/point_files.h"
#include "points/images/cpu_renderer.h"
#include "points/images/gl_renderer.h"
#include "tests/points/image_support.h"
#include "tests/support/random_volumes.h"

namespace restroke::points {
namespace {

using implicit::Primitive;
using implicit::PrimitiveList;
using implicit::Sign;
using restroke::testing::Random;

implicit::Shape boxAt(Point center, Vec3 size, std::array<float, 4> rotation = {0, 0, 0, 1}) {
  const Vec3 half = size * 0.5f;
  const implicit::VolumeParameters parameters{{{half.x}, {half.y}, {half.z}, {0}}, {}};
  implicit::Pose pose;
  pose.position = center;
  pose.rotation = rotation;
  return std::make_shared<const implicit::PosedVolume>(implicit::boxKind().make(parameters), pose);
}

PrimitiveList listOf(const std::vector<Primitive>& primitives) {
  PrimitiveList list;
  for (const Primitive& primitive : primitives) list.append(primitive);
  return list;
}

// A block with a slot and a step, all of whose faces are along two of the families, and off the grid.
PrimitiveList part() {
  return listOf({{boxAt({0.013f, -0.007f, 0.004f}, {2, 1.3f, 0.9f}), Sign::Positive},
                 {boxAt({0.3f, 0.2f, 0.41f}, {0.523f, 2, 0.51f}), Sign::Negative},
                 {boxAt({-0.71f, 0.1f, 0.63f}, {0.4f, 0.37f, 0.5f}), Sign::Positive}});
}

Camera cameraFrom(Vec3 direction) {
  Camera camera = testing::cameraAt(1, 400, 300);
  camera.position = direction * 4.0f;
  camera.view = -direction;
  camera.up = {0.1f, 0.95f, 0.2f};
  camera.halfHeight = 0.4f;
  return camera;
}

struct Comparison {
  std::size_t hit = 0, missed = 0, wrong = 0;
};

// Pixels where a ray meets the list's shape; of those, the ones that nothing is drawn at though all within
// two pixels around meet it too, and the ones whose depth is none of those around, by `tolerance`.
Comparison compare(const std::vector<Surfel>& surfels, const PrimitiveList& list, const Camera& camera,
                   double tolerance) {
  const DepthImage picture = renderDepth(surfels, camera);
  std::vector<double> truth(picture.depth.size(), HUGE_VAL);
  for (std::size_t i = 0; i < truth.size(); ++i)
    if (const auto hit = castRay(list, testing::rayOfPixel(camera, i))) truth[i] = hit->t;
  Comparison out;
  const int w = static_cast<int>(camera.width), h = static_cast<int>(camera.height);
  for (int y = 2; y < h - 2; ++y)
    for (int x = 2; x < w - 2; ++x) {
      const auto i = static_cast<std::size_t>(y * w + x);
      if (truth[i] == HUGE_VAL) continue;
      ++out.hit;
      double least = HUGE_VAL, most = 0;
      for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx) {
          const double t = truth[static_cast<std::size_t>((y + dy) * w + x + dx)];
          least = std::fmin(least, t);
          most = std::fmax(most, t);
        }
      const auto depth = static_cast<double>(picture.depth[i]);
      if (!std::isfinite(depth) && std::isfinite(most)) ++out.missed;
      if (!(depth > least - tolerance && depth <= most + tolerance)) ++out.wrong;
    }
  return out;
}

TEST(DexelSurfels, D7FacesAlongAFamilysLinesHaveHolesThatTheThreeTogetherDoNot) {
  const PrimitiveList list = part();
  const TriDexel model = triDexelOf(list, dexelGridFor(list.bounds(), {.resolution = 64}));
  const double cell = model.grid().cell();
  for (const Vec3 direction :
       {Vec3(0.6f, 0.5f, 0.62f), Vec3(-0.5f, -0.4f, 0.77f), Vec3(0.3f, -0.8f, -0.52f)}) {
    const Camera camera = cameraFrom(normalized(direction));
    for (int axis = 0; axis < 3; ++axis) {
      const Comparison alone = compare(surfelsOf(model, {.family = axis}), list, camera, 2.5 * cell);
      EXPECT_GT(alone.missed + alone.wrong, alone.hit / 10) << axis;
    }
    const Comparison all = compare(surfelsOf(model), list, camera, 2.5 * cell);
    EXPECT_GT(all.hit, 10'000u);
    EXPECT_EQ(all.missed, 0u);
    EXPECT_EQ(all.wrong, 0u);
  }
}

TEST(DexelSurfels, D7ShapesOfAnyKindAreWithoutHoles) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    Random random(seed);
    std::vector<Primitive> primitives = {{{{0, 0, 0}, 1.0f}, Sign::Positive}};
    while (primitives.size() < 30)
      primitives.push_back({{random.inCube(0.9f), random.between(0.25f, 0.5f)},
                            random.below(2) == 0 ? Sign::Positive : Sign::Negative});
    primitives.push_back(
        {boxAt({0, 0.4f, 0}, {1.9f, 0.6f, 0.7f}, {0.3f, 0.2f, -0.4f, 0.8f}), Sign::Positive});
    const PrimitiveList list = listOf(primitives);
    const TriDexel model = triDexelOf(list, dexelGridFor(list.bounds(), {.resolution = 96}));
    const Comparison all = compare(surfelsOf(model), list, cameraFrom(normalized(Vec3(0.5f, 0.3f, 0.8f))),
                                   3 * model.grid().cell());
    EXPECT_GT(all.hit, 10'000u);
    // Tips between spheres get thinner than a cell, and there discs stick out by their radius.
    EXPECT_LT(all.missed, all.hit / 10'000) << seed;
    EXPECT_LT(all.wrong, all.hit / 1'000) << seed;
  }
}

TEST(DexelSurfels, D7WhatIsCutAddedAndUntouchedIsTold) {
  const PrimitiveList list = listOf({{{{0, 0, 0}, 1.0f}, Sign::Positive},
                                     {{{0, 0, 1}, 0.5f}, Sign::Negative},
                                     {{{0, 1, 0}, 0.4f}, Sign::Positive},
                                     {{{0, 1.4f, 0}, 0.2f}, Sign::Negative}});
  const TriDexel model = triDexelOf(list, dexelGridFor(list.bounds(), {.resolution = 50}));
  const std::vector<Surfel> surfels = surfelsOf(model, {.ends = DexelEnds::All});
  EXPECT_EQ(surfels.size(), model.endCount());
  std::array<std::size_t, 4> counts{};
  for (const Surfel& s : surfels) {
    ASSERT_LT(s.primitive, 4u);
    ++counts[s.primitive];
    const Primitive owner = list.at(s.primitive);
    EXPECT_EQ(s.sign, owner.sign);
    const implicit::Sphere ball = owner.shape.ball();
    EXPECT_NEAR(length(s.position - ball.center), ball.radius, 1e-6f);
    const SurfaceKind kind = kindOf({.surfels = surfels}, s.primitive, s.sign);
    EXPECT_EQ(kind, s.primitive == 0   ? SurfaceKind::Base
                    : s.primitive == 2 ? SurfaceKind::Added
                                       : SurfaceKind::Carved);
  }
  for (const std::size_t count : counts) EXPECT_GT(count, 20u);
}

TEST(DexelSurfels, D7TheColoursOfCpuAndOpenGlPicturesAreThoseOfCutAndUncut) {
  const PrimitiveList list =
      listOf({{{{0, 0, 0}, 1.0f}, Sign::Positive}, {{{0, 0, 1}, 0.6f}, Sign::Negative}});
  const TriDexel model = triDexelOf(list, dexelGridFor(list.bounds(), {.resolution = 80}));
  const std::vector<Surfel> surfels = surfelsOf(model);
  const Camera camera = cameraFrom({0, 0, 1});
  const RenderedImage picture = render({.surfels = surfels}, camera);
  const std::size_t middle = 150 * 400 + 200, side = 150 * 400 + 110;
  EXPECT_EQ(picture.primitive[middle], 1u);
  EXPECT_EQ(picture.primitive[side], 0u);
  GlRenderer gl;
  const DepthImage depth = gl.renderDepth(surfels, camera);
  std::size_t different = 0;
  for (std::size_t i = 0; i < depth.depth.size(); ++i)
    if (std::isfinite(depth.depth[i]) != std::isfinite(picture.depth[i])) ++different;
  EXPECT_LE(different, 12u);
}

TEST(DexelSurfels, ThreadsChangeNothingAndNothingGivesNothing) {
  const PrimitiveList list = part();
  const TriDexel model = triDexelOf(list, dexelGridFor(list.bounds(), {.resolution = 40}));
  const std::vector<Surfel> one = surfelsOf(model, {}, {.threads = 1});
  for (const int threads : {2, 8}) {
    const std::vector<Surfel> many = surfelsOf(model, {}, {.threads = threads});
    ASSERT_EQ(many.size(), one.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      ASSERT_EQ(many[i].position, one[i].position);
      ASSERT_EQ(many[i].radius, one[i].radius);
    }
  }
  EXPECT_TRUE(surfelsOf(TriDexel(model.grid())).empty());
  EXPECT_TRUE(surfelsOf(TriDexel()).empty());
  EXPECT_THROW((void)surfelsOf(model, {.family = 3}), InputError);
}

TEST(DexelSurfels, D8AreWrittenAsPointsWithNormals) {
  const PrimitiveList list = listOf({{{{0, 0, 0}, 1.0f}, Sign::Positive}});
  const TriDexel model = triDexelOf(list, dexelGridFor(list.bounds(), {.resolution = 20}));
  const auto file = std::filesystem::temp_directory_path() / "restroke_dexel_surfels.xyz";
  writeXyz(file, surfelsOf(model, {.ends = DexelEnds::All}));
  std::ifstream in(file);
  std::size_t lines = 0;
  double p[3], n[3];
  while (in >> p[0] >> p[1] >> p[2] >> n[0] >> n[1] >> n[2]) {
    ++lines;
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(p[a], n[a], 3e-4);
  }
  EXPECT_EQ(lines, model.endCount());
  std::filesystem::remove(file);
}

}  // namespace
}  // namespace restroke::points
