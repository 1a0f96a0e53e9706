// Meshes of solids with known volumes, edges and corners.

#include "points/isosurface/isosurface.h"

#include <gtest/gtest.h>
#include <xxhash.h>

#include <numbers>

#include "implicit/errors.h"
#include "points/files/mesh_files.h"
#include "tests/points/isosurface_support.h"
#include "tests/support/admesh.h"
#include "tests/support/effort.h"

namespace restroke::points {
namespace {

using implicit::Prefix;
using implicit::Primitive;
using implicit::PrimitiveList;
using implicit::Side;
using implicit::Sign;
using testing::BoxSource;
using testing::Random;

PrimitiveList listOf(const std::vector<Primitive>& plain) {
  PrimitiveList list;
  for (const Primitive& p : plain) list.append(p);
  return list;
}
Primitive add(Point c, float r) {
  return {{c, r}, Sign::Positive};
}
Primitive carve(Point c, float r) {
  return {{c, r}, Sign::Negative};
}

Isosurface meshOf(const std::vector<Primitive>& plain, const IsosurfaceOptions& options = {}) {
  const PrimitiveList list = listOf(plain);
  return isosurfaceOf(ListSource(list), options);
}

void expectSound(const Isosurface& out) {
  const MeshFaults faults = faultsOf(out.mesh);
  EXPECT_TRUE(faults.none()) << describe(faults);
  EXPECT_EQ(out.selfIntersections, 0u);
  EXPECT_EQ(testing::eulerCharacteristic(out.mesh) % 2, 0);
}

// What the plane at distance d from its centre cuts off a ball.
double capOf(double radius, double d) {
  const double h = radius - d;
  return std::numbers::pi * h * h * (3 * radius - h) / 3;
}

// The circle in which two spheres with centres on the z axis meet.
struct Crease {
  double z, radius;
};
Crease creaseOf(double r0, double z1, double r1) {
  const double z = (z1 * z1 + r0 * r0 - r1 * r1) / (2 * z1);
  return {z, std::sqrt(r0 * r0 - z * z)};
}

double farthestOf(const Crease& crease, const Isosurface& out) {
  double most = 0;
  for (int i = 0; i < 720; ++i) {
    const double angle = i * std::numbers::pi / 360;
    const DVec3 p(crease.radius * std::cos(angle), crease.radius * std::sin(angle), crease.z);
    most = std::max(most, testing::distanceFrom(out.mesh, p, 4 * out.cell));
  }
  return most / out.cell;
}

TEST(Isosurface, ASphereHasItsVolumeAndItsVerticesOnTheSurface) {
  const Isosurface out = meshOf({add({0.1f, -0.2f, 0.3f}, 1)});
  expectSound(out);
  EXPECT_DOUBLE_EQ(out.resolution, kDefaultResolution);
  EXPECT_NEAR(volumeOf(out.mesh), 4 * std::numbers::pi / 3, 4e-4);
  EXPECT_EQ(testing::eulerCharacteristic(out.mesh), 2);
  EXPECT_GT(out.cutCells, 50'000u);
  for (const Point p : out.mesh.vertices)
    ASSERT_NEAR(length(DVec3(p) - DVec3(0.1f, -0.2f, 0.3f)), 1, out.cell * out.cell);
}

TEST(Isosurface, AUnionAndADifferenceKeepTheirVolumesAndTheirCreases) {
  const double r0 = 1, r1 = 0.7, z1 = 1;
  const Crease crease = creaseOf(r0, z1, static_cast<double>(0.7f));
  const double lens = capOf(r0, crease.z) + capOf(r1, z1 - crease.z);
  const double ball0 = 4 * std::numbers::pi / 3, ball1 = ball0 * r1 * r1 * r1;
  const Isosurface both = meshOf({add({0, 0, 0}, 1), add({0, 0, 1}, 0.7f)});
  const Isosurface less = meshOf({add({0, 0, 0}, 1), carve({0, 0, 1}, 0.7f)});
  expectSound(both);
  expectSound(less);
  EXPECT_NEAR(volumeOf(both.mesh) / (ball0 + ball1 - lens), 1, 2e-4);
  EXPECT_NEAR(volumeOf(less.mesh) / (ball0 - lens), 1, 2e-4);
}

TEST(Isosurface, CreasesAreKeptToWithinHalfACellAtEveryResolution) {
  const Crease crease = creaseOf(1, 1, static_cast<double>(0.7f));
  for (const int resolution : {10, 17, 32, 63}) {
    const Isosurface both = meshOf({add({0, 0, 0}, 1), add({0, 0, 1}, 0.7f)}, {.resolution = resolution});
    const Isosurface less = meshOf({add({0, 0, 0}, 1), carve({0, 0, 1}, 0.7f)}, {.resolution = resolution});
    expectSound(both);
    expectSound(less);
    EXPECT_LT(farthestOf(crease, both), 0.5) << resolution;
    EXPECT_LT(farthestOf(crease, less), 0.5) << resolution;
  }
}

TEST(Isosurface, EdgesAndCornersOfBoxesAreKeptToWithinHalfACell) {
  double sum = 0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < (restroke::testing::kSanitized ? 4u : 40u); ++seed) {
    const BoxSource box = BoxSource::random(seed, {1, 0.6, 0.35});
    const Isosurface out = isosurfaceOf(box, {.resolution = static_cast<int>(11 + seed % 20)});
    expectSound(out);
    EXPECT_NEAR(volumeOf(out.mesh) / (8 * 0.6 * 0.35), 1, 0.02) << seed;
    for (int e = 0; e < 12; ++e)
      for (int i = 0; i <= 100; ++i) {
        DVec3 local((e & 1) != 0 ? 1 : -1, (e & 1) != 0 ? 1 : -1, (e & 1) != 0 ? 1 : -1);
        local[(e / 4 + 1) % 3] = (e & 2) != 0 ? 1 : -1;
        local[e / 4] = i / 50.0 - 1;
        const double distance = testing::distanceFrom(out.mesh, box.at(local), 4 * out.cell) / out.cell;
        ASSERT_LT(distance, 0.5) << "seed " << seed << ", edge " << e << ", sample " << i;
        sum += distance;
        ++count;
      }
  }
  EXPECT_LT(sum / count, 0.03);  // most of them exactly
}

TEST(Isosurface, ABoxWithFacesOnGridPointsIsThatBox) {
  // Cells of 1/4, and bounds one cell too large: every face is in a plane of grid points.
  class Shifted : public BoxSource {
   public:
    Shifted() : BoxSource(BoxSource::random(0, {1, 0.75, 0.5})) {}
    [[nodiscard]] Box bounds() const override {
      return {{-1.125f, -0.875f, -0.625f}, {1.125f, 0.875f, 0.625f}};
    }
  };
  const Isosurface out = isosurfaceOf(Shifted(), {.cell = 0.25});
  expectSound(out);
  EXPECT_NEAR(volumeOf(out.mesh), 3, 0.03);
  const Box box = boundsOf(out.mesh);
  for (int a = 0; a < 3; ++a)
    EXPECT_NEAR(box.max[a], (std::array{1.0f, 0.75f, 0.5f}[static_cast<std::size_t>(a)]), 1e-3f);
}

TEST(Isosurface, ACavityIsASecondShellThatFacesIntoIt) {
  const Isosurface out = meshOf({add({0, 0, 0}, 1), carve({0.1f, 0, 0}, 0.5f)}, {.resolution = 40});
  expectSound(out);
  EXPECT_EQ(faultsOf(out.mesh).shellCount, 2u);
  EXPECT_NEAR(volumeOf(out.mesh) / (4 * std::numbers::pi / 3 * (1 - 0.125)), 1, 2e-3);
}

// Ratio of the mesh's volume to that of the list, from 400,000 random points.
double volumeRatio(const PrimitiveList& list, const Isosurface& out) {
  Random random(17);
  const Box box = list.bounds();
  const Vec3 size = box.max - box.min;
  std::vector<Point> points(400'000);
  for (Point& p : points)
    p = {random.between(box.min.x, box.max.x), random.between(box.min.y, box.max.y),
         random.between(box.min.z, box.max.z)};
  std::vector<Side> sides(points.size());
  implicit::sidesOf(list, points, sides);
  const auto count = static_cast<double>(std::count(sides.begin(), sides.end(), Side::Inside));
  const double all = static_cast<double>(size.x) * static_cast<double>(size.y) * static_cast<double>(size.z);
  return volumeOf(out.mesh) / (count / static_cast<double>(sides.size()) * all);
}

TEST(Isosurface, RandomListsAreSoundAndHaveTheirMonteCarloVolume) {
  for (std::uint64_t seed = 1; seed <= (restroke::testing::kSanitized ? 1u : 3u); ++seed) {
    Random random(seed);
    std::vector<Primitive> plain{add({0, 0, 0}, 1)};
    for (int i = 0; i < 150; ++i) plain.push_back(restroke::testing::randomPrimitive(random, plain));
    const PrimitiveList list = listOf(plain);
    const Isosurface out = isosurfaceOf(ListSource(list));
    expectSound(out);
    // The Monte Carlo volume's standard deviation is 0.1 to 0.2 %.
    EXPECT_NEAR(volumeRatio(list, out), 1, 0.01) << "seed " << seed;
  }
}

TEST(Isosurface, S13AShapeOfAllKindsIsSoundAndHasItsMonteCarloVolume) {
  const PrimitiveList list = testing::shapeOfAllKinds();
  const Isosurface out = isosurfaceOf(ListSource(list));
  expectSound(out);
  EXPECT_DOUBLE_EQ(out.resolution, kDefaultResolution);
  EXPECT_NEAR(volumeRatio(list, out), 1, 0.01);
}

TEST(Isosurface, S13EveryExampleOfEveryKindIsSoundHoweverThin) {
  for (const implicit::VolumeKind* kind : implicit::volumeKinds())
    for (const implicit::VolumeParameters& parameters : kind->examples())
      for (const std::array<float, 4>& rotation :
           {std::array{0.0f, 0.0f, 0.0f, 1.0f}, std::array{0.3f, 0.5f, -0.2f, 0.7f}}) {
        SCOPED_TRACE(kind->name);
        PrimitiveList list;
        list.append({std::make_shared<const implicit::PosedVolume>(
                         kind->make(parameters), implicit::Pose{{0.1f, 0.2f, 0.3f}, rotation, 1}),
                     Sign::Positive});
        const Isosurface out = isosurfaceOf(ListSource(list), {.resolution = 20});
        if (!out.mesh.triangles.empty()) expectSound(out);
      }
}

TEST(Isosurface, CoarseMeshesOfCrowdedListsAreSound) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Random random(seed);
    std::vector<Primitive> plain{add({0, 0, 0}, 1)};
    for (int i = 0; i < 100; ++i) plain.push_back(restroke::testing::randomPrimitive(random, plain));
    expectSound(meshOf(plain, {.resolution = 12}));
  }
}

TEST(Isosurface, WhatWasPastedOrCarvedOnItselfIsSound) {
  expectSound(meshOf({add({0, 0, 0}, 1), add({0, 0, 0}, 1)}, {.resolution = 24}));
  // Spheres that touch in a point, on a grid point and elsewhere.
  expectSound(meshOf({add({-1, 0, 0}, 1), add({1, 0, 0}, 1)}, {.resolution = 24}));
  expectSound(meshOf({add({-1, 0, 0}, 1), add({1, 0, 0}, 1)}, {.resolution = 25}));
  expectSound(meshOf({add({0, 0, 0}, 1), carve({0, 0, 0.5f}, 0.5f)}, {.resolution = 24}));
  // A shell as thin as float32 can make it, and one in which the grid finds a few points.
  expectSound(
      meshOf({add({0, 0, 0}, 1), carve({0, 0, 0}, 0.9999999f), add({0, 0, 2}, 0.1f)}, {.resolution = 24}));
  expectSound(meshOf({add({0, 0, 0}, 1), carve({0, 0, 0}, 0.99f), add({0, 0, 2}, 0.1f)}, {.resolution = 24}));
  EXPECT_TRUE(meshOf({add({0, 0, 0}, 1), carve({0, 0, 0}, 1)}, {.resolution = 24}).mesh.triangles.empty());
}

TEST(Isosurface, WhatIsSmallerThanACellIsSeenOrNotButNeverOpen) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    std::vector<Primitive> plain;
    for (int i = 0; i < 60; ++i) plain.push_back(add(random.inCube(1), random.between(0.01f, 0.15f)));
    const Isosurface out = meshOf(plain, {.cell = 0.1});
    expectSound(out);
  }
}

