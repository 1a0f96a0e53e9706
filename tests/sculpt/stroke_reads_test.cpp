#include "sculpt/stroke_reads.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "sculpt/brush.h"
#include "tests/sculpt/test_commands.h"
#include "tests/support/brute_force.h"

namespace restroke::sculpt {
namespace {

using restroke::testing::Random;

TEST(ChangedPlaces, TheBallAroundHoldsEveryBall) {
  Random random{31};
  for (int round = 0; round < 500; ++round) {
    ChangedPlaces changes;
    EXPECT_TRUE(changes.empty());
    const auto count = 1 + random.below(6);
    for (std::size_t i = 0; i < count; ++i)
      changes.add({random.inCube(round % 2 == 0 ? 1 : 0.1f), random.between(0.01f, 1.5f)});
    for (const implicit::Sphere& ball : changes.balls())
      EXPECT_LE(
          length(DVec3(ball.center) - DVec3(changes.around().center)) + static_cast<double>(ball.radius),
          static_cast<double>(changes.around().radius) * (1 + 1e-6));
  }
}

StrokeReads readsOf(const StrokeCommand& command, const points::SurfelModel& model) {
  const auto caster = retarget::makeCaster(command.method, model, command.stroke.camera);
  ReadingCaster reading(*caster);
  (void)stampsAlong(command.stroke, command.brush, 0x1p-16f, reading);
  return reading.take();
}

points::SurfelModel unitSphere() {
  points::SurfelModel model({.density = 300});
  const implicit::Primitive base{implicit::Sphere{}, implicit::Sign::Positive};
  model.append({&base, 1});
  return model;
}

bool isTouched(const StrokeReads& reads, const implicit::Sphere& ball) {
  StrokeReads copy = reads;
  std::array<ChangedPlaces, 1> changes;
  changes[0].add(ball);
  return copy.touchedBy(changes);
}

// The oracle: a ball in the way of a ray, up to where it ends. Whatever it says is said; a little more may
// be.
TEST(StrokeReads, SayWhatLiesBetweenTheCameraAndTheHits) {
  const points::SurfelModel model = unitSphere();
  const StrokeCommand command = line(30);
  const StrokeReads reads = readsOf(command, model);
  const auto caster = retarget::makeCaster(command.method, model, command.stroke.camera);
  Random random{32};
  int touched = 0, said = 0;
  for (int i = 0; i < 2000; ++i) {
    const implicit::Sphere ball{Point(0, -0.15f, 1) + random.inCube(0.5f), random.between(0.01f, 0.1f)};
    bool truly = false;
    for (const retarget::StrokePoint& point : command.stroke.points) {
      const Ray ray = rayThrough(command.stroke.camera, point.screen);
      const auto hit = caster->cast(point.screen);
      const DVec3 end = hit ? DVec3(hit->position) : ray.at(ray.tMax), along = end - ray.origin;
      const double t = std::clamp(dot(DVec3(ball.center) - ray.origin, along) / dot(along, along), 0.0, 1.0);
      truly =
          truly || length(DVec3(ball.center) - ray.origin - t * along) <= static_cast<double>(ball.radius);
    }
    const bool is = isTouched(reads, ball);
    EXPECT_TRUE(is || !truly) << i;
    touched += truly ? 1 : 0;
    said += is ? 1 : 0;
  }
  EXPECT_GT(touched, 50);
  EXPECT_LT(said, 3 * touched);
}

TEST(StrokeReads, ABallBehindTheHitsOrBehindTheCameraIsNotRead) {
  const points::SurfelModel model = unitSphere();
  const StrokeReads reads = readsOf(line(0), model);
  EXPECT_TRUE(isTouched(reads, {{0, 0, 1}, 0.01f}));
  EXPECT_TRUE(isTouched(reads, {{0, 0, 2}, 0.01f}));
  EXPECT_FALSE(isTouched(reads, {{0, 0, 0}, 0.5f}));
  EXPECT_FALSE(isTouched(reads, {{0, 0, 6}, 0.5f}));
  EXPECT_FALSE(isTouched(reads, {{0, 0.3f, 1}, 0.1f}));
  // A stroke that misses reads to the end of what the camera sees.
  const StrokeReads missed = readsOf(miss(), model);
  EXPECT_FALSE(isTouched(missed, {{0, 0, 0}, 0.5f}));
  const Ray ray = rayThrough(miss().stroke.camera, miss().stroke.points[3].screen);
  EXPECT_TRUE(isTouched(missed, {Point(ray.at(0.9 * ray.tMax)), 0.1f}));
}

// Where a stroke is touched in one place, the rest is not cast anew, and the outcome is the same.
TEST(ReadingCaster, OnlyWhatWasTouchedIsCastAnew) {
  points::SurfelModel model = unitSphere();
  const StrokeCommand command = line(0);
  StrokeReads reads = readsOf(command, model);
  const implicit::Primitive bump{implicit::Sphere{{0.3f, 0, 0.95f}, 0.08f}, implicit::Sign::Positive};
  model.append({&bump, 1});
  std::array<ChangedPlaces, 1> changes;
  changes[0].add(bump.shape.ball());
  ASSERT_TRUE(reads.touchedBy(changes));
  const auto caster = retarget::makeCaster(command.method, model, command.stroke.camera);
  ReadingCaster again(*caster, &reads);
  const StrokeOutcome outcome = stampsAlong(command.stroke, command.brush, 0x1p-16f, again);
  ReadingCaster whole(*caster);
  EXPECT_EQ(outcome, stampsAlong(command.stroke, command.brush, 0x1p-16f, whole));
  EXPECT_GT(again.castAnew(), 0u);
  EXPECT_LT(3 * again.castAnew(), whole.castAnew());
}

}  // namespace
}  // namespace restroke::sculpt
