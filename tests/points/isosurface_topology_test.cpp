// Whatever the sides of the grid's points are, the mesh is closed, manifold, faces outwards and does not meet
// itself.

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "implicit/errors.h"
#include "points/isosurface/dual_mesh.h"
#include "points/isosurface/isosurface.h"
#include "points/isosurface/meetings.h"
#include "tests/points/isosurface_support.h"
#include "tests/support/effort.h"

namespace restroke::points {
namespace {

using implicit::Side;
using testing::BitSource;
using testing::Random;

// The whole property, for points (x + 0.5, y + 0.5, z + 0.5).
::testing::AssertionResult isRight(const BitSource& source, std::array<int, 3> size) {
  const Isosurface out = isosurfaceOf(source, {.cell = 1.0}, {.threads = 1});
  // Every point of a small grid, every seventh of a large one.
  const int count = size[0] * size[1] * size[2], step = count < 400 ? 1 : 7;
  bool any = false;
  for (int i = 0; i < count; ++i) {
    const int x = i % size[0], y = i / size[0] % size[1], z = i / size[0] / size[1];
    const Point p(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, static_cast<float>(z) + 0.5f);
    const bool inside = source.inside(p);
    any = any || inside;
    if (i % step != 0) continue;
    if (const int winding = testing::windingNumber(out.mesh, p); winding != (inside ? 1 : 0))
      return ::testing::AssertionFailure()
             << "the mesh winds " << winding << " times around (" << x << ", " << y << ", " << z
             << "), which is " << (inside ? "inside" : "outside");
  }
  if (out.mesh.triangles.empty())
    return any ? ::testing::AssertionFailure() << "nothing came out" : ::testing::AssertionSuccess();
  const MeshFaults faults = faultsOf(out.mesh, {.threads = 1});
  if (!faults.none()) return ::testing::AssertionFailure() << describe(faults);
  if (out.selfIntersections != 0) return ::testing::AssertionFailure() << "it says that it meets itself";
  if (testing::eulerCharacteristic(out.mesh) % 2 != 0)
    return ::testing::AssertionFailure() << "odd Euler characteristic";
  if (3 * out.mesh.triangles.size() % 2 != 0)
    return ::testing::AssertionFailure() << "odd number of triangles";
  return ::testing::AssertionSuccess();
}

std::vector<bool> bitsOf(std::uint64_t value, std::size_t count) {
  std::vector<bool> bits(count);
  for (std::size_t i = 0; i < count; ++i) bits[i] = (value >> i & 1) != 0;
  return bits;
}

TEST(Isosurface, S13EveryCellIsClosedAndManifold) {
  const std::array<int, 3> size{2, 2, 2};
  for (std::uint64_t value = 0; value < 256; ++value)
    for (const auto crossings : {BitSource::Crossings::Middle, BitSource::Crossings::Random})
      ASSERT_TRUE(isRight(BitSource(size, bitsOf(value, 8), crossings), size)) << "corners " << value;
}

class EveryPairOfCells : public ::testing::TestWithParam<int> {};

TEST_P(EveryPairOfCells, S13IsClosedAndManifold) {
  std::array<int, 3> size{2, 2, 2};
  size[static_cast<std::size_t>(GetParam())] = 3;
  // All of them; with sanitizers, which take a minute for that, one of eleven.
  constexpr std::uint64_t kStep = restroke::testing::kSanitized ? 11 : 1;
  for (std::uint64_t value = 0; value < 4096; value += kStep)
    ASSERT_TRUE(isRight(BitSource(size, bitsOf(value, 12), BitSource::Crossings::Random), size))
        << "points " << value;
}

INSTANTIATE_TEST_SUITE_P(AlongEachAxis, EveryPairOfCells, ::testing::Values(0, 1, 2), [](const auto& test) {
  return std::string(1, static_cast<char>('X' + test.param));
});

// Two cells that join the inside corners of the face between them: without care an edge with four triangles.
TEST(Isosurface, ANeckThroughAnAmbiguousFaceIsATube) {
  // Diagonal corners of the middle face, whose centre the source calls inside.
  class Neck : public BitSource {
   public:
    Neck()
        : BitSource({2, 2, 3},
                    {false, false, false, false, true, false, false, true, false, false, false, false}) {}
    void sides(std::span<const Point> points, std::span<Side> sides) const override {
      BitSource::sides(points, sides);
      for (std::size_t i = 0; i < points.size(); ++i)
        if (points[i] == Point(1, 1, 1.5f)) sides[i] = Side::Inside;
    }
  };
  const Isosurface out = isosurfaceOf(Neck(), {.cell = 1.0});
  const MeshFaults faults = faultsOf(out.mesh);
  EXPECT_TRUE(faults.none()) << describe(faults);
  EXPECT_EQ(faults.shellCount, 1u);
  EXPECT_EQ(testing::eulerCharacteristic(out.mesh), 2);
}

class RandomGrids : public ::testing::TestWithParam<BitSource::Crossings> {};

TEST_P(RandomGrids, S13AreClosedManifoldAndDoNotMeetThemselves) {
  constexpr int kWork = restroke::testing::kSanitized ? 4000 : 76'800;
  int grids = 0;
  // Many small ones, some large ones.
  for (int n = 4; n <= 12; ++n)
    for (int k = 0; k < kWork / (n * n * n * n); ++k) {
      const std::array<int, 3> size{n, n, n};
      const std::uint64_t seed = static_cast<std::uint64_t>(n * 1000 + k);
      Random random(seed);
      const std::size_t percent = 10 + random.below(81);
      std::vector<bool> bits(static_cast<std::size_t>(n * n * n));
      for (std::size_t i = 0; i < bits.size(); ++i) bits[i] = random.below(100) < percent;
      ASSERT_TRUE(isRight(BitSource(size, bits, GetParam()), size)) << "seed " << seed << ", size " << n;
      ++grids;
    }
  EXPECT_GT(grids, kWork / 200);  // whole numbers of each size
}

INSTANTIATE_TEST_SUITE_P(Isosurface, RandomGrids,
                         ::testing::Values(BitSource::Crossings::Middle, BitSource::Crossings::Random,
                                           BitSource::Crossings::AtEnds),
                         [](const auto& test) {
                           return test.param == BitSource::Crossings::Middle   ? "CrossedInTheMiddle"
                                  : test.param == BitSource::Crossings::Random ? "CrossedAnywhere"
                                                                               : "CrossedAtTheEnds";
                         });

// All pairs of triangles against those of which one is of a doubtful quad: the others meet nothing.
std::size_t expectOnlyDoubtfulOnesMeet(const ContourSource& source, double cell) {
  const SideGrid grid(source, source.bounds(), cell);
  const DualMesh dual(grid, source);
  const DualMesh::Triangles triangles = dual.triangles();
  const std::vector<bool> doubtful = dual.doubtfulQuads();
  std::vector<bool> chosen(triangles.quad.size());
  for (std::size_t t = 0; t < chosen.size(); ++t) chosen[t] = doubtful[triangles.quad[t]];
  EXPECT_EQ(meetingPairs(triangles.mesh, chosen),
            meetingPairs(triangles.mesh, std::vector<bool>(chosen.size(), true)));
  return static_cast<std::size_t>(std::count(chosen.begin(), chosen.end(), false));
}

TEST(DualMesh, OnlyTrianglesOfDoubtfulQuadsMeetOthers) {
  const std::array<int, 3> size{9, 8, 7};
  std::size_t sure = 0;
  for (std::uint64_t seed = 1; seed <= (restroke::testing::kSanitized ? 20u : 300u); ++seed) {
    Random random(seed);
    // From salt and pepper to blobs, in which more cells have one patch.
    std::vector<bool> bits(9 * 8 * 7);
    const std::size_t one = 2 + random.below(5);
    for (std::size_t i = 0; i < bits.size(); ++i) bits[i] = random.below(one) == 0;
    if (seed % 2 == 0)
      for (std::size_t i = 1; i < bits.size(); ++i)
        if (random.below(4) != 0) bits[i] = bits[i >= 72 && random.below(2) == 0 ? i - 72 : i - 1];
    for (const auto crossings :
         {BitSource::Crossings::Middle, BitSource::Crossings::Random, BitSource::Crossings::AtEnds})
      sure += expectOnlyDoubtfulOnesMeet(BitSource(size, bits, crossings), 1.0);
  }
  EXPECT_GT(sure, 10'000u);
  // Of an ordinary shape most quads need no test.
  const implicit::PrimitiveList list = testing::shapeOfAllKinds();
  const ListSource source(list);
  EXPECT_GT(expectOnlyDoubtfulOnesMeet(source, 0.05), 10'000u);
}

TEST(SideGrid, ASourcesOwnGridMustHaveAnOutsideBorder) {
  class Full final : public GridSource {
   public:
    [[nodiscard]] Box bounds() const override { return {Point(0), Point(2)}; }
    [[nodiscard]] Grid grid() const override { return {1, {{{0, 1, 2}, {0, 1, 2}, {0, 1, 2}}}}; }
    void sides(std::span<const Point>, std::span<Side> sides) const override {
      std::fill(sides.begin(), sides.end(), Side::Inside);
    }
    [[nodiscard]] Crossing crossing(Point inside, Point) const override { return {DVec3(inside)}; }
    void fillSides(std::size_t, std::span<std::uint64_t> bits) const override { bits[4] = 6; }
  };
  EXPECT_THROW((void)isosurfaceOf(Full()), InternalError);
}

}  // namespace
}  // namespace restroke::points