TEST(Isosurface, NothingGivesAnEmptyMesh) {
  EXPECT_TRUE(meshOf({}).mesh.vertices.empty());
  EXPECT_TRUE(meshOf({carve({0, 0, 0}, 1)}).mesh.vertices.empty());
  const PrimitiveList list = listOf({add({0, 0, 0}, 1)});
  EXPECT_TRUE(isosurfaceOf(ListSource(list, Prefix{0})).mesh.vertices.empty());
  // No grid point is in either ball.
  const Isosurface missed = meshOf({add({-1, 0, 0}, 0.1f), add({1, 0, 0}, 0.1f)}, {.cell = 3.0});
  EXPECT_TRUE(missed.mesh.triangles.empty());
  EXPECT_EQ(missed.cutCells, 0u);
}

TEST(Isosurface, APrefixIsTheShapeAtThatMoment) {
  const PrimitiveList list = listOf({add({0, 0, 0}, 1), carve({0, 0, 1}, 0.7f)});
  const PrimitiveList first = listOf({add({0, 0, 0}, 1)});
  const ListSource prefix(list, Prefix{1});
  EXPECT_EQ(isosurfaceOf(prefix, {.resolution = 20}).mesh,
            isosurfaceOf(ListSource(first), {.resolution = 20}).mesh);
}

