// Solids that cut and add on the lines of a tri-dexel, against each line by itself (R8, D4).

#include "points/dexel/solid_tool.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "points/dexel/mesh_dexels.h"
#include "points/dexel/refine/refine.h"
#include "points/dexel/toolpath/swept_cutter.h"
#include "tests/support/brute_force.h"
#include "tests/support/effort.h"
#include "tests/support/meshes.h"

namespace restroke::points {
namespace {

using restroke::testing::boxMesh;
using restroke::testing::kSanitized;
using restroke::testing::Random;

// A line with its ends, and the operations that changed it.
struct PlainLine {
  LineEnds ends;
  std::vector<OperationId> changes;
};
using PlainModel = std::array<std::vector<PlainLine>, 3>;

PlainModel plainOf(const TriDexel& model) {
  PlainModel plain;
  for (int axis = 0; axis < 3; ++axis) {
    auto& lines = plain[static_cast<std::size_t>(axis)];
    lines.resize(model.family(axis).lineCount());
    for (std::size_t i = 0; i < lines.size(); ++i) model.family(axis).read(i, lines[i].ends);
  }
  return plain;
}

// Every line asks the solid.
void applyPlainly(PlainModel& plain, const DexelGrid& grid, const SolidStep& step) {
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int row = 0; row < grid.height(axis); ++row)
      for (int column = 0; column < grid.width(axis); ++column) {
        PlainLine& line =
            plain[static_cast<std::size_t>(axis)][static_cast<std::size_t>(row * grid.width(axis) + column)];
        Ray ray{DVec3(0), DVec3(0)};
        ray.origin[u] = static_cast<double>(grid.at(u, column));
        ray.origin[v] = static_cast<double>(grid.at(v, row));
        ray.direction[axis] = 1;
        std::vector<SolidSpan> spans;
        step.solid->intersect(ray, spans);
        bool isChanged = false;
        const bool fills = step.operation == DexelOperation::Union;
        std::vector<ToolSpan> tool;
        for (const SolidSpan& s : spans)
          tool.push_back({static_cast<float>(s.enter), static_cast<float>(s.exit), packNormal(s.enterNormal),
                          packNormal(s.exitNormal)});
        if (step.operation == DexelOperation::Intersection) {
          isChanged = applyToLine(line.ends, tool, step.operation, step.id);
        } else {
          for (std::size_t i = 0; i < tool.size(); ++i) {
            if (!fills) {
              tool[i].enterNormal = packNormal(-spans[i].enterNormal);
              tool[i].exitNormal = packNormal(-spans[i].exitNormal);
            }
            isChanged |= changeLine(line.ends, tool[i], fills, step.id);
          }
        }
        if (isChanged) line.changes.push_back(step.id);
      }
  }
}

void expectSame(const TriDexel& model, const PlainModel& plain) {
  LineEnds ends;
  std::vector<OperationId> changes;
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i < model.family(axis).lineCount(); ++i) {
      const PlainLine& line = plain[static_cast<std::size_t>(axis)][i];
      model.family(axis).read(i, ends);
      ASSERT_EQ(ends, line.ends) << "axis " << axis << ", line " << i;
      if (!model.family(axis).keepsHistory()) continue;
      changes.clear();
      model.family(axis).changesOf(i, changes);
      ASSERT_EQ(changes, line.changes) << "axis " << axis << ", line " << i;
    }
}

// Moves of all kinds that cut into, add to and miss a box of side 8 about the origin.
struct RandomSteps {
  std::vector<std::unique_ptr<SweptCutter>> solids;
  std::vector<SolidStep> steps;

