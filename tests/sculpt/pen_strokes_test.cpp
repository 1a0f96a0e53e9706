#include "sculpt/pen_strokes.h"

#include <gtest/gtest.h>

#include "implicit/errors.h"
#include "tests/sculpt/test_commands.h"

namespace restroke::sculpt {
namespace {

std::string drawing(const std::string& strokes, const std::string& size = R"("width":100,"height":80)") {
  return "{\"source\":\"somewhere\",\"notes\":null," + size + ",\"strokes\":" + strokes + "}";
}

TEST(PenStrokes, AreRoundedToFixedPointWithTimesFromTheStrokesFirstPoint) {
  const TemporaryFolder folder;
  const auto file = folder.file(
      "a.json",
      drawing(
          R"([{"name":"a","points":[[1,2,5.0,0.5],[1.03125,-2.03125,5.0126,1]]},{"points":[[0,0,9,0]]}])"));
  const StrokeLog log = readPenStrokes(file, {.base = {}, .mode = PenMode::Alternate});
  ASSERT_EQ(log.commands.size(), 2u);
  const auto& a = std::get<StrokeCommand>(log.commands[0]);
  ASSERT_EQ(a.stroke.points.size(), 2u);
  EXPECT_EQ(a.stroke.points[0], (retarget::StrokePoint{{16, 32}, 0, 512}));
  EXPECT_EQ(a.stroke.points[1], (retarget::StrokePoint{{17, -32}, 13, 1023}));  // halves go up
  EXPECT_EQ(a.brush.mode, Mode::Add);
  EXPECT_FLOAT_EQ(a.brush.radius, 0.05f * std::sqrt(3.0f));
  EXPECT_EQ(a.method, retarget::Method::Exact);
  EXPECT_EQ(a.stroke.camera.width, 100u);
  EXPECT_EQ(a.stroke.camera.height, 80u);
  EXPECT_EQ(std::get<StrokeCommand>(log.commands[1]).brush.mode, Mode::Carve);
  EXPECT_EQ(log.header.density, 8000);
}

TEST(PenStrokes, TheBasesSilhouetteSpansThePartOfTheShorterSideThatIsAskedFor) {
  const TemporaryFolder folder;
  const auto file = folder.file("a.json", drawing(R"([{"points":[[0,0,0,0]]}])"));
  const implicit::Sphere base{{5, -3, 2}, 2};
  const StrokeLog log = readPenStrokes(file, {.base = base, .radius = 0.5f, .density = 77, .fill = 0.5f});
  const Camera& camera = std::get<StrokeCommand>(log.commands[0]).stroke.camera;
  EXPECT_EQ(std::get<StrokeCommand>(log.commands[0]).brush.radius, 0.5f);
  EXPECT_EQ(log.header.density, 77);
  const auto hits = [&](int x, int y) {
    return intersect(base, rayThrough(camera, {16 * x, 16 * y})).has_value();
  };
  EXPECT_TRUE(hits(50, 40));
  // Half of 80 pixels: from 20 to 60 in y.
  EXPECT_TRUE(hits(50, 21));
  EXPECT_FALSE(hits(50, 19));
  EXPECT_TRUE(hits(69, 40));
  EXPECT_FALSE(hits(71, 40));
}

TEST(PenStrokes, EveryBrokenRuleIsNamedWithItsPlace) {
  const TemporaryFolder folder;
  const auto says = [&](const std::string& text, const std::string& what) {
    const auto file = folder.file("a.json", text);
    try {
      (void)readPenStrokes(file);
      ADD_FAILURE() << text << " was accepted";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("a.json"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << text << ": " << error.what();
    }
  };
  const auto point = [](const std::string& text) {
    return drawing("[{\"points\":[[0,0,0,0]," + text + "]}]");
  };
  says("", "ends in the middle");
  says("{", "ends in the middle");
  says(drawing("[").substr(0, 70), "ends in the middle");
  says("{\n\n\"width\":oops}", "a.json:3: byte 9");
  says("[]", "the text is an array of 0, but must be an object");
  says(drawing("[]"), "strokes is an array of 0");
  says(drawing("{}"), "strokes is an object");
  says(drawing("[7]"), "strokes[0] is 7");
  says(drawing("[{}]"), "strokes[0].points is missing");
  says(drawing("[{\"points\":[]}]"), "strokes[0].points is an array of 0");
  says(drawing("[{\"points\":\"x\"}]"), "strokes[0].points is \"x\"");
  says(drawing("[{\"points\":[[0,0,0,0]]}]", "\"width\":0,\"height\":80"), "width is 0");
  says(drawing("[{\"points\":[[0,0,0,0]]}]", "\"width\":100,\"height\":-1"), "height is -1");
  says(drawing("[{\"points\":[[0,0,0,0]]}]", "\"width\":100"), "height is missing");
  says(drawing("[{\"points\":[[0,0,0,0]]}]", "\"width\":100,\"height\":1e9"), "height is 1000000000");
  says(drawing("[{\"points\":[[0,0,0,0]]}]", "\"width\":\"100\",\"height\":9"), "width is \"100\"");
  says(point("[NaN,0,0,0]"), "not valid JSON");
  says(point("[1e999,0,0,0]"), "overflows");
  says(point("[1e12,0,0,0]"), "strokes[0].points[1][0] is 1000000000000");
  says(point("[0,-1e7,0,0]"), "strokes[0].points[1][1] is -10000000");
  says(point("[0,null,0,0]"), "strokes[0].points[1][1] is null");
  says(point("[0,0,\"0\",0]"), "strokes[0].points[1][2] is \"0\"");
  says(point("[0,0,-1,0]"), "strokes[0].points[1][2] is -1, but must be no earlier");
  says(point("[0,0,1e9,0]"), "strokes[0].points[1][2] is 1000000000");
  says(point("[0,0,0,1.5]"), "strokes[0].points[1][3] is 1.5");
  says(point("[0,0,0,-0.5]"), "strokes[0].points[1][3] is -0.5");
  says(point("[0,0,0]"), "strokes[0].points[1] is an array of 3");
  says(point("5"), "strokes[0].points[1] is 5");
  says(drawing(std::string(100000, '[')), "nested deeper");
}

TEST(PenStrokes, AllSharedFilesAreRead) {
  const auto data = sharedData();
  if (data.empty()) GTEST_SKIP() << "no shared data folder";
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(data / "strokes")) {
    if (entry.path().extension() != ".json") continue;
    EXPECT_FALSE(readPenStrokes(entry.path()).commands.empty()) << entry.path();
    ++files;
  }
  EXPECT_GE(files, 6u);
}

}  // namespace
}  // namespace restroke::sculpt
