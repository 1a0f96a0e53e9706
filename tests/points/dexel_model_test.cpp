// Tri-dexels of lists: against the list itself, and the same bits however they are made.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "implicit/errors.h"
#include "implicit/ray_cast.h"
#include "implicit/side.h"
#include "implicit/simd/dispatch.h"
#include "points/dexel/tri_dexel.h"
#include "tests/support/brute_force.h"
#include "tests/support/random_volumes.h"

namespace restroke::points {
namespace {

using implicit::Primitive;
using implicit::PrimitiveList;
using implicit::Sign;
using restroke::testing::Random;

std::vector<Primitive> randomList(std::uint64_t seed, std::size_t count) {
  Random random(seed);
  std::vector<Primitive> list = {{{{0, 0, 0}, 1.0f}, Sign::Positive}};
  while (list.size() < count) list.push_back(restroke::testing::randomPrimitive(random, list));
  return list;
}

PrimitiveList listOf(const std::vector<Primitive>& primitives) {
  PrimitiveList list;
  for (const Primitive& primitive : primitives) list.append(primitive);
  return list;
}

// Sides of points of the grid, as the list tells them, agree but within one cell of the surface.
void compareSides(const TriDexel& model, const PrimitiveList& list) {
  const DexelGrid& grid = model.grid();
  std::size_t different = 0, asked = 0;
  Random random(5);
  for (int i = 0; i < 20'000; ++i) {
    GridCounts at;
    for (std::size_t a = 0; a < 3; ++a)
      at[a] = static_cast<int>(random.below(static_cast<std::size_t>(grid.counts()[a])));
    const Point p = grid.at(at);
    const bool inside = sideOf(list, p) == implicit::Side::Inside;
    ++asked;
    if (model.isInside(at) == inside) continue;
    ++different;
    // Within a cell there is a point of the other side.
    bool near = false;
    const auto h = static_cast<float>(grid.cell());
    for (int k = 0; k < 400 && !near; ++k)
      near = (sideOf(list, p + random.inCube(h) * 0.577f) == implicit::Side::Inside) != inside;
    EXPECT_TRUE(near) << p.x << ", " << p.y << ", " << p.z;
  }
  EXPECT_LT(static_cast<double>(different), 1e-3 * static_cast<double>(asked));
}

TEST(TriDexel, OfABallHasItsVolumeAndItsEnds) {
  const PrimitiveList list = listOf({{{{0.1f, -0.2f, 0.3f}, 1.0f}, Sign::Positive}});
  const TriDexel model = triDexelOf(list, dexelGridFor(list.bounds(), {.resolution = 128}));
  EXPECT_NEAR(model.volume(), 4.18879, 4.18879 * 2e-3);
  LineEnds ends;
  for (int axis = 0; axis < 3; ++axis) {
    const Dexels& dexels = model.family(axis);
    for (int row = 0; row < dexels.height(); ++row)
      for (int column = 0; column < dexels.width(); ++column) {
        dexels.read(dexels.lineAt(column, row), ends);
        for (const SpanEnd& end : ends) {
          Point p;
          p[axis] = end.depth;
          p[(axis + 1) % 3] = model.grid().at((axis + 1) % 3, column);
          p[(axis + 2) % 3] = model.grid().at((axis + 2) % 3, row);
          const Vec3 d = p - Point(0.1f, -0.2f, 0.3f);
          EXPECT_NEAR(length(d), 1, 1e-6);
          EXPECT_NEAR(dot(unpackNormal(end.normal), d), 1, 1e-5);
        }
      }
  }
}

TEST(TriDexel, AgreesWithTheListButWithinACellOfTheSurface) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const PrimitiveList list = listOf(randomList(seed, 200));
    compareSides(triDexelOf(list, dexelGridFor(list.bounds(), {.resolution = 96})), list);
  }
}

