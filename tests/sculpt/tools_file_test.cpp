// Files of tools and workpieces (R8).

#include "sculpt/tools_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "implicit/errors.h"

namespace restroke::sculpt {
namespace {

using points::Cutter;

ToolsFile parsed(const std::string& text) {
  return parseToolsFile(text, "t.json");
}
Cutter cutterOf(const std::string& tool) {
  return selectedTool(parsed(R"({"tools":{"1":{)" + tool + "}}}"), 1).cutter.value();
}
template <class F>
void expectRefused(const F& f, const std::string& says) {
  try {
    f();
    ADD_FAILURE() << "accepted; expected: " << says;
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find(says), std::string::npos) << what;
    EXPECT_EQ(what.rfind("t.json:", 0), 0u) << what;
  }
}

TEST(ToolsFile, ShapesBecomeCutters) {
  EXPECT_EQ(cutterOf(R"("shape":"cylindrical","length":12.7,"diameter":1)"),
            (Cutter{.kind = Cutter::Kind::Flat, .radius = 0.5, .length = 12.7}));
  EXPECT_EQ(
      cutterOf(R"("units":"metric","shape":"ballnose","length":30.125,"diameter":6.25,"description":"x")"),
      (Cutter{.kind = Cutter::Kind::Ball, .radius = 3.125, .length = 30.125}));
  const Cutter bull{.kind = Cutter::Kind::BullNose, .radius = 4, .length = 20, .cornerRadius = 1};
  EXPECT_EQ(cutterOf(R"("shape":"bullnose","length":20,"diameter":8,"corner_radius":1)"), bull);
  EXPECT_EQ(cutterOf(R"("shape":"Bull-Nose","length":20,"diameter":8,"corner_radius":1)"), bull);
  EXPECT_EQ(cutterOf(R"("length":20,"diameter":8,"corner_radius":1)"), bull);
  EXPECT_EQ(cutterOf(R"("shape":"bullnose","length":20,"diameter":8,"corner_radius":4)").kind,
            Cutter::Kind::Ball);
  EXPECT_EQ(cutterOf(R"("shape":"bullnose","length":20,"diameter":8,"corner_radius":0)").kind,
            Cutter::Kind::Flat);
}

TEST(ToolsFile, ImperialToolsAreInInches) {
  const Cutter cutter =
      cutterOf(R"("units":"imperial","shape":"bullnose","length":2,"diameter":0.5,"corner_radius":0.0625)");
  EXPECT_DOUBLE_EQ(cutter.radius, 6.35);
  EXPECT_DOUBLE_EQ(cutter.length, 50.8);
  EXPECT_DOUBLE_EQ(cutter.cornerRadius, 1.5875);
}

TEST(ToolsFile, ToolsCutUnlessTheyAdd) {
  const ToolsFile file =
      parsed(R"({"tools":{"1":{"length":1,"diameter":1},"2":{"length":1,"diameter":1,"mode":"add"},
                                    "3":{"length":1,"diameter":1,"mode":"cut"}}})");
  EXPECT_FALSE(selectedTool(file, 1).adds);
  EXPECT_TRUE(selectedTool(file, 2).adds);
  EXPECT_FALSE(selectedTool(file, 3).adds);
  EXPECT_EQ(numbersOf(file), "1, 2 and 3");
}

TEST(ToolsFile, WhatIsNoCutterIsAnErrorOnlyWhenSelected) {
  const ToolsFile file = parsed(R"({"tools":{"1":{"shape":"conical","length":15,"diameter":12},
    "2":{"shape":"ballnose","length":1,"diameter":8},"3":{"shape":"bullnose","length":9,"diameter":8},
    "4":{"shape":"cylindrical","length":9,"diameter":-8},"7":{"shape":"cylindrical","length":9,"diameter":8}}})");
  EXPECT_TRUE(selectedTool(file, 7).cutter.has_value());
  expectRefused([&] { (void)selectedTool(file, 1); }, "tool 1 has the shape \"conical\"; cutters must be");
  expectRefused([&] { (void)selectedTool(file, 2); }, "at least as long");
  expectRefused([&] { (void)selectedTool(file, 3); }, "without corner_radius");
  expectRefused([&] { (void)selectedTool(file, 4); }, "greater than 0");
  expectRefused([&] { (void)selectedTool(file, 5); }, "there is no tool 5; the tools are 1, 2, 3, 4 and 7");
  expectRefused([&] { (void)selectedTool(parsed("{}"), 1); }, "the tools are none");
}

