// Paths given as poses (R8).

#include "points/dexel/toolpath/pose_path.h"

#include <gtest/gtest.h>

#include <string>

#include "implicit/errors.h"

namespace restroke::points {
namespace {

constexpr std::array<double, 9> kUpright{1, 0, 0, 0, 1, 0, 0, 0, 1}, kOver{1, 0, 0, 0, 0, -1, 0, 1, 0};

PoseMatrix poseOf(const std::array<double, 9>& m, DVec3 tip) {
  return {m[0], m[1], m[2], tip.x, m[3], m[4], m[5], tip.y, m[6], m[7], m[8], tip.z, 0, 0, 0, 1};
}

TEST(PosePath, SweepsFromPoseToPose) {
  const PosePath path = posePathOf({poseOf(kUpright, {0, 0, 0}), poseOf(kUpright, {1, 0, 0}),
                                    poseOf(kUpright, {1, 0, 0}), poseOf(kUpright, {1, 2, 3})});
  ASSERT_EQ(path.steps.size(), 2u);
  EXPECT_EQ(path.steps[0].element, (PathElement{.from = {0, 0, 0}, .to = {1, 0, 0}}));
  EXPECT_EQ(path.steps[1].element, (PathElement{.from = {1, 0, 0}, .to = {1, 2, 3}}));
  EXPECT_EQ(path.still, 1u);
  EXPECT_EQ(path.turns, 0u);
  ASSERT_EQ(path.orientations.size(), 1u);
  EXPECT_EQ(path.orientations[0], kUpright);
}

TEST(PosePath, OnePoseIsAPlaceAndNoneIsNoPath) {
  EXPECT_TRUE(posePathOf({}).steps.empty());
  for (const std::size_t count : {1u, 2u}) {
    const PosePath path = posePathOf(std::vector<PoseMatrix>(count, poseOf(kOver, {4, 5, 6})));
    ASSERT_EQ(path.steps.size(), 1u);
    EXPECT_EQ(path.steps[0].element, (PathElement{.from = {4, 5, 6}, .to = {4, 5, 6}}));
    EXPECT_EQ(path.orientations[path.steps[0].orientation], kOver);
    EXPECT_EQ(path.still, count - 1);
  }
}

TEST(PosePath, WhereItTurnsItIsPlacedWithoutASweep) {
  const PosePath path =
      posePathOf({poseOf(kUpright, {0, 0, 0}), poseOf(kUpright, {1, 0, 0}), poseOf(kOver, {2, 0, 0}),
                  poseOf(kUpright, {3, 0, 0}), poseOf(kUpright, {4, 0, 0}), poseOf(kOver, {5, 0, 0})});
  ASSERT_EQ(path.steps.size(), 4u);
  EXPECT_EQ(path.steps[0], (PosePath::Step{{.from = {0, 0, 0}, .to = {1, 0, 0}}, 0}));
  EXPECT_EQ(path.steps[1], (PosePath::Step{{.from = {2, 0, 0}, .to = {2, 0, 0}}, 1}));
  EXPECT_EQ(path.steps[2], (PosePath::Step{{.from = {3, 0, 0}, .to = {4, 0, 0}}, 0}));
  EXPECT_EQ(path.steps[3], (PosePath::Step{{.from = {5, 0, 0}, .to = {5, 0, 0}}, 1}));
  EXPECT_EQ(path.turns, 3u);
  EXPECT_EQ(path.orientations.size(), 2u);
}

TEST(PosePath, FewDigitsAreNoTurn) {
  std::array<double, 9> nearly = kUpright;
  nearly[1] = 4e-7;
  const PosePath path = posePathOf({poseOf(kUpright, {0, 0, 0}), poseOf(nearly, {1, 0, 0})});
  ASSERT_EQ(path.steps.size(), 1u);
  EXPECT_EQ(path.turns, 0u);
}

TEST(PosePath, PosesThatScaleAreRefused) {
  try {
    (void)posePathOf({poseOf(kUpright, {0, 0, 0}), poseOf({2, 0, 0, 0, 2, 0, 0, 0, 2}, {0, 0, 0})});
    ADD_FAILURE() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("pose 2 scales by 2"), std::string::npos) << error.what();
  }
}

TEST(PosePath, FilesAreToldApartByTheirFirstWord) {
  for (const char* poses : {"1 0 0 0", "# G1 X1\n\n  -1 0 0", "+.5", ".5 0"})
    EXPECT_TRUE(looksLikePoses(poses)) << poses;
  for (const char* gcode : {"G1 X1", "; 1 2\nT1", "%\n", "(1 2)\nG0", "", "# nothing\n", "N1 G1", "/1"})
    EXPECT_FALSE(looksLikePoses(gcode)) << gcode;
}

}  // namespace
}  // namespace restroke::points
