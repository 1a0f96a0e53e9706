#include "sculpt/history.h"

#include <gtest/gtest.h>

#include <functional>

#include "implicit/errors.h"
#include "sculpt/pen_strokes.h"
#include "tests/sculpt/test_commands.h"

namespace restroke::sculpt {
namespace {

void expectSame(const Command& a, const Command& b) {
  ASSERT_EQ(a.index(), b.index());
  if (const auto* stroke = std::get_if<StrokeCommand>(&a)) {
    const auto& other = std::get<StrokeCommand>(b);
    EXPECT_EQ(stroke->stroke, other.stroke);
    EXPECT_EQ(stroke->brush, other.brush);
    EXPECT_EQ(stroke->method, other.method);
    EXPECT_EQ(stroke->outcome, other.outcome);
  } else {
    EXPECT_EQ(std::get<FixedCommand>(a).mode, std::get<FixedCommand>(b).mode);
    EXPECT_EQ(std::get<FixedCommand>(a).stamps, std::get<FixedCommand>(b).stamps);
  }
}

TEST(History, StartsAtItsRootWithNothingAhead) {
  const History history;
  EXPECT_EQ(history.size(), 1u);
  EXPECT_EQ(history.cursor(), kRootNode);
  EXPECT_EQ(history.parent(kRootNode), kRootNode);
  EXPECT_EQ(history.redoTarget(kRootNode), kRootNode);
  EXPECT_TRUE(history.pathTo(kRootNode).empty());
}

TEST(History, GivesBackEveryCommandEqualInEveryField) {
  std::vector<Command> commands;
  commands.emplace_back(line(0));
  commands.emplace_back(line(5, Mode::Carve));
  StrokeCommand recorded = line(-7);
  recorded.method = retarget::Method::Embree;
  recorded.outcome = StrokeOutcome{{Stamp{.center = {0.1f, -0.0f, 1}, .radius = 0.3f}}, 300, 2};
  commands.emplace_back(recorded);
  recorded.outcome = StrokeOutcome{{}, 21, 0};
  commands.emplace_back(recorded);
  StrokeCommand onePoint = line(1);
  onePoint.stroke.points.resize(1);
  onePoint.stroke.camera.position.x = 0.25f;
  commands.emplace_back(onePoint);
  commands.emplace_back(FixedCommand{Mode::Carve, {{{1, 2, 3}, 4}, {{-1e-20f, 0, 5}, 1e-9f}}});
  commands.emplace_back(FixedCommand{Mode::Add, {}});
  History history;
  for (const Command& command : commands) history.add(command);
  for (std::uint32_t i = 0; i < commands.size(); ++i) expectSame(history.command(NodeId{i + 1}), commands[i]);
}

TEST(History, UndoAndRedoAreNotNodes) {
  History history;
  EXPECT_THROW(history.add(UndoCommand{}), InternalError);
  EXPECT_EQ(history.size(), 1u);
}

// S8: branches; redo takes the child last visited, else the oldest.
TEST(History, S8RedoFollowsTheChildLastVisited) {
  History history;
  const NodeId a = history.add(line(0));
  const NodeId b = history.add(line(1));
  history.moveCursor(a);
  const NodeId c = history.add(line(2));
  EXPECT_EQ(history.parent(b), a);
  EXPECT_EQ(history.parent(c), a);
  history.moveCursor(a);
  EXPECT_EQ(history.redoTarget(a), c);
  history.moveCursor(kRootNode);
  EXPECT_EQ(history.redoTarget(kRootNode), a);
  history.moveCursor(b);  // over two levels
  history.moveCursor(kRootNode);
  EXPECT_EQ(history.redoTarget(kRootNode), a);
  EXPECT_EQ(history.redoTarget(a), b);
  EXPECT_EQ(history.pathTo(c), (std::vector<NodeId>{a, c}));
}

TEST(History, CamerasAndBrushesAreKeptOnceWhileTheyRecur) {
  const auto bytesOf = [](int strokes, const std::function<float(int)>& x) {
    History history;
    for (int i = 0; i < strokes; ++i) {
      StrokeCommand command = line(0);
      command.stroke.camera.position.x = x(i);
      history.add(command);
    }
    return history.bytes();
  };
  const std::size_t same = bytesOf(64, [](int) { return 0.0f; });
  const std::size_t alternating = bytesOf(64, [](int i) { return static_cast<float>(i % 2); });
  const std::size_t different = bytesOf(64, [](int i) { return static_cast<float>(i); });
  EXPECT_LE(alternating, same + 2 * sizeof(Camera));
  EXPECT_GE(different, same + 60 * sizeof(Camera));
}

// The budget of 64 + 4 n bytes a stroke: header and camera counted, over every stroke file of the shared
// folder.
TEST(History, S5BytesAStrokeStayWithinTheBudgetOnRealStrokes) {
  const auto data = sharedData();
  if (data.empty()) GTEST_SKIP() << "no shared data folder";
  for (const auto& entry : std::filesystem::directory_iterator(data / "strokes")) {
    if (entry.path().extension() != ".json") continue;
    const StrokeLog log = readPenStrokes(entry.path());
    History whole, bare({.times = false, .pressures = false});
    double points = 0;
    for (const Command& command : log.commands) {
      const NodeId node = whole.add(command);
      expectSame(whole.command(node), command);
      bare.add(command);
      points += static_cast<double>(std::get<StrokeCommand>(command).stroke.points.size());
    }
    const auto strokes = static_cast<double>(log.commands.size());
    EXPECT_LE(static_cast<double>(whole.bytes()), 64 * strokes + 4 * points) << entry.path();
    EXPECT_LE(static_cast<double>(bare.bytes()), 48 * strokes + 2.5 * points) << entry.path();
    std::printf(
        "%-34s %6.0f points in %4.0f strokes: %7zu bytes (budget %8.0f), without time and pressure %7zu "
        "(%8.1f)\n",
        entry.path().filename().c_str(), points, strokes, whole.bytes(), 64 * strokes + 4 * points,
        bare.bytes(), 48 * strokes + 2.5 * points);
  }
}

TEST(History, LeavesOutTheChannelsThatItIsToldTo) {
  History history({.times = false, .pressures = true});
  const auto command = std::get<StrokeCommand>(history.command(history.add(line(3))));
  EXPECT_EQ(command.stroke.points[4].time, 0u);
  EXPECT_EQ(command.stroke.points[4].pressure, 504);
  EXPECT_EQ(command.stroke.points[4].screen, line(3).stroke.points[4].screen);
}

}  // namespace
}  // namespace restroke::sculpt
