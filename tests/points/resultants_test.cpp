// Histories merged into fewer operations (SPEC R7): the result stays, on every line.

#include "points/dexel/refine/resultants.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "implicit/errors.h"
#include "implicit/shapes/kinds.h"
#include "points/dexel/dexel_tool.h"
#include "points/dexel/line_family.h"
#include "points/dexel/mesh_dexels.h"
#include "points/dexel/refine/hidden_operations.h"
#include "points/dexel/refine/refine.h"
#include "tests/support/effort.h"
#include "tests/support/meshes.h"
#include "tests/support/random_volumes.h"

namespace restroke::points {
namespace {

using implicit::Primitive;
using implicit::PrimitiveList;
using implicit::Shape;
using implicit::Sign;
using restroke::testing::kSanitized;
using restroke::testing::Random;

// Balls of mixed sizes that lie on each other, now and then the same again, strokes, and other volumes.
std::vector<Primitive> denseHistory(std::uint64_t seed, std::size_t count) {
  Random random(seed);
  std::vector<Primitive> list = {{{{0, 0, 0}, 1.0f}, Sign::Positive}};
  while (list.size() < count) {
    const Sign sign = random.below(2) == 0 ? Sign::Positive : Sign::Negative;
    const std::size_t choice = random.below(12);
    if (choice == 0) {
      list.push_back(list[random.below(list.size())]);
      if (random.below(2) == 0) list.back().sign = sign;
    } else if (choice == 1) {
      const Point from = random.inCube(0.9f);
      const Vec3 by = random.inCube(0.05f);
      const float radius = random.between(0.05f, 0.2f);
      for (int i = 0; i < 12 && list.size() < count; ++i)
        list.push_back({{from + by * static_cast<float>(i), radius}, sign});
    } else if (choice == 2) {
      list.push_back(restroke::testing::randomMixedPrimitive(random, list));
    } else {
      const float radius = random.below(4) == 0 ? random.between(0.3f, 0.7f) : random.between(0.03f, 0.3f);
      list.push_back({{random.inCube(0.9f), radius}, sign});
    }
  }
  return list;
}

TriDexelDocument::Operation operationOf(const Primitive& primitive) {
  return {primitive.sign == Sign::Positive ? DexelOperation::Union : DexelOperation::Subtraction,
          primitive.shape};
}

// On lines that all of the document's shapes lie in.
void replayOn(TriDexel& model, const TriDexelDocument& document) {
  if (const auto* initial = std::get_if<std::vector<Primitive>>(&document.initial))
    for (const Primitive& primitive : *initial) model.apply({&primitive, 1}, OperationId::Initial);
  std::uint32_t id = 0;
  for (const TriDexelDocument::Operation& operation : document.operations) {
    const auto own = static_cast<OperationId>(++id);
    if (const auto* posed = std::get_if<TriDexelDocument::PosedTool>(&operation.tool)) {
      apply(model, DexelTool(document.tools[posed->tool]), {posed->pose, operation.operation, own});
      continue;
    }
    const Shape& shape = std::get<Shape>(operation.tool);
    const Primitive primitive{shape,
                              operation.operation == DexelOperation::Union ? Sign::Positive : Sign::Negative};
    if (operation.operation == DexelOperation::Intersection)
      model.intersect(shape, own);
    else
      model.apply({&primitive, 1}, own);
  }
}

TriDexelDocument documentOf(const std::vector<Primitive>& primitives, int resolution, bool history = true) {
  TriDexelDocument out;
  out.initial = std::vector{primitives[0]};
  Box box;
  for (const Primitive& primitive : primitives) box.add(boundsOf(primitive.shape));
  for (std::size_t i = 1; i < primitives.size(); ++i) out.operations.push_back(operationOf(primitives[i]));
  out.model = TriDexel(dexelGridFor(box, {.resolution = resolution}), {.history = history});
  replayOn(out.model, out);
  return out;
}

// Depths, normals and flags.
void expectSameEnds(const Dexels& a, const Dexels& b) {
  ASSERT_EQ(a.lineCount(), b.lineCount());
  LineEnds first, second;
  for (std::size_t line = 0; line < a.lineCount(); ++line) {
    a.read(line, first);
    b.read(line, second);
    ASSERT_EQ(first.size(), second.size()) << "line " << line;
    for (std::size_t k = 0; k < first.size(); ++k) {
      ASSERT_EQ(first[k].depth, second[k].depth) << "line " << line << " end " << k;
      ASSERT_EQ(first[k].normal, second[k].normal) << "line " << line << " end " << k;
    }
  }
}

PrimitiveList listOf(const TriDexelDocument& document) {
  PrimitiveList list;
  for (const Primitive& primitive : std::get<std::vector<Primitive>>(document.initial))
    list.append(primitive);
  for (const TriDexelDocument::Operation& operation : document.operations)
    list.append({std::get<Shape>(operation.tool),
                 operation.operation == DexelOperation::Union ? Sign::Positive : Sign::Negative});
  return list;
}

void expectSameReplays(const TriDexelDocument& before, const TriDexelDocument& after, std::uint64_t seed) {
  for (const DexelGrid& grid :
       {before.model.grid(),
        dexelGridFor(before.model.bounds(), {.cell = before.model.grid().cell() * 0.77})}) {
    TriDexel old(grid), merged(grid);
    replayOn(old, before);
    replayOn(merged, after);
    for (int axis = 0; axis < 3; ++axis) expectSameEnds(old.family(axis), merged.family(axis));
  }
  for (const auto* document : {&before, &after})
    for (const TriDexelDocument::Operation& operation : document->operations)
      if (operation.operation == DexelOperation::Intersection || operation.tool.index() != 0) return;
  Random random(seed);
  for (int i = 0; i < 3; ++i) {
    const LineFamily family =
        latticeAlong(DVec3(random.inCube(1)), before.model.bounds(), before.model.grid().cell() * 2.3);
    expectSameEnds(dexelsOf(listOf(before), family), dexelsOf(listOf(after), family));
  }
}

// Of each old operation its new number, by what operations are: those that were dropped have none.
std::vector<OperationId> newIdsIn(const TriDexelDocument& before, const TriDexelDocument& after,
                                  const HiddenOperations& hidden) {
  std::vector<OperationId> ids = {OperationId::Initial};
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < before.operations.size(); ++i) {
    if (hidden.verdicts[i] != OperationVerdict::Needed) {
      ids.push_back(OperationId::None);
      continue;
    }
    EXPECT_EQ(before.operations[i], after.operations.at(next));
    ids.push_back(static_cast<OperationId>(++next));
  }
  EXPECT_EQ(after.operations.size(), next);
  return ids;
}

std::vector<std::uint8_t> referredIn(const TriDexelDocument& document) {
  std::vector<std::uint8_t> out(document.operations.size());
  LineEnds ends;
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t line = 0; line < document.model.family(axis).lineCount(); ++line) {
      document.model.family(axis).read(line, ends);
      for (const SpanEnd& end : ends)
        for (const OperationId id : {end.inner, end.outer})
          if (id != OperationId::None && id != OperationId::Initial)
            out[static_cast<std::size_t>(id) - 1] = 1;
    }
  return out;
}

