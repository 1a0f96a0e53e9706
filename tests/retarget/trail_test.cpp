// The output stroke: what is kept of it, and where it is between two places.

#include "retarget/trail.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/retarget/test_shapes.h"
#include "tests/retarget/test_trails.h"

namespace restroke::retarget {
namespace {

TEST(TrailRecorder, KeepsEachPlaceOnceInOrderAndAnswersAsTheCaster) {
  const auto model = sphereModel(500);
  const auto caster = makeCaster(Method::Exact, model, smallCamera());
  TrailRecorder recorder(*caster);
  const ScreenPoint left{1900, 1920}, middle{2560, 1920}, off{0, 0};
  const std::vector<StrokePlace> asked{{middle, 2}, {left, 0}, {off, 3}, {middle, 2}, {left, 0.5}};
  for (const StrokePlace& place : asked) {
    EXPECT_EQ(recorder.cast(place), caster->cast(place));
    const auto read = recorder.readsAlong(place);
    ASSERT_TRUE(read);
    EXPECT_EQ(read->direction, caster->readsAlong(place)->direction);
  }
  const Trail trail = recorder.take();
  ASSERT_EQ(trail.points.size(), 4u);
  const std::vector<StrokePlace> expected{asked[1], asked[4], asked[0], asked[2]};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(trail.points[i].place, expected[i]);
    EXPECT_EQ(trail.points[i].hit, caster->cast(expected[i]));
  }
  EXPECT_TRUE(recorder.take().points.empty()) << "it was taken";
}

TEST(Trail, BetweenTwoHitsIsTheirMeanByNearness) {
  Trail trail;
  trail.points = {{{{0, 0}, 0}, SurfaceHit{{0, 0, 0}, {1, 0, 0}, implicit::PrimitiveId{7}}},
                  {{{160, 80}, 2}, SurfaceHit{{4, 2, 0}, {0, 1, 0}, implicit::PrimitiveId{9}}}};
  const auto quarter = trail.at(0.5), middle = trail.at(1), late = trail.at(1.5);
  ASSERT_TRUE(quarter && middle && late);
  EXPECT_EQ(quarter->place, StrokePlace({40, 20}, 0.5));
  EXPECT_EQ(quarter->hit->position, Point(1, 0.5f, 0));
  EXPECT_EQ(quarter->hit->primitive, implicit::PrimitiveId{7});
  EXPECT_EQ(late->hit->primitive, implicit::PrimitiveId{9});
  EXPECT_EQ(middle->hit->normal, Vec3(normalized(DVec3(1, 1, 0))));
  EXPECT_EQ(trail.at(2)->hit, trail.points[1].hit);
}

TEST(Trail, OfOppositeNormalsTheNearersIsKept) {
  Trail trail;
  trail.points = {{{{0, 0}, 0}, SurfaceHit{{0, 0, 0}, {1, 0, 0}}},
                  {{{0, 0}, 1}, SurfaceHit{{1, 0, 0}, {-1, 0, 0}}}};
  EXPECT_EQ(trail.at(0.5)->hit->normal, Vec3(1, 0, 0));
}

TEST(Trail, IsNowhereBesideAMissAndBeyondItsEnds) {
  Trail trail;
  EXPECT_FALSE(trail.at(0));
  trail.points = {{{{0, 0}, 1}, SurfaceHit{}}, {{{0, 0}, 2}, std::nullopt}, {{{0, 0}, 3}, SurfaceHit{}}};
  EXPECT_FALSE(trail.at(0));
  EXPECT_FALSE(trail.at(3.5));
  EXPECT_FALSE(trail.at(1.5));
  EXPECT_FALSE(trail.at(2.5));
  EXPECT_TRUE(trail.at(1)->hit);
  ASSERT_TRUE(trail.at(2));
  EXPECT_FALSE(trail.at(2)->hit);
}

}  // namespace
}  // namespace restroke::retarget
