// Dexels on any family of lines (SPEC R1): along axes, in any direction, the rays of a camera.

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "implicit/errors.h"
#include "implicit/ray_cast.h"
#include "implicit/side.h"
#include "points/dexel/line_family.h"
#include "points/dexel/mesh_dexels.h"
#include "tests/support/brute_force.h"
#include "tests/support/effort.h"
#include "tests/support/meshes.h"

namespace restroke::points {
namespace {

using implicit::PrimitiveList;
using implicit::Sign;
using restroke::testing::Random;

PrimitiveList randomList(std::uint64_t seed, std::size_t count) {
  Random random(seed);
  std::vector<implicit::Primitive> primitives = {{{{0, 0, 0}, 1.0f}, Sign::Positive}};
  while (primitives.size() < count)
    primitives.push_back(restroke::testing::randomPrimitive(random, primitives));
  PrimitiveList list;
  list.insert(0, primitives);
  return list;
}

// The document's example: layers over the first 52, 16, 10 and 5 of 100 places.
TEST(DexelsOnAGrid, R1FiftyTwoOfAHundredLinesCarryOneToFourSegments) {
  TriangleMesh mesh;
  float low = 0;
  for (const int lines : {52, 16, 10, 5}) {
    const auto full = static_cast<float>(lines / 10), rest = static_cast<float>(lines % 10);
    if (full > 0)
      mesh = restroke::testing::together(mesh, restroke::testing::boxMesh({0, 0, low}, {10, full, low + 1}));
    if (rest > 0)
      mesh = restroke::testing::together(
          mesh, restroke::testing::boxMesh({0, full, low}, {rest, full + 1, low + 1}));
    low += 2;
  }
  Box box;
  box.add({{0, 0, 0}, {10, 10, 10}});
  const TriDexel model = triDexelOf(mesh, DexelGrid(box, 1));
  const Dexels& dexels = model.family(2);
  ASSERT_EQ(dexels.width(), 10);
  ASSERT_EQ(dexels.height(), 10);
  std::array<int, 5> linesWith{};
  for (std::size_t line = 0; line < dexels.lineCount(); ++line) ++linesWith.at(dexels.endCount(line) / 2);
  EXPECT_EQ(linesWith, (std::array<int, 5>{48, 36, 6, 5, 5}));
  EXPECT_EQ(dexels.endCount(), 2u * (36 + 2 * 6 + 3 * 5 + 4 * 5));
}

// Ends are the places along each line where the side changes, and nothing else.
void expectSides(const Dexels& dexels, const LineFamily& family, const PrimitiveList& list) {
  std::size_t asked = 0, wrong = 0;
  LineEnds ends;
  for (int row = 0; row < family.height; row += 3)
    for (int column = 0; column < family.width; column += 3) {
      const std::size_t at = dexels.lineAt(column, row);
      const Ray line = family.line(column, row);
      EXPECT_NEAR(length(line.direction), 1, 1e-12);
      dexels.read(at, ends);
      for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        const double middle =
            (static_cast<double>(ends[i].depth) + static_cast<double>(ends[i + 1].depth)) / 2;
        ++asked;
        wrong += (sideOf(list, Point(line.at(middle))) == implicit::Side::Inside) != (i % 2 == 0);
      }
      for (const SpanEnd& end : ends) {
        if (static_cast<double>(end.depth) <= family.from) continue;
        const DVec3 normal(unpackNormal(end.normal)), place = line.at(static_cast<double>(end.depth));
        ++asked;
        wrong += sideOf(list, Point(place + 1e-4 * normal)) == implicit::Side::Inside ||
                 sideOf(list, Point(place - 1e-4 * normal)) != implicit::Side::Inside;
      }
    }
  EXPECT_GT(asked, restroke::testing::kSanitized ? 30u : 500u);
  EXPECT_LT(static_cast<double>(wrong), 0.02 * static_cast<double>(asked))
      << "edges, and slivers thinner than that";
}

TEST(DexelsOnAnyLines, R1AlongAnyDirection) {
  const PrimitiveList list = randomList(41, 80);
  for (const DVec3 direction : {DVec3(0, 0, 1), DVec3(1, 2, -0.5), DVec3(-3, 0.1, 0.2)}) {
    const LineFamily family =
        latticeAlong(direction, list.bounds(), restroke::testing::kSanitized ? 0.2 : 0.04);
    const Dexels dexels = dexelsOf(list, family, {}, {.threads = 2});
    EXPECT_EQ(dexels, dexelsOf(list, family, {}, {.threads = 1}));
    expectSides(dexels, family, list);
  }
}

// The volume does not depend on the direction.
TEST(DexelsOnAnyLines, R1TheVolumeIsTheSameAlongAnyDirection) {
  const PrimitiveList list = randomList(42, 40);
  const double cell = restroke::testing::kSanitized ? 0.1 : 0.02;
  const double expected =
      dexelsOf(list, latticeAlong({0, 0, 1}, list.bounds(), cell)).totalLength() * cell * cell;
  for (const DVec3 direction : {DVec3(1, 1, 1), DVec3(0.2, -1, 0.4)})
    EXPECT_NEAR(dexelsOf(list, latticeAlong(direction, list.bounds(), cell)).totalLength() * cell * cell,
                expected, (restroke::testing::kSanitized ? 0.02 : 0.002) * expected);
}

TEST(DexelsOnAnyLines, R1TheRaysOfACameraEnterWhereCastRaysHit) {
  const PrimitiveList list = randomList(43, 80);
  Camera camera;
  camera.position = {0.5f, 1, 4};
  camera.view = {-0.1f, -0.25f, -1};
  camera.width = 90;
  camera.height = 60;
  const LineFamily family = raysOf(camera);
  const Dexels dexels = dexelsOf(list, family);
  LineEnds ends;
  std::size_t hits = 0, other = 0;
  for (int row = 0; row < family.height; ++row)
    for (int column = 0; column < family.width; ++column) {
      Ray ray = family.line(column, row);
      const Ray expected = rayThrough(camera, {16 * column + 8, 16 * row + 8});
      EXPECT_LT(length(ray.direction - normalized(expected.direction)), 1e-12);
      ray.tMin = 0;
      const auto hit = castRay(list, ray);
      dexels.read(dexels.lineAt(column, row), ends);
      hits += hit.has_value();
      other += hit.has_value() != !ends.empty() ||
               (hit && std::fabs(hit->t - static_cast<double>(ends[0].depth)) > 1e-5);
    }
  EXPECT_GT(hits, 500u);
  EXPECT_LE(other, 1u);
}

TEST(DexelsOnAnyLines, R1RaysThatBeginInsideEnterAtTheirBeginning) {
  PrimitiveList list;
  list.append({{{0, 0, 0}, 1.0f}, Sign::Positive});
  Camera camera;
  camera.position = {0, 0, 0.5f};
  camera.width = camera.height = 9;
  const Dexels dexels = dexelsOf(list, raysOf(camera));
  LineEnds ends;
  dexels.read(dexels.lineAt(4, 4), ends);
  ASSERT_EQ(ends.size(), 2u);
  EXPECT_EQ(ends[0].depth, 0);
  EXPECT_NEAR(static_cast<double>(ends[1].depth), 1.5, 1e-6);
  EXPECT_NEAR(static_cast<double>(unpackNormal(ends[0].normal).z), 1, 1e-6) << "against the ray";
}

TEST(DexelsOnAnyLines, R1RefuseDirectionsAndBoundsThatAreNone) {
  Box box;
  box.add({{-1, -1, -1}, {1, 1, 1}});
  EXPECT_THROW((void)latticeAlong({0, 0, 0}, box, 0.1), InputError);
  EXPECT_THROW((void)latticeAlong({std::nan(""), 0, 1}, box, 0.1), InputError);
  EXPECT_THROW((void)latticeAlong({0, 0, 1}, {}, 0.1), InputError);
  EXPECT_THROW((void)latticeAlong({0, 0, 1}, box, 0), InputError);
  EXPECT_THROW((void)latticeAlong({0, 0, 1}, box, 1e-5), InputError);
  Camera camera;
  camera.halfHeight = 0;
  EXPECT_THROW((void)raysOf(camera), InputError);
}

}  // namespace
}  // namespace restroke::points
