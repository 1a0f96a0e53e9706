// SPEC S7: `embree` and `exact` agree on every hit that both have; disagreements are counted.

#include "retarget/methods/embree.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <string>

#include "tests/retarget/test_shapes.h"
#include "tests/retarget/test_strokes.h"

namespace restroke::retarget {
namespace {

struct Comparison {
  std::size_t both = 0;        // hits of both
  std::size_t exactOnly = 0;   // hits of exact where embree misses
  std::size_t embreeOnly = 0;  // the reverse
  std::size_t different = 0;   // hits of both that are not equal
};

Comparison compare(const points::SurfelModel& model, const Camera& camera, std::int32_t step) {
  const auto screen = screenGrid(camera, step);
  const auto exact = castAll(*makeCaster(Method::Exact, model, camera), screen);
  const auto embree = castAll(*makeCaster(Method::Embree, model, camera), screen);
  Comparison c;
  for (std::size_t i = 0; i < screen.size(); ++i) {
    if (exact[i] && embree[i]) {
      ++c.both;
      if (exact[i] != embree[i]) ++c.different;
    } else if (exact[i]) {
      ++c.exactOnly;
    } else if (embree[i]) {
      ++c.embreeOnly;
    }
  }
  return c;
}

void print(const std::string& what, const Comparison& c) {
  std::printf("%-36s %7zu hits of both, %5zu of exact only, %zu of embree only, %zu different\n",
              what.c_str(), c.both, c.exactOnly, c.embreeOnly, c.different);
}

TEST(EmbreeMethod, HitsOfBothAreEqualBitForBitOnTheSphere) {
  for (const float density : {100.0f, 1000.0f, 10000.0f}) {
    const auto c = compare(sphereModel(density), smallCamera(), 17);
    print("sphere at density " + std::to_string(static_cast<int>(density)), c);
    EXPECT_GT(c.both, 25000u);
    EXPECT_EQ(c.different, 0u);
    EXPECT_EQ(c.embreeOnly, 0u) << "a disc without surface behind it must not be a hit";
    EXPECT_LT(static_cast<double>(c.exactOnly), 0.002 * static_cast<double>(c.both));
  }
}

TEST(EmbreeMethod, HitsOfBothAreEqualBitForBitOnAShapeOfBumpsAndHollows) {
  for (const float density : {2000.0f, 20000.0f}) {
    const auto c = compare(bumpyModel(density), smallCamera(), 17);
    print("bumps at density " + std::to_string(static_cast<int>(density)), c);
    EXPECT_GT(c.both, 25000u);
    EXPECT_EQ(c.different, 0u);
    EXPECT_EQ(c.embreeOnly, 0u);
    EXPECT_LT(static_cast<double>(c.exactOnly), 0.002 * static_cast<double>(c.both));
  }
}

TEST(EmbreeMethod, HitsOfBothAreEqualBitForBitOnTheShapeOfThePapersScale) {
  const auto file = sharedStampsFolder() / "paper-108x3426.stamps";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no shared data: " << file;
  points::SurfelModel model({.density = 14000});
  model.append(readStampFile(file));
  for (const Vec3 view : {Vec3(0, 0, -1), Vec3(1, -0.5f, 0.3f)}) {
    const implicit::Sphere ball = model.list().boundingSphere();
    const auto c = compare(
        model, frameSphere(ball.center, ball.radius, {.view = view, .width = 640, .height = 480}), 33);
    print("paper-108x3426 at density 14000", c);
    EXPECT_GT(c.both, 8000u);
    EXPECT_EQ(c.different, 0u);
    EXPECT_EQ(c.embreeOnly, 0u);
    EXPECT_LT(static_cast<double>(c.exactOnly), 0.002 * static_cast<double>(c.both));
  }
}

TEST(EmbreeMethod, SeesNothingFromWithinTheSolid) {
  // The far side's discs face away, and the ray never enters the shape.
  const auto model = sphereModel(5000);
  Camera camera = smallCamera();
  camera.position = {0, 0, 0.5f};
  const auto caster = makeCaster(Method::Embree, model, camera);
  for (const ScreenPoint p : screenGrid(camera, 97)) EXPECT_FALSE(caster->cast(p));
}

TEST(EmbreeMethod, SeesTheBallBehindTheOneThatItStartsIn) {
  auto model = sphereModel(5000);
  const implicit::Primitive behind{{{0, 0, -3}, 1}, implicit::Sign::Positive};
  model.append({&behind, 1});
  Camera camera = smallCamera();
  camera.position = {0, 0, 0};
  const auto hit = makeCaster(Method::Embree, model, camera)->cast(ScreenPoint{2560, 1920});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(static_cast<double>(hit->position.z), -2, 1e-6);
}

TEST(EmbreeMethod, ADiscThatOverhangsASilhouetteIsPassedThrough) {
  // A coarse ball in front of a wall-like larger one: rays past its rim meet its discs, and must go on to the
  // wall.
  points::SurfelModel model({.density = 20});
  const std::vector<implicit::Primitive> balls{{{{0, 0, -20}, 18}, implicit::Sign::Positive},
                                               {{{0, 0, 1}, 0.5f}, implicit::Sign::Positive}};
  model.append(balls);
  const auto c = compare(model, smallCamera(), 17);
  EXPECT_EQ(c.different, 0u);
  EXPECT_EQ(c.embreeOnly, 0u);
  EXPECT_EQ(c.exactOnly, 0u) << "behind every gap there is the wall";
}

}  // namespace
}  // namespace restroke::retarget
