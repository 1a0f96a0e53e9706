#include "sculpt/stroke_log.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <random>

#include "implicit/errors.h"
#include "sculpt/replay.h"
#include "sculpt/stroke_log_lines.h"
#include "tests/sculpt/test_commands.h"

namespace restroke::sculpt {
namespace {

const char* const kHeader =
    R"({"restroke":1,"unit":"mm","density":300,"grid":1.5258789e-05,"base":{"sphere":{"center":[0,0,0],"radius":1}}})";
const char* const kStroke =
    R"({"stroke":{"camera":{"position":[0,0,4],"view":[0,0,-1],"up":[0,1,0],"halfHeight":0.3,"viewport":[400,400],"near":0.1,"far":10},)"
    R"("brush":{"radius":0.1,"spacing":0.25,"pressureToRadius":0,"mode":"add"},"method":"exact","points":[[3200,3200,0,512],[3300,3200,8,512]]}})";

StrokeLog sampleLog() {
  StrokeLog log{.header = coarseHeader(), .commands = {}};
  log.header.base = implicit::Sphere{{0.1f, -0.0f, 1e-30f}, 0.7f};
  log.commands = {line(0), line(3), line(3, Mode::Carve), UndoCommand{}, UndoCommand{}, RedoCommand{}};
  StrokeCommand recorded = line(1);
  recorded.stroke.camera.far = 33.3f;
  recorded.method = retarget::Method::Embree;
  recorded.outcome = StrokeOutcome{{Stamp{.center = {0.1f, -0.0f, 1.0f / 3}, .radius = 0.3f}}, 5, 2};
  log.commands.emplace_back(recorded);
  log.commands.emplace_back(FixedCommand{Mode::Carve, {{{1e-9f, -2, 3}, 0.125f}}});
  return log;
}

std::string linesOf(const StrokeLog& log) {
  std::string text = formatHeader(log.header) + "\n";
  for (const Command& command : log.commands) {
    LineContext context;
    text += formatCommand(command, context) + "\n";
  }
  return text;
}

std::string sentenceOf(const std::filesystem::path& file) {
  try {
    (void)readLog(file);
  } catch (const InputError& error) {
    return error.what();
  }
  return "(no error)";
}

TEST(StrokeLog, ComesBackEqualInEveryField) {
  const TemporaryFolder folder;
  const StrokeLog log = sampleLog();
  writeLog(folder / "a.log", log);
  const StrokeLog read = readLog(folder / "a.log");
  EXPECT_FALSE(read.warning.has_value());
  EXPECT_FALSE(read.stampList);
  EXPECT_EQ(read.commands.size(), log.commands.size());
  EXPECT_EQ(linesOf(read), linesOf(log));
  EXPECT_TRUE(std::signbit(read.header.base.ball().center.y));
  EXPECT_EQ(read.lines.front(), 2u);
  EXPECT_EQ(read.bytes, textOf(folder / "a.log").size());
  writeLog(folder / "b.log", read);
  EXPECT_EQ(textOf(folder / "a.log"), textOf(folder / "b.log"));
}

TEST(StrokeLog, ACameraOrBrushEqualToThatOfTheStrokeAboveIsLeftOut) {
  const TemporaryFolder folder;
  writeLog(folder / "a.log",
           {.header = coarseHeader(), .commands = {line(0), UndoCommand{}, line(0), line(0, Mode::Carve)}});
  const std::string text = textOf(folder / "a.log");
  EXPECT_EQ(text.find("\"camera\""), text.rfind("\"camera\""));
  EXPECT_NE(text.find("\"brush\""), text.rfind("\"brush\""));
  const StrokeLog read = readLog(folder / "a.log");
  EXPECT_EQ(std::get<StrokeCommand>(read.commands[3]).stroke, line(0).stroke);
  EXPECT_EQ(std::get<StrokeCommand>(read.commands[3]).brush, line(0, Mode::Carve).brush);
}

TEST(StrokeLog, FloatsAreWrittenSoThatEveryBitComesBack) {
  std::minstd_rand random(7);
  for (int i = 0; i < 200000; ++i) {
    const auto bits = static_cast<std::uint32_t>(random() ^ (random() << 16));
    const auto value = std::bit_cast<float>(bits);
    if (!std::isfinite(value)) continue;
    const auto back = static_cast<float>(std::strtod(formatFloat(value).c_str(), nullptr));
    ASSERT_EQ(std::bit_cast<std::uint32_t>(back), bits) << formatFloat(value);
  }
  EXPECT_EQ(formatFloat(0.1f), "0.1");
  EXPECT_EQ(formatFloat(-0.0f), "-0.0");
}

// X6: a log survives a crash at any moment with at most the stroke in progress lost.
TEST(StrokeLog, X6ALogCutAtAnyByteOfItsLastLineLosesOnlyThatLine) {
  const TemporaryFolder folder;
  const std::string before = std::string(kHeader) + "\n" + kStroke + "\n";
  const std::string whole = before + kStroke + "\n";
  for (std::size_t size = before.size(); size <= whole.size(); ++size) {
    const auto file = folder.file("a.log", whole.substr(0, size));
    const StrokeLog log = readLog(file);
    const bool torn = size > before.size() && size < whole.size();
    ASSERT_EQ(log.commands.size(), size == whole.size() ? 2u : 1u) << size;
    ASSERT_EQ(log.warning.has_value(), torn) << size;
    if (torn) {
      EXPECT_NE(log.warning->find("a.log:3: the last line is torn"), std::string::npos) << *log.warning;
    }
    appendToLog(file, UndoCommand{});
    ASSERT_EQ(textOf(file), (size == whole.size() ? whole : before) + "{\"undo\":{}}\n") << size;
  }
}

TEST(StrokeLog, AppendingLeavesEarlierLinesAsTheyAre) {
  const TemporaryFolder folder;
  const auto file = folder.file("a.log", std::string(kHeader) + "\n");
  appendToLog(file, line(0));
  const std::string one = textOf(file);
  appendToLog(file, line(0, Mode::Carve));
  EXPECT_EQ(textOf(file).substr(0, one.size()), one);
  const StrokeLog log = readLog(file);
  ASSERT_EQ(log.commands.size(), 2u);
  EXPECT_EQ(std::get<StrokeCommand>(log.commands[1]).brush.mode, Mode::Carve);
}

TEST(StrokeLog, AppendingIsRefusedWhereThereIsNoLog) {
  const TemporaryFolder folder;
  EXPECT_THROW(appendToLog(folder / "missing.log", UndoCommand{}), InputError);
  const auto stamps = folder.file("a.stamps", "B 0 0 0 1\n");
  EXPECT_THROW(appendToLog(stamps, UndoCommand{}), InputError);
  EXPECT_EQ(textOf(stamps), "B 0 0 0 1\n");
  const auto torn = folder.file("torn.log", "{\"restroke\":1");
  EXPECT_THROW(appendToLog(torn, UndoCommand{}), InputError);
  EXPECT_EQ(textOf(torn), "{\"restroke\":1");
  EXPECT_THROW(appendToLog(folder / "", UndoCommand{}), InputError);
}

TEST(StrokeLog, EveryBrokenRuleIsNamedWithItsLine) {
  const TemporaryFolder folder;
  const auto sentence = [&](const std::string& text) { return sentenceOf(folder.file("a.log", text)); };
  const auto replaced = [](std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
  };
  const std::string header = std::string(kHeader) + "\n";
  struct Case {
    std::string from, to, says;
  };
  const std::vector<Case> strokes = {
      {"[0,0,4]", "[0,NaN,4]", "not valid JSON"},
      {"[0,0,4]", "[0,Infinity,4]", "not valid JSON"},
      {"[0,0,4]", "[0,1e999,4]", "overflows"},
      {"[0,0,4]", "[0,1e300,4]", "stroke.camera.position[1] is 1e+300"},
      {"[0,0,4]", "[0,\"1\",4]", "stroke.camera.position[1] is \"1\""},
      {"[0,0,4]", "[0,0]", "stroke.camera.position is an array of 2"},
      {"[0,0,-1]", "[0,0,0]", "stroke"},
      {"[0,1,0]", "[0,0,1]", "stroke"},
      {"[400,400]", "[0,400]", "stroke.camera.viewport[0] is 0"},
      {"[400,400]", "[400,70000]", "stroke.camera.viewport[1] is 70000"},
      {"[400,400]", "[400.5,400]", "stroke.camera.viewport[0] is 400.5"},
      {"\"far\":10", "\"far\":0.01", "stroke"},
      {"\"far\":10", "\"far\":10,\"zoom\":1", "\"zoom\" is not a known key"},
      {"\"far\":10", "\"far\":10,\"far\":11", "occurs twice"},
      {"\"radius\":0.1", "\"radius\":-0.1", "stroke.brush.radius is -0.1"},
      {"\"radius\":0.1", "\"radius\":0", "stroke.brush.radius is 0"},
      {"\"spacing\":0.25", "\"spacing\":0", "spacing"},
      {"\"pressureToRadius\":0", "\"pressureToRadius\":2", "pressure"},
      {"\"mode\":\"add\"", "\"mode\":\"dig\"", "stroke.brush.mode is \"dig\""},
      {",\"mode\":\"add\"", "", "stroke.brush.mode is missing"},
      {"\"exact\"", "\"magic\"", "magic"},
      {"\"exact\"", "7", "stroke.method is 7"},
      {"[3300,3200,8,512]", "[3300,3200,8]", "stroke.points[1] is an array of 3"},
      {"[3300,3200,8,512]", "[3300.5,3200,8,512]", "stroke.points[1][0] is 3300.5"},
      {"[3300,3200,8,512]", "[3300,99999999999,8,512]", "stroke.points[1][1] is 99999999999"},
      {"[3300,3200,8,512]", "[3300,3200,-8,512]", "stroke.points[1][2] is -8"},
      {"[3300,3200,8,512]", "[3300,3200,8,1024]", "stroke.points[1][3] is 1024"},
      {"[3300,3200,8,512]", "[3300,3200,18446744073709551615,512]",
       "stroke.points[1][2] is 18446744073709551615"},
      {"[3300,3200,8,512]", "null", "stroke.points[1] is null"},
      {"[3200,3200,0,512]", "[3200,3200,9,512]", "stroke.points[1][2] is 8, but must be no earlier"},
      {"[[3200,3200,0,512],[3300,3200,8,512]]", "[]", "point"},
      {"[[3200,3200,0,512],[3300,3200,8,512]]", "{}", "stroke.points is an object"},
      {"{\"stroke\"", "{\"strike\"", "\"strike\" is not a known key"},
      {"\"exact\"", "\"exact\",\"outcome\":{\"misses\":0,\"pieces\":0,\"stamps\":[]}", "only for methods"},
      {"\"exact\"", "\"embree\",\"outcome\":{\"misses\":3,\"pieces\":0,\"stamps\":[]}", "misses is 3"},
      {"\"exact\"", "\"embree\",\"outcome\":{\"misses\":0,\"pieces\":1,\"stamps\":[[0,0,1,-1]]}",
       "stamps[0][3] is -1"},
      {"{\"stroke\"", "{\"undo\":{},\"stroke\"", "exactly one command"},
  };
  for (const Case& c : strokes) {
    const std::string says = sentence(header + kStroke + "\n" + replaced(kStroke, c.from, c.to) + "\n");
    EXPECT_NE(says.find("a.log:3: "), std::string::npos) << c.to << ": " << says;
    EXPECT_NE(says.find(c.says), std::string::npos) << c.to << ": " << says;
    EXPECT_EQ(says.find('\n'), std::string::npos) << says;
  }
  const std::vector<Case> headers = {
      {"{\"restroke\":1", "{\"restroke\":2", "version 2 is needed"},
      {"{\"restroke\":1", "{\"restroke\":\"1\"", "restroke is \"1\""},
      {"{\"restroke\":1", "{\"retroke\":1", "\"restroke\" is missing"},
      {"\"mm\"", "\"inch\"", "unit is \"inch\""},
      {"\"density\":300", "\"density\":0", "density is 0"},
      {"\"density\":300", "\"density\":1e39", "density is 1e+39"},
      {"1.5258789e-05", "0.001", "power of two"},
      {"\"radius\":1", "\"radius\":0", "base.sphere.radius is 0"},
      {"[0,0,0]", "[0,0,2e6]", "base.sphere.center[2] is 2000000"},
      {"\"sphere\"", "\"cube\"", "base: there is no kind of volume \"cube\""},
  };
  for (const Case& c : headers) {
    const std::string says = sentence(replaced(kHeader, c.from, c.to) + "\n");
    EXPECT_NE(says.find("a.log:1: "), std::string::npos) << c.to << ": " << says;
    EXPECT_NE(says.find(c.says), std::string::npos) << c.to << ": " << says;
  }
  const auto says = [&](const std::string& text, const std::string& what) {
    EXPECT_NE(sentence(text).find(what), std::string::npos) << sentence(text);
  };
  says("", "is empty");
  says(kHeader, "a.log:1: the header line is torn");
  says(header + "\n" + kStroke + "\n", "a.log:2: ");
  says(header + "{\"undo\":1}\n", "undo is 1");
  says(header + "[]\n", "an array of 0");
  says(header + "{}\n", "exactly one command");
  says(header + "{\"fixed\":{\"mode\":\"add\",\"stamps\":[[0,0,0,0]]}}\n", "fixed.stamps[0][3] is 0");
  says(header + replaced(kStroke, "\"brush\"", "\"crush\"") + "\n", "\"crush\"");
  says(header + R"({"stroke":{"method":"exact","points":[[0,0,0,0]]}})" + "\n", "stroke.camera is missing");
  says(header + std::string(1000, '[') + "\n", "nested deeper");
  says(header + std::string(1000000, '[') + std::string(1000000, ']') + "\n", "nested deeper");
  says(header + std::string(1, '\0') + "\n", "a.log:2: ");
  says(header + "{\"undo\":{}} {\"undo\":{}}\n", "not valid JSON");
}

TEST(StrokeLog, MissingFilesAndFoldersAreRefused) {
  const TemporaryFolder folder;
  EXPECT_NE(sentenceOf(folder / "missing.log").find("No such file"), std::string::npos);
  EXPECT_NE(sentenceOf(folder / "").find("is a folder"), std::string::npos);
  EXPECT_NE(sentenceOf("/dev/zero").find("is a device"), std::string::npos);
}

TEST(StrokeLog, CarriageReturnsAtLineEndsAreAccepted) {
  const TemporaryFolder folder;
  EXPECT_EQ(readLog(folder.file("a.log", std::string(kHeader) + "\r\n" + kStroke + "\r\n")).commands.size(),
            1u);
}

TEST(StrokeLog, AMillionPointsAreReadBack) {
  StrokeCommand command = line(0);
  command.stroke.points.resize(1000000);
  for (std::size_t i = 0; i < command.stroke.points.size(); ++i)
    command.stroke.points[i] = {
        .screen = {static_cast<std::int32_t>(i % 6400), static_cast<std::int32_t>(i % 6399)},
        .time = static_cast<std::uint32_t>(i)};
  const TemporaryFolder folder;
  writeLog(folder / "a.log", {.header = coarseHeader(), .commands = {command}});
  const StrokeLog read = readLog(folder / "a.log");
  EXPECT_EQ(std::get<StrokeCommand>(read.commands.at(0)).stroke, command.stroke);
}

TEST(StampList, BecomesFixedCommandsOnItsBase) {
  const TemporaryFolder folder;
  const StrokeLog log = readLog(
      folder.file("a.stamps", "B 1 2 3 0.5\r\nS 1 2\r\n1 2 3 0.1\r\n 1e-1  2 3 0.25 \nS -1 1\n0 0 0 1\n\n"));
  EXPECT_TRUE(log.stampList);
  EXPECT_EQ(log.header.base, (implicit::Sphere{{1, 2, 3}, 0.5f}));
  EXPECT_FLOAT_EQ(log.header.density, 32000);
  ASSERT_EQ(log.commands.size(), 2u);
  EXPECT_EQ(std::get<FixedCommand>(log.commands[0]).mode, Mode::Add);
  EXPECT_EQ(std::get<FixedCommand>(log.commands[0]).stamps[1], (implicit::Sphere{{0.1f, 2, 3}, 0.25f}));
  EXPECT_EQ(std::get<FixedCommand>(log.commands[1]).mode, Mode::Carve);
  EXPECT_EQ(log.lines, (std::vector<std::size_t>{2, 5}));
  // Its last newline may be missing.
  EXPECT_EQ(readLog(folder.file("b.stamps", "B 0 0 0 1\nS 1 1\n0 0 1 0.1")).commands.size(), 1u);
  EXPECT_TRUE(readLog(folder.file("c.stamps", "B 0 0 0 1\n")).commands.empty());
}

TEST(StampList, EveryBrokenRuleIsNamedWithItsLine) {
  const TemporaryFolder folder;
  const auto says = [&](const std::string& text, const std::string& what) {
    const std::string sentence = sentenceOf(folder.file("a.stamps", text));
    EXPECT_NE(sentence.find(what), std::string::npos) << text << ": " << sentence;
  };
  says("hello\n", "a.stamps:1: found \"hello\"");
  says("B 0 0 0\n", "a.stamps:1: found \"\"");
  says("B 0 0 0 0\n", "a.stamps:1: found \"0\", but must be a radius more than 0");
  says("B 0 0 0 -1\n", "a.stamps:1: found \"-1\"");
  says("B 0 nan 0 1\n", "a.stamps:1: found \"nan\"");
  says("B 0 inf 0 1\n", "a.stamps:1: found \"inf\"");
  says("B 0 1e30 0 1\n", "a.stamps:1: found \"1e30\"");
  says("B 0 0 0 1 2\n", "a.stamps:1: found \"2\"");
  says("B 0 0 0 1\nS 2 1\n", "a.stamps:2: found \"2\"");
  says("B 0 0 0 1\nS 1 0\n", "a.stamps:2: found \"0\"");
  says("B 0 0 0 1\nS 1 99999999999999999999\n", "a.stamps:2: found \"99999999999999999999\"");
  says("B 0 0 0 1\nS 1 2\n0 0 1 0.1\n",
       "a.stamps:3: the list ends here, but must give 2 stamps of the stroke and has 1");
  says("B 0 0 0 1\nS 1 2\n0 0 1 0.1\nS 1 1\n", "a.stamps:4: found \"S\"");
  says("B 0 0 0 1\n\nS 1 1\n0 0 1 0.1\n", "a.stamps:2: found \"\"");
}

TEST(StampList, ThePapersListsAreRead) {
  const auto data = sharedData();
  if (data.empty()) GTEST_SKIP() << "no shared data folder";
  const StrokeLog log = readLog(data / "stamps" / "paper-108x3426.stamps");
  std::size_t stamps = 0;
  for (const Command& command : log.commands) stamps += std::get<FixedCommand>(command).stamps.size();
  EXPECT_EQ(log.commands.size(), 108u);
  EXPECT_EQ(stamps, 3426u);
}

}  // namespace
}  // namespace restroke::sculpt