void expectModelWithNewNumbers(const TriDexelDocument& before, const TriDexelDocument& after) {
  const std::vector<OperationId> ids = newIdsIn(before, after, hiddenOperations(before, referredIn(before)));
  ASSERT_EQ(before.model.grid(), after.model.grid());
  TriDexel expected = before.model;
  LineEnds ends;
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t line = 0; line < expected.family(axis).lineCount(); ++line) {
      expected.family(axis).read(line, ends);
      for (SpanEnd& end : ends)
        for (OperationId* id : {&end.inner, &end.outer})
          if (*id != OperationId::None) *id = ids[static_cast<std::size_t>(*id)];
      if (!ends.empty()) expected.family(axis).write(line, ends);
    }
  EXPECT_EQ(after.model, expected);
}

// Whoever replays what a line's history names, on the initial solid, gets the line.
void expectHistoriesMakeTheirLines(const TriDexelDocument& document, std::uint64_t seed) {
  Random random(seed);
  const PrimitiveList all = listOf(document);
  std::vector<OperationId> entries, members;
  for (int i = 0; i < (kSanitized ? 30 : 150); ++i) {
    const int axis = static_cast<int>(random.below(3)), u = (axis + 1) % 3, v = (axis + 2) % 3;
    const Dexels& dexels = document.model.family(axis);
    const int column = static_cast<int>(random.below(static_cast<std::size_t>(dexels.width()))),
              row = static_cast<int>(random.below(static_cast<std::size_t>(dexels.height())));
    entries.clear();
    members.clear();
    dexels.changesOf(dexels.lineAt(column, row), entries);
    for (const OperationId entry : entries) appendMembers(document, entry, members);
    ASSERT_TRUE(std::is_sorted(members.begin(), members.end()));
    PrimitiveList named;
    named.append(all.at(0));
    for (const OperationId id : members) named.append(all.at(static_cast<std::size_t>(id)));
    LineFamily line{.width = 1, .height = 1};
    line.direction = DVec3(0);
    line.direction[axis] = 1;
    line.origin[u] = static_cast<double>(document.model.grid().at(u, column));
    line.origin[v] = static_cast<double>(document.model.grid().at(v, row));
    expectSameEnds(dexelsOf(named, line), dexelsOf(all, line));
  }
}

