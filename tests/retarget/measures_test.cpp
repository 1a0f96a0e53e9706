// SPEC X2: what the measures say of results whose errors are known.

#include "retarget/measures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "retarget/surface_distance.h"
#include "tests/retarget/test_shapes.h"
#include "tests/retarget/test_trails.h"
#include "tests/support/brute_force.h"
#include "tests/support/random_volumes.h"

namespace restroke::retarget {
namespace {

using restroke::testing::Random;

std::vector<DVec3> randomWalk(Random& random, std::size_t vertices, float step) {
  std::vector<DVec3> walk{DVec3(random.inCube(1))};
  while (walk.size() < vertices) walk.push_back(walk.back() + DVec3(random.inCube(step)));
  return walk;
}

/// The definition, at points all along the segments.
double hausdorffBySampling(const Polylines& a, const Polylines& b, int parts) {
  double most = 0;
  for (const auto& [from, to] : {std::pair(&a, &b), std::pair(&b, &a)})
    for (const auto& piece : *from)
      for (std::size_t i = 0; i < piece.size(); ++i)
        for (int k = 0; k < (i + 1 < piece.size() ? parts : 1); ++k) {
          const DVec3 step = i + 1 < piece.size() ? piece[i + 1] - piece[i] : DVec3(0);
          most = std::max(most, distanceTo(*to, piece[i] + step * (static_cast<double>(k) / parts)));
        }
  return most;
}

TEST(HausdorffDistance, IsWhatSamplingTheSegmentsFinelyFinds) {
  Random random(6);
  for (int round = 0; round < 40; ++round) {
    const float step = round % 2 == 0 ? 0.1f : 1.0f;
    Polylines a{randomWalk(random, 2 + random.below(20), step), randomWalk(random, 1, step)};
    Polylines b{randomWalk(random, 1 + random.below(20), step), {}};
    if (round % 4 == 0) {  // nearly alike
      b = a;
      for (auto& piece : b)
        for (DVec3& p : piece) p += DVec3(random.inCube(0.01f));
    }
    const double sampled = hausdorffBySampling(a, b, 400), found = hausdorffDistance(a, b);
    // Between two samples it can be greater by half their distance.
    EXPECT_LE(found, sampled + static_cast<double>(step) * std::sqrt(3.0) / 800) << "seed 6, round " << round;
    EXPECT_GE(found, sampled * (1 - 0x1p-9)) << "seed 6, round " << round;
    EXPECT_NEAR(found, hausdorffDistance(b, a), found * 0x1p-9);
  }
}

TEST(HausdorffDistance, OfACurveAndItselfIsNothingHoweverItIsDivided) {
  Random random(7);
  const Polylines curve{randomWalk(random, 2000, 0.1f), randomWalk(random, 10, 0.1f)};
  EXPECT_EQ(hausdorffDistance(curve, curve), 0);
  Polylines divided;
  for (const auto& piece : curve) {
    divided.emplace_back();
    for (std::size_t i = 0; i + 1 < piece.size(); ++i)
      for (int k = 0; k < 3; ++k)
        divided.back().push_back(piece[i] + (piece[i + 1] - piece[i]) * (static_cast<double>(k) / 3));
    divided.back().push_back(piece.back());
  }
  EXPECT_LT(hausdorffDistance(curve, divided), 1e-10);
}

TEST(HausdorffDistance, SeesTheMiddleOfASegment) {
  // Both ends of the long segment are on the other curve; its middle is a unit away.
  const Polylines straight{{{-3, 0, 0}, {3, 0, 0}}}, bent{{{-3, 0, 0}, {-1, 1, 0}, {1, 1, 0}, {3, 0, 0}}},
      ends{{{-3, 0, 0}}, {{3, 0, 0}}};
  EXPECT_NEAR(hausdorffDistance(straight, bent), 1, 1e-3);
  EXPECT_NEAR(hausdorffDistance(straight, ends), 3, 3e-3);
}

TEST(HausdorffDistance, OfCurvesWithoutPointsIsNothingOrInfinite) {
  EXPECT_EQ(hausdorffDistance({}, {}), 0);
  EXPECT_EQ(hausdorffDistance({{}}, {}), 0);
  EXPECT_EQ(hausdorffDistance({{DVec3(0)}}, {}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(hausdorffDistance({{DVec3(0)}}, {{DVec3(3, 4, 0)}}), 5);
}

TEST(SurfaceDistance, OfABallIsTheFormulas) {
  const auto model = sphereModel(1000);
  const SurfaceDistance surface(model);
  Random random(8);
  for (int i = 0; i < 300; ++i) {
    SurfaceHit place{random.inCube(2), Vec3(0, 0, 1)};
    const auto d = surface.from(place);
    ASSERT_TRUE(d);
    EXPECT_NEAR(*d, std::fabs(length(DVec3(place.position)) - 1), 1e-7) << "seed 8, " << i;
  }
}

TEST(SurfaceDistance, IsNeverLessThanTheDistanceAndNearlyThatOfDenseSamples) {
  const auto coarse = bumpyModel(1500), dense = bumpyModel(150000);
  const SurfaceDistance surface(coarse);
  const NearestSurfels samples(dense.surfels());
  Random random(9);
  double worst = 0;
  for (int i = 0; i < 500; ++i) {
    const Point p = random.inCube(1.1f);
    const auto d = surface.from({p, Vec3(0, 0, 1)});
    ASSERT_TRUE(d);
    const double sampled = length(DVec3(samples.surfels()[*samples.nearest(p)].position) - DVec3(p));
    // The surface is at most a disc's radius, 0.006, nearer than its samples.
    ASSERT_GE(*d, sampled - 0.006) << "seed 9, " << i;
    worst = std::max(worst, *d - sampled);
  }
  EXPECT_LT(worst, 0.02) << "the nearest surfel of the coarse sampling may be on another bump";
}

TEST(SurfaceDistance, OfExactHitsIsRounding) {
  Random random(10);
  points::SurfelModel mixed({.density = 500});
  std::vector<implicit::Primitive> list{{{Point(0), 1}, implicit::Sign::Positive}};
  for (int i = 0; i < 25; ++i) list.push_back(restroke::testing::randomMixedPrimitive(random, list));
  mixed.append(list);
  for (const points::SurfelModel& model : {bumpyModel(1000), std::move(mixed)}) {
    const SurfaceDistance surface(model);
    const auto exact = makeCaster(Method::Exact, model, smallCamera());
    std::size_t hits = 0;
    for (const ScreenPoint p : screenGrid(smallCamera(), 101))
      if (const auto hit = exact->cast(p)) {
        ++hits;
        // Half a unit in the last place of float32 on each axis, for coordinates up to 2.
        EXPECT_LE(*surface.from(*hit), std::sqrt(3.0) * 0x1p-24 * 2) << p.x << ", " << p.y;
      }
    EXPECT_GT(hits, 500u);
  }
}

TEST(SurfaceDistance, OfAnEmptyShapeThereIsNone) {
  const auto model = sphereModel(500);
  EXPECT_FALSE(SurfaceDistance(model, {.count = 0}).from({Point(0), Vec3(0, 0, 1)}));
}

/// A straight stroke of six points along x, a tenth of a unit apart, with normals along z.
Trail straight() {
  Trail trail;
  for (int i = 0; i < 6; ++i)
    trail.points.push_back({{{160 * i, 80}, static_cast<double>(i)},
                            SurfaceHit{{0.1f * static_cast<float>(i), 0, 0}, {0, 0, 1}}});
  return trail;
}

TEST(Measures, OfAShiftedStrokeAreTheShift) {
  const Trail truth = straight();
  Trail result = truth;
  for (TrailPoint& p : result.points) p.hit->position.y = 0.25f;
  const Measures m = summarise(std::vector{observe({.result = result, .truth = &truth, .camera = {}})});
  EXPECT_EQ(m.strokes, 1u);
  EXPECT_EQ(m.places, 6u);
  EXPECT_EQ(m.missRate, 0);
  EXPECT_DOUBLE_EQ(m.errorRms, 0.25);
  EXPECT_DOUBLE_EQ(m.errorMax, 0.25);
  EXPECT_DOUBLE_EQ(m.hausdorff, 0.25);
  EXPECT_NEAR(m.errorRmsOfLength, 0.5, 1e-7);
  EXPECT_NEAR(m.errorMaxOfLength, 0.5, 1e-7);
  EXPECT_NEAR(m.hausdorffOfLength, 0.5, 1e-7);
  EXPECT_NEAR(m.lengthDrift, 0, 1e-12);
  EXPECT_EQ(m.normalErrorMax, 0);
  EXPECT_TRUE(std::isnan(m.stretchMedian));
  EXPECT_TRUE(std::isnan(m.surfaceDistanceRms));
}

TEST(Measures, SlidingAlongTheStrokeIsAnErrorButLittleHausdorff) {
  const Trail truth = straight();
  Trail result = truth;
  for (TrailPoint& p : result.points) p.hit->position.x = p.hit->position.x * p.hit->position.x * 2;
  const Measures m = summarise(std::vector{observe({.result = result, .truth = &truth, .camera = {}})});
  EXPECT_NEAR(m.errorMax, 0.12, 1e-7);
  EXPECT_LT(m.hausdorff, 1e-6);
}

TEST(Measures, OfAStretchedStrokeWithTurnedNormals) {
  const Trail original = straight();
  Trail result = original;
  for (TrailPoint& p : result.points) {
    p.hit->position *= 1.5f;
    p.hit->normal = {0.5f, 0, std::sqrt(0.75f)};
  }
  result.points[5].hit->normal = {0, 1, 0};
  result.points[5].hit->position.x += 0.15f;
  const Measures m = summarise(
      std::vector{observe({.result = result, .truth = &original, .original = &original, .camera = {}})});
  EXPECT_NEAR(m.lengthDrift, 0.8, 1e-6);
  EXPECT_NEAR(m.stretchMedian, 1.5, 1e-6);
  EXPECT_NEAR(m.stretchMin, 1.5, 1e-6);
  EXPECT_NEAR(m.stretchMax, 3, 1e-6);
  EXPECT_NEAR(m.normalErrorMean, (5 * 30 + 90) / 6.0, 1e-5);
  EXPECT_NEAR(m.normalErrorMax, 90, 1e-5);
}

TEST(Measures, CountMissesOnEitherSideAndCompareTheRest) {
  Trail truth = straight(), result = straight();
  truth.points[0].hit.reset();
  result.points[2].hit.reset();
  result.points[3].hit.reset();
  result.points.pop_back();  // beyond the end is a miss
  result.points[1].hit->position.z = 0.5f;
  const StrokeObservations seen = observe({.result = result, .truth = &truth, .camera = {}});
  EXPECT_EQ(seen.places, 6u);
  EXPECT_EQ(seen.expected, 5u);
  EXPECT_EQ(seen.missed, 3u);
  EXPECT_EQ(seen.gained, 1u);
  EXPECT_EQ(seen.errors, (std::vector{0.5, 0.0}));
  EXPECT_EQ(seen.comparedTrueLength, 0) << "no two neighbours are hits on both sides";
  const Measures m = summarise(std::vector{seen});
  EXPECT_DOUBLE_EQ(m.missRate, 0.6);
  EXPECT_TRUE(std::isnan(m.lengthDrift));
  // Without a truth the original says what is expected, and without one every place.
  EXPECT_EQ(observe({.result = result, .original = &truth, .camera = {}}).missed, 3u);
  EXPECT_EQ(observe({.result = result, .camera = {}}).missed, 2u);
  EXPECT_EQ(observe({.result = result, .camera = {}}).expected, 5u);
}

TEST(Measures, OfEmptyStrokesAndOfSinglePointsSayWhatTheyCan) {
  const Trail nothing;
  Trail point = straight();
  point.points.resize(1);
  const auto model = sphereModel(500);
  const Measures none = summarise({});
  EXPECT_EQ(none.strokes, 0u);
  EXPECT_TRUE(std::isnan(none.missRate));
  const Measures empty = summarise(std::vector{
      observe({.result = nothing, .truth = &nothing, .original = &nothing, .camera = {}, .model = &model})});
  EXPECT_EQ(empty.places, 0u);
  EXPECT_TRUE(std::isnan(empty.missRate) && std::isnan(empty.errorRms) && std::isnan(empty.driftMax));
  const Measures lost = summarise(std::vector{observe({.result = nothing, .truth = &point, .camera = {}})});
  EXPECT_EQ(lost.missRate, 1);
  EXPECT_TRUE(std::isnan(lost.hausdorff) && std::isnan(lost.errorMax));
  const Measures one = summarise(std::vector{
      observe({.result = point, .truth = &point, .original = &point, .camera = {}, .model = &model})});
  EXPECT_EQ(one.errorMax, 0);
  EXPECT_EQ(one.hausdorff, 0);
  EXPECT_NEAR(one.surfaceDistanceMax, 1, 1e-7);
  EXPECT_TRUE(std::isnan(one.errorMaxOfLength) && std::isnan(one.stretchMedian));
}

TEST(Measures, OfSeveralStrokesPoolTheirPlaces) {
  const Trail truth = straight();
  Trail shifted = truth, far = truth;
  for (TrailPoint& p : shifted.points) p.hit->position.y = 3;
  for (TrailPoint& p : far.points) p.hit->position.y = 4;
  far.points.resize(3);
  Trail farTruth = truth;
  farTruth.points.resize(3);
  const Measures m = summarise(std::vector{observe({.result = shifted, .truth = &truth, .camera = {}}),
                                           observe({.result = far, .truth = &farTruth, .camera = {}})});
  EXPECT_EQ(m.strokes, 2u);
  EXPECT_NEAR(m.errorRms, std::sqrt((6 * 9 + 3 * 16) / 9.0), 1e-6);
  EXPECT_NEAR(m.errorMax, 4, 1e-6);
  EXPECT_NEAR(m.hausdorff, 4, 1e-6);
  EXPECT_NEAR(m.errorMaxOfLength, 4 / 0.35, 1e-5);
}

TEST(Measures, SeeWhereAPlaceNowIsOnTheScreen) {
  // The default camera is at z = 4; a pixel there is 4 * 0.6 / 240 = 0.01 model units wide at z = 0.
  Trail result;
  const ScreenPoint middle{160 * kSubPixels, 120 * kSubPixels};
  result.points = {{{middle, 0}, SurfaceHit{{0.03f, 0.04f, 0}, {0, 0, 1}}},
                   {{middle, 1}, SurfaceHit{{0, 0, 0}, {0, 0, 1}}},
                   {{middle, 2}, SurfaceHit{{0, 0, 5}, {0, 0, 1}}}};
  const StrokeObservations seen = observe({.result = result, .camera = smallCamera()});
  ASSERT_EQ(seen.drifts.size(), 2u);
  EXPECT_NEAR(seen.drifts[0], 5, 1e-5);
  EXPECT_NEAR(seen.drifts[1], 0, 1e-5);
  EXPECT_EQ(seen.behind, 1u);
  EXPECT_EQ(seen.hidden, 0u) << "nothing is known of the shape";
}

TEST(Measures, SeeWhatHidesAPlace) {
  const auto model = sphereModel(500);
  Trail result;
  const ScreenPoint middle{160 * kSubPixels, 120 * kSubPixels};
  result.points = {{{middle, 0}, SurfaceHit{{0, 0, 1}, {0, 0, 1}}},
                   {{middle, 1}, SurfaceHit{{0, 0, 0.995f}, {0, 0, 1}}},
                   {{middle, 2}, SurfaceHit{{0, 0, 0.9f}, {0, 0, 1}}},
                   {{middle, 3}, SurfaceHit{{0, 0, -1}, {0, 0, -1}}}};
  EXPECT_EQ(observe({.result = result, .camera = smallCamera(), .model = &model}).hidden, 2u);
}

TEST(Measures, OfExactOnTheShapeThatItWasDrawnOnAreRounding) {
  const auto model = bumpyModel(1000);
  const Trail trail = trailAlong(model, smallCamera(), 200);
  const Measures m = summarise(std::vector{observe(
      {.result = trail, .truth = &trail, .original = &trail, .camera = smallCamera(), .model = &model})});
  EXPECT_EQ(m.errorMax, 0);
  EXPECT_EQ(m.hausdorff, 0);
  EXPECT_EQ(m.stretchMin, 1);
  EXPECT_EQ(m.stretchMax, 1);
  EXPECT_EQ(m.hidden, 0u);
  EXPECT_EQ(m.behind, 0u);
  EXPECT_LT(m.driftMax, 1e-4);
  EXPECT_LT(m.surfaceDistanceMax, 2.1e-7);
}

}  // namespace
}  // namespace restroke::retarget
