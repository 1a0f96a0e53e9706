#include "retarget/stroke.h"

#include <gtest/gtest.h>

#include <string>

#include "implicit/errors.h"

namespace restroke::retarget {
namespace {

Stroke typicalStroke() {
  return {.camera = {}, .points = {{{16, 32}, 0, 100}, {{20, 30}, 8, 200}, {{20, 30}, 8, 1023}}};
}

std::string sentenceOf(const Stroke& stroke) {
  try {
    validate(stroke, "line 7");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Stroke, TypicalOneIsValid) {
  EXPECT_EQ(sentenceOf(typicalStroke()), "");
}

TEST(Stroke, OnePointAndEqualPointsAreValid) {
  EXPECT_EQ(sentenceOf({.camera = {}, .points = {{}}}), "");
  EXPECT_EQ(sentenceOf({.camera = {}, .points = {{}, {}, {}}}), "");
}

TEST(Stroke, ExtremesOfEveryRangeAreValid) {
  const Stroke stroke{
      .camera = {},
      .points = {{{-kMaxScreen, kMaxScreen}, 0, 0}, {{kMaxScreen, -kMaxScreen}, kMaxTime, kMaxPressure}}};
  EXPECT_EQ(sentenceOf(stroke), "");
}

TEST(Stroke, WithoutPointsIsRejected) {
  EXPECT_EQ(sentenceOf({}), "line 7: the stroke has no points; it must have at least one");
}

TEST(Stroke, EveryRangeIsChecked) {
  const auto rejected = [](auto change, const std::string& word) {
    Stroke stroke = typicalStroke();
    change(stroke);
    const std::string sentence = sentenceOf(stroke);
    EXPECT_EQ(sentence.rfind("line 7", 0), 0u) << sentence;
    EXPECT_NE(sentence.find(word), std::string::npos) << sentence;
  };
  rejected([](Stroke& s) { s.points[1].screen.x = kMaxScreen + 1; }, "point 1");
  rejected([](Stroke& s) { s.points[1].screen.y = -kMaxScreen - 1; }, "point 1");
  rejected([](Stroke& s) { s.points[2].time = kMaxTime + 1; }, "point 2");
  rejected([](Stroke& s) { s.points[2].time = 7; }, "never decrease");
  rejected([](Stroke& s) { s.points[0].time = 1; }, "first point");
  rejected([](Stroke& s) { s.points[2].pressure = kMaxPressure + 1; }, "pressure");
  rejected([](Stroke& s) { s.camera.halfHeight = 0; }, "line 7");
  rejected([](Stroke& s) { s.camera.width = 0; }, "line 7");
}

}  // namespace
}  // namespace restroke::retarget
