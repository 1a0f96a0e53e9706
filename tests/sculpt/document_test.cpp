#include "sculpt/document.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "implicit/errors.h"
#include "sculpt/pen_strokes.h"
#include "sculpt/replay.h"
#include "tests/sculpt/test_commands.h"

namespace restroke::sculpt {
namespace {

std::uint64_t scratchHash(const Document& document) {
  std::vector<implicit::Primitive> primitives;
  for (std::size_t i = 0; i < document.model().list().size(); ++i)
    primitives.push_back(document.model().list().at(i));
  points::SurfelModel scratch(document.model().sampling(), clustersFor(document.header()));
  scratch.append(primitives);
  EXPECT_EQ(scratch.surfelCount(), document.model().surfelCount());
  return scratch.stateHash();
}

// Carries out the commands, undoes them all and redoes them all, and compares the state at every step.
void expectEveryStepReturns(const LogHeader& header, const std::vector<Command>& commands) {
  Document document(header);
  std::vector<std::uint64_t> hashes{document.model().stateHash()};
  for (const Command& command : commands) {
    document.apply(command);
    hashes.push_back(document.model().stateHash());
  }
  EXPECT_EQ(hashes.back(), scratchHash(document));
  for (std::size_t i = commands.size(); i > 0; --i) {
    document.apply(UndoCommand{});
    ASSERT_EQ(document.model().stateHash(), hashes[i - 1]) << "after undoing stroke " << i;
  }
  EXPECT_FALSE(document.canUndo());
  for (std::size_t i = 1; i <= commands.size(); ++i) {
    document.apply(RedoCommand{});
    ASSERT_EQ(document.model().stateHash(), hashes[i]) << "after redoing stroke " << i;
  }
  EXPECT_FALSE(document.canRedo());
}

TEST(Document, S6UndoingAndRedoingEverythingReturnsToEveryState) {
  expectEveryStepReturns(coarseHeader(),
                         {line(0), line(-40, Mode::Carve), miss(), line(10),
                          FixedCommand{Mode::Carve, {{{0, 0, 1}, 0.3f}}}, line(-20), line(-20, Mode::Carve)});
}

TEST(Document, S6UndoingAndRedoingEverythingOfRealStrokesReturnsToEveryState) {
  const auto data = sharedData();
  if (data.empty()) GTEST_SKIP() << "no shared data folder";
  for (const char* name : {"excalidraw_valentine.json", "perfect_freehand_degenerate.json"}) {
    const StrokeLog log =
        readPenStrokes(data / "strokes" / name, {.base = {}, .mode = PenMode::Alternate, .density = 200});
    expectEveryStepReturns(log.header, log.commands);
  }
}

// A method that depends on the machine: redo brings back what was recorded.
TEST(Document, S6UndoingAndRedoingEverythingReturnsAlsoWithRecordedOutcomes) {
  std::vector<Command> commands;
  for (const int offset : {0, 20, -35}) {
    StrokeCommand command = line(offset, offset == 20 ? Mode::Carve : Mode::Add);
    command.method = retarget::Method::Embree;
    commands.emplace_back(command);
  }
  LogHeader header = coarseHeader();
  header.density = 2000;
  expectEveryStepReturns(header, commands);
}

TEST(Document, AStrokeAfterUndoBranches) {
  Document document(coarseHeader());
  document.apply(line(0));
  document.apply(line(30));
  const std::uint64_t first = document.model().stateHash();
  document.apply(UndoCommand{});
  document.apply(line(-30));
  EXPECT_EQ(document.history().size(), 4u);
  EXPECT_EQ(document.history().parent(NodeId{3}), NodeId{1});
  EXPECT_NE(document.model().stateHash(), first);
  EXPECT_EQ(document.model().stateHash(), scratchHash(document));
  document.apply(UndoCommand{});
  document.apply(RedoCommand{});
  EXPECT_EQ(document.history().cursor(), NodeId{3});
}

TEST(Document, UndoAtTheRootAndRedoWithNothingAheadAreRefused) {
  Document document(coarseHeader());
  const std::uint64_t before = document.model().stateHash();
  EXPECT_THROW(document.apply(UndoCommand{}), InputError);
  EXPECT_THROW(document.apply(RedoCommand{}), InputError);
  EXPECT_EQ(document.model().stateHash(), before);
}

TEST(Document, AStrokeThatHitsNothingIsANodeWithoutPrimitives) {
  Document document(coarseHeader());
  const CommandReport report = document.apply(miss());
  EXPECT_EQ(report.primitivesAdded, 0u);
  EXPECT_EQ(report.misses, 21u);
  EXPECT_EQ(report.pieces, 0u);
  EXPECT_EQ(document.history().size(), 2u);
  EXPECT_EQ(document.model().list().size(), 1u);
  EXPECT_TRUE(document.canUndo());
}

TEST(Document, RefusesStrokesAndStampsOutOfRangeAndStaysAsItWas) {
  Document document(coarseHeader(), {.timeStamps = true});
  document.apply(line(0));
  const std::uint64_t before = document.model().stateHash();
  StrokeCommand bad = line(1);
  bad.brush.radius = -1;
  EXPECT_THROW(document.apply(bad), InputError);
  bad = line(1);
  bad.stroke.camera.width = 0;
  EXPECT_THROW(document.apply(bad), InputError);
  bad = line(1);
  bad.stroke.points.clear();
  EXPECT_THROW(document.apply(bad), InputError);
  // The second stamp is refused after the first was put on the list.
  EXPECT_THROW(document.apply(FixedCommand{Mode::Add, {{{0, 0, 1}, 0.1f}, {{0, 0, 1}, -1}}}), InputError);
  EXPECT_EQ(document.history().size(), 2u);
  EXPECT_EQ(document.model().stateHash(), before);
  EXPECT_EQ(document.nodeOfPrimitive().size(), document.model().list().size());
}

TEST(Document, NamesTheNodeOfEveryPrimitive) {
  Document document(coarseHeader());
  const std::size_t a = document.apply(line(0)).primitivesAdded;
  document.apply(miss());
  const std::size_t b = document.apply(line(40)).primitivesAdded;
  const std::vector<std::uint32_t> nodes = document.nodeOfPrimitive();
  ASSERT_EQ(nodes.size(), 1 + a + b);
  EXPECT_EQ(nodes[0], 0u);
  EXPECT_EQ(std::count(nodes.begin(), nodes.end(), 1u), static_cast<std::ptrdiff_t>(a));
  EXPECT_EQ(std::count(nodes.begin(), nodes.end(), 3u), static_cast<std::ptrdiff_t>(b));
  EXPECT_TRUE(std::is_sorted(nodes.begin(), nodes.end()));
}

TEST(Document, TimingStampsChangesNoResult) {
  Document timed(coarseHeader(), {.timeStamps = true}), plain(coarseHeader());
  for (const int offset : {0, 15, -60}) {
    timed.apply(line(offset));
    plain.apply(line(offset));
  }
  EXPECT_EQ(timed.model().stateHash(), plain.model().stateHash());
  EXPECT_EQ(timed.stampSeconds().size(), timed.model().list().size() - 1);
  EXPECT_TRUE(plain.stampSeconds().empty());
}

// DESIGN invariant 5: replay uses what was recorded; recompute makes it anew and says where it differs.
TEST(Document, UsesTheRecordedOutcomeUnlessToldToRecompute) {
  StrokeCommand command = line(0);
  command.method = retarget::Method::Embree;
  Document first(coarseHeader());
  first.apply(command);
  const auto recorded = std::get<StrokeCommand>(first.history().command(NodeId{1}));
  ASSERT_TRUE(recorded.outcome.has_value());
  EXPECT_FALSE(recorded.outcome->stamps.empty());

  StrokeCommand altered = recorded;
  altered.outcome->stamps.resize(1);
  Document replayed(coarseHeader());
  replayed.apply(altered);
  EXPECT_EQ(replayed.model().list().size(), 2u);

  Document again(coarseHeader(), {.recompute = true});
  EXPECT_TRUE(again.apply(altered).outcomeDiffers);
  EXPECT_EQ(again.model().stateHash(), first.model().stateHash());
  Document same(coarseHeader(), {.recompute = true});
  EXPECT_FALSE(same.apply(recorded).outcomeDiffers);
}

TEST(Document, MethodsThatAreTheSameEverywhereRecordNothing) {
  Document document(coarseHeader());
  document.apply(line(0));
  EXPECT_FALSE(std::get<StrokeCommand>(document.history().command(NodeId{1})).outcome.has_value());
}

TEST(Document, RefusesHeadersOutOfRange) {
  const auto refused = [](auto change) {
    LogHeader header = coarseHeader();
    change(header);
    EXPECT_THROW((void)Document(header), InputError);
  };
  refused([](LogHeader& h) { h.density = 0; });
  refused([](LogHeader& h) { h.grid = 0.3f; });
  refused([](LogHeader& h) { h.unit = "inch"; });
  refused([](LogHeader& h) { h.base = implicit::Sphere{{}, -1}; });
  refused([](LogHeader& h) { h.base = implicit::Sphere{{1e9f, 0, 0}, 1}; });
}

TEST(Replay, NamesTheLineOfACommandThatCannotBeCarriedOut) {
  StrokeLog log{
      .header = coarseHeader(), .commands = {line(0), UndoCommand{}, UndoCommand{}}, .lines = {2, 3, 4}};
  for (const bool shapes : {true, false}) {
    try {
      if (shapes)
        (void)replay(log, {.file = "a.log"});
      else
        (void)historyOf(log, "a.log");
      FAIL() << "the second undo has nothing to undo";
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()), std::string("a.log:4: ") + kNothingToUndo);
    }
  }
}

TEST(Replay, HistoryWithoutShapesHasTheSameTree) {
  const StrokeLog log{
      .header = coarseHeader(),
      .commands = {line(0), line(9), UndoCommand{}, line(-9), UndoCommand{}, UndoCommand{}, RedoCommand{}}};
  const Document document = replay(log);
  const History history = historyOf(log);
  EXPECT_EQ(history.cursor(), document.history().cursor());
  ASSERT_EQ(history.size(), document.history().size());
  for (std::uint32_t i = 0; i < history.size(); ++i) {
    EXPECT_EQ(history.parent(NodeId{i}), document.history().parent(NodeId{i}));
    EXPECT_EQ(history.redoTarget(NodeId{i}), document.history().redoTarget(NodeId{i}));
  }
}

}  // namespace
}  // namespace restroke::sculpt