TEST(Resultants, R7TheResultStaysOnEveryLineWhateverIsDropped) {
  std::size_t before = 0, after = 0;
  for (std::uint64_t seed = 1; seed <= (kSanitized ? 1 : 4); ++seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    const TriDexelDocument document = documentOf(denseHistory(seed, kSanitized ? 200 : 900), 24);
    const Resultants merged = resultantsOf(document);
    expectModelWithNewNumbers(document, merged.document);
    expectSameReplays(document, merged.document, seed);
    expectHistoriesMakeTheirLines(document, seed);
    expectHistoriesMakeTheirLines(merged.document, seed + 1);
    const ResultantReport& report = merged.report;
    EXPECT_EQ(report.operationsBefore,
              report.operationsAfter + report.withoutEffect + report.hidden + report.covered);
    EXPECT_GT(report.withoutEffect, 0u);
    EXPECT_GT(report.hidden, 0u);
    EXPECT_GT(report.covered, 0u);
    EXPECT_LT(report.documentBytesAfter, report.documentBytesBefore);
    EXPECT_LT(report.historyEntriesAfter, report.historyEntriesBefore);
    EXPECT_EQ(report.runs, merged.document.runs.size());
    before += report.operationsBefore;
    after += report.operationsAfter;
  }
  // They lie on each other: much is decided by those that come last.
  EXPECT_LT(static_cast<double>(after), 0.8 * static_cast<double>(before));
}

TEST(Resultants, R7ASecondMergingChangesNothingButWhatTheFirstMadePossible) {
  const TriDexelDocument document = documentOf(denseHistory(7, kSanitized ? 150 : 600), 20);
  const Resultants once = resultantsOf(document), twice = resultantsOf(once.document);
  expectModelWithNewNumbers(once.document, twice.document);
  expectSameReplays(document, twice.document, 7);
  expectHistoriesMakeTheirLines(twice.document, 8);
  EXPECT_LE(twice.report.hidden, once.report.hidden / 10);
}

TEST(Resultants, X1AreTheSameForAnyNumberOfThreads) {
  const TriDexelDocument document = documentOf(denseHistory(9, kSanitized ? 150 : 600), 20);
  const Resultants expected = resultantsOf(document, {}, {.threads = 1});
  for (const int threads : {2, 8}) {
    const Resultants other = resultantsOf(document, {}, {.threads = threads});
    EXPECT_EQ(other.document.operations, expected.document.operations);
    EXPECT_EQ(other.document.model, expected.document.model);
    EXPECT_EQ(other.document.runs, expected.document.runs);
    EXPECT_EQ(other.report.historyEntriesAfter, expected.report.historyEntriesAfter);
  }
}

// A carving, and what happens when something else is added before or after it.
std::vector<OperationVerdict> verdictsOf(const std::vector<Primitive>& primitives) {
  const TriDexelDocument document = documentOf(primitives, 8, false);
  return hiddenOperations(document, std::vector<std::uint8_t>(document.operations.size())).verdicts;
}

constexpr Sign kAdd = Sign::Positive, kCarve = Sign::Negative;

