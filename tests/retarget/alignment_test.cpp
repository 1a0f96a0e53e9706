#include "retarget/alignment.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "implicit/errors.h"
#include "points/files/mesh_files.h"
#include "points/surfel_model.h"
#include "tests/support/alignment_trials.h"
#include "tests/support/effort.h"
#include "tests/support/meshes.h"

namespace restroke::retarget {
namespace {

using namespace restroke::testing;

/// A ball with seven swellings of different sizes in no order: it determines every motion.
TriangleMesh lumpyBall() {
  TriangleMesh mesh = ballMesh(5);
  Random random{11};
  struct Lump {
    DVec3 at;
    double height, sharpness;
  };
  std::vector<Lump> lumps;
  for (int k = 0; k < 7; ++k) {
    DVec3 at(random.inCube(1));
    at = normalized(at + DVec3(0.01));
    lumps.push_back({at, 0.15 + 0.06 * k, 3.0 + 1.5 * k});
  }
  for (Point& p : mesh.vertices) {
    double radius = 1;
    for (const Lump& l : lumps) radius += l.height * std::exp(l.sharpness * (dot(DVec3(p), l.at) - 1));
    p = Point(radius * DVec3(p));
  }
  return mesh;
}

const SurfaceSampler& lumpySurface() {
  static const SurfaceSampler surface{lumpyBall()};
  return surface;
}

constexpr std::array kMotions{TrialMotion::Shift, TrialMotion::Turn, TrialMotion::Scale, TrialMotion::All};
constexpr AlignmentOptions kQuickWhole{.points = 600};
constexpr AlignmentOptions kQuickPatch{.mode = AlignmentMode::Patch, .points = 600};

TEST(Alignment, S10FindsShiftTurnScaleAndAllAtOnceFromIndependentSamplesOfAWholeShape) {
  const SurfaceSampler& surface = lumpySurface();
  const Extent extent = extentOf(surface.mesh());
  const auto dense = surface.draw(5000, 1);
  Random random{3};
  std::uint32_t seed = 10;
  for (const TrialMotion kind : kMotions)
    for (int trial = 0; trial < (kSanitized ? 1 : 3); ++trial) {
      const Similarity truth = trialMotion(kind, extent, random);
      const std::vector<Point> stroke =
          strokeOn(dense, extent.size * static_cast<double>(random.between(0.3f, 1)), random);
      const auto before = surface.draw(5000, ++seed), after = movedPoints(truth, surface.draw(4000, ++seed));
      const Alignment a = alignSurfels(before, after, kQuickWhole);
      ASSERT_EQ(a.verdict, AlignmentVerdict::Found) << a.reason << "; seed " << seed;
      EXPECT_LE(strokeError(stroke, a.motion, truth), 0.002) << "seed " << seed;
      EXPECT_LE(a.relativeRms, 0.01);
      EXPECT_GT(a.rivalRatio, 2);
    }
}

TEST(Alignment, S10FindsAPatchThoughTheRestIsDeformed) {
  const SurfaceSampler& surface = lumpySurface();
  const Extent extent = extentOf(surface.mesh());
  const auto dense = surface.draw(5000, 1);
  Random random{4};
  std::uint32_t seed = 100;
  for (const TrialMotion kind : kMotions) {
    if (kSanitized && kind != TrialMotion::All) continue;
    const Similarity truth = trialMotion(kind, extent, random);
    const std::vector<Point> stroke = strokeOn(dense, 0.4 * extent.size, random);
    const Point middle = stroke[stroke.size() / 2];
    const double radius = 0.35 * extent.size;
    const Deformation deform{
        .center = DVec3(middle), .axis = {0.6, 0, 0.8}, .radius = radius, .fade = 0.3 * extent.size};
    const auto before = patchAround(surface.draw(20000, ++seed), std::array{middle}, radius);
    const auto after = movedPoints(truth, deformedPoints(deform, surface.draw(15000, ++seed)));
    const Alignment a = alignSurfels(before, after, kQuickPatch);
    ASSERT_EQ(a.verdict, AlignmentVerdict::Found) << a.reason << "; motion " << static_cast<int>(kind);
    EXPECT_LE(strokeError(stroke, a.motion, truth), 0.01) << "motion " << static_cast<int>(kind);
  }
}

TEST(Alignment, S10ShapesThatSlideAlongThemselvesAreFeatureless) {
  Random random{5};
  for (const PlainShape shape : {PlainShape::Ball, PlainShape::Torus, PlainShape::Shaft}) {
    const Similarity truth = trialMotion(TrialMotion::All, {}, random);
    const Alignment a =
        alignSurfels(drawPlain(shape, 5000, 1), movedPoints(truth, drawPlain(shape, 4000, 2)), kQuickWhole);
    EXPECT_EQ(a.verdict, AlignmentVerdict::Featureless) << nameOf(shape) << ": " << a.reason;
    EXPECT_LT(a.firmness, 1e-4) << nameOf(shape);
  }
}

TEST(Alignment, S10ShapesThatFitInSeveralWaysAreSymmetric) {
  Random random{6};
  for (const PlainShape shape : {PlainShape::Cube, PlainShape::Brick}) {
    const Similarity truth = trialMotion(TrialMotion::All, {}, random);
    const Alignment a =
        alignSurfels(drawPlain(shape, 5000, 1), movedPoints(truth, drawPlain(shape, 4000, 2)), kQuickWhole);
    EXPECT_EQ(a.verdict, AlignmentVerdict::Symmetric) << nameOf(shape) << ": " << a.reason;
    EXPECT_LT(a.relativeRms, 1e-3) << nameOf(shape);
    EXPECT_NEAR(a.motion.scale, truth.scale, 1e-3);
  }
}

TEST(Alignment, APatchOfABallAndOfAFlatFaceAreFeatureless) {
  for (const PlainShape shape : {PlainShape::Ball, PlainShape::Cube}) {
    const std::array middle{shape == PlainShape::Ball ? Point(0.6f, 0, 0.8f) : Point(0.1f, 0, 1)};
    const auto patch = patchAround(drawPlain(shape, 20000, 1), middle, 0.6);
    const Alignment a = alignSurfels(patch, drawPlain(shape, 15000, 2), kQuickPatch);
    EXPECT_EQ(a.verdict, AlignmentVerdict::Featureless) << nameOf(shape) << ": " << a.reason;
  }
}

TEST(Alignment, OfMotionsThatFitAlikeTheSmallestIsGiven) {
  const auto before = drawPlain(PlainShape::Brick, 5000, 1);
  const Similarity small{rotationAbout({0, 0.6, 0.8}, 0.05), 1.02, {0.1, 0, 0.05}};
  const Alignment a =
      alignSurfels(before, movedPoints(small, drawPlain(PlainShape::Brick, 4000, 2)), kQuickWhole);
  EXPECT_EQ(a.verdict, AlignmentVerdict::Symmetric) << a.reason;
  for (const OrientedPoint& p : before)
    ASSERT_LE(length(moved(a.motion, DVec3(p.position)) - moved(small, DVec3(p.position))), 0.01);
}

TEST(Alignment, WhatDidNotChangeStaysWhateverItsSymmetry) {
  for (const PlainShape shape : kPlainShapes) {
    const auto before = drawPlain(shape, 1000, 1);
    auto after = before;
    std::reverse(after.begin(), after.end());
    const Alignment a = alignSurfels(before, after);
    EXPECT_EQ(a.verdict, AlignmentVerdict::Found) << nameOf(shape);
    EXPECT_EQ(a.motion, Similarity{});
    EXPECT_EQ(a.rms, 0);
  }
}

TEST(Alignment, APatchWhosePointsAreAllStillThereStays) {
  const auto before = drawPlain(PlainShape::Ball, 4000, 1);
  const auto patch = patchAround(before, std::array{Point(0, 0, 1)}, 0.7);
  auto after = before;
  for (OrientedPoint& p : after)
    if (p.position.z < 0) p.position = p.position * 1.5f;
  const Alignment a = alignSurfels(patch, after, kQuickPatch);
  EXPECT_EQ(a.verdict, AlignmentVerdict::Found) << a.reason;
  EXPECT_EQ(a.motion, Similarity{});
  // One point elsewhere, and it is a patch of a ball like any other.
  auto other = patch;
  other.front().position = other.front().position * 1.0001f;
  EXPECT_EQ(alignSurfels(other, after, kQuickPatch).verdict, AlignmentVerdict::Featureless);
}

TEST(Alignment, AWholeShapeWithMorePointsThanBeforeIsNotUnchanged) {
  auto after = drawPlain(PlainShape::Ball, 3000, 1);
  const std::vector<OrientedPoint> before(after.begin(), after.begin() + 2999);
  EXPECT_EQ(alignSurfels(before, after, kQuickWhole).verdict, AlignmentVerdict::Featureless);
}

TEST(Alignment, AnotherShapeIsNotFound) {
  const auto lumpy = lumpySurface().draw(5000, 1);
  EXPECT_EQ(alignSurfels(lumpy, drawPlain(PlainShape::Torus, 4000, 2), kQuickWhole).verdict,
            AlignmentVerdict::NoFit);
  auto mirrored = lumpySurface().draw(4000, 2);
  for (OrientedPoint& p : mirrored) {
    p.position.x = -p.position.x;
    p.normal.x = -p.normal.x;
  }
  EXPECT_NE(alignSurfels(lumpy, mirrored, kQuickWhole).verdict, AlignmentVerdict::Found);
}

TEST(Alignment, UnevenDensityDoesNotPullTheMotion) {
  const SurfaceSampler& surface = lumpySurface();
  const auto thinned = [&](std::uint32_t seed, int axis) {
    std::vector<OrientedPoint> points = surface.draw(24000, seed), kept;
    for (std::size_t k = 0; k < points.size(); ++k)
      if (points[k].position[axis] > 0 || k % 8 == 0) kept.push_back(points[k]);
    return kept;
  };
  Random random{8};
  const Similarity truth = trialMotion(TrialMotion::All, extentOf(surface.mesh()), random);
  const Alignment a = alignSurfels(thinned(1, 0), movedPoints(truth, thinned(2, 1)), {.points = 1000});
  ASSERT_EQ(a.verdict, AlignmentVerdict::Found) << a.reason;
  const std::vector<Point> stroke = strokeOn(surface.draw(5000, 3), 1, random);
  EXPECT_LE(strokeError(stroke, a.motion, truth), 0.002);
}

/// Stamps on a ball, as sculpting leaves them, moved with the ball.
std::vector<OrientedPoint> sculpted(const Similarity& motion, int stamps) {
  points::SurfelModel model({.density = static_cast<float>(300 / (motion.scale * motion.scale))});
  Random random{21};
  std::vector<implicit::Primitive> list{{implicit::Sphere{Point(0), 1}, implicit::Sign::Positive}};
  for (int k = 0; k < stamps; ++k) {
    const DVec3 at = normalized(DVec3(random.inCube(1)) + DVec3(0.01));
    list.push_back({implicit::Sphere{Point(at), random.between(0.15f, 0.45f)},
                    k % 3 == 2 ? implicit::Sign::Negative : implicit::Sign::Positive});
  }
  for (implicit::Primitive& p : list) {
    const implicit::Sphere ball = p.shape.ball();
    p.shape = implicit::Sphere{Point(moved(motion, DVec3(ball.center))),
                               ball.radius * static_cast<float>(motion.scale)};
  }
  model.append(list);
  return orientedPoints(model.surfels());
}

TEST(Alignment, S10FindsTheMotionOfASculptedShapeFromItsSurfels) {
  Random random{9};
  const Similarity truth = trialMotion(TrialMotion::All, {}, random);
  const auto before = sculpted({}, 12), after = sculpted(truth, 12);
  const Alignment a = alignSurfels(before, after, {.points = 1000});
  ASSERT_EQ(a.verdict, AlignmentVerdict::Found) << a.reason;
  EXPECT_LE(strokeError(strokeOn(before, 1.5, random), a.motion, truth), 0.002);
}

TEST(Alignment, SomeStampsMoreDoNotPullTheMotion) {
  Random random{10};
  const Similarity truth = trialMotion(TrialMotion::Shift, {}, random);
  const auto before = sculpted({}, 11), after = sculpted(truth, 12);
  const Alignment a = alignSurfels(before, after, {.points = 1000});
  ASSERT_NE(a.verdict, AlignmentVerdict::Featureless) << a.reason;
  EXPECT_LE(strokeError(strokeOn(before, 1.5, random), a.motion, truth), 0.01);
}

TEST(Alignment, EqualArgumentsGiveEqualResults) {
  const auto before = lumpySurface().draw(3000, 1), after = lumpySurface().draw(2000, 2);
  const Alignment a = alignSurfels(before, after, kQuickWhole), b = alignSurfels(before, after, kQuickWhole);
  EXPECT_EQ(a.motion, b.motion);
  EXPECT_EQ(a.rms, b.rms);
  EXPECT_EQ(a.reason, b.reason);
}

TEST(Alignment, TooFewPointsAreNoFit) {
  const auto many = lumpySurface().draw(1000, 1), few = lumpySurface().draw(49, 2);
  EXPECT_EQ(alignSurfels(few, many).verdict, AlignmentVerdict::NoFit);
  EXPECT_EQ(alignSurfels(many, few).verdict, AlignmentVerdict::NoFit);
  EXPECT_EQ(alignSurfels({}, {}).verdict, AlignmentVerdict::NoFit);
  EXPECT_EQ(alignSurfels(few, many).motion, Similarity{});
}

TEST(Alignment, PointsAtOnePlaceOrOnALineAreNeverFound) {
  const std::vector<OrientedPoint> place(200, OrientedPoint{{1, 2, 3}, {0, 0, 1}});
  std::vector<OrientedPoint> line;
  for (int k = 0; k < 200; ++k) line.push_back({{static_cast<float>(k), 0, 0}, {0, 0, 1}});
  const auto shape = lumpySurface().draw(500, 1);
  for (const AlignmentMode mode : {AlignmentMode::Whole, AlignmentMode::Patch}) {
    EXPECT_NE(alignSurfels(place, shape, {.mode = mode, .points = 100}).verdict, AlignmentVerdict::Found);
    EXPECT_NE(alignSurfels(line, shape, {.mode = mode, .points = 100}).verdict, AlignmentVerdict::Found);
    EXPECT_NE(alignSurfels(shape, place, {.mode = mode, .points = 100}).verdict, AlignmentVerdict::Found);
    EXPECT_NE(alignSurfels(shape, line, {.mode = mode, .points = 100}).verdict, AlignmentVerdict::Found);
  }
}

TEST(Alignment, NumbersThatAreNotFiniteAreRefused) {
  const auto good = lumpySurface().draw(100, 1);
  auto bad = good;
  bad[7].position.y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW((void)alignSurfels(bad, good), InputError);
  EXPECT_THROW((void)alignSurfels(good, bad), InputError);
  bad[7] = good[7];
  bad[8].normal = Vec3(0);
  EXPECT_THROW((void)alignSurfels(bad, good), InputError);
}

TEST(Alignment, APatchIsWhatLiesNearAPointOfTheStroke) {
  const auto points = lumpySurface().draw(2000, 1);
  Random random{12};
  const std::vector<Point> stroke = strokeOn(points, 1, random);
  const auto patch = patchAround(points, stroke, 0.3);
  std::size_t found = 0;
  for (const OrientedPoint& p : points) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const Point s : stroke) nearest = std::min(nearest, length(DVec3(p.position) - DVec3(s)));
    const bool isIn = found < patch.size() && patch[found] == p;
    EXPECT_EQ(isIn, nearest <= 0.3);
    found += isIn ? 1 : 0;
  }
  EXPECT_EQ(found, patch.size());
  EXPECT_GT(found, 50u);
  EXPECT_TRUE(patchAround(points, {}, 1).empty());
}

TEST(Alignment, S10MeshesThatPeopleHaveAreFound) {
  const std::filesystem::path folder = std::filesystem::path(RESTROKE_SHARED_DIR) / "data/meshes/closed";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "the shared data is not at " << folder;
  Random random{13};
  for (const char* name : {"bunny.off", "spot.obj"}) {
    const SurfaceSampler surface(points::readMesh(folder / name));
    const Extent extent = extentOf(surface.mesh());
    const Similarity truth = trialMotion(TrialMotion::All, extent, random);
    const auto before = surface.draw(6000, 1);
    const Alignment a = alignSurfels(before, movedPoints(truth, surface.draw(5000, 2)), kQuickWhole);
    ASSERT_EQ(a.verdict, AlignmentVerdict::Found) << name << ": " << a.reason;
    EXPECT_LE(strokeError(strokeOn(before, 0.6 * extent.size, random), a.motion, truth), 0.002) << name;
    if (kSanitized) break;
  }
}

}  // namespace
}  // namespace restroke::retarget
