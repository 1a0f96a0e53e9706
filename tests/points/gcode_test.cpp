// Programs of milling machines as paths (R8).

#include "points/dexel/toolpath/gcode.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "implicit/errors.h"
#include "tests/support/brute_force.h"
#include "tests/support/effort.h"

namespace restroke::points {
namespace {

using restroke::testing::Random;

GcodeProgram parsed(const std::string& text) {
  return parseGcode(text, "p.nc", {.tool = 1});
}
std::vector<GcodeElement> elementsOf(const std::string& text) {
  return parsed(text).elements;
}
// The last element of a program that begins at X0 Y0 Z0 with a feed move there.
PathElement lastOf(const std::string& text) {
  const auto elements = elementsOf("G1 Z0\n" + text);
  EXPECT_GE(elements.size(), 2u) << text;
  return elements.back().element;
}
void expectNear(DVec3 a, DVec3 b) {
  EXPECT_NEAR(a.x, b.x, 1e-12);
  EXPECT_NEAR(a.y, b.y, 1e-12);
  EXPECT_NEAR(a.z, b.z, 1e-12);
}
void expectRefused(const std::string& text, const std::string& says,
                   const GcodeOptions& options = {.tool = 1}) {
  try {
    (void)parseGcode(text, "p.nc", options);
    ADD_FAILURE() << "accepted: " << text;
  } catch (const InputError& error) {
    const std::string what = error.what();
    EXPECT_NE(what.find(says), std::string::npos) << text << ": " << what;
    EXPECT_EQ(what.rfind("p.nc: line ", 0), 0u) << what;
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
  }
}

TEST(Gcode, MovesGoOnFromWhereTheLastOneEnded) {
  const auto elements = elementsOf("G1 X1 Y2 Z-3 F100\nX4\nG0 Z5\nY0 X0\n");
  ASSERT_EQ(elements.size(), 4u);
  EXPECT_EQ(elements[0], (GcodeElement{{.from = {0, 0, 0}, .to = {1, 2, -3}}, 1, 1, false}));
  EXPECT_EQ(elements[1], (GcodeElement{{.from = {1, 2, -3}, .to = {4, 2, -3}}, 1, 2, false}));
  EXPECT_EQ(elements[2], (GcodeElement{{.from = {4, 2, -3}, .to = {4, 2, 5}}, 1, 3, true}));
  EXPECT_EQ(elements[3], (GcodeElement{{.from = {4, 2, 5}, .to = {0, 0, 5}}, 1, 4, true}));
}

TEST(Gcode, WordsMayBeSmallHaveBlanksNumbersAndComments) {
  const auto elements = elementsOf(
      "%\nN10 g0 1 x +0. 12 34 Y 7(there)z.5 ; on\n\n(G28 X0)\n/G28 X0\nN20 g1 x-1.\n; M30\nX 3\t\r\nX4 (up) "
      "Y5\n%\nG28\n");
  ASSERT_EQ(elements.size(), 4u);
  EXPECT_EQ(elements[0].element.to, DVec3(0.1234, 7, 0.5));
  EXPECT_EQ(elements[1].element.to, DVec3(-1, 7, 0.5));
  EXPECT_EQ(elements[2].element.to, DVec3(3, 7, 0.5));
  EXPECT_EQ(elements[3].element.to, DVec3(4, 5, 0.5));
  EXPECT_EQ(elements[3].line, 9u);
  EXPECT_TRUE(elementsOf("").empty());
  EXPECT_TRUE(elementsOf("%\n\nG21 G90 (nothing moves)\nM30\n").empty());
}

TEST(Gcode, UnitsAndPositionsCountFromTheirBlockOn) {
  const auto elements = elementsOf("G1 Z0 X1\nX1 Y0.5 G20 G91\nX-1\nG21 X2\nG90 X2\n");
  ASSERT_EQ(elements.size(), 5u);
  EXPECT_EQ(elements[1].element.to, DVec3(26.4, 12.7, 0));
  expectNear(elements[2].element.to, {1, 12.7, 0});
  expectNear(elements[3].element.to, {3, 12.7, 0});
  expectNear(elements[4].element.to, {2, 12.7, 0});
}

TEST(Gcode, TSelectsTheToolFromItsBlockOn) {
  const auto elements = parseGcode("M6 T3\nG1 Z-1\nX1 T12\nX2\nT3 M6\nX3\n", "p.nc").elements;
  ASSERT_EQ(elements.size(), 4u);
  EXPECT_EQ(elements[0].tool, 3u);
  EXPECT_EQ(elements[1].tool, 12u);
  EXPECT_EQ(elements[2].tool, 12u);
  EXPECT_EQ(elements[3].tool, 3u);
  expectRefused("G1 X1\n", "no T", {});
  expectRefused("T0\nG1 X1\n", "T0");
  expectRefused("T-1\n", "whole number");
  expectRefused("T1.5\n", "whole number");
  EXPECT_EQ(elementsOf("G1 X1\n").at(0).tool, 1u);
}

TEST(Gcode, RapidMovesThatBringTheToolCutNothing) {
  // Parked anywhere, it comes to X5 Y6 Z7: there it begins.
  auto program = parsed("G0 X5 Y6\nZ7\nG0 X0\nG1 Z0\n");
  ASSERT_EQ(program.elements.size(), 3u);
  EXPECT_EQ(program.approaches, 2u);
  EXPECT_EQ(program.elements[0].element, (PathElement{.from = {5, 6, 7}, .to = {5, 6, 7}}));
  EXPECT_EQ(program.elements[1].element, (PathElement{.from = {5, 6, 7}, .to = {0, 6, 7}}));
  EXPECT_TRUE(program.elements[1].isRapid);
  // A feed move ends that, whatever it says.
  program = parsed("G0 X5\nG1 Y1\nG0 Z5\n");
  ASSERT_EQ(program.elements.size(), 2u);
  EXPECT_EQ(program.elements[0].element, (PathElement{.from = {5, 0, 0}, .to = {5, 1, 0}}));
  EXPECT_EQ(program.elements[1].element, (PathElement{.from = {5, 1, 0}, .to = {5, 1, 5}}));
}

TEST(Gcode, MovesThatStayAreLeftOutButTheFirst) {
  const auto program = parsed("G1 X0\nX0 Y0\nX1\nX1\nG0 X1\n");
  ASSERT_EQ(program.elements.size(), 2u);
  EXPECT_EQ(program.still, 3u);
  EXPECT_EQ(program.elements[0].element.from, program.elements[0].element.to);
}

TEST(Gcode, M2AndM30EndTheProgramAfterTheirBlock) {
  for (const char* end : {"M2", "M30", "m02"}) {
    const auto elements = elementsOf(std::string("G1 X1\nX2 ") + end + "\nX3\nnot words at all\n");
    ASSERT_EQ(elements.size(), 2u);
    EXPECT_EQ(elements[1].element.to.x, 2);
  }
}

TEST(Gcode, ArcsByTheirCentre) {
  const PathElement quarter = lastOf("G1 X10\nG3 X0 Y10 I-10 J0\n");
  EXPECT_EQ(quarter, (PathElement{PathElement::Kind::Arc, {10, 0, 0}, {0, 10, 0}, {0, 0, 0}, 2, false}));
  // A whole turn, with and without its end, and again by its centre alone.
  for (const char* text : {"G2 X0 Y0 I3 J4\n", "G2 I3 J4\n", "G2 I3 J4\nI3 J4\n"}) {
    const PathElement whole = lastOf(text);
    EXPECT_EQ(whole.from, whole.to);
    EXPECT_EQ(whole.center, DVec3(3, 4, 0));
    EXPECT_TRUE(whole.clockwise);
    EXPECT_EQ(whole.kind, PathElement::Kind::Arc);
  }
  const PathElement helix = lastOf("G3 X0 Y0 Z-2 I5\n");
  EXPECT_EQ(helix.to, DVec3(0, 0, -2));
  EXPECT_EQ(helix.center, DVec3(5, 0, 0));
  // Inches; steps; other planes.
  expectNear(lastOf("G20 G2 X2 I1\n").center, {25.4, 0, 0});
  expectNear(lastOf("G1 X5 Y5\nG91 G2 X2 I1\n").center, {6, 5, 0});
  const PathElement xz = lastOf("G18 G2 X2 Z2 I2 K0\n");
  EXPECT_EQ(xz.axis, 1);
  EXPECT_EQ(xz.center, DVec3(2, 0, 0));
  const PathElement yz = lastOf("G19 G3 Y2 Z2 K2 P1\n");
  EXPECT_EQ(yz.axis, 0);
  EXPECT_EQ(yz.center, DVec3(0, 0, 2));
}

TEST(Gcode, ArcsByTheirRadius) {
  struct Case {
    const char* text;
    DVec3 center;
  };
  for (const Case& c : {Case{"G3 X10 Y10 R10\n", {0, 10, 0}}, Case{"G2 X10 Y10 R10\n", {10, 0, 0}},
                        Case{"G3 X10 Y10 R-10\n", {10, 0, 0}}, Case{"G2 X10 Y10 R-10\n", {0, 10, 0}},
                        Case{"G2 X10 R5\n", {5, 0, 0}}, Case{"G2 X10 R4.995\n", {5, 0, 0}},
                        Case{"G18 G2 X10 Z10 R10\n", {0, 0, 10}}, Case{"G19 G3 Y10 Z10 R10\n", {0, 0, 10}}}) {
    SCOPED_TRACE(c.text);
    expectNear(lastOf(c.text).center, c.center);
  }
}

TEST(Gcode, RandomArcsByRadiusAreThoseByCentre) {
  Random random(0x6001);
  RecordProperty("seed", "0x6001");
  for (int k = 0; k < 200; ++k) {
    SCOPED_TRACE(k);
    const double a = static_cast<double>(random.between(0, 6.2f)),
                 turn = static_cast<double>(random.between(0.1f, 6.1f)),
                 r = static_cast<double>(random.between(0.5f, 50));
    const bool clockwise = random.below(2) == 0;
    const double b = clockwise ? a - turn : a + turn;
    const double x = r * (std::cos(b) - std::cos(a)), y = r * (std::sin(b) - std::sin(a));
    const PathElement e = lastOf(fmt::format("G{} X{:.12f} Y{:.12f} R{:.12f}\n", clockwise ? 2 : 3, x, y,
                                             turn > 3.141592653589793 ? -r : r));
    EXPECT_NEAR(e.center.x, -r * std::cos(a), 1e-4);
    EXPECT_NEAR(e.center.y, -r * std::sin(a), 1e-4);
  }
}

TEST(Gcode, ArcsThatAreNoneAreRefused) {
  expectRefused("G1 Z0\nG2 X10 I4\n", "the distances must be the same");
  EXPECT_EQ(lastOf("G2 X10.02 I5\n").center, DVec3(5, 0, 0));
  expectRefused("G1 Z0\nG2 X10.06 I5\n", "begins 5 mm from its centre and ends 5.06 mm");
  EXPECT_EQ(lastOf("G2 X0.009 Y0 I0.004\n").center, DVec3(0.004, 0, 0));
  expectRefused("G2 X10\n", "no centre");
  expectRefused("G2 X10 I0 J0\n", "where it begins");
  expectRefused("G2 X10 K5\n", "across its plane");
  expectRefused("G18\nG2 X10 J5\n", "I and K");
  expectRefused("G2 X10 I5 R5\n", "one of them");
  expectRefused("G2 X10 R4.9\n", "at least half");
  expectRefused("G2 X10 R0\n", "at least half");
  expectRefused("G2 X0 Y0 R5\n", "ends where it begins");
  expectRefused("G2 R5\n", "ends where it begins");
  expectRefused("G2\n", "neither");
  expectRefused("G2 X10 I5 P2\n", "several turns");
  expectRefused("G2 X10 I1e\n", "letter E");
  expectRefused("G2 X10 R9e9\n", "letter E");
  expectRefused("G2 X10 R9000000\n", "radius");
  expectRefused("G2 X10 J9000000\n", "radius");
  expectRefused("G1 X10 I5\n", "only arcs");
  expectRefused("I5\n", "only arcs");
}

TEST(Gcode, WhatMovesNothingIsPassedOver) {
  const auto elements = elementsOf(
      "G17 G21 G40 G49 G54 G61 G80 G90 G94\nG64 P0.01\nG91.1\nM3 S1000 F20\nM6 T1 G43 H1 D2\nG4 P1.5\nM0 M8 "
      "M9\nG1 X1 G95 F.2\n"
      "G4 P2\nX2\nG61.1 G96 G98\nM5\n");
  ASSERT_EQ(elements.size(), 2u);
  EXPECT_EQ(elements[1].element.to.x, 2);
}

TEST(Gcode, WhatWouldMoveOrIsNotKnownIsRefusedWithItsLine) {
  expectRefused("G1 X1\n\nG28 Z0\n", "line 3: G28");
  for (const char* word : {"G10 L2 P1 X1",
                           "G28",
                           "G28.1",
                           "G30",
                           "G41 D1",
                           "G42",
                           "G43.1 Z1",
                           "G52 X1",
                           "G53 G0 X1",
                           "G55",
                           "G59.3",
                           "G92 X0",
                           "G92.1",
                           "G5 X1",
                           "G5.1",
                           "G33 Z1 K1",
                           "G38.2 Z1",
                           "G73",
                           "G76",
                           "G81 X1 Z-1 R1",
                           "G83",
                           "G89",
                           "G90.1",
                           "G68",
                           "G51",
                           "G7",
                           "G999",
                           "G1.5",
                           "G-1",
                           "G0.05",
                           "G100",
                           "M98 P100",
                           "M99",
                           "A90",
                           "B1",
                           "C1",
                           "U1",
                           "V1",
                           "W1",
                           "E5",
                           "O100",
                           "#1=5",
                           "X#1",
                           "X[1+2]",
                           "X1*20",
                           "X",
                           "G",
                           "X--1",
                           "X1.2.3",
                           "X.",
                           "Xnan",
                           "X1 X2",
                           "G0 G1 X1",
                           "G17 G18",
                           "G20 G21",
                           "G90 G91",
                           "T1 T2",
                           "I1 I2",
                           "R1 R2",
                           "(open",
                           "1",
                           ")",
                           "=",
                           "X1\x01",
                           "\xc3\xa9"})
    expectRefused(std::string("G1\n") + word + "\n", "line 2: ");
  expectRefused("X1\n", "motion");
  expectRefused("G1 X1\nG80\nX2\n", "line 3: there is X, Y or Z, but no motion");
  expectRefused("G1 X2000000\n", "within +-1e+06");
  expectRefused("G1 X" + std::string(400, '9') + "\n", "followed by a number");
  expectRefused("G4 X5\n", "dwell");
}

TEST(Gcode, AnyBytesAreAPathOrASentence) {
  Random random(0x6002);
  RecordProperty("seed", "0x6002");
  const std::string letters = "GXYZIJKRTMNFP0123456789.-+ \n();%/#G1G2G3";
  int paths = 0;
  for (int k = 0; k < (restroke::testing::kSanitized ? 500 : 20000); ++k) {
    std::string text;
    for (std::size_t i = random.below(40); i > 0; --i)
      text += random.below(20) == 0 ? static_cast<char>(random.below(256))
                                    : letters[random.below(letters.size())];
    try {
      (void)parsed(text);
      ++paths;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
  EXPECT_GT(paths, 10);
}

TEST(Gcode, ProgramsOfOthersAreRead) {
  const std::filesystem::path folder = std::filesystem::path(RESTROKE_SHARED_DIR) / "data" / "toolpaths";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "the shared tool paths are not here: " << folder;
  const GcodeProgram wave = readGcode(folder / "wave.gcode");
  std::size_t feeds = 0;
  for (const GcodeElement& e : wave.elements) {
    EXPECT_EQ(e.tool, 3u);
    feeds += e.isRapid ? 0 : 1;
  }
  EXPECT_EQ(feeds, 1151u);
  EXPECT_EQ(wave.elements.front().element, (PathElement{.from = {0, 0, 3}, .to = {0, 0, 3}}));
  const GcodeProgram scorpion = readGcode(folder / "scorpion.nc");
  feeds = 0;
  for (const GcodeElement& e : scorpion.elements) feeds += e.isRapid ? 0 : 1;
  EXPECT_EQ(feeds, 266u);
}

}  // namespace
}  // namespace restroke::points