TEST(Resultants, R7OneLaterOperationOfEitherSignHidesWhatLiesWithinIt) {
  const Primitive base{{{0, 0, 0}, 1.0f}, kAdd}, inner{{{0.8f, 0, 0}, 0.2f}, kCarve};
  for (const Sign sign : {kAdd, kCarve}) {
    const Primitive outer{{{0.8f, 0, 0}, 0.3f}, sign}, between{{{0.8f, 0.3f, 0}, 0.2f}, kAdd};
    EXPECT_EQ(verdictsOf({base, inner, between, outer})[0], OperationVerdict::Hidden);
    EXPECT_EQ(verdictsOf({base, outer, between, inner})[2], OperationVerdict::Needed);
  }
  // Borders that float32 may not tell apart: the same centre, or touching from within.
  EXPECT_EQ(verdictsOf({base, inner, {{{0.8f, 0, 0}, 0.200001f}, kAdd}})[0], OperationVerdict::Needed);
  EXPECT_EQ(verdictsOf({base, inner, {{{0.9f, 0, 0}, 0.3f}, kAdd}})[0], OperationVerdict::Needed);
  // The same place again with the other sign: ends at the border may be the first one's.
  EXPECT_EQ(verdictsOf({base, inner, {inner.shape, kAdd}})[0], OperationVerdict::Needed);
}

TEST(Resultants, R7WhatARunHasAlreadyDoneHasNoEffect) {
  const Primitive base{{{0, 0, 0}, 1.0f}, kAdd}, large{{{0.9f, 0, 0}, 0.3f}, kCarve},
      small{{{0.9f, 0.1f, 0}, 0.1f}, kCarve};
  EXPECT_EQ(verdictsOf({base, large, small})[1], OperationVerdict::WithoutEffect);
  EXPECT_EQ(verdictsOf({base, large, large})[1], OperationVerdict::WithoutEffect);
  // What is added elsewhere does not matter; where it meets, it does.
  EXPECT_EQ(verdictsOf({base, large, {{{-0.9f, 0, 0}, 0.3f}, kAdd}, small})[2],
            OperationVerdict::WithoutEffect);
  EXPECT_EQ(verdictsOf({base, large, {{{0.9f, 0.2f, 0}, 0.1f}, kAdd}, small})[2], OperationVerdict::Needed);
  // Added within the initial solid; taken away where nothing ever was.
  EXPECT_EQ(verdictsOf({base, {{{0.2f, 0, 0}, 0.5f}, kAdd}})[0], OperationVerdict::WithoutEffect);
  EXPECT_EQ(verdictsOf({base, large, {{{0.2f, 0, 0}, 0.5f}, kAdd}})[1], OperationVerdict::Needed)
      << "it meets the carving";
  EXPECT_EQ(verdictsOf({base, {{{2, 0, 0}, 0.5f}, kCarve}})[0], OperationVerdict::WithoutEffect);
  EXPECT_EQ(verdictsOf({base, {{{2, 0.3f, 0}, 0.2f}, kAdd}, {{{2, 0, 0}, 0.5f}, kCarve}})[1],
            OperationVerdict::Needed);
}

TEST(Resultants, R7SeveralLaterOperationsCoverWhatNoneHidesAlone) {
  const Primitive base{{{0, 0, 0}, 1.0f}, kAdd}, inner{{{0.8f, 0, 0}, 0.25f}, kCarve},
      left{{{0.62f, 0, 0}, 0.4f}, kAdd}, right{{{0.98f, 0, 0}, 0.4f}, kCarve};
  EXPECT_EQ(verdictsOf({base, inner, left, right})[0], OperationVerdict::Covered);
  EXPECT_EQ(verdictsOf({base, inner, left, {{{1.1f, 0, 0}, 0.2f}, kCarve}})[0], OperationVerdict::Needed);
  EXPECT_EQ(verdictsOf({base, left, inner, right})[1], OperationVerdict::Needed) << "one is earlier";
  // As large as it, moved a little each way: every part of its rim is within one of them.
  std::vector<Primitive> around = {base, inner};
  for (int a = 0; a < 3; ++a)
    for (const float by : {-0.01f, 0.01f}) {
      around.push_back({inner.shape, a % 2 == 0 ? kAdd : kCarve});
      Point center = inner.shape.ball().center;
      center[a] += by;
      around.back().shape = Shape(center, inner.shape.ball().radius);
    }
  EXPECT_EQ(verdictsOf(around)[0], OperationVerdict::Covered);
  around.pop_back();
  EXPECT_EQ(verdictsOf(around)[0], OperationVerdict::Needed);
}