TEST(ToolsFile, AWorkpieceIsABox) {
  const ToolsFile file =
      parsed(R"({"workpiece":{"automatic":false,"margin":5,"bounds":{"min":[0,-1,-2],"max":[3,4,5]}}})");
  ASSERT_TRUE(file.workpiece.has_value());
  const TriangleMesh stock = stockOf(file);
  EXPECT_EQ(boundsOf(stock).min, Point(0, -1, -2));
  EXPECT_EQ(boundsOf(stock).max, Point(3, 4, 5));
  EXPECT_DOUBLE_EQ(volumeOf(stock), 3 * 5 * 7);
  expectRefused([] { (void)stockOf(parsed(R"({"workpiece":{"automatic":true}})")); }, "workpiece.bounds");
  expectRefused([] { (void)stockOf(parsed("{}")); }, "workpiece.bounds");
}

TEST(ToolsFile, WhatIsNotAsItMustBeIsRefused) {
  for (const auto& [text, says] : std::vector<std::pair<std::string, std::string>>{
           {"", "JSON"},
           {"[]", "an object"},
           {R"({"tools":[]})", "tools by their numbers"},
           {R"({"tools":{"a":{}}})", "numbers of tools"},
           {R"({"tools":{"-1":{}}})", "numbers of tools"},
           {R"({"tools":{"1":5}})", "an object"},
           {R"({"tools":{"1":{"shape":5,"length":1,"diameter":1}}})", "a string"},
           {R"({"tools":{"1":{"length":"1","diameter":1}}})", "tools.1.length"},
           {R"({"tools":{"1":{"length":1}}})", "tools.1.diameter is missing"},
           {R"({"tools":{"1":{"length":NaN,"diameter":1}}})", "not valid JSON"},
           {R"({"tools":{"1":{"length":1e999,"diameter":1}}})", "overflows"},
           {R"({"tools":{"1":{"units":"cubits","length":1,"diameter":1}}})", "imperial"},
           {R"({"tools":{"1":{"mode":"melt","length":1,"diameter":1}}})", "cut"},
           {R"({"workpiece":5})", "an object"},
           {R"({"workpiece":{"bounds":{"min":[0,0,0]}}})", "max is missing"},
           {R"({"workpiece":{"bounds":{"min":[0,0],"max":[1,1,1]}}})", "three numbers"},
           {R"({"workpiece":{"bounds":{"min":[0,0,0],"max":[1,0,1]}}})", "must have an inside"},
           {R"({"workpiece":{"bounds":{"min":[0,0,0],"max":[1,1,2e6]}}})", "1e6"}}) {
    SCOPED_TRACE(text);
    expectRefused([&] { (void)parsed(text); }, says);
  }
}

TEST(ToolsFile, ProjectsOfOthersAreRead) {
  const std::filesystem::path folder = std::filesystem::path(RESTROKE_SHARED_DIR) / "data" / "toolpaths";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "the shared tool paths are not here: " << folder;
  const ToolsFile wave = readToolsFile(folder / "wave.camotics");
  EXPECT_EQ(numbersOf(wave), "1, 2 and 3");
  EXPECT_EQ(selectedTool(wave, 3).cutter->kind, Cutter::Kind::Ball);
  EXPECT_EQ(wave.workpiece->max, Point(97.5f, 97.5f, 0));
  const ToolsFile scorpion = readToolsFile(folder / "scorpion.camotics");
  EXPECT_EQ(selectedTool(scorpion, 1).cutter->radius, 0.5);
}

}  // namespace
}  // namespace restroke::sculpt