  RandomSteps(Random& random, int count, bool intersects) {
    constexpr std::array kKinds{Cutter::Kind::Flat, Cutter::Kind::Ball, Cutter::Kind::BullNose};
    for (int k = 0; k < count; ++k) {
      Cutter cutter{.kind = kKinds[random.below(3)],
                    .radius = 0.4 + 0.2 * static_cast<double>(random.below(5)),
                    .length = 6};
      if (cutter.kind == Cutter::Kind::BullNose) cutter.cornerRadius = 0.25;
      PathElement element{.from = DVec3(random.inCube(5)), .to = DVec3(random.inCube(5))};
      if (random.below(3) == 0) {
        element.kind = PathElement::Kind::Arc;
        element.center = DVec3(random.inCube(3));
        element.axis = static_cast<int>(random.below(3));
        if (random.below(2) == 0) {
          element.axis = 2;
          element.to.z = element.from.z;
        }
      }
      solids.push_back(std::make_unique<SweptCutter>(cutter, element, SweepOptions{.tolerance = 0.01}));
      const std::size_t kind = random.below(intersects ? 8 : 7);
      steps.push_back({solids.back().get(),
                       kind == 7   ? DexelOperation::Intersection
                       : kind >= 5 ? DexelOperation::Union
                                   : DexelOperation::Subtraction,
                       OperationId{static_cast<std::uint32_t>(k) + 1}});
    }
  }
};

TriDexel stock(int resolution) {
  const TriangleMesh box = boxMesh({-4, -4, -4}, {4, 4, 4});
  return triDexelOf(box, dexelGridFor(boundsOf(box), {.resolution = resolution}));
}

TEST(SolidTool, EachLineIsWhatItWouldBeByItself) {
  Random random(0x7001);
  RecordProperty("seed", "0x7001");
  for (int k = 0; k < (kSanitized ? 2 : 6); ++k) {
    SCOPED_TRACE(k);
    const RandomSteps random24(random, 24, k % 2 == 1);
    TriDexel model = stock(24);
    for (int axis = 0; axis < 3; ++axis) model.family(axis).startHistory();
    PlainModel plain = plainOf(model);
    for (const SolidStep& step : random24.steps) {
      apply(model, {&step, 1});
      applyPlainly(plain, model.grid(), step);
    }
    expectSame(model, plain);
  }
}

TEST(SolidTool, ThreadsAndTheDivisionOfStepsChangeNothing) {
  Random random(0x7002);
  RecordProperty("seed", "0x7002");
  const RandomSteps random60(random, kSanitized ? 12 : 60, true);
  const std::span<const SolidStep> steps = random60.steps;
  TriDexel one = stock(64);
  for (const SolidStep& step : steps) apply(one, {&step, 1}, {.threads = 1});
  for (const int threads : {1, 2, 8}) {
    TriDexel all = stock(64);
    apply(all, steps, {.threads = threads});
    EXPECT_EQ(all, one);
    TriDexel halves = stock(64);
    apply(halves, steps.first(steps.size() / 2), {.threads = threads});
    apply(halves, steps.subspan(steps.size() / 2), {.threads = threads});
    EXPECT_EQ(halves, one);
  }
}

TEST(SolidTool, ASlotHasItsVolumeAndAWallToo) {
  const Cutter cutter{.kind = Cutter::Kind::Flat, .radius = 1, .length = 10};
  TriDexel model = stock(160);
  const SweptCutter slot(cutter, {.from = {-2, 0, 3}, .to = {2, 0, 3}});
  const SolidStep cut{&slot, DexelOperation::Subtraction, OperationId{1}};
  apply(model, {&cut, 1});
  const double removed = 4 * 2 + 3.141592653589793;
  EXPECT_NEAR(model.volume(), 512 - removed, 0.05);
  // Beyond the grid it is cut off, until that has grown.
  const SweptCutter wall({.kind = Cutter::Kind::Flat, .radius = 0.5, .length = 2},
                         {.from = {-3, 3, 4}, .to = {3, 3, 4}});
  const SolidStep add{&wall, DexelOperation::Union, OperationId{2}};
  TriDexel grown = model;
  grown.growTo(wall.bounds());
  apply(grown, {&add, 1});
  EXPECT_NEAR(grown.volume() - model.volume(), 2 * (6 + 0.25 * 3.141592653589793), 0.05);
  EXPECT_NEAR(static_cast<double>(grown.bounds().max.z), 6, 1e-5);
}