TEST(Isosurface, ResolutionAndCellSayTheSame) {
  const Isosurface byResolution = meshOf({add({0, 0, 0}, 1)}, {.resolution = 20});
  EXPECT_NEAR(byResolution.cell, 0.1, 1e-6);
  EXPECT_EQ(meshOf({add({0, 0, 0}, 1)}, {.cell = byResolution.cell}).mesh, byResolution.mesh);
}

TEST(Isosurface, OptionsOutOfRangeAreRefused) {
  const std::vector<Primitive> plain{add({0, 0, 0}, 1)};
  EXPECT_THROW((void)meshOf(plain, {.resolution = 10, .cell = 0.1}), InputError);
  EXPECT_THROW((void)meshOf(plain, {.resolution = 0}), InputError);
  EXPECT_THROW((void)meshOf(plain, {.resolution = kMaxResolution + 1}), InputError);
  for (const double cell : {0.0, -1.0, std::nan(""), HUGE_VAL})
    EXPECT_THROW((void)meshOf(plain, {.cell = cell}), InputError);
  EXPECT_THROW((void)meshOf(plain, {.cell = 1e-4}), InputError);   // the grid
  EXPECT_THROW((void)meshOf(plain, {.cell = 1e-12}), InputError);  // float32
  EXPECT_THROW((void)meshOf({add({1000, 0, 0}, 1)}, {.cell = 1e-3}), InputError);
  EXPECT_THROW((void)meshOf({}, {.resolution = 0}), InputError);  // also when there is nothing to do
}

