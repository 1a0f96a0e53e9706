// What each method of refinement guarantees (SPEC R3-R6, points/dexel/refine/refine.h).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "implicit/errors.h"
#include "points/dexel/refine/model_cells.h"
#include "tests/points/refine_support.h"
#include "tests/support/effort.h"

namespace restroke::points {
namespace {

using restroke::testing::kSanitized;
using restroke::testing::Random;
using testing::denseDocument;
using testing::difference;
using testing::makeModel;
using testing::someZones;

constexpr int kFine = kSanitized ? 12 : 64;

// A zone of 1 % of the volume of the cube of half size 1.15.
Zone smallZone(Random& random) {
  const Point c = random.inCube(0.5f);
  const Vec3 half(0.2154f * 1.15f);
  return Zone(orientedBoxOf({c - half, c + half}));
}

TEST(Refine, R5ClustersAndAllAreTheSameBitsOnRandomHistories) {
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    TriDexelDocument document = denseDocument({.seed = seed, .count = kSanitized ? 300u : 3000u});
    makeModel(document, 16);
    const DexelHistory history(document);
    for (const Zone& zone : someZones()) {
      const auto lines = newLines(zone, {.resolution = kFine / 2});
      const RefinedModel all = refine({document, history}, {zone, lines}, {.method = RefineMethod::All});
      for (const int threads : {1, 2})
        EXPECT_TRUE(testing::areEqual(refine({document, history}, {zone, lines},
                                             {.method = RefineMethod::Clusters}, {.threads = threads}),
                                      all));
      EXPECT_TRUE(testing::areEqual(
          refine({document, history}, {zone, lines}, {.method = RefineMethod::All, .plain = true}), all));
      EXPECT_GT(all.families[0].dexels.endCount(), kSanitized ? 10u : 200u);
    }
  }
}

// The figure: a dense mixed history at 258 lines.
TEST(Refine, R4EndsMissLessThanAFiftiethOfAPercentOnADenseHistoryAt258Lines) {
  TriDexelDocument document = denseDocument({.seed = 4, .count = kSanitized ? 500u : 8000u});
  makeModel(document, kSanitized ? 64 : 258);
  const DexelHistory history(document);
  Random random(5);
  for (int k = 0; k < 4; ++k) {
    const Zone zone = smallZone(random);
    const auto lines = newLines(zone, {.resolution = kFine});
    const RefinedModel all = refine({document, history}, {zone, lines}, {.method = RefineMethod::All}),
                       ends = refine({document, history}, {zone, lines}, {.method = RefineMethod::Ends});
    EXPECT_LT(difference(ends, all).part(), kSanitized ? 2e-2 : 2e-4);
    EXPECT_LE(ends.ids.size(), history.idCount());
  }
}

// At few lines references are missed, but never what the cells know: corrected it is no worse, and the
// document's method is worse.
TEST(Refine, R4OneReferenceAnEndMissesMoreThanTwo) {
  TriDexelDocument document = denseDocument({.seed = 6, .count = kSanitized ? 500u : 6000u});
  makeModel(document, 57);
  const DexelHistory history(document);
  Random random(7);
  double byEnds = 0, byDocument = 0;
  for (int k = 0; k < 3; ++k) {
    const Zone zone = smallZone(random);
    const auto lines = newLines(zone, {.resolution = kFine});
    const RefinedModel all = refine({document, history}, {zone, lines}, {.method = RefineMethod::All});
    byEnds += difference(refine({document, history}, {zone, lines}), all).part();
    byDocument +=
        difference(refine({document, history}, {zone, lines}, {.method = RefineMethod::Document}), all)
            .part();
  }
  EXPECT_LT(byEnds, byDocument);
}

// On the model's own lines nothing of what they noticed is lost.
TEST(Refine, R2bTouchingIsExactOnTheModelsOwnLines) {
  TriDexelDocument document = denseDocument({.seed = 8, .count = kSanitized ? 300u : 3000u});
  makeModel(document, 40, {.operations = true, .history = true});
  const DexelHistory history(document);
  const DexelGrid& grid = document.model.grid();
  const Zone zone(orientedBoxOf({{-0.4f, -0.3f, -0.5f}, {0.4f, 0.5f, 0.3f}}));
  std::vector<LineFamily> lines;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    LineFamily family{.width = grid.width(axis), .height = grid.height(axis)};
    family.direction = DVec3(0);
    family.direction[axis] = 1;
    family.origin[u] = static_cast<double>(grid.at(u, 0));
    family.origin[v] = static_cast<double>(grid.at(v, 0));
    family.originStep[u] = family.originRowStep[v] = grid.cell();
    lines.push_back(family);
  }
  const RefinedModel all = refine({document, history}, {zone, lines}, {.method = RefineMethod::All}),
                     touching =
                         refine({document, history}, {zone, lines}, {.method = RefineMethod::Touching});
  // Lines differ from the model's by rounding to float32: what only grazes one may count for one only.
  EXPECT_LT(difference(touching, all).part(), 1e-6);
  EXPECT_LE(touching.ids.size(), all.ids.size());
  EXPECT_EQ(touching.ids.front(), OperationId::Initial);
}

