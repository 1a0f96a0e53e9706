// `nearest` against the definition: every surfel looked at.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "retarget/methods/nearest_surfels.h"
#include "tests/retarget/test_shapes.h"
#include "tests/retarget/test_trails.h"
#include "tests/support/brute_force.h"

namespace restroke::retarget {
namespace {

using points::Surfel;
using restroke::testing::Random;

std::size_t nearestByDefinition(const std::vector<Surfel>& surfels, Point p) {
  std::size_t best = 0;
  const auto squared = [&](std::size_t i) {
    const DVec3 d = DVec3(surfels[i].position) - DVec3(p);
    return dot(d, d);
  };
  for (std::size_t i = 1; i < surfels.size(); ++i)
    if (squared(i) < squared(best)) best = i;
  return best;
}

std::vector<Surfel> surfelsAt(const std::vector<Point>& positions) {
  std::vector<Surfel> surfels;
  for (const Point p : positions) surfels.push_back({.position = p, .radius = 0.1f});
  return surfels;
}

TEST(NearestSurfels, FindsWhatLookingAtAllFinds) {
  Random random(1);
  const auto surfels = bumpyModel(3000).surfels();
  const NearestSurfels tree(surfels);
  for (int i = 0; i < 1000; ++i) {
    const Point p = i % 2 == 0 ? random.inCube(1.5f)
                               : surfels[random.below(surfels.size())].position + random.inCube(0.01f);
    ASSERT_EQ(tree.nearest(p), nearestByDefinition(surfels, p)) << "seed 1, query " << i;
  }
}

TEST(NearestSurfels, OfEquallyNearOnesItTakesTheLowest) {
  // On a coarse grid most queries have several, and many surfels are at the same place.
  Random random(2);
  for (const std::size_t count : {1u, 2u, 11u, 40u, 3000u}) {
    std::vector<Point> positions;
    for (std::size_t i = 0; i < count; ++i) {
      const Point p = random.inCube(4);
      positions.push_back({std::floor(p.x), std::floor(p.y), std::floor(p.z)});
    }
    const auto surfels = surfelsAt(positions);
    const NearestSurfels tree(surfels);
    for (int i = 0; i < 300; ++i) {
      const Point p = random.inCube(5) * 2.0f,
                  query = Point{std::floor(p.x), std::floor(p.y), std::floor(p.z)} * 0.5f;
      ASSERT_EQ(tree.nearest(query), nearestByDefinition(surfels, query)) << count << ", query " << i;
    }
  }
}

TEST(NearestSurfels, TellsApartWhatFloat32CannotSquare) {
  Random random(3);
  // Distances that differ in the last bit; far from the origin; squares below the smallest number.
  for (const auto& [offset, spread, away] :
       {std::array{0.0f, 1e-6f, 1.0f}, std::array{9e5f, 0.5f, 1.0f}, std::array{9e5f, 0.5f, 1e6f},
        std::array{0.0f, 1e-21f, 1e-21f}, std::array{0.0f, 1e-30f, 1e-22f}}) {
    std::vector<Point> positions;
    for (int i = 0; i < 500; ++i) positions.push_back(Point(offset) + random.inCube(spread));
    const auto surfels = surfelsAt(positions);
    const NearestSurfels tree(surfels);
    for (int i = 0; i < 200; ++i) {
      const Point p = Point(offset) + random.inCube(away);
      ASSERT_EQ(tree.nearest(p), nearestByDefinition(surfels, p)) << offset << ' ' << spread << ' ' << i;
    }
  }
}

TEST(NearestSurfels, OfNoneThereIsNone) {
  EXPECT_EQ(NearestSurfels({}).nearest(Point(0)), std::nullopt);
}

TEST(NearestSurfels, TheNearestPointOfADiscIsWithinItsRimOrOnIt) {
  const Surfel disc{.position = {1, 2, 3}, .normal = {0, 0, 1}, .radius = 0.5f};
  EXPECT_EQ(nearestOnDisc(disc, {1.25, 2, 7}), DVec3(1.25, 2, 3));
  EXPECT_EQ(nearestOnDisc(disc, {1, 2, -7}), DVec3(1, 2, 3));
  EXPECT_EQ(nearestOnDisc(disc, {1, 4, 3.5}), DVec3(1, 2.5, 3));
}

TEST(NearestMethod, EveryPlaceGoesToItsNearestSurfelsDisc) {
  const auto before = sphereModel(4000);
  const Trail trail = trailAlong(before, smallCamera(), 200);
  const auto after = bumpyModel(4000);
  const auto surfels = after.surfels();
  const auto caster =
      makeCaster(Method::Nearest, {.model = after, .camera = smallCamera(), .change = {.original = &trail}});
  std::size_t hits = 0, moved = 0;
  for (const TrailPoint& point : trail.points) {
    const auto hit = caster->cast(point.place);
    ASSERT_EQ(hit.has_value(), point.hit.has_value());
    if (!hit) continue;
    ++hits;
    const Surfel& surfel = surfels[nearestByDefinition(surfels, point.hit->position)];
    EXPECT_EQ(hit->position, Point(nearestOnDisc(surfel, DVec3(point.hit->position))));
    EXPECT_EQ(hit->normal, surfel.normal);
    EXPECT_EQ(hit->primitive, after.list().idAt(surfel.primitive));
    EXPECT_EQ(hit->scale, 1.0f);
    if (hit->position != point.hit->position) ++moved;
  }
  EXPECT_GT(hits, 100u);
  EXPECT_LT(hits, trail.points.size());
  EXPECT_GT(moved, 20u);
}

TEST(NearestMethod, SeesThePrefixOnly) {
  const Trail trail = trailAlong(sphereModel(2000), smallCamera(), 60);
  const auto whole = bumpyModel(2000);
  points::SurfelModel part({.density = 2000});
  for (std::size_t i = 0; i < 30; ++i) {
    const implicit::Primitive primitive = whole.list().at(i);
    part.append({&primitive, 1});
  }
  const Change change{.original = &trail};
  const auto ofPrefix = makeCaster(
      Method::Nearest, {.model = whole, .camera = smallCamera(), .prefix = {.count = 30}, .change = change});
  const auto ofPart = makeCaster(Method::Nearest, {.model = part, .camera = smallCamera(), .change = change});
  for (const TrailPoint& point : trail.points) {
    const auto a = ofPrefix->cast(point.place), b = ofPart->cast(point.place);
    ASSERT_EQ(a.has_value(), b.has_value());
    if (!a) continue;
    EXPECT_EQ(a->position, b->position);
    EXPECT_EQ(a->normal, b->normal);
  }
}

TEST(NearestMethod, AnEmptyPrefixAndAnEmptyTrailAreMissed) {
  const auto model = sphereModel(500);
  const Trail trail = trailAlong(model, smallCamera(), 20), nothing;
  const auto onNothing =
      makeCaster(Method::Nearest,
                 {.model = model, .camera = {}, .prefix = {.count = 0}, .change = {.original = &trail}});
  for (const TrailPoint& point : trail.points) EXPECT_FALSE(onNothing->cast(point.place));
  EXPECT_FALSE(makeCaster(Method::Nearest, {.model = model, .camera = {}, .change = {.original = &nothing}})
                   ->cast({{0, 0}, 0}));
}

TEST(FollowingMethods, CastAsExactWhileThereIsNoTrail) {
  const auto model = bumpyModel(500);
  const auto screen = screenGrid(smallCamera(), 97);
  const auto exact = castAll(*makeCaster(Method::Exact, model, smallCamera()), screen);
  for (const Method method :
       {Method::Fixed, Method::Nearest, Method::Mapped, Method::Surface, Method::Aligned})
    EXPECT_EQ(castAll(*makeCaster(method, model, smallCamera()), screen), exact) << nameOf(method);
}

}  // namespace
}  // namespace restroke::retarget