TEST(SolidTool, R5AReplayOnTheModelsOwnLinesHasItsEnds) {
  // A box machined along lines and arcs, with walls added; every length a multiple of 1/64.
  Random random(0x7003);
  RecordProperty("seed", "0x7003");
  TriDexelDocument document;
  document.initial = boxMesh({-4, -4, -4}, {4, 4, 4});
  document.cutters = {{.kind = Cutter::Kind::Flat, .radius = 0.75, .length = 3},
                      {.kind = Cutter::Kind::Ball, .radius = 0.5, .length = 3},
                      {.kind = Cutter::Kind::BullNose, .radius = 1, .length = 3, .cornerRadius = 0.25}};
  const auto place = [&] {
    DVec3 p;
    for (int a = 0; a < 3; ++a) p[a] = static_cast<double>(random.below(512)) / 64 - 4;
    return p;
  };
  for (int k = 0; k < 60; ++k) {
    CutterMove move{.cutter = static_cast<std::uint32_t>(random.below(3)),
                    .element = {.from = place(), .to = place()}};
    if (k % 4 == 0) {
      move.element.kind = PathElement::Kind::Arc;
      move.element.center = place();
      move.element.to.z = move.element.from.z;
    }
    document.operations.push_back(
        {random.below(5) == 0 ? DexelOperation::Union : DexelOperation::Subtraction, move});
  }
  Box outer;
  outer.add({{-8, -8, -8}, {8, 8, 8}});
  document.model = triDexelOf(std::get<TriangleMesh>(document.initial), dexelGridFor(outer, {.cell = 0.25}));
  for (std::size_t i = 0; i < document.operations.size(); ++i) {
    const auto& move = std::get<CutterMove>(document.operations[i].tool);
    const SweptCutter sweep(document.cutters[move.cutter], move.element);
    const SolidStep step{&sweep, document.operations[i].operation, static_cast<OperationId>(i + 1)};
    apply(document.model, {&step, 1});
  }

  const DexelHistory history(document);
  const Zone zone(orientedBoxOf(outer));
  const RefinedModel replayed =
      refine({document, history}, {zone, newLines(zone, {.cell = 0.25})}, {.method = RefineMethod::All});
  ASSERT_EQ(replayed.families.size(), 3u);
  LineEnds ends, expected;
  for (int axis = 0; axis < 3; ++axis) {
    const RefinedFamily& family = replayed.families[static_cast<std::size_t>(axis)];
    const Dexels& own = document.model.family(axis);
    ASSERT_EQ(family.dexels.lineCount(), own.lineCount());
    for (int row = 0; row < family.dexels.height(); ++row)
      for (int column = 0; column < family.dexels.width(); ++column) {
        const DVec3 o = family.lines.family.line(column, row).origin;
        const int u = document.model.grid().nearestTo((axis + 1) % 3, static_cast<float>(o[(axis + 1) % 3])),
                  v = document.model.grid().nearestTo((axis + 2) % 3, static_cast<float>(o[(axis + 2) % 3]));
        own.read(own.lineAt(u, v), expected);
        family.dexels.read(family.dexels.lineAt(column, row), ends);
        ASSERT_EQ(ends.size(), expected.size()) << "axis " << axis << ", line " << u << ", " << v;
        for (std::size_t i = 0; i < ends.size(); ++i) {
          ASSERT_EQ(ends[i].depth, expected[i].depth) << "axis " << axis << ", line " << u << ", " << v;
          ASSERT_EQ(ends[i].normal, expected[i].normal) << "axis " << axis << ", line " << u << ", " << v;
        }
      }
  }
}

TEST(SolidTool, WhatIsNowhereNearChangesNothing) {
  TriDexel model = stock(16);
  const TriDexel before = model;
  const SweptCutter far({}, {.from = {50, 50, 50}, .to = {60, 50, 50}});
  for (const DexelOperation operation : {DexelOperation::Subtraction, DexelOperation::Union}) {
    const SolidStep step{&far, operation, OperationId{1}};
    apply(model, {&step, 1});
    EXPECT_EQ(model, before);
  }
  apply(model, {});
  EXPECT_EQ(model, before);
  const SolidStep step{&far, DexelOperation::Intersection, OperationId{1}};
  apply(model, {&step, 1});
  EXPECT_EQ(model.endCount(), 0u);
}

}  // namespace
}  // namespace restroke::points
