// DESIGN invariant 6: whatever is edited where, the shape is the one that a replay of everything gives.

#include <gtest/gtest.h>

#include <cstdlib>

#include "implicit/errors.h"
#include "sculpt/base_change.h"
#include "sculpt/pen_strokes.h"
#include "sculpt/replay.h"
#include "tests/sculpt/random_trees.h"
#include "tests/sculpt/test_commands.h"
#include "tests/support/effort.h"

namespace restroke::sculpt {
namespace {

using restroke::testing::Random;
using retarget::Method;

std::uint64_t fromScratch(const Document& document) {
  return document.replayedFromScratch().stateHash();
}

/// The first primitive that a replay of everything has otherwise, for messages.
std::string firstDifference(const Document& document) {
  const points::SurfelModel scratch = document.replayedFromScratch();
  const implicit::PrimitiveList &mine = document.model().list(), &truth = scratch.list();
  const std::vector<std::uint32_t> nodes = document.nodeOfPrimitive();
  for (std::size_t i = 0; i < std::min(mine.size(), truth.size()); ++i) {
    if (mine.at(i) == truth.at(i)) continue;
    const implicit::Sphere &a = mine.at(i).shape.ball(), &b = truth.at(i).shape.ball();
    std::string method = "fixed stamps";
    if (nodes[i] > 0 && document.history().kind(NodeId{nodes[i]}) == NodeKind::Stroke)
      method = retarget::nameOf(document.history().method(NodeId{nodes[i]}));
    return fmt::format("primitive {} of node {} ({}): ({}, {}, {}; {}) instead of ({}, {}, {}; {})", i,
                       nodes[i], method, a.center.x, a.center.y, a.center.z, a.radius, b.center.x, b.center.y,
                       b.center.z, b.radius);
  }
  return fmt::format("{} primitives instead of {}", mine.size(), truth.size());
}

/// Applies the command, and writes it down as it is to be recorded.
void applyAndLog(Document& document, const Command& command, StrokeLog& log) {
  const CommandReport report = document.apply(command);
  log.commands.push_back(recorded(command, report, document));
}

/// One random history: after every command the state is that of a replay from scratch, and in the end the
/// log, written and read, gives it at every number of threads.
void tryTree(std::uint32_t seed, int commands, const Methods& methods) {
  SCOPED_TRACE("seed " + std::to_string(seed));
  Random random{seed};
  LogHeader header = coarseHeader();
  header.density = 150;
  Document document(header);
  StrokeLog log{.header = header, .commands = {}};
  for (int i = 0; i < commands; ++i) {
    const Command command = randomCommand(random, document.history().size(), methods);
    const std::uint64_t before = document.model().stateHash();
    const NodeId cursor = document.history().cursor();
    const std::size_t nodes = document.history().size();
    try {
      applyAndLog(document, command, log);
    } catch (const InputError& error) {
      ASSERT_EQ(document.model().stateHash(), before) << "command " << i << ": " << error.what();
      ASSERT_EQ(document.history().cursor(), cursor) << error.what();
      ASSERT_EQ(document.history().size(), nodes) << error.what();
      continue;
    }
    ASSERT_EQ(document.model().stateHash(), fromScratch(document))
        << "command " << i << " of kind " << command.index() << ": " << firstDifference(document);
    ASSERT_EQ(document.nodeOfPrimitive().size(), document.model().list().size());
  }
  const TemporaryFolder folder;
  writeLog(folder / "a.log", log);
  const StrokeLog read = readLog(folder / "a.log");
  for (const int threads : {1, 2}) {
    const Document again = replay(read, {.file = "a.log"}, {.threads = threads});
    ASSERT_EQ(again.model().stateHash(), document.model().stateHash()) << threads << " threads";
    ASSERT_EQ(again.history().cursor(), document.history().cursor());
    ASSERT_EQ(again.history().size(), document.history().size());
  }
  writeLog(folder / "b.log", read);
  ASSERT_EQ(textOf(folder / "a.log"), textOf(folder / "b.log"));
}

// RESTROKE_TREES=1000 tries as many; the default keeps the test short.
int trees(int ordinarily) {
  const char* given = std::getenv("RESTROKE_TREES");
  if (given) return std::max(1, std::atoi(given));
  return restroke::testing::kSanitized ? ordinarily / 8 : ordinarily;
}

TEST(IncrementalReplay, X1S8RandomTreesOfExactStrokesEqualAReplayOfEverything) {
  for (int i = 0; i < trees(120) && !HasFatalFailure(); ++i)
    tryTree(static_cast<std::uint32_t>(1000 + i), 40, {Method::Exact});
}

TEST(IncrementalReplay, X1S8RandomTreesOfAllMethodsThatAreTheSameEverywhereEqualAReplayOfEverything) {
  for (int i = 0; i < trees(40) && !HasFatalFailure(); ++i)
    tryTree(static_cast<std::uint32_t>(5000 + i), 30,
            {Method::Exact, Method::Fixed, Method::Nearest, Method::Mapped, Method::Surface});
}

TEST(IncrementalReplay, X1S8RandomTreesWithOutcomesThatAreRecordedEqualAReplayOfTheLog) {
  for (int i = 0; i < trees(16) && !HasFatalFailure(); ++i)
    tryTree(static_cast<std::uint32_t>(7000 + i), 24, {Method::Exact, Method::Embree, Method::DepthCpu});
}

TEST(IncrementalReplay, X1S10RandomTreesOfAlignedStrokesEqualAReplayOfTheLog) {
  for (int i = 0; i < std::max(1, trees(4) / 4) && !HasFatalFailure(); ++i)
    tryTree(static_cast<std::uint32_t>(9000 + i), 14, {Method::Aligned, Method::Exact});
}

// S7: what a cancelled stroke held up comes to lie on what is below.
TEST(IncrementalReplay, S7AStrokeOnACancelledStrokeFallsToTheShapeBelow) {
  Document document(coarseHeader());
  document.apply(line(0));
  const CommandReport above = document.apply(line(0));
  ASSERT_GT(above.primitivesAdded, 0u);
  const CommandReport report = document.apply(CancelCommand{{}, NodeId{1}});
  EXPECT_EQ(report.retargeted, 1u);
  EXPECT_EQ(report.changed, 1u);
  Document alone(coarseHeader());
  alone.apply(line(0));
  EXPECT_EQ(document.model().stateHash(), alone.model().stateHash());
  document.apply(RestoreCommand{{}, NodeId{1}});
  EXPECT_EQ(document.model().stateHash(), fromScratch(document));
  EXPECT_EQ(document.history().result(NodeId{2}).stamps, above.primitivesAdded);
}

TEST(IncrementalReplay, StrokesThatReadNothingOfWhatChangedAreNotCastAnew) {
  Document document(coarseHeader());
  document.apply(line(-120));
  for (const int offset : {0, 60, 120}) document.apply(line(offset));
  const CommandReport report = document.apply(CancelCommand{{}, NodeId{1}});
  EXPECT_EQ(report.retargeted, 0u);
  EXPECT_EQ(report.changed, 0u);
  EXPECT_EQ(document.model().stateHash(), fromScratch(document));
}

TEST(IncrementalReplay, S8OfTwoStrokesThatChangePlacesTheLaterLiesOnTop) {
  Document document(coarseHeader());
  document.apply(line(0));
  StrokeCommand across = line(0, Mode::Carve);
  for (auto& point : across.stroke.points) std::swap(point.screen.x, point.screen.y);
  document.apply(across);
  const std::uint64_t before = document.model().stateHash();
  document.apply(MoveCommand{{}, NodeId{1}, NodeId{2}, Extent::Single});
  EXPECT_EQ(document.history().cursor(), NodeId{2});  // 1 lies ahead
  document.apply(RedoCommand{});
  EXPECT_EQ(document.history().cursor(), NodeId{1});
  EXPECT_NE(document.model().stateHash(), before);
  Document swapped(coarseHeader());
  swapped.apply(across);
  swapped.apply(line(0));
  EXPECT_EQ(document.model().stateHash(), swapped.model().stateHash());
}

TEST(IncrementalReplay, S8AnotherBaseUnderAllStrokesIsWhatTheyAreCastOn) {
  LogHeader header = coarseHeader();
  Document document(header);
  document.apply(line(0));
  document.apply(line(30));
  const implicit::Shape other(Point(0.05f, 0, 0.1f), 0.8f);
  const CommandReport report = document.apply(BaseCommand{{}, other});
  EXPECT_EQ(report.node, NodeId{3});
  EXPECT_EQ(report.retargeted, 2u);
  Document fresh({.density = header.density, .base = other});
  fresh.apply(line(0));
  fresh.apply(line(30));
  EXPECT_EQ(document.model().stateHash(), fresh.model().stateHash());
  document.apply(UndoCommand{});
  EXPECT_EQ(document.model().stateHash(), fromScratch(document));
  EXPECT_EQ(document.base(), header.base);
}

// The stroke is where the transform took it, to float32.
TEST(IncrementalReplay, S7MappedStrokesFollowATransformOfTheBase) {
  Document document(coarseHeader());
  StrokeCommand drawn = line(10);
  drawn.method = Method::Mapped;
  drawn.brush.radii = Radii::Follow;
  document.apply(drawn);
  std::vector<implicit::Primitive> before;
  for (std::size_t i = 1; i < document.model().list().size(); ++i)
    before.push_back(document.model().list().at(i));
  const Affine map = affineNamed("rotate 1 2 3 40; scale 1.5; translate 0.5 -0.25 1", "test");
  document.apply(TransformCommand{{}, matrixOf(map)});
  ASSERT_EQ(document.model().list().size(), before.size() + 1);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const implicit::Sphere ball = document.model().list().at(i + 1).shape.ball();
    EXPECT_LT(length(DVec3(ball.center) - map.point(DVec3(before[i].shape.ball().center))), 4e-5) << i;
    EXPECT_FLOAT_EQ(ball.radius, 1.5f * before[i].shape.ball().radius);
  }
}

/// A stone that looks the same from no two sides.
implicit::Shape stone() {
  const auto hull =
      implicit::volumeKindNamed("convexPolyhedron").make({{{1.1f,  0,     0.1f, -0.8f,  0.2f,  0,     0.1f,
                                                            0.9f,  -0.2f, 0,    -0.7f,  0.15f, 0.2f,  0.1f,
                                                            0.95f, -0.1f, 0.2f, -0.75f, 0.6f,  0.55f, 0.5f,
                                                            -0.5f, -0.6f, 0.4f, 0.5f,   -0.4f, -0.5f}}});
  return std::make_shared<const implicit::PosedVolume>(hull, implicit::Pose{});
}

// S10: nobody tells the method what the transform was.
TEST(IncrementalReplay, S10AlignedStrokesFollowABaseThatTellsHowItMoved) {
  LogHeader header = coarseHeader();
  header.base = stone();
  header.density = 2000;
  Document document(header);
  StrokeCommand drawn = line(0);
  drawn.method = Method::Aligned;
  drawn.brush.radii = Radii::Follow;
  ASSERT_GT(document.apply(drawn).primitivesAdded, 10u);
  std::vector<implicit::Primitive> before;
  for (std::size_t i = 1; i < document.model().list().size(); ++i)
    before.push_back(document.model().list().at(i));
  const double strokeLength =
      length(DVec3(before.front().shape.ball().center - before.back().shape.ball().center));
  const Affine map = affineNamed("rotate 1 2 3 40; scale 1.3; translate 0.5 -0.25 1", "test");
  const CommandReport report = document.apply(TransformCommand{{}, matrixOf(map)});
  EXPECT_TRUE(report.notes.empty()) << report.notes.front();
  ASSERT_EQ(report.recasts.size(), 1u);
  EXPECT_NEAR(static_cast<double>(report.recasts[0].scale), 1.3, 0.01);
  ASSERT_EQ(document.model().list().size(), before.size() + 1);
  for (std::size_t i = 0; i < before.size(); ++i) {
    const implicit::Sphere ball = document.model().list().at(i + 1).shape.ball();
    EXPECT_LT(length(DVec3(ball.center) - map.point(DVec3(before[i].shape.ball().center))),
              0.02 * strokeLength)
        << i;
  }
  // Back on the shape that it was drawn on, it is where it was drawn.
  document.apply(UndoCommand{});
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(document.model().list().at(i + 1), before[i]) << i;
}

TEST(IncrementalReplay, S10AlignedStrokesOnABallSayThatNothingTellsTheMotionAndAreCast) {
  Document document(coarseHeader());
  StrokeCommand drawn = line(0);
  drawn.method = Method::Aligned;
  document.apply(drawn);
  const CommandReport report =
      document.apply(TransformCommand{{}, matrixOf(affineNamed("translate 0.1 0 0", "test"))});
  ASSERT_EQ(report.notes.size(), 1u);
  EXPECT_NE(report.notes[0].find("node 1: aligned: no motion is known"), std::string::npos)
      << report.notes[0];
  Document cast(coarseHeader());
  cast.apply(line(0));
  cast.apply(TransformCommand{{}, matrixOf(affineNamed("translate 0.1 0 0", "test"))});
  EXPECT_EQ(document.model().stateHash(), cast.model().stateHash());
}

TEST(IncrementalReplay, S7FixedStrokesStayWhereTheyWereWhateverBecomesOfTheBase) {
  Document document(coarseHeader());
  StrokeCommand drawn = line(10);
  drawn.method = Method::Fixed;
  document.apply(drawn);
  std::vector<implicit::Primitive> before;
  for (std::size_t i = 1; i < document.model().list().size(); ++i)
    before.push_back(document.model().list().at(i));
  document.apply(TransformCommand{{}, matrixOf(affineNamed("translate 0.5 0 0", "test"))});
  ASSERT_EQ(document.model().list().size(), before.size() + 1);
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(document.model().list().at(i + 1), before[i]) << i;
}

// A copy lies ahead until it is redone, and then on the shape as it has become (S8).
TEST(IncrementalReplay, S8ACopyIsCastOntoWhatIsThereWhenItIsRedone) {
  Document document(coarseHeader());
  document.apply(line(0));
  document.apply(UndoCommand{});
  document.apply(line(5));
  const std::uint64_t before = document.model().stateHash();
  document.apply(CopyCommand{NodeId{1}, NodeId{2}, Extent::Branch});
  EXPECT_EQ(document.model().stateHash(), before);
  EXPECT_EQ(document.history().cursor(), NodeId{2});
  document.apply(RedoCommand{});
  EXPECT_EQ(document.history().cursor(), NodeId{3});
  Document drawn(coarseHeader());
  drawn.apply(line(5));
  drawn.apply(line(0));
  EXPECT_EQ(document.model().stateHash(), drawn.model().stateHash());
}

TEST(IncrementalReplay, ATransformThatTheBaseCannotTakeIsRefusedAndNothingHasChanged) {
  LogHeader header = coarseHeader();
  header.base = std::make_shared<const implicit::PosedVolume>(
      implicit::volumeKindNamed("torus").make({{{1}, {0.4f}}}), implicit::Pose{});
  Document document(header);
  document.apply(line(60));
  const std::uint64_t before = document.model().stateHash();
  for (const char* words : {"scale 1 2 1", "scale 1e30", "translate 1e30 0 0"})
    EXPECT_THROW(document.apply(TransformCommand{{}, matrixOf(affineNamed(words, "test"))}), InputError)
        << words;
  TransformCommand mirror;
  mirror.matrix[0] = -1;
  EXPECT_THROW(document.apply(mirror), InputError);
  EXPECT_EQ(document.model().stateHash(), before);
  EXPECT_EQ(document.history().size(), 2u);
}

// Refused only when the shape is made: the tree goes back, and the shape with it.
TEST(IncrementalReplay, ABaseWithMoreSamplesThanCanBeHeldIsRefusedAndNothingHasChanged) {
  Document document(coarseHeader());
  document.apply(line(0));
  document.apply(line(0, Mode::Carve));
  const std::uint64_t before = document.model().stateHash();
  EXPECT_THROW(document.apply(BaseCommand{{}, implicit::Shape(Point(0), 9e5f)}), InputError);
  EXPECT_EQ(document.model().stateHash(), before);
  EXPECT_EQ(document.history().size(), 3u);
  EXPECT_EQ(document.history().cursor(), NodeId{2});
  document.apply(CancelCommand{{}, NodeId{1}});
  EXPECT_EQ(document.model().stateHash(), fromScratch(document));
}

// Every stroke of real drawings cancelled and restored, one at a time.
TEST(IncrementalReplay, S8CancellingEachRealStrokeEqualsAReplayOfEverything) {
  const auto data = sharedData();
  if (data.empty()) GTEST_SKIP() << "no shared data folder";
  const StrokeLog log = readPenStrokes(data / "strokes" / "excalidraw_valentine.json",
                                       {.base = {}, .mode = PenMode::Alternate, .density = 100});
  Document document = replay(log);
  const std::uint64_t whole = document.model().stateHash();
  const auto step = static_cast<std::uint32_t>(restroke::testing::kSanitized ? 29 : 5);
  for (std::uint32_t node = 1; node < document.history().size(); node += step) {
    document.apply(CancelCommand{{}, NodeId{node}});
    ASSERT_EQ(document.model().stateHash(), fromScratch(document)) << "without node " << node;
    document.apply(RestoreCommand{{}, NodeId{node}});
    ASSERT_EQ(document.model().stateHash(), whole) << "with node " << node << " again";
  }
}

}  // namespace
}  // namespace restroke::sculpt
