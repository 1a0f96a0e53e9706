// Interval operations on one line, against the brute-force definition; the container; the kernels.

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "implicit/simd/dispatch.h"
#include "points/dexel/dexels.h"
#include "points/dexel/span_end.h"
#include "tests/support/brute_force.h"

namespace restroke::points {
namespace {

using restroke::testing::Random;

ToolSpan tool(float enter, float exit) {
  return {enter, exit, packNormal({0, 0, -1}), packNormal({0, 0, 1})};
}

LineEnds solid(std::initializer_list<float> depths) {
  LineEnds ends;
  for (const float depth : depths)
    ends.push_back({depth, packNormal({0, 0, ends.size() % 2 == 0 ? -1.0f : 1.0f}), OperationId::Initial,
                    OperationId::None});
  return ends;
}

std::vector<float> depthsOf(const LineEnds& ends) {
  std::vector<float> depths;
  for (const SpanEnd& end : ends) depths.push_back(end.depth);
  return depths;
}

std::vector<float> after(LineEnds line, ToolSpan span, DexelOperation operation) {
  applyToLine(line, {&span, 1}, operation, OperationId{7});
  return depthsOf(line);
}

using Depths = std::vector<float>;

// The paper's figure 8 (SPEC D4).
TEST(DexelSubtraction, Case1ToolAboveLeavesTheSpan) {
  EXPECT_EQ(after(solid({1, 4}), tool(5, 6), DexelOperation::Subtraction), (Depths{1, 4}));
}
TEST(DexelSubtraction, Case2ToolCutsTheTop) {
  EXPECT_EQ(after(solid({1, 4}), tool(3, 6), DexelOperation::Subtraction), (Depths{1, 3}));
}
TEST(DexelSubtraction, Case3ToolCutsTheBottom) {
  EXPECT_EQ(after(solid({1, 4}), tool(0, 2), DexelOperation::Subtraction), (Depths{2, 4}));
}
TEST(DexelSubtraction, Case4ToolWithinSplitsTheSpan) {
  EXPECT_EQ(after(solid({1, 4}), tool(2, 3), DexelOperation::Subtraction), (Depths{1, 2, 3, 4}));
}
TEST(DexelSubtraction, Case5ToolAroundRemovesTheSpan) {
  EXPECT_EQ(after(solid({1, 4}), tool(0, 5), DexelOperation::Subtraction), Depths{});
  EXPECT_EQ(after(solid({1, 4}), tool(1, 4), DexelOperation::Subtraction), Depths{});
}
TEST(DexelSubtraction, Case6ToolBelowLeavesTheSpan) {
  EXPECT_EQ(after(solid({1, 4}), tool(-2, 0), DexelOperation::Subtraction), (Depths{1, 4}));
  EXPECT_EQ(after(solid({1, 4}), tool(-2, 1), DexelOperation::Subtraction), (Depths{1, 4}))
      << "it only touches";
}

TEST(DexelUnion, Case1ToolAboveIsASpanOfItsOwn) {
  EXPECT_EQ(after(solid({1, 4}), tool(5, 6), DexelOperation::Union), (Depths{1, 4, 5, 6}));
}
TEST(DexelUnion, Case2ToolRaisesTheTop) {
  EXPECT_EQ(after(solid({1, 4}), tool(3, 6), DexelOperation::Union), (Depths{1, 6}));
  EXPECT_EQ(after(solid({1, 4}), tool(4, 6), DexelOperation::Union), (Depths{1, 6}))
      << "touching spans are one";
}
TEST(DexelUnion, Case3ToolLowersTheBottom) {
  // The paper's text gives the bottom of the tool's place to the wrong end here.
  EXPECT_EQ(after(solid({1, 4}), tool(0, 2), DexelOperation::Union), (Depths{0, 4}));
}
TEST(DexelUnion, Case4ToolWithinChangesNothing) {
  EXPECT_EQ(after(solid({1, 4}), tool(2, 3), DexelOperation::Union), (Depths{1, 4}));
}
TEST(DexelUnion, Case5ToolAroundIsTheSpan) {
  EXPECT_EQ(after(solid({1, 4}), tool(0, 5), DexelOperation::Union), (Depths{0, 5}));
}
TEST(DexelUnion, Case6ToolBelowIsASpanOfItsOwn) {
  EXPECT_EQ(after(solid({1, 4}), tool(-2, 0), DexelOperation::Union), (Depths{-2, 0, 1, 4}));
}
TEST(DexelUnion, MergesSpansThatItJoins) {
  EXPECT_EQ(after(solid({1, 2, 3, 4, 5, 6, 8, 9}), tool(1.5f, 5.5f), DexelOperation::Union),
            (Depths{1, 6, 8, 9}));
}

TEST(DexelOperations, NewEndsTakeTheToolsNormalTheFlagAndTheOperation) {
  LineEnds line = solid({1, 4});
  const ToolSpan span = tool(2, 3);
  EXPECT_TRUE(applyToLine(line, {&span, 1}, DexelOperation::Subtraction, OperationId{7}));
  ASSERT_EQ(line.size(), 4u);
  EXPECT_EQ(unpackNormal(line[1].normal), Vec3(0, 0, 1)) << "the tool's entry, turned around";
  EXPECT_EQ(unpackNormal(line[2].normal), Vec3(0, 0, -1));
  for (const std::size_t i : {1u, 2u}) {
    EXPECT_TRUE(line[i].isCut());
    EXPECT_EQ(line[i].outer, OperationId{7});
    EXPECT_EQ(line[i].inner, OperationId::Initial);
  }
  for (const std::size_t i : {0u, 3u}) EXPECT_FALSE(line[i].isCut());
  EXPECT_TRUE(applyToLine(line, {&span, 1}, DexelOperation::Union, OperationId{8}));
  EXPECT_EQ(depthsOf(line), (Depths{1, 4}));
  EXPECT_FALSE(applyToLine(line, {&span, 1}, DexelOperation::Union, OperationId{9}));
}

// Small whole numbers, so that ends often coincide.
std::vector<ToolSpan> randomSpans(Random& random, int most) {
  std::vector<ToolSpan> spans;
  float at = 0;
  for (int i = static_cast<int>(random.below(static_cast<std::size_t>(most) + 1)); i > 0; --i) {
    const float enter = at + static_cast<float>(random.below(4)) + (spans.empty() ? 0.0f : 1.0f);
    const float exit = enter + 1 + static_cast<float>(random.below(4));
    spans.push_back(tool(enter, exit));
    at = exit;
  }
  return spans;
}

TEST(DexelOperations, AreThoseOfSetsOnRandomLines) {
  Random random(20);
  for (int trial = 0; trial < 20'000; ++trial) {
    LineEnds line;
    for (const ToolSpan& span : randomSpans(random, 4)) {
      line.push_back({span.enter, span.enterNormal, OperationId::Initial, OperationId::None});
      line.push_back({span.exit, span.exitNormal, OperationId::Initial, OperationId::None});
    }
    const std::vector<ToolSpan> spans = randomSpans(random, 3);
    for (const DexelOperation operation :
         {DexelOperation::Union, DexelOperation::Subtraction, DexelOperation::Intersection}) {
      LineEnds result = line;
      const bool changed = applyToLine(result, spans, operation, OperationId{1});
      ASSERT_EQ(result.size() % 2, 0u);
      ASSERT_EQ(changed, result != line);
      for (std::size_t i = 1; i < result.size(); ++i) ASSERT_LT(result[i - 1].depth, result[i].depth);
      const auto in = [](const LineEnds& ends, float x) {
        return std::count_if(ends.begin(), ends.end(), [&](const SpanEnd& e) { return e.depth < x; }) % 2 ==
               1;
      };
      for (float x = -0.5f; x < 60; x += 1) {
        const bool a = in(line, x), b = std::any_of(spans.begin(), spans.end(), [&](const ToolSpan& s) {
                                      return s.enter < x && x < s.exit;
                                    });
        const bool expected = operation == DexelOperation::Union         ? a || b
                              : operation == DexelOperation::Subtraction ? a && !b
                                                                         : a && b;
        ASSERT_EQ(in(result, x), expected) << "at " << x << ", trial " << trial;
      }
    }
  }
}

TEST(PackedNormals, AreWithinTheirErrorAndTurnAroundExactly) {
  Random random(21);
  for (int i = 0; i < 100'000; ++i) {
    const Vec3 n =
        i < 6 ? Vec3((i == 0) - (i == 1), (i == 2) - (i == 3), (i == 4) - (i == 5)) : random.inCube(1);
    const PackedNormal packed = packNormal(n);
    EXPECT_LT(length(DVec3(unpackNormal(packed)) - normalized(DVec3(n))), kPackedNormalError);
    EXPECT_EQ(unpackNormal(turnedAround(packed)), -unpackNormal(packed));
    EXPECT_EQ(turnedAround(packed | kPackedFlag), turnedAround(packed) | kPackedFlag);
  }
}

TEST(Dexels, WithoutOperationsReadNoneHoweverTheyWereWritten) {
  Dexels dexels(2, 1, {.operations = false});
  dexels.write(0, solid({1, 2}));
  dexels.write(1, solid({1, 2, 3, 4}));
  LineEnds read;
  for (const std::size_t line : {0u, 1u}) {
    dexels.read(line, read);
    for (const SpanEnd& end : read) EXPECT_EQ(end.inner, OperationId::None) << "line " << line;
  }
}

TEST(Dexels, ChangeInPlaceAsListsOfEndsDo) {
  for (const bool operations : {true, false}) {
    Random random(22);
    Dexels dexels(5, 3, {operations});
    std::vector<LineEnds> expected(dexels.lineCount());
    LineEnds read;
    for (int step = 0; step < 20'000; ++step) {
      const std::size_t line = random.below(dexels.lineCount());
      const float enter = static_cast<float>(random.below(60));
      const ToolSpan span = tool(enter, enter + static_cast<float>(random.below(8)));
      const bool fills = random.below(2) == 0;
      const OperationId id = operations ? static_cast<OperationId>(step) : OperationId::None;
      EXPECT_EQ(dexels.change(line, span, fills, static_cast<OperationId>(step)),
                changeLine(expected[line], span, fills, id));
      dexels.read(line, read);
      ASSERT_EQ(read, expected[line]) << "step " << step;
      ASSERT_EQ(dexels.endCount(line), read.size());
    }
    std::size_t ends = 0;
    for (const LineEnds& line : expected) ends += line.size();
    EXPECT_EQ(dexels.endCount(), ends);
  }
}

}  // namespace
}  // namespace restroke::points