TEST(Resultants, R7OfManyStampsInOnePlaceFewStay) {
  Random random(21);
  std::vector<Primitive> primitives = {{{{0, 0, 0}, 1.0f}, kAdd}};
  for (int i = 0; i < (kSanitized ? 100 : 2000); ++i)
    primitives.push_back(
        {{Point(1, 0, 0) + random.inCube(0.02f), 0.2f}, random.below(3) == 0 ? kAdd : kCarve});
  const TriDexelDocument document = documentOf(primitives, 60);
  const Resultants merged = resultantsOf(document);
  EXPECT_LT(merged.report.operationsAfter, document.operations.size() / (kSanitized ? 1 : 2));
  expectModelWithNewNumbers(document, merged.document);
  expectSameReplays(document, merged.document, 21);
  expectHistoriesMakeTheirLines(merged.document, 22);
}

TEST(Resultants, R7IntersectionsHideWhatLiesWhollyOutside) {
  TriDexelDocument document;
  document.initial = std::vector<Primitive>{{{{0, 0, 0}, 1.0f}, kAdd}};
  const auto box = implicit::boxKind().make(implicit::boxKind().examples()[0]);
  implicit::Pose pose;
  pose.scale = 0.5f / static_cast<float>(box->measures().radius);
  const Shape volume = std::make_shared<const implicit::PosedVolume>(box, pose);
  for (const Shape& kept : {Shape({0, 0, 0}, 0.5f), volume}) {
    document.operations = {operationOf({{{0.9f, 0, 0}, 0.3f}, kAdd}),
                           operationOf({{{0, 0.9f, 0}, 0.3f}, kCarve}),
                           operationOf({{{0, 0, 0}, 0.2f}, kCarve}),
                           operationOf({{{0, 0.4f, 0}, 0.3f}, kAdd}),
                           {DexelOperation::Intersection, kept}};
    document.model =
        TriDexel(dexelGridFor({Point(-1.3f), Point(1.3f)}, {.resolution = 20}), {.history = true});
    replayOn(document.model, document);
    const auto verdicts = hiddenOperations(document, std::vector<std::uint8_t>(5)).verdicts;
    const auto kNeeded = OperationVerdict::Needed, kHidden = OperationVerdict::Hidden;
    EXPECT_EQ(verdicts, (std::vector{kHidden, kHidden, kNeeded, kNeeded, kNeeded}));
    const Resultants merged = resultantsOf(document);
    expectModelWithNewNumbers(document, merged.document);
    expectSameReplays(document, merged.document, 1);
  }
}