TEST(Refine, R4WhereOnlyRemovedTheDocumentsResultContainsTheSolidAndWhereOnlyAddedTheSolidContainsIt) {
  for (const bool adds : {false, true}) {
    TriDexelDocument document =
        denseDocument({.seed = 9, .count = kSanitized ? 100u : 1500u, .adds = adds ? 100u : 0u});
    if (adds) document.initial = std::vector<implicit::Primitive>{};
    makeModel(document, 33);
    const DexelHistory history(document);
    for (const Zone& zone : someZones()) {
      const auto lines = newLines(zone, {.resolution = kFine});
      const RefinedModel all = refine({document, history}, {zone, lines}, {.method = RefineMethod::All}),
                         found =
                             refine({document, history}, {zone, lines}, {.method = RefineMethod::Document});
      const testing::Difference wrong = difference(found, all);
      // What is thinner than a cell the approximation itself may lack.
      EXPECT_LT(adds ? wrong.tooMuch : wrong.tooLittle, 2e-3 * wrong.length) << adds;
    }
  }
}

// A plate that no line of the model along its faces meets, and needles between lines: what no end refers to.
TEST(Refine, R4EndsMissWhatLiesBetweenTheLinesAndClustersDoNot) {
  TriDexelDocument document;
  document.initial = std::vector<implicit::Primitive>{{{{0, 0, 0}, 1.0f}, implicit::Sign::Positive}};
  document.operations.push_back(testing::operationOf({{{0, 0, 0}, 0.8f}, implicit::Sign::Negative}));
  // Grid of 20 lines over -1 .. 1: points at odd multiples of 0.05.
  for (int i = 0; i < 40; ++i)
    document.operations.push_back(testing::operationOf(
        {{{0.1f * static_cast<float>(i % 5), 0.1f * static_cast<float>(i / 8), 0}, 0.03f},
         implicit::Sign::Positive}));
  document.model = TriDexel(DexelGrid({Point(-1), Point(1)}, 0.1));
  {
    TriDexelDocument copy = document;
    std::vector<implicit::Primitive> all = std::get<std::vector<implicit::Primitive>>(copy.initial);
    for (const auto& operation : copy.operations)
      all.push_back({std::get<implicit::Shape>(operation.tool), operation.operation == DexelOperation::Union
                                                                    ? implicit::Sign::Positive
                                                                    : implicit::Sign::Negative});
    document.model.apply(all, OperationId::Initial);
  }
  const DexelHistory history(document);
  const Zone zone(orientedBoxOf({{-0.3f, -0.3f, -0.3f}, {0.3f, 0.3f, 0.3f}}));
  // Fine enough to meet the needles: every 0.025.
  const auto lines = newLines(zone, {.resolution = kSanitized ? 24 : kFine});
  const RefinedModel all = refine({document, history}, {zone, lines}, {.method = RefineMethod::All});
  EXPECT_GT(all.families[0].dexels.totalLength(), 0);
  EXPECT_EQ(refine({document, history}, {zone, lines}).families[0].dexels.totalLength(), 0);
  EXPECT_TRUE(
      testing::areEqual(refine({document, history}, {zone, lines}, {.method = RefineMethod::Clusters}), all));
}

TEST(Refine, R3TheVolumeOfAZoneIsThatOfTheSolidInIt) {
  TriDexelDocument document;
  document.initial = std::vector<implicit::Primitive>{{{{0, 0, 0}, 1.0f}, implicit::Sign::Positive}};
  makeModel(document, 32);
  const DexelHistory history(document);
  // An eighth of the ball.
  const Zone zone(orientedBoxOf({{0, 0, 0}, {1.2f, 1.2f, 1.2f}}));
  const RefinedModel refined = refine({document, history}, {zone, newLines(zone, {.resolution = 100})});
  ASSERT_TRUE(refined.volume());
  EXPECT_NEAR(*refined.volume(), 4.18879 / 8, 4e-3);
  EXPECT_EQ(refined.ids, std::vector{OperationId::Initial});
  const Zone frustum = someZones()[3];
  EXPECT_FALSE(refine({document, history}, {frustum, newLines(frustum, {})}).volume());
}

