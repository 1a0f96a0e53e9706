// Brushes whose tip is any volume, and strokes that sweep (SPEC S13).

#include <gtest/gtest.h>

#include <cmath>

#include "implicit/errors.h"
#include "implicit/side.h"
#include "points/surfel_model.h"
#include "sculpt/brush.h"
#include "sculpt/stroke_log.h"
#include "tests/sculpt/test_commands.h"
#include "tests/support/random_volumes.h"

namespace restroke::sculpt {
namespace {

using implicit::Primitive;
using implicit::Sign;
using restroke::testing::Random;

/// The unit sphere with a wavy stroke over it, stamped or swept.
struct Drawn {
  retarget::Stroke stroke;
  Brush brush;
  StrokeOutcome outcome;
  std::vector<Primitive> primitives;
};
Drawn draw(Brush brush, int points = 60) {
  Drawn drawn;
  drawn.brush = std::move(brush);
  for (int i = 0; i < points; ++i) {
    const double s = static_cast<double>(i) / (points - 1);
    drawn.stroke.points.push_back({{static_cast<std::int32_t>((440 + 400 * s) * kSubPixels),
                                    static_cast<std::int32_t>((360 + 60 * std::sin(7 * s)) * kSubPixels)},
                                   static_cast<std::uint32_t>(10 * i),
                                   static_cast<std::uint16_t>(400 + 600 * s)});
  }
  points::SurfelModel model({.density = 100});
  model.append(std::vector<Primitive>{{implicit::Shape(), Sign::Positive}});
  const auto caster = retarget::makeCaster(retarget::Method::Exact, model, drawn.stroke.camera);
  drawn.outcome = stampsAlong(drawn.stroke, drawn.brush, 0x1p-16f, *caster);
  drawn.primitives = primitivesOf(drawn.outcome, drawn.brush);
  return drawn;
}

TEST(Tip, S13StandsOnTheSurfaceAndPointsAlongTheStroke) {
  const auto tip = implicit::volumeKindNamed("box").make({{{1}, {0.5f}, {0.25f}, {0}}});
  const Drawn drawn = draw({.radius = 0.05f, .tip = tip});
  ASSERT_GT(drawn.primitives.size(), 20u);
  ASSERT_EQ(drawn.primitives.size(), drawn.outcome.stamps.size());
  for (std::size_t i = 0; i < drawn.primitives.size(); ++i) {
    const implicit::PosedVolume* volume = drawn.primitives[i].shape.volume();
    ASSERT_NE(volume, nullptr);
    EXPECT_EQ(&volume->volume(), tip.get());
    EXPECT_EQ(volume->pose().scale, 0.05f);
    const DVec3 at(volume->pose().position);
    const DVec3 up = volume->toModel({0, 0, 1}) - volume->toModel({0, 0, 0});
    const DVec3 ahead = volume->toModel({1, 0, 0}) - volume->toModel({0, 0, 0});
    EXPECT_GT(dot(up, normalized(at)) / length(up), 0.9995);  // on a sphere the normal is the place
    if (i + 1 < drawn.primitives.size()) {
      const DVec3 step = DVec3(drawn.outcome.stamps[i + 1].center) - DVec3(drawn.outcome.stamps[i].center);
      EXPECT_GT(dot(ahead, step), 0.9 * length(ahead) * length(step)) << i;
    }
  }
}

TEST(Tip, ASingleStampPointsToTheCamerasRight) {
  const auto tip = implicit::volumeKindNamed("box").make({{{1}, {0.5f}, {0.25f}, {0}}});
  const Drawn drawn = draw({.radius = 0.05f, .tip = tip}, 2);
  retarget::Stroke one = drawn.stroke;
  one.points = {{{640 * kSubPixels, 360 * kSubPixels}, 0, 1023}};
  points::SurfelModel model({.density = 100});
  model.append(std::vector<Primitive>{{implicit::Shape(), Sign::Positive}});
  const auto caster = retarget::makeCaster(retarget::Method::Exact, model, one.camera);
  const auto primitives = primitivesOf(stampsAlong(one, drawn.brush, 0x1p-16f, *caster), drawn.brush);
  ASSERT_EQ(primitives.size(), 1u);
  const auto& volume = *primitives[0].shape.volume();
  const DVec3 ahead = normalized(volume.toModel({1, 0, 0}) - volume.toModel({0, 0, 0}));
  EXPECT_NEAR(ahead.x, 1, 1e-6);
}

TEST(Sweep, S13HasTheSilhouetteOfDenseStampsWithFarFewerPrimitives) {
  for (const float effect : {0.0f, 0.7f}) {
    const Brush swept{.radius = 0.06f, .spacing = 0.02f, .pressureToRadius = effect, .trace = Trace::Sweep};
    const Drawn sweep = draw(swept);
    Brush dense = swept;
    dense.trace = Trace::Stamps;  // scallops of 5e-5 of the radius
    const Drawn stamps = draw(dense);
    Brush usual = dense;
    usual.spacing = 0.1f;  // scallops of 1e-3, about what can be seen
    EXPECT_GE(draw(usual).primitives.size(), 5 * sweep.primitives.size());
    // Every surface sample of either is within the bound of the other's surface: not inside it by more, nor
    // outside.
    const double bound = 2 * static_cast<double>(kSweepTolerance) * 0.06 + 1e-4;
    const auto inside = [&](const Drawn& drawn, Point p) {
      for (const Primitive& primitive : drawn.primitives)
        if (contains(primitive.shape, p)) return true;
      return false;
    };
    const auto compare = [&](const Drawn& a, const Drawn& b) {
      points::SurfelModel model({.density = 4000});
      model.append(a.primitives);
      std::size_t far = 0;
      for (const points::Surfel& s : model.surfels()) {
        const Vec3 off = static_cast<float>(bound) * s.normal;
        far += inside(b, s.position + off) || !inside(b, s.position - off);
      }
      // In a crease between bends the normal need not lead to the other surface.
      EXPECT_LE(far, model.surfelCount() / 100) << model.surfelCount();
    };
    compare(sweep, stamps);
    compare(stamps, sweep);
  }
}

TEST(Sweep, ALoneStampIsABallAndABallThatHoldsTheNextStaysOne) {
  const Brush brush{.radius = 0.05f, .trace = Trace::Sweep};
  StrokeOutcome outcome{{{.center = {0, 0, 0}, .radius = 0.05f}}, 0, 1};
  ASSERT_EQ(primitivesOf(outcome, brush).size(), 1u);
  EXPECT_TRUE(primitivesOf(outcome, brush)[0].shape.isSphere());
  outcome.stamps.push_back({.center = {0.01f, 0, 0}, .radius = 0.02f, .joined = true});
  ASSERT_EQ(primitivesOf(outcome, brush).size(), 1u);
  EXPECT_EQ(primitivesOf(outcome, brush)[0].shape, implicit::Shape({0, 0, 0}, 0.05f));
  outcome.stamps.push_back({.center = {0.2f, 0, 0}, .radius = 0.02f, .joined = true});
  const auto primitives = primitivesOf(outcome, brush);
  ASSERT_EQ(primitives.size(), 2u);
  EXPECT_TRUE(contains(primitives[1].shape, {0.1f, 0, 0}));
  outcome.stamps.push_back({.center = {0.2f, 0, 0}, .radius = 0.3f, .joined = true});
  EXPECT_EQ(primitivesOf(outcome, brush).back().shape, implicit::Shape({0.2f, 0, 0}, 0.3f));
  EXPECT_TRUE(primitivesOf({}, brush).empty());
}

TEST(Sweep, OnlyTheBallIsSwept) {
  const auto tip = implicit::volumeKindNamed("cylinder").make({{{1}, {0.5f}}});
  EXPECT_THROW(validate(Brush{.trace = Trace::Sweep, .tip = tip}, "here"), InputError);
}

// What a log says of a shape is the shape: as base, as tip, swept, and with a recorded outcome.
TEST(StrokeLog, S13RoundTripsEveryKindOfVolume) {
  TemporaryFolder folder;
  Random random(1);
  for (const implicit::VolumeKind* kind : implicit::volumeKinds())
    for (const implicit::VolumeParameters& parameters : kind->examples()) {
      SCOPED_TRACE(kind->name);
      StrokeLog log;
      const auto volume = kind->make(parameters);
      log.header.base = restroke::testing::randomlyPosed(random, volume);
      Drawn drawn = draw({.radius = 0.05f, .tip = volume}, 5);
      StrokeCommand command{drawn.stroke, drawn.brush, retarget::Method::Exact, {}};
      log.commands.emplace_back(command);
      command.method = retarget::Method::Embree;
      command.outcome = drawn.outcome;
      log.commands.emplace_back(command);
      Drawn sweep = draw({.radius = 0.05f, .trace = Trace::Sweep}, 5);
      command = {sweep.stroke, sweep.brush, retarget::Method::Embree, sweep.outcome};
      log.commands.emplace_back(command);
      const auto file = folder / "a.log";
      writeLog(file, log);
      const StrokeLog read = readLog(file);
      EXPECT_EQ(read.header.base, log.header.base);
      ASSERT_EQ(read.commands.size(), log.commands.size());
      for (std::size_t i = 0; i < log.commands.size(); ++i) {
        const auto& a = std::get<StrokeCommand>(read.commands[i]);
        const auto& b = std::get<StrokeCommand>(log.commands[i]);
        EXPECT_EQ(a.brush, b.brush);
        EXPECT_EQ(a.outcome, b.outcome);
        EXPECT_EQ(primitivesOf(b.outcome.value_or(StrokeOutcome{}), a.brush),
                  primitivesOf(b.outcome.value_or(StrokeOutcome{}), b.brush));
      }
    }
}

}  // namespace
}  // namespace restroke::sculpt