// The oracle: where a ray enters the list's shape, the line enters a span.
TEST(TriDexel, EntersWhereRaysDo) {
  const PrimitiveList list = listOf(randomList(4, 150));
  const TriDexel model = triDexelOf(list, dexelGridFor(list.bounds(), {.resolution = 64}));
  LineEnds ends;
  std::size_t compared = 0, missing = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Dexels& dexels = model.family(axis);
    for (int row = 0; row < dexels.height(); ++row)
      for (int column = 0; column < dexels.width(); ++column) {
        DVec3 origin{0}, direction{0};
        origin[axis] = -10;
        direction[axis] = 1;
        origin[(axis + 1) % 3] = static_cast<double>(model.grid().at((axis + 1) % 3, column));
        origin[(axis + 2) % 3] = static_cast<double>(model.grid().at((axis + 2) % 3, row));
        dexels.read(dexels.lineAt(column, row), ends);
        const auto hit = castRay(list, {origin, direction});
        if (hit.has_value() != !ends.empty()) {
          ++missing;
          continue;
        }
        if (!hit) continue;
        ++compared;
        if (std::fabs(static_cast<double>(ends[0].depth) - (hit->t - 10)) > 1e-5) {
          ++missing;
          continue;
        }
        // Where boundaries cross, either one's normal will do.
        EXPECT_LT(dot(DVec3(unpackNormal(ends[0].normal)), direction), 1e-3);
      }
  }
  EXPECT_GT(compared, 3000u);
  EXPECT_LE(missing, 2u) << "stretches that float32 has no room for";
}

TEST(TriDexel, IsTheSameWhetherAppliedOneByOneOrTogetherAtAnySimdLevelAndThreadCount) {
  const std::vector<Primitive> primitives = randomList(6, 400);
  const PrimitiveList list = listOf(primitives);
  const DexelGrid grid = dexelGridFor(list.bounds(), {.resolution = 100});
  const implicit::SimdLevel before = implicit::simdLevel();
  const TriDexel expected = triDexelOf(list, grid, {}, {.threads = 1});
  for (const implicit::SimdLevel level : implicit::supportedSimdLevels()) {
    implicit::useSimdLevel(level);
    for (const int threads : {1, 2, 8}) EXPECT_EQ(triDexelOf(list, grid, {}, {.threads = threads}), expected);
    TriDexel model(grid);
    for (std::uint32_t i = 0; i < primitives.size(); ++i)
      model.apply({&primitives[i], 1}, static_cast<OperationId>(i), {.threads = 2});
    EXPECT_EQ(model, expected);
  }
  implicit::useSimdLevel(before);
}

TEST(TriDexel, HoldsVolumesOfEveryKind) {
  Random random(8);
  std::vector<Primitive> primitives = {{{{0, 0, 0}, 1.0f}, Sign::Positive}};
  for (int i = 0; i < 40; ++i)
    primitives.push_back(restroke::testing::randomMixedPrimitive(random, primitives));
  const PrimitiveList list = listOf(primitives);
  compareSides(triDexelOf(list, dexelGridFor(list.bounds(), {.resolution = 64})), list);
}

TEST(TriDexel, WholeModelsAreUnitedSubtractedAndIntersectedLineByLine) {
  const std::vector<Primitive> a = randomList(9, 120), b = randomList(10, 120);
  PrimitiveList both = listOf(a);
  for (const Primitive& primitive : b) both.append(primitive);
  const DexelGrid grid = dexelGridFor(both.bounds(), {.resolution = 80});
  const TriDexel first = triDexelOf(listOf(a), grid), second = triDexelOf(listOf(b), grid);
  LineEnds x, y, expected;
  for (const DexelOperation operation :
       {DexelOperation::Union, DexelOperation::Subtraction, DexelOperation::Intersection}) {
    TriDexel result = first;
    result.apply(second, operation, OperationId{1000}, {.threads = 2});
    TriDexel alone = first;
    alone.apply(second, operation, OperationId{1000}, {.threads = 1});
    EXPECT_EQ(result, alone);
    for (int axis = 0; axis < 3; ++axis)
      for (std::size_t line = 0; line < first.family(axis).lineCount(); ++line) {
        first.family(axis).read(line, expected);
        second.family(axis).read(line, y);
        std::vector<ToolSpan> spans;
        for (std::size_t i = 0; i < y.size(); i += 2)
          spans.push_back(
              {y[i].depth, y[i + 1].depth, y[i].normal & ~kPackedFlag, y[i + 1].normal & ~kPackedFlag});
        applyToLine(expected, spans, operation, OperationId{1000});
        result.family(axis).read(line, x);
        ASSERT_EQ(x, expected) << "axis " << axis << ", line " << line;
      }
  }
}