TEST(Resultants, R7MeshToolsAndCuttersThatMeetNothingHaveNoEffect) {
  TriDexelDocument document;
  const TriangleMesh stock = restroke::testing::ballMesh(2);
  document.initial = stock;
  document.tools = {restroke::testing::ballMesh(1)};
  document.cutters = {{.kind = Cutter::Kind::Flat, .radius = 0.1, .length = 1}};
  for (const double x : {0.9, 3.0, 0.5}) {
    TriDexelDocument::PosedTool posed;
    posed.pose = {0.2, 0, 0, x, 0, 0.2, 0, 0, 0, 0, 0.2, 0, 0, 0, 0, 1};
    document.operations.push_back({DexelOperation::Subtraction, posed});
  }
  for (const double z : {0.5, 1.5})
    document.operations.push_back(
        {DexelOperation::Subtraction, CutterMove{0, {.from = {-1, 0.1, z}, .to = {1, 0.2, z}}}});
  document.operations.push_back(operationOf({{{0.9f, 0, 0}, 0.4f}, kCarve}));
  document.model = TriDexel(dexelGridFor({Point(-1.1f), Point(1.1f)}, {.resolution = 12}));
  const auto verdicts = hiddenOperations(document, std::vector<std::uint8_t>(6)).verdicts;
  EXPECT_EQ(verdicts, (std::vector{OperationVerdict::Hidden, OperationVerdict::WithoutEffect,
                                   OperationVerdict::Needed, OperationVerdict::Needed,
                                   OperationVerdict::WithoutEffect, OperationVerdict::Needed}));
  const TriDexelDocument merged = resultantsOf(document).document;
  ASSERT_EQ(merged.operations.size(), 3u);
  const DexelHistory before(document), after(merged);
  const Zone zone(orientedBoxOf({Point(-1.1f), Point(1.1f)}));
  Random random(3);
  for (int i = 0; i < 3; ++i) {
    const std::vector<LineFamily> lines =
        newLines(zone, {.resolution = 20, .direction = DVec3(random.inCube(1)) + DVec3(0, 0, 0.01)});
    const RefinedModel old = refine({document, before}, {zone, lines}, {.method = RefineMethod::All}),
                       other = refine({merged, after}, {zone, lines}, {.method = RefineMethod::All});
    ASSERT_EQ(old.families.size(), other.families.size());
    for (std::size_t f = 0; f < lines.size(); ++f)
      expectSameEnds(old.families[f].dexels, other.families[f].dexels);
  }
}

TEST(Resultants, R7RunsShortenHistoriesAndTouchingRefinesThemAlike) {
  // Strokes, alternately added and carved.
  Random random(5);
  std::vector<Primitive> primitives = {{{{0, 0, 0}, 1.0f}, kAdd}};
  for (int stroke = 0; stroke < 12; ++stroke) {
    const Point from = random.inCube(0.8f);
    const Vec3 by = random.inCube(0.06f);
    for (int i = 0; i < 30; ++i)
      primitives.push_back({{from + by * static_cast<float>(i), 0.15f}, stroke % 2 == 0 ? kCarve : kAdd});
  }
  const TriDexelDocument document = documentOf(primitives, 20);
  const Resultants merged = resultantsOf(document);
  EXPECT_GT(merged.report.runs, 6u);
  EXPECT_LT(merged.report.historyEntriesAfter, merged.report.historyEntriesBefore / 2);
  EXPECT_LT(merged.report.historyBytesAfter, merged.report.historyBytesBefore);
  std::size_t next = 1;
  for (const TriDexelDocument::Run& run : merged.document.runs) {
    EXPECT_GE(static_cast<std::size_t>(run.first), next);
    EXPECT_TRUE(run.count >= 2 && run.count <= ResultantOptions{}.longestRun);
    next = static_cast<std::size_t>(run.first) + run.count;
  }
  EXPECT_LE(next, merged.document.operations.size() + 1);
  const Zone zone(orientedBoxOf({{-0.4f, -0.5f, -0.3f}, {0.6f, 0.5f, 0.4f}}));
  const std::vector<LineFamily> lines = newLines(zone, {.resolution = 30});
  const auto refined = [&](const TriDexelDocument& d, RefineMethod method) {
    return refine({d, DexelHistory(d)}, {zone, lines}, {.method = method});
  };
  const RefinedModel touching = refined(merged.document, RefineMethod::Touching),
                     all = refined(document, RefineMethod::All);
  for (std::size_t f = 0; f < 3; ++f) expectSameEnds(touching.families[f].dexels, all.families[f].dexels);
  // Without runs histories name operations.
  const Resultants plain = resultantsOf(document, {.runs = false});
  EXPECT_TRUE(plain.document.runs.empty());
  EXPECT_EQ(plain.document.operations, merged.document.operations);
  expectHistoriesMakeTheirLines(plain.document, 2);
}

TEST(Resultants, OfNothingAreNothing) {
  TriDexelDocument document;
  EXPECT_EQ(resultantsOf(document).report.operationsAfter, 0u);
  document = documentOf({{{{0, 0, 0}, 1.0f}, kAdd}}, 5);
  const Resultants merged = resultantsOf(document);
  EXPECT_EQ(merged.document.model, document.model);
  EXPECT_EQ(merged.report.referred + merged.report.runs, 0u);
}

}  // namespace
}  // namespace restroke::points