TEST(Isosurface, WhatIsFarFromTheOriginIsSoundAndAsCoarseAsFloatsDemand) {
  const Isosurface out = meshOf({add({10000, -5000, 2000}, 1), carve({10001, -5000, 2000}, 0.7f)});
  expectSound(out);
  EXPECT_LT(out.resolution, kDefaultResolution);
  EXPECT_GT(out.resolution, 20);
}

TEST(Isosurface, ThreadsChangeNothing) {
  Random random(7);
  std::vector<Primitive> plain{add({0, 0, 0}, 1)};
  for (int i = 0; i < 100; ++i) plain.push_back(restroke::testing::randomPrimitive(random, plain));
  const PrimitiveList list = listOf(plain);
  const Isosurface one = isosurfaceOf(ListSource(list), {.resolution = 60}, {.threads = 1});
  EXPECT_GT(one.fans, 0u);
  for (const int threads : {2, 8}) {
    const Isosurface many = isosurfaceOf(ListSource(list), {.resolution = 60}, {.threads = threads});
    ASSERT_EQ(many.mesh.vertices.size(), one.mesh.vertices.size());
    for (std::size_t i = 0; i < one.mesh.vertices.size(); ++i)
      ASSERT_EQ(many.mesh.vertices[i], one.mesh.vertices[i])
          << "vertex " << i << " at " << threads << " threads";
    ASSERT_EQ(many.mesh.triangles, one.mesh.triangles) << threads;
  }
}

TEST(Isosurface, X1TheBitsAreThoseWrittenDown) {
  const Isosurface out =
      meshOf({add({0, 0, 0}, 1), carve({0.3f, 0.2f, 0.9f}, 0.6f), add({-0.8f, 0.2f, 0.3f}, 0.5f)},
             {.resolution = 24});
  XXH3_state_t* state = XXH3_createState();
  XXH3_64bits_reset(state);
  XXH3_64bits_update(state, out.mesh.vertices.data(), out.mesh.vertices.size() * sizeof(Point));
  XXH3_64bits_update(state, out.mesh.triangles.data(),
                     out.mesh.triangles.size() * sizeof(out.mesh.triangles[0]));
  const std::uint64_t hash = XXH3_64bits_digest(state);
  XXH3_freeState(state);
  EXPECT_EQ(hash, 0x38017f47db66a8a6u) << std::hex << hash;
}

// Sources that misbehave
// ------------------------------------------------------------------------------------------------