TEST(TriDexel, KeepsWhatIsWithinAShape) {
  const std::vector<Primitive> primitives = randomList(12, 100);
  const PrimitiveList list = listOf(primitives);
  const DexelGrid grid = dexelGridFor(list.bounds(), {.resolution = 70});
  const implicit::Shape ball({0.3f, 0.1f, -0.2f}, 0.8f);
  TriDexel model = triDexelOf(list, grid);
  model.intersect(ball, OperationId{500}, {.threads = 2});
  // Within both, and nowhere else.
  std::size_t wrong = 0, inside = 0;
  Random random(13);
  for (int i = 0; i < 20'000; ++i) {
    GridCounts at;
    for (std::size_t a = 0; a < 3; ++a)
      at[a] = static_cast<int>(random.below(static_cast<std::size_t>(grid.counts()[a])));
    const Point p = grid.at(at);
    const bool expected = sideOf(list, p) == implicit::Side::Inside && contains(ball, p);
    inside += expected;
    wrong += model.isInside(at) != expected;
  }
  EXPECT_GT(inside, 200u);
  EXPECT_LE(wrong, 2u);
}

TEST(TriDexel, GrowsByEmptyLinesAndKeepsWhatIsThere) {
  const std::vector<Primitive> primitives = randomList(11, 60);
  const PrimitiveList list = listOf(primitives);
  TriDexel model = triDexelOf(list, dexelGridFor(list.bounds(), {.resolution = 50}));
  const double volume = model.volume();
  const std::size_t ends = model.endCount();
  Box wider = list.bounds();
  wider.max.x += 1.3f;
  wider.min.z -= 0.4f;
  model.growTo(wider);
  EXPECT_EQ(model.endCount(), ends);
  EXPECT_NEAR(model.volume(), volume, 1e-9);
  // The grown grid has the lines of the old one: the same list on it gives the same ends there.
  EXPECT_EQ(model, triDexelOf(list, model.grid()));
  const TriDexel same = model;
  model.growTo(wider);
  EXPECT_EQ(model, same);
  model.growTo({});
  EXPECT_EQ(model, same);
  // Far away there are too many lines on the way, or float32 has no numbers for them.
  for (const float far : {600.0f, 1e6f}) {
    wider.max.x = far;
    EXPECT_THROW(model.growTo(wider), InputError);
    EXPECT_EQ(model, same);
  }
}

// SPEC R1 counts bytes at 200,000 lines: single-digit megabytes at depth complexity 1.
TEST(TriDexel, TwoHundredThousandLinesTakeSingleDigitMegabytes) {
  const PrimitiveList list = listOf({{{{0, 0, 0}, 1.0f}, Sign::Positive}});
  const TriDexel model = triDexelOf(list, dexelGridFor(list.bounds(), {.resolution = 259}));
  EXPECT_GT(model.grid().lineCount(), 200'000u);
  EXPECT_LT(model.bytes(), 9'000'000u);
}

TEST(DexelGrid, RefusesWhatCannotBe) {
  Box box;
  box.add({{-1, -1, -1}, {1, 1, 1}});
  EXPECT_THROW((void)dexelGridFor({}, {}), InputError);
  EXPECT_THROW((void)dexelGridFor(box, {.resolution = 0}), InputError);
  EXPECT_THROW((void)dexelGridFor(box, {.resolution = kMostLines + 1}), InputError);
  EXPECT_THROW((void)dexelGridFor(box, {.cell = 0.0}), InputError);
  EXPECT_THROW((void)dexelGridFor(box, {.cell = std::nan("")}), InputError);
  EXPECT_THROW((void)dexelGridFor(box, {.resolution = 10, .cell = 0.1}), InputError);
  EXPECT_THROW((void)dexelGridFor(box, {.cell = 1e-6}), InputError);
}

TEST(DexelGrid, FindsTheFirstPointFromACoordinateOn) {
  Box box;
  box.add({{-1.3f, 0, 5}, {1, 0.7f, 5.1f}});
  const DexelGrid grid(box, 0.0371);
  for (int axis = 0; axis < 3; ++axis) {
    const int n = grid.counts()[static_cast<std::size_t>(axis)];
    for (int i = 0; i < n; ++i) {
      const auto at = static_cast<double>(grid.at(axis, i));
      EXPECT_EQ(grid.firstFrom(axis, at), i);
      EXPECT_EQ(grid.firstFrom(axis, std::nextafter(at, 1e9)), i + 1);
    }
    EXPECT_EQ(grid.firstFrom(axis, -1e9), 0);
    EXPECT_EQ(grid.firstFrom(axis, 1e9), n);
  }
}

}  // namespace
}  // namespace restroke::points
