// `surface`: coordinates on a primitive, evaluated again on what became of it.

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "implicit/volume.h"
#include "retarget/anchors.h"
#include "tests/retarget/test_shapes.h"
#include "tests/retarget/test_trails.h"
#include "tests/support/meshes.h"
#include "tests/support/random_volumes.h"

namespace restroke::retarget {
namespace {

using implicit::PosedVolume;
using implicit::Primitive;
using implicit::Shape;
using implicit::Sign;
using implicit::VolumeParameters;
using restroke::testing::Random;

Shape posed(const char* kind, const VolumeParameters& parameters, const implicit::Pose& pose = {}) {
  return std::make_shared<const PosedVolume>(implicit::volumeKindNamed(kind).make(parameters), pose);
}

Shape meshShape(const TriangleMesh& mesh, const implicit::Pose& pose = {}) {
  return posed("mesh",
               {.values = {{}},
                .mesh = std::make_shared<const implicit::MeshSource>(implicit::MeshSource{.mesh = mesh})},
               pose);
}

/// Hits on the shape's surface: some of its samples.
std::vector<SurfaceHit> hitsOn(const Shape& shape) {
  const auto samples = implicit::sampled(shape, samplesOf(shape, 256));
  std::vector<SurfaceHit> hits;
  for (std::uint32_t i = 0; i < 256; i += 5) {
    const auto sample = implicit::placedSample(samples, i);
    hits.push_back({sample.position, sample.normal});
  }
  return hits;
}

double sizeOf(const Shape& shape) {
  return static_cast<double>(length(shape.ball().center) + shape.ball().radius);
}

TEST(SurfaceCoordinates, OnABallAreRadiiFromItsCentre) {
  const Shape before({1, 2, 3}, 0.5f), after({-2, 0, 1}, 2);
  const auto coordinates = SurfaceCoordinates::between(before, after);
  ASSERT_TRUE(coordinates);
  const auto hit = coordinates->carry({{1, 2.5f, 3}, {0, 1, 0}});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->position, Point(-2, 2, 1));
  EXPECT_EQ(hit->normal, Vec3(0, 1, 0));
  EXPECT_EQ(hit->scale, 4.0f);
  EXPECT_EQ(hit->primitive, kNoPrimitive);
  // A hollow's normals go inwards, and stay so.
  EXPECT_EQ(coordinates->carry({{1, 2.5f, 3}, {0, -1, 0}})->normal, Vec3(0, -1, 0));
}

TEST(SurfaceCoordinates, OfEveryKindGoWithItsPose) {
  Random random(4);
  for (const implicit::VolumeKind* kind : implicit::volumeKinds())
    for (const VolumeParameters& parameters : kind->examples()) {
      const auto volume = kind->make(parameters);
      const Shape before = restroke::testing::randomlyPosed(random, volume);
      // Equal parameters are enough: logs are read anew.
      const Shape after = restroke::testing::randomlyPosed(random, kind->make(parameters));
      const auto coordinates = SurfaceCoordinates::between(before, after);
      ASSERT_TRUE(coordinates) << kind->name;
      const double rounding = 1e-6 * (sizeOf(before) / static_cast<double>(before.volume()->pose().scale) *
                                          static_cast<double>(after.volume()->pose().scale) +
                                      sizeOf(after));
      for (const SurfaceHit& was : hitsOn(before)) {
        const auto is = coordinates->carry(was);
        ASSERT_TRUE(is) << kind->name;
        const DVec3 local = before.volume()->toLocal(DVec3(was.position));
        EXPECT_LT(length(DVec3(is->position) - after.volume()->toModel(local)), rounding) << kind->name;
        const DVec3 ahead = before.volume()->toLocal(DVec3(was.position) + 0.01 * DVec3(was.normal));
        const DVec3 normal = normalized(after.volume()->toModel(ahead) - after.volume()->toModel(local));
        EXPECT_LT(length(DVec3(is->normal) - normal), 1e-6) << kind->name;
        EXPECT_EQ(is->scale, static_cast<float>(static_cast<double>(after.volume()->pose().scale) /
                                                static_cast<double>(before.volume()->pose().scale)));
      }
    }
}

TEST(SurfaceCoordinates, OnWhatDidNotChangeChangeNothing) {
  Random random(5);
  for (const implicit::VolumeKind* kind : implicit::volumeKinds()) {
    const Shape shape = restroke::testing::randomlyPosed(random, kind->make(kind->examples().front()));
    const auto coordinates = SurfaceCoordinates::between(shape, shape);
    for (const SurfaceHit& was : hitsOn(shape)) {
      const auto is = coordinates->carry(was);
      ASSERT_TRUE(is);
      EXPECT_LE(length(is->position - was.position), static_cast<float>(1e-6 * sizeOf(shape))) << kind->name;
      EXPECT_LT(length(is->normal - was.normal), 1e-6f) << kind->name;
      EXPECT_EQ(is->scale, 1.0f);
    }
  }
}

TEST(SurfaceCoordinates, GoFromABallToAnEllipsoidAndBack) {
  const Shape ball({0.5f, 0, 0}, 0.25f);
  const Shape ellipsoid = posed("ellipsoid", {{{0.9f}, {0.6f}, {0.4f}}},
                                {.position = {1, 1, 1}, .rotation = {0.5f, 0.5f, 0.5f, 0.5f}, .scale = 2});
  const auto there = SurfaceCoordinates::between(ball, ellipsoid),
             back = SurfaceCoordinates::between(ellipsoid, ball);
  ASSERT_TRUE(there && back);
  for (const SurfaceHit& was : hitsOn(ball)) {
    const auto is = there->carry(was);
    ASSERT_TRUE(is);
    EXPECT_LT(
        std::fabs(ellipsoid.volume()->volume().clearance(ellipsoid.volume()->toLocal(DVec3(is->position)))),
        1e-6);
    EXPECT_LT(length(DVec3(is->normal) - outwardNormal(ellipsoid, DVec3(is->position))), 1e-5);
    EXPECT_NEAR(static_cast<double>(is->scale), 8 * std::cbrt(0.9 * 0.6 * 0.4), 1e-5);
    const auto again = back->carry(*is);
    ASSERT_TRUE(again);
    EXPECT_LT(length(again->position - was.position), 1e-6f);
    EXPECT_LT(length(again->normal - was.normal), 1e-5f);
    EXPECT_NEAR(static_cast<double>(again->scale * is->scale), 1, 1e-6);
  }
}

TEST(SurfaceCoordinates, StayInProportionOnABoxWithOtherSides) {
  const Shape before = posed("box", {{{1}, {1}, {1}, {0}}}), after = posed("box", {{{2}, {1}, {0.5f}, {0}}});
  const auto coordinates = SurfaceCoordinates::between(before, after);
  ASSERT_TRUE(coordinates);
  const auto hit = coordinates->carry({{0.5f, 0.25f, 1}, {0, 0, 1}});
  ASSERT_TRUE(hit);
  EXPECT_LT(length(hit->position - Point(1, 0.25f, 0.5f)), 1e-6f);
  EXPECT_EQ(hit->normal, Vec3(0, 0, 1));
  EXPECT_NEAR(static_cast<double>(hit->scale), 1, 1e-6);
}

TEST(SurfaceCoordinates, StayOnTheBoundaryOfATorusWithOtherRadii) {
  const Shape before = posed("torus", {{{1}, {0.25f}}}),
              after = posed("torus", {{{1}, {0.35f}}}, {.scale = 3});
  const auto coordinates = SurfaceCoordinates::between(before, after);
  ASSERT_TRUE(coordinates);
  for (const SurfaceHit& was : hitsOn(before)) {
    const auto is = coordinates->carry(was);
    ASSERT_TRUE(is);
    const DVec3 p = DVec3(is->position) / 3.0;
    EXPECT_NEAR(std::hypot(std::hypot(p.x, p.y) - 1, p.z), static_cast<double>(0.35f), 1e-6);
    EXPECT_LT(length(DVec3(is->normal) - outwardNormal(after, DVec3(is->position))), 1e-6);
  }
}

TEST(SurfaceCoordinates, OnAMeshWhoseVerticesMovedAreThoseOfItsTriangles) {
  const TriangleMesh mesh = restroke::testing::ballMesh(3);
  TriangleMesh sheared = mesh;
  const auto shear = [](DVec3 p) { return DVec3(2 * p.x + p.y, p.y - 0.5 * p.z, p.z); };
  for (Point& v : sheared.vertices) v = Point(shear(DVec3(v)));
  const Shape before = meshShape(mesh, {.position = {1, 0, 0}, .scale = 0.5f}), after = meshShape(sheared);
  const auto coordinates = SurfaceCoordinates::between(before, after);
  ASSERT_TRUE(coordinates);
  for (const SurfaceHit& was : hitsOn(before)) {
    const auto is = coordinates->carry(was);
    ASSERT_TRUE(is);
    // An affine map keeps barycentric coordinates.
    const DVec3 local = before.volume()->toLocal(DVec3(was.position));
    EXPECT_LT(length(DVec3(is->position) - shear(local)), 2e-6);
    EXPECT_LT(length(DVec3(is->normal) - outwardNormal(after, DVec3(is->position))), 1e-5);
  }
}

TEST(SurfaceCoordinates, OnAMeshKeepTheDistanceFromItInProportion) {
  const TriangleMesh box = restroke::testing::boxMesh(Point(-1), Point(1));
  TriangleMesh larger = box;
  for (Point& v : larger.vertices) v *= 3.0f;
  const auto coordinates = SurfaceCoordinates::between(meshShape(box), meshShape(larger));
  ASSERT_TRUE(coordinates);
  const auto hit = coordinates->carry({{0.5f, 0.25f, 1.125f}, {0, 0, 1}});
  ASSERT_TRUE(hit);
  EXPECT_LT(length(hit->position - Point(1.5f, 0.75f, 3.375f)), 1e-6f);
  EXPECT_EQ(hit->scale, 3.0f);
  // A carved mesh's normals go inwards.
  EXPECT_EQ(coordinates->carry({{0.5f, 0.25f, 1}, {0, 0, -1}})->normal, Vec3(0, 0, -1));
}

TEST(SurfaceCoordinates, ThereAreNoneBetweenShapesThatDoNotCorrespond) {
  const Shape ball(Point(0), 1),
      box = posed("box", {{{1}, {1}, {1}, {0}}}), cylinder = posed("cylinder", {{{1}, {1}}}),
      coarse = meshShape(restroke::testing::ballMesh(1)), fine = meshShape(restroke::testing::ballMesh(2));
  EXPECT_FALSE(SurfaceCoordinates::between(ball, box));
  EXPECT_FALSE(SurfaceCoordinates::between(box, ball));
  EXPECT_FALSE(SurfaceCoordinates::between(box, cylinder));
  EXPECT_FALSE(SurfaceCoordinates::between(coarse, fine));
  EXPECT_FALSE(SurfaceCoordinates::between(coarse, ball));
}

TEST(Anchors, AreSetWhereAHitsPrimitiveIsKnown) {
  const auto model = bumpyModel(500);
  Trail trail = trailAlong(model, smallCamera(), 60);
  trail.points.front().hit.reset();
  std::size_t unknown = 0;
  for (TrailPoint& point : trail.points)
    if (point.hit && unknown < 3) {
      point.hit->primitive = kNoPrimitive;
      ++unknown;
    }
  setAnchors(trail, model.list(), [&](implicit::PrimitiveId id) {
    return OwnerKey{7, static_cast<std::uint32_t>(model.list().positionOf(id))};
  });
  std::size_t set = 0;
  for (const TrailPoint& point : trail.points) {
    ASSERT_EQ(point.anchor.has_value(), point.hit && point.hit->primitive != kNoPrimitive);
    if (!point.anchor) continue;
    ++set;
    EXPECT_EQ(point.anchor->owner.node, 7u);
    EXPECT_EQ(point.anchor->owner.index, model.list().positionOf(point.hit->primitive));
    EXPECT_EQ(point.anchor->shape, model.list()[point.hit->primitive].shape);
  }
  EXPECT_GT(set, 20u);
}

/// A stroke over the bumpy ball, of which every primitive then moves, but three.
struct Moved {
  points::SurfelModel before = bumpyModel(2000);
  points::SurfelModel after{{.density = 2000}};
  Trail trail = trailAlong(before, smallCamera(), 150);
  std::map<std::uint32_t, Primitive> owners;