TEST(Refine, AZoneBesideTheModelIsEmptyAndOneWithinItIsFull) {
  TriDexelDocument document = denseDocument({.seed = 12, .count = 0});
  makeModel(document, 64);
  const DexelHistory history(document);
  for (const RefineMethod method : {RefineMethod::Ends, RefineMethod::Document, RefineMethod::All}) {
    const Zone beside(orientedBoxOf({{3, 3, 3}, {4, 4, 4}}));
    const RefinedModel empty =
        refine({document, history}, {beside, newLines(beside, {.resolution = 8})}, {.method = method});
    EXPECT_EQ(empty.families[0].dexels.endCount(), 0u) << nameOf(method);
    EXPECT_TRUE(empty.ids.empty());
    const Zone within(orientedBoxOf({{-0.2f, -0.2f, -0.2f}, {0.2f, 0.2f, 0.2f}}));
    const RefinedModel full =
        refine({document, history}, {within, newLines(within, {.resolution = 8})}, {.method = method});
    EXPECT_NEAR(full.volume().value(), 0.064, 1e-6) << nameOf(method);
  }
}

TEST(Refine, RefusesModelsThatDoNotKeepWhatAMethodNeeds) {
  TriDexelDocument document = denseDocument({.seed = 13, .count = 3});
  makeModel(document, 8, {.operations = false});
  const DexelHistory history(document);
  const Zone zone = someZones()[1];
  const auto lines = newLines(zone, {.resolution = 4});
  EXPECT_THROW((void)refine({document, history}, {zone, lines}), InputError);
  EXPECT_THROW((void)refine({document, history}, {zone, lines}, {.method = RefineMethod::Touching}),
               InputError);
  EXPECT_NO_THROW((void)refine({document, history}, {zone, lines}, {.method = RefineMethod::Clusters}));
  makeModel(document, 8);
  EXPECT_THROW((void)refine({document, history}, {zone, lines}, {.widening = -1}), InputError);
  EXPECT_THROW((void)refine({document, history}, {zone, lines}, {.widening = std::nan("")}), InputError);
}

// The cells' kinds, asked from points of their edges; and stretches of lines, asked from points on them.
TEST(ModelCells, KnowWhatTheirTwelveEdgesHave) {
  TriDexelDocument document = denseDocument({.seed = 14, .count = 400, .least = 0.1f, .most = 0.3f});
  makeModel(document, 24);
  const TriDexel& model = document.model;
  const ModelCells cells(model, {Point(-0.6f), Point(0.7f)}, {});
  Random random(15);
  std::array<std::size_t, 4> seen{};
  for (int k = 0; k < 4000; ++k) {
    std::array<int, 3> cell;
    for (std::size_t a = 0; a < 3; ++a) cell[a] = 8 + static_cast<int>(random.below(8));
    bool inside = false, outside = false;
    for (int axis = 0; axis < 3; ++axis)
      for (int edge = 0; edge < 4; ++edge) {
        const auto a = static_cast<std::size_t>(axis), u = (a + 1) % 3, v = (a + 2) % 3;
        const Dexels& dexels = model.family(axis);
        const std::size_t line = dexels.lineAt(cell[u] + (edge & 1), cell[v] + (edge >> 1));
        const float from = model.grid().at(axis, cell[a]), to = model.grid().at(axis, cell[a] + 1);
        for (int i = 0; i < 40; ++i) {
          const bool in = dexels.contains(line, from + (to - from) * (static_cast<float>(i) + 0.5f) / 40);
          (in ? inside : outside) = true;
        }
      }
    const ModelCells::Kind kind = cells.at(cell);
    ++seen[static_cast<std::size_t>(kind)];
    if (inside && outside) {
      EXPECT_EQ(kind, ModelCells::Kind::Mixed);
    } else if (kind != ModelCells::Kind::Mixed) {  // a span between two of the points asked makes it mixed
      EXPECT_EQ(kind, inside ? ModelCells::Kind::Full : ModelCells::Kind::Empty);
    }
  }
  for (std::size_t i = 1; i < 4; ++i) EXPECT_GT(seen[i], 50u);
  // Stretches.
  const DexelGrid& grid = model.grid();
  for (int k = 0; k < 500; ++k) {
    DVec3 direction(random.inCube(1));
    if (k % 4 == 0) direction = DVec3(k % 8 == 0 ? 1 : -1, 0, 0);
    const Ray line{DVec3(random.inCube(0.6f)), normalized(direction)};
    double at = -0.9;
    cells.forStretches(line, {-0.9, 0.9}, [&](ModelCells::Kind kind, double from, double to) {
      EXPECT_EQ(from, at);
      EXPECT_LT(from, to);
      at = to;
      for (const double part : {0.25, 0.5, 0.75}) {
        const DVec3 p = line.at(from + part * (to - from));
        bool within = true;
        std::array<int, 3> cell{};
        for (int a = 0; a < 3; ++a) {
          within = within && p[a] > -0.6 && p[a] < 0.7;
          cell[static_cast<std::size_t>(a)] = grid.firstFrom(a, p[a]) - 1;
        }
        if (within && to - from > 1e-9) {
          EXPECT_EQ(cells.at(cell), kind);
        }
      }
    });
    EXPECT_EQ(at, 0.9);
  }
}

}  // namespace
}  // namespace restroke::points
