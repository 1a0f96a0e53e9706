// Tri-dexels in OpenGL: Booleans are those of the CPU bit for bit.

#include <gtest/gtest.h>

#include <latch>
#include <thread>

#include "points/dexel/gl/gl_dexel_state.h"
#include "points/dexel/gl/gl_tri_dexel.h"
#include "tests/points/dexel_gl_support.h"

namespace restroke::points {
namespace {

using restroke::testing::Random;
using testing::appliedLineByLine;
using testing::randomModel;
using testing::wholeGrid;

using GlTriDexels = testing::GlDexelTest;
constexpr DexelOperation kOperations[] = {DexelOperation::Union, DexelOperation::Subtraction,
                                          DexelOperation::Intersection};

TriDexel appliedByGl(const GlDexelContext& gl, const TriDexel& model, const TriDexel& tool,
                     DexelOperation operation, OperationId id, GlTriDexel::Options options = {}) {
  GlTriDexel onCard(gl, model.grid(), options), toolOnCard(gl, model.grid(), options);
  onCard.upload(model);
  toolOnCard.upload(tool);
  onCard.apply(toolOnCard, operation, id);
  return onCard.download();
}

// The paper's figure 8 (SPEC D4), as in dexel_line_test.cpp.
struct LineCase {
  const char* name;
  DexelOperation operation;
  std::vector<float> solid, tool, expected;
};
void PrintTo(const LineCase& given, std::ostream* out) {
  *out << given.name;
}
class GlDexelCases : public GlTriDexels, public ::testing::WithParamInterface<LineCase> {};

TEST_P(GlDexelCases, AreThePapers) {
  const LineCase& given = GetParam();
  const auto modelOf = [](const std::vector<float>& depths) {
    TriDexel model(wholeGrid({1, 1, 1}));
    for (int axis = 0; axis < 3; ++axis) {
      LineEnds ends;
      for (const float depth : depths)
        ends.push_back({depth, packNormal({0, 0, ends.size() % 2 == 0 ? -1.0f : 1.0f}), OperationId::Initial,
                        OperationId::None});
      model.family(axis).write(0, ends);
    }
    return model;
  };
  const TriDexel model = modelOf(given.solid), tool = modelOf(given.tool);
  const TriDexel result = appliedByGl(gl(), model, tool, given.operation, OperationId{7});
  EXPECT_EQ(result, appliedLineByLine(model, tool, given.operation, OperationId{7}));
  for (int axis = 0; axis < 3; ++axis) {
    LineEnds ends;
    result.family(axis).read(0, ends);
    std::vector<float> depths;
    for (const SpanEnd& end : ends) depths.push_back(end.depth);
    EXPECT_EQ(depths, given.expected);
  }
}

constexpr DexelOperation kCut = DexelOperation::Subtraction, kAdd = DexelOperation::Union;
INSTANTIATE_TEST_SUITE_P(
    Subtraction, GlDexelCases,
    ::testing::Values(LineCase{"Case1ToolAboveLeavesTheSpan", kCut, {1, 4}, {5, 6}, {1, 4}},
                      LineCase{"Case2ToolCutsTheTop", kCut, {1, 4}, {3, 6}, {1, 3}},
                      LineCase{"Case3ToolCutsTheBottom", kCut, {1, 4}, {0, 2}, {2, 4}},
                      LineCase{"Case4ToolWithinSplitsTheSpan", kCut, {1, 4}, {2, 3}, {1, 2, 3, 4}},
                      LineCase{"Case5ToolAroundRemovesTheSpan", kCut, {1, 4}, {0, 5}, {}},
                      LineCase{"Case6ToolBelowLeavesTheSpan", kCut, {1, 4}, {-2, 0}, {1, 4}}),
    [](const auto& given) { return given.param.name; });
INSTANTIATE_TEST_SUITE_P(
    Union, GlDexelCases,
    ::testing::Values(
        LineCase{"Case1ToolAboveIsASpanOfItsOwn", kAdd, {1, 4}, {5, 6}, {1, 4, 5, 6}},
        LineCase{"Case2ToolRaisesTheTop", kAdd, {1, 4}, {3, 6}, {1, 6}},
        LineCase{"Case3ToolLowersTheBottom", kAdd, {1, 4}, {0, 2}, {0, 4}},
        LineCase{"Case4ToolWithinChangesNothing", kAdd, {1, 4}, {2, 3}, {1, 4}},
        LineCase{"Case5ToolAroundIsTheSpan", kAdd, {1, 4}, {0, 5}, {0, 5}},
        LineCase{"Case6ToolBelowIsASpanOfItsOwn", kAdd, {1, 4}, {-2, 0}, {-2, 0, 1, 4}},
        LineCase{"MergesSpansThatItJoins", kAdd, {1, 2, 3, 4, 5, 6, 8, 9}, {1.5f, 5.5f}, {1, 6, 8, 9}}),
    [](const auto& given) { return given.param.name; });

TEST_F(GlTriDexels, KeepWhatIsUploadedBitForBit) {
  Random random(1);
  const TriDexel model = randomModel(random, wholeGrid({30, 17, 41}), 6);
  GlTriDexel onCard(gl(), model.grid());
  EXPECT_EQ(onCard.endCount(), 0u);
  EXPECT_EQ(onCard.download(), TriDexel(model.grid()));
  onCard.upload(model);
  EXPECT_EQ(onCard.endCount(), model.endCount());
  EXPECT_EQ(onCard.download(), model);
  EXPECT_GE(onCard.bytes(), 16 * model.endCount() + 4 * model.grid().lineCount());
  EXPECT_FALSE(gl().driver().empty());
}

TEST_F(GlTriDexels, AreChangedAsOnTheCpuWithManySpansALine) {
  Random random(2);
  for (int trial = 0; trial < 6; ++trial) {
    const DexelGrid grid = wholeGrid({20 + 9 * trial, 33, 25});
    const TriDexel model = randomModel(random, grid, 5), tool = randomModel(random, grid, 1 + trial);
    for (const DexelOperation operation : kOperations) {
      const TriDexel result = appliedByGl(gl(), model, tool, operation, OperationId{77});
      EXPECT_EQ(result, appliedLineByLine(model, tool, operation, OperationId{77})) << "trial " << trial;
      TriDexel onCpu = model;
      onCpu.apply(tool, operation, OperationId{77});
      EXPECT_EQ(result, onCpu) << "trial " << trial;
    }
  }
}

TEST_F(GlTriDexels, AreTheSameAfterFiftyOperations) {
  for (const std::uint64_t seed : {3, 4}) {
    Random random(seed);
    const DexelGrid grid = wholeGrid({24, 31, 19});
    TriDexel expected = randomModel(random, grid, 3);
    GlTriDexel onCard(gl(), grid), tool(gl(), grid);
    onCard.upload(expected);
    for (std::uint32_t i = 0; i < 50; ++i) {
      const TriDexel other = randomModel(random, grid, 2);
      // An intersection now and then: more would leave nothing.
      const DexelOperation operation = kOperations[i % 7 == 6 ? 2 : random.below(2)];
      expected.apply(other, operation, OperationId{100 + i});
      tool.upload(other);
      onCard.apply(tool, operation, OperationId{100 + i});
    }
    EXPECT_GT(expected.endCount(), 100u);
    EXPECT_EQ(onCard.endCount(), expected.endCount());
    EXPECT_EQ(onCard.download(), expected);
  }
}

TEST_F(GlTriDexels, MayBeEmptyOnEitherSideOrBoth) {
  Random random(5);
  const DexelGrid grid = wholeGrid({9, 8, 7});
  const TriDexel some = randomModel(random, grid, 3), none(grid);
  for (const DexelOperation operation : kOperations) {
    EXPECT_EQ(appliedByGl(gl(), some, none, operation, OperationId{1}),
              operation == DexelOperation::Intersection ? none : some);
    EXPECT_EQ(appliedByGl(gl(), none, some, operation, OperationId{1}),
              appliedLineByLine(none, some, operation, OperationId{1}));
    EXPECT_EQ(appliedByGl(gl(), none, none, operation, OperationId{1}), none);
  }
  GlTriDexel withoutLines(gl(), DexelGrid());
  withoutLines.apply(withoutLines, DexelOperation::Union, OperationId{1});
  EXPECT_EQ(withoutLines.download().endCount(), 0u);
}

TEST_F(GlTriDexels, OfListsAreChangedAsOnTheCpuWithOrWithoutOperations) {
  Random random(10);
  std::vector<implicit::Primitive> a = {{{{0, 0, 0}, 1.0f}, implicit::Sign::Positive}}, b;
  while (a.size() < 80) a.push_back(restroke::testing::randomPrimitive(random, a));
  while (b.size() < 40) b.push_back({{{random.inCube(1), 0.3f}}, implicit::Sign::Positive});
  for (const bool kept : {true, false}) {
    TriDexel model(dexelGridFor({{-1.3f, -1.3f, -1.3f}, {1.3f, 1.3f, 1.3f}}, {.resolution = 70}), {kept});
    TriDexel tool(model.grid(), {kept});
    model.apply(a, OperationId::Initial);
    tool.apply(b, OperationId::Initial);
    for (const DexelOperation operation : kOperations) {
      TriDexel expected = model;
      expected.apply(tool, operation, OperationId{500});
      const TriDexel result = appliedByGl(gl(), model, tool, operation, OperationId{500});
      EXPECT_EQ(result, expected);
      EXPECT_EQ(result.family(0).keepsOperations(), kept);
    }
  }
}

TEST_F(GlTriDexels, HoldHundredsOfSpansALine) {
  Random random(6);
  const DexelGrid grid = wholeGrid({6, 5, 4});
  const TriDexel model = randomModel(random, grid, 800), tool = randomModel(random, grid, 500);
  for (const DexelOperation operation : kOperations)
    EXPECT_EQ(appliedByGl(gl(), model, tool, operation, OperationId{5}),
              appliedLineByLine(model, tool, operation, OperationId{5}));
}

TEST_F(GlTriDexels, AreTheSameInBandsOfAnySize) {
  Random random(7);
  const DexelGrid grid = wholeGrid({40, 23, 31});
  const TriDexel model = randomModel(random, grid, 4), tool = randomModel(random, grid, 4);
  for (const DexelOperation operation : kOperations) {
    const TriDexel expected = appliedLineByLine(model, tool, operation, OperationId{5});
    for (const std::size_t lines : {std::size_t{1}, std::size_t{100}, std::size_t{257}, std::size_t{100'000}})
      EXPECT_EQ(appliedByGl(gl(), model, tool, operation, OperationId{5}, {.linesPerBand = lines}), expected);
  }
}

TEST_F(GlTriDexels, GrowWithWhatIsAddedAndMayBeTheirOwnTool) {
  const DexelGrid grid = wholeGrid({30, 30, 30});
  TriDexel expected(grid);
  GlTriDexel onCard(gl(), grid), tool(gl(), grid);
  for (std::uint32_t i = 0; i < 150; ++i) {
    TriDexel other(grid);
    const float at = static_cast<float>(i * 7 % 150);
    for (int axis = 0; axis < 3; ++axis)
      for (std::size_t line = 0; line < other.family(axis).lineCount(); ++line)
        other.family(axis).write(
            line, std::vector<SpanEnd>{{at, packNormal({0, 0, -1})}, {at + 0.5f, packNormal({0, 0, 1})}});
    tool.upload(other);
    onCard.apply(tool, DexelOperation::Union, OperationId{i});
    expected.apply(other, DexelOperation::Union, OperationId{i});
  }
  EXPECT_EQ(expected.endCount(), 2u * 150 * grid.lineCount());
  EXPECT_EQ(onCard.download(), expected);
  onCard.apply(onCard, DexelOperation::Union, OperationId{1000});
  EXPECT_EQ(onCard.download(), expected) << "united with itself";
  onCard.apply(onCard, DexelOperation::Subtraction, OperationId{1001});
  EXPECT_EQ(onCard.endCount(), 0u) << "less itself";
}

TEST_F(GlTriDexels, TakeDepthsOfAnySizeAndBothZeros) {
  const DexelGrid grid = wholeGrid({1, 1, 1});
  const float values[] = {-3e38f, -1e-20f, -0.0f, 0.0f, 1e-20f, 1.0f, 1.0000001f, 3e38f};
  const auto modelOf = [&](float enter, float exit) {
    TriDexel model(grid);
    for (int axis = 0; axis < 3; ++axis)
      model.family(axis).write(
          0, std::vector<SpanEnd>{{enter, packNormal({0, 0, -1})}, {exit, packNormal({0, 0, 1})}});
    return model;
  };
  for (const float a : values)
    for (const float b : values)
      for (const float c : values)
        for (const float d : values) {
          if (!(a < b && c < d)) continue;
          const TriDexel model = modelOf(a, b), tool = modelOf(c, d);
          const DexelOperation operation = kOperations[(a < c) + (b < d)];
          ASSERT_EQ(appliedByGl(gl(), model, tool, operation, OperationId{1}),
                    appliedLineByLine(model, tool, operation, OperationId{1}))
              << a << " to " << b << ", " << c << " to " << d;
        }
}

TEST_F(GlTriDexels, OfOtherGridsContextsOrSizesAreRefused) {
  const DexelGrid grid = wholeGrid({5, 6, 7});
  GlTriDexel model(gl(), grid), other(gl(), wholeGrid({5, 6, 8}));
  EXPECT_THROW(model.apply(other, DexelOperation::Union, OperationId{1}), InternalError);
  EXPECT_THROW(model.upload(TriDexel(other.grid())), InternalError);
  const GlDexelContext second;
  const GlTriDexel elsewhere(second, grid);
  EXPECT_THROW(model.apply(elsewhere, DexelOperation::Union, OperationId{1}), InternalError);
  const GlTriDexel inBands(gl(), grid, {.linesPerBand = 10});
  EXPECT_THROW(model.apply(inBands, DexelOperation::Union, OperationId{1}), InternalError);
  EXPECT_THROW(GlTriDexel(gl(), grid, {.linesPerBand = 0}), InputError);
  EXPECT_THROW(GlTriDexel(gl(), grid, {.linesPerBand = GlTriDexel::kMostLinesPerBand + 1}), InputError);
  EXPECT_THROW(GlTriDexel(gl(), wholeGrid({1'000'000, 1, 1})), InputError) << "beyond what drivers allow";
}

TEST_F(GlTriDexels, LieInBuffersThatGrowAndSayWhenShadersWouldNotSeeThem) {
  GlDexelContext::State& state = *gl().state();
  const GlDexelContext::State::Use use(state);
  GlBuffer buffer = state.newBuffer();
  const std::vector<std::uint32_t> numbers = {3, 1, 4, 1, 5};
  buffer.write(numbers.data(), numbers.size() * sizeof numbers[0]);
  EXPECT_EQ(buffer.readNumber(4), 5u);
  const std::size_t before = buffer.capacity();
  buffer.fill(3 * before, 7);
  EXPECT_GE(buffer.capacity(), 3 * before);
  EXPECT_EQ(buffer.readNumber(0), 7u);
  EXPECT_EQ(buffer.readNumber(3 * before / sizeof numbers[0] - 1), 7u);
  EXPECT_THROW(buffer.reserve(std::size_t{1} << 45), InputError);
  EXPECT_EQ(buffer.readNumber(0), 7u) << "what it had it keeps";
  GlBuffer other = std::move(buffer);
  EXPECT_EQ(other.readNumber(1), 7u);
}

TEST_F(GlTriDexels, MayBeUsedByManyThreadsAndEndOnAny) {
  Random random(8);
  const DexelGrid grid = wholeGrid({12, 13, 14});
  const TriDexel model = randomModel(random, grid, 3), tool = randomModel(random, grid, 3);
  const TriDexel expected = appliedLineByLine(model, tool, DexelOperation::Subtraction, OperationId{1});
  std::vector<std::thread> threads;
  std::vector<TriDexel> results(4, TriDexel(grid));
  for (TriDexel& result : results)
    threads.emplace_back(
        [&] { result = appliedByGl(gl(), model, tool, DexelOperation::Subtraction, OperationId{1}); });
  for (std::thread& thread : threads) thread.join();
  for (const TriDexel& result : results) EXPECT_EQ(result, expected);
}

// Computes and draws on many threads, then ends the process while these threads end.
[[noreturn]] void computeAndExit() {
  static GlDexelContext context;
  static GlTriDexel model(context, wholeGrid({3, 3, 3}));
  constexpr int kThreads = 32;
  std::latch done(kThreads);
  for (int i = 0; i < kThreads; ++i)
    std::thread([&] {
      model.apply(model, DexelOperation::Intersection, OperationId{1});
      static_cast<void>(model.endCount());
      done.arrive_and_wait();
    }).detach();
  done.wait();
  std::exit(0);
}

TEST_F(GlTriDexels, LetTheProcessEndWhileThreadsThatComputedEnd) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (int i = 0; i < 5; ++i) EXPECT_EXIT(computeAndExit(), ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace restroke::points