  Moved() {
    setAnchors(trail, before.list(), [this](implicit::PrimitiveId id) {
      return OwnerKey{0, static_cast<std::uint32_t>(before.list().positionOf(id))};
    });
    std::vector<Primitive> all;
    for (std::size_t i = 0; i < before.list().size(); ++i) {
      Primitive p = before.list().at(i);
      const implicit::Sphere ball = p.shape.ball();
      p.shape = Shape(ball.center * 1.25f + Point(0.5f, 0, 0), ball.radius * 1.25f);
      all.push_back(p);
      if (i % 3 != 1) owners.emplace(static_cast<std::uint32_t>(i), p);
      if (i % 3 == 2) owners.at(static_cast<std::uint32_t>(i)).shape = posed("box", {{{1}, {1}, {1}, {0}}});
    }
    after.append(all);
  }
};

TEST(SurfaceMethod, PlacesGoWithTheirOwnersAndToTheNearestWhereTheseAreGone) {
  const Moved moved;
  const NamedOwners owners(moved.owners);
  const CasterInput input{
      .model = moved.after, .camera = smallCamera(), .change = {.original = &moved.trail, .owners = &owners}};
  const auto surface = makeCaster(Method::Surface, input), nearest = makeCaster(Method::Nearest, input);
  std::size_t followed = 0, gone = 0;
  for (const TrailPoint& point : moved.trail.points) {
    const auto hit = surface->cast(point.place);
    ASSERT_EQ(hit.has_value(), point.hit.has_value());
    if (!hit) continue;
    if (point.anchor->owner.index % 3 == 0) {
      ++followed;
      EXPECT_LT(length(hit->position - (point.hit->position * 1.25f + Point(0.5f, 0, 0))), 1e-6f);
      EXPECT_LT(length(hit->normal - point.hit->normal), 1e-6f);
      EXPECT_EQ(hit->scale, 1.25f);
    } else {
      ++gone;
      EXPECT_EQ(hit, nearest->cast(point.place));
    }
  }
  EXPECT_GT(followed, 20u);
  EXPECT_GT(gone, 10u);
}

TEST(SurfaceMethod, BetweenTwoPointsOfOneOwnerItGoesAlong) {
  const Moved moved;
  const NamedOwners owners(moved.owners);
  const auto caster = makeCaster(
      Method::Surface,
      {.model = moved.after, .camera = {}, .change = {.original = &moved.trail, .owners = &owners}});
  std::size_t between = 0;
  const auto& points = moved.trail.points;
  for (std::size_t i = 0; i + 1 < points.size(); ++i) {
    if (!points[i].anchor || !points[i + 1].anchor ||
        points[i].anchor->owner != points[i + 1].anchor->owner || points[i].anchor->owner.index % 3 != 0)
      continue;
    ++between;
    const auto at = caster->cast({{}, static_cast<double>(i) + 0.25});
    ASSERT_TRUE(at);
    const Point mean = points[i].hit->position * 0.75f + points[i + 1].hit->position * 0.25f;
    EXPECT_LT(length(at->position - (mean * 1.25f + Point(0.5f, 0, 0))), 1e-6f);
  }
  EXPECT_GT(between, 20u);
}

TEST(SurfaceMethod, WithoutOwnersItIsNearest) {
  const Moved moved;
  const CasterInput input{.model = moved.after, .camera = {}, .change = {.original = &moved.trail}};
  const auto surface = makeCaster(Method::Surface, input), nearest = makeCaster(Method::Nearest, input);
  for (const TrailPoint& point : moved.trail.points)
    EXPECT_EQ(surface->cast(point.place), nearest->cast(point.place));
}

TEST(SurfaceMethod, OwnersThatStayedKeepTheStrokeWhereItWas) {
  Moved moved;
  for (std::uint32_t i = 0; i < moved.before.list().size(); ++i)
    moved.owners.insert_or_assign(i, moved.before.list().at(i));
  const NamedOwners owners(moved.owners);
  const auto caster = makeCaster(
      Method::Surface,
      {.model = moved.before, .camera = {}, .change = {.original = &moved.trail, .owners = &owners}});
  for (const TrailPoint& point : moved.trail.points) {
    const auto hit = caster->cast(point.place);
    ASSERT_EQ(hit.has_value(), point.hit.has_value());
    if (hit) {
      EXPECT_LT(length(hit->position - point.hit->position), 1e-6f);
    }
  }
}

}  // namespace
}  // namespace restroke::retarget