TEST(Isosurface, ASourceThatAnswersNonsenseAboutCrossingsStillGivesASoundMesh) {
  class Nonsense : public BoxSource {
   public:
    Nonsense() : BoxSource(BoxSource::random(3, {1, 0.6, 0.35})) {}
    [[nodiscard]] Crossing crossing(Point inside, Point) const override {
      const double nan = std::nan("");
      return inside.x > 0 ? Crossing{{nan, nan, nan}, {nan, 0, 0}} : Crossing{{1e30, -1e30, 1e30}, {0, 0, 0}};
    }
  };
  const Isosurface out = isosurfaceOf(Nonsense(), {.resolution = 20});
  expectSound(out);
  EXPECT_FALSE(out.mesh.triangles.empty());
}

TEST(Isosurface, ASolidBeyondItsBoundsIsABug) {
  class Liar : public BoxSource {
   public:
    Liar() : BoxSource(BoxSource::random(0, {1, 1, 1})) {}
    [[nodiscard]] Box bounds() const override { return {Point(-0.5f), Point(0.5f)}; }
  };
  EXPECT_THROW((void)isosurfaceOf(Liar(), {.resolution = 20}), InternalError);
}

// ListSource
// ------------------------------------------------------------------------------------------------------------

TEST(ListSource, CrossingsAreOnTheSurfaceWithTheOwnersNormal) {
  const PrimitiveList list = listOf({add({0, 0, 0}, 1), carve({0, 0, 1}, 0.5f)});
  const ListSource source(list);
  const Crossing outer = source.crossing({0.5f, 0, 0}, {1.5f, 0, 0});
  EXPECT_NEAR(outer.position.x, 1, 1e-12);
  EXPECT_NEAR(outer.normal.x, 1, 1e-12);
  const Crossing hollow = source.crossing({0, 0, 0.4f}, {0, 0, 0.7f});
  EXPECT_NEAR(hollow.position.z, 0.5, 1e-12);
  EXPECT_NEAR(hollow.normal.z, 1, 1e-12);
}

TEST(ListSource, OfSeveralCrossingsTheOneNearestTheInsideIsTaken) {
  const PrimitiveList list = listOf({add({0, 0, 0}, 1), add({3, 0, 0}, 0.5f)});
  const Crossing crossing = ListSource(list).crossing({0, 0, 0}, {5, 0, 0});
  EXPECT_NEAR(crossing.position.x, 1, 1e-12);
}

TEST(ListSource, WhereRoundingHidesTheCrossingFromTheRayThereIsOneAllTheSame) {
  // Segments that graze spheres: float32 calls one end inside, the ray may see no inside at all.
  Random random(11);
  int asked = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Point center = random.inCube(10);
    const float radius = random.between(0.01f, 1);
    const PrimitiveList list = listOf({add(center, radius)});
    const ListSource source(list);
    Point p = center;
    p.x += radius;
    p.x = std::nextafter(p.x, random.below(2) == 0 ? -100.0f : 100.0f);
    const Point q(p.x, p.y + radius, p.z);
    const std::array<Point, 2> ends{p, q};
    std::array<Side, 2> sides{};
    source.sides(ends, sides);
    if (sides[0] != Side::Inside || sides[1] != Side::Outside) continue;
    ++asked;
    const Crossing crossing = source.crossing(p, q);
    ASSERT_NEAR(length(crossing.position - DVec3(center)), static_cast<double>(radius), 1e-5);
    ASSERT_NEAR(length(crossing.normal), 1, 1e-12);
    ASSERT_GT(crossing.normal.x, 0.9);
  }
  EXPECT_GT(asked, 1000);
}

// Others' opinions
// ------------------------------------------------------------------------------------------------------

TEST(Isosurface, S13AdmeshFindsNothingToRepair) {
  if (!restroke::testing::hasAdmesh()) GTEST_SKIP() << "the program admesh is not installed";
  const PrimitiveList list = testing::shapeOfAllKinds();
  const Isosurface out = isosurfaceOf(ListSource(list), {.resolution = 64});
  const restroke::testing::AdmeshReport report = restroke::testing::askAdmesh(out.mesh);
  EXPECT_EQ(report.repairs(), std::vector<std::string>{}) << report.text;
  EXPECT_EQ(report.valueOf("Normals fixed"), 0);
  EXPECT_EQ(report.valueOf("Number of facets"), static_cast<double>(out.mesh.triangles.size()));
  EXPECT_EQ(report.valueOf("Number of parts"), static_cast<double>(faultsOf(out.mesh).shellCount));
  EXPECT_NEAR(report.valueOf("Volume"), volumeOf(out.mesh), 1e-4);
}

}  // namespace
}  // namespace restroke::points
