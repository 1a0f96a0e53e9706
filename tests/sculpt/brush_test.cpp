#include "sculpt/brush.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "implicit/errors.h"
#include "implicit/geometry/camera.h"

namespace restroke::sculpt {
namespace {

using retarget::Stroke;
using retarget::StrokePoint;
using retarget::SurfaceHit;

constexpr float kGrid = 0x1p-16f;
// Half the diagonal of a cell of the grid: how far rounding moves a centre at most.
constexpr double kRounding = 0.87 * 0x1p-16;

/// A surface given as a function of the ray; counts its casts.
class FunctionCaster final : public retarget::Caster {
 public:
  using Surface = std::function<std::optional<DVec3>(const Ray&, ScreenPoint)>;
  FunctionCaster(const Camera& camera, Surface surface) : camera_(camera), surface_(std::move(surface)) {}
  std::optional<SurfaceHit> cast(const retarget::StrokePlace& place) override {
    ++casts;
    const auto hit = surface_(rayThrough(camera_, place.screen), place.screen);
    if (!hit) return std::nullopt;
    return SurfaceHit{Point(*hit), {0, 0, 1}};
  }
  std::size_t casts = 0;

 private:
  Camera camera_;
  Surface surface_;
};

/// The default camera looks along -z from (0, 0, 4); a pixel at z = 0 is 1/300 wide.
constexpr double kPixel = 4 * 2 * 0.3 / 720;

std::optional<DVec3> plane(const Ray& ray, double z) {
  return ray.at((ray.origin.z - z) / -ray.direction.z);
}
std::optional<DVec3> onPlane(const Ray& ray, ScreenPoint) {
  return plane(ray, 0);
}

std::optional<DVec3> onUnitSphere(const Ray& ray, ScreenPoint) {
  const double dd = dot(ray.direction, ray.direction), od = dot(ray.origin, ray.direction);
  const double discriminant = od * od - dd * (dot(ray.origin, ray.origin) - 1);
  if (discriminant <= 0) return std::nullopt;
  return ray.at((-od - std::sqrt(discriminant)) / dd);
}

StrokePoint pixel(double x, double y, int pressure = retarget::kMaxPressure) {
  return {{static_cast<std::int32_t>(std::lround(x * kSubPixels)),
           static_cast<std::int32_t>(std::lround(y * kSubPixels))},
          0,
          static_cast<std::uint16_t>(pressure)};
}

StrokeOutcome stamped(std::vector<StrokePoint> points, const Brush& brush,
                      FunctionCaster::Surface surface = onPlane) {
  FunctionCaster caster({}, std::move(surface));
  return stampsAlong({.camera = {}, .points = std::move(points)}, brush, kGrid, caster);
}

double gap(const StrokeOutcome& outcome, std::size_t i) {
  return length(DVec3(outcome.stamps[i + 1].center) - DVec3(outcome.stamps[i].center));
}

TEST(Brush, StampsOnAPlaneAreEvenlySpaced) {
  const auto outcome = stamped({pixel(340, 360), pixel(941, 360)}, {});
  // 600 pixels are 2 units, and one for rounding; a stamp every 0.0125, the first at the start.
  EXPECT_EQ(outcome.stamps.size(), 161u);
  EXPECT_EQ(outcome.pieces, 1u);
  EXPECT_EQ(outcome.misses, 0u);
  for (std::size_t i = 0; i + 1 < outcome.stamps.size(); ++i)
    EXPECT_NEAR(gap(outcome, i), 0.0125, 2 * kRounding);
  for (const auto& stamp : outcome.stamps) EXPECT_EQ(stamp.radius, 0.05f);
}

TEST(Brush, SignFollowsTheMode) {
  for (const Mode mode : {Mode::Add, Mode::Carve}) {
    const Brush brush{.mode = mode};
    const auto primitives = primitivesOf(stamped({pixel(600, 360), pixel(640, 360)}, brush), brush);
    ASSERT_GT(primitives.size(), 3u);
    for (const auto& primitive : primitives)
      EXPECT_EQ(primitive.sign, mode == Mode::Add ? implicit::Sign::Positive : implicit::Sign::Negative);
  }
}

TEST(Brush, OnePointMakesOneStamp) {
  const auto outcome = stamped({pixel(640, 360)}, {});
  ASSERT_EQ(outcome.stamps.size(), 1u);
  EXPECT_EQ(outcome.pieces, 1u);
  EXPECT_EQ(outcome.stamps[0].center, Point(0));
}

TEST(Brush, EqualPointsMakeOneStampAndOneCast) {
  FunctionCaster caster({}, onPlane);
  const Stroke stroke{.camera = {}, .points = {pixel(640, 360), pixel(640, 360), pixel(640, 360, 5)}};
  const auto outcome = stampsAlong(stroke, {.pressureToRadius = 1}, kGrid, caster);
  EXPECT_EQ(outcome.stamps.size(), 1u);
  EXPECT_EQ(outcome.pieces, 1u);
  EXPECT_EQ(caster.casts, 1u);
}

TEST(Brush, RepeatedPointsAlongAStrokeChangeNothing) {
  const auto once = stamped({pixel(600, 360), pixel(640, 380), pixel(700, 300)}, {});
  const auto often = stamped({pixel(600, 360), pixel(600, 360), pixel(640, 380), pixel(640, 380),
                              pixel(640, 380), pixel(700, 300), pixel(700, 300)},
                             {});
  EXPECT_EQ(once, often);
}

TEST(Brush, StrokeThatMissesEverywhereAddsNothing) {
  const auto outcome = stamped({pixel(1, 1), pixel(40, 1), pixel(40, 1)}, {}, onUnitSphere);
  EXPECT_TRUE(outcome.stamps.empty());
  EXPECT_EQ(outcome.pieces, 0u);
  EXPECT_EQ(outcome.misses, 3u) << "each input point counts, also a repeated one, and no point in between";
}

TEST(Brush, NumberOfStampsDoesNotDependOnTheSampleRate) {
  // A spiral over the sphere's front, drawn with 40 to 4,000 points.
  const auto curve = [](std::size_t count) {
    std::vector<StrokePoint> points;
    for (std::size_t i = 0; i < count; ++i) {
      const double s = static_cast<double>(i) / static_cast<double>(count - 1), angle = 4 * s,
                   r = 40 + 180 * s;
      points.push_back(pixel(640 + r * std::cos(angle), 360 + r * std::sin(angle)));
    }
    return points;
  };
  const auto reference = stamped(curve(400), {}, onUnitSphere);
  ASSERT_GT(reference.stamps.size(), 100u);
  for (const std::size_t count :
       {std::size_t{100}, std::size_t{1000}, std::size_t{4000}, std::size_t{40000}}) {
    const auto outcome = stamped(curve(count), {}, onUnitSphere);
    EXPECT_NEAR(static_cast<double>(outcome.stamps.size()), static_cast<double>(reference.stamps.size()), 1)
        << count;
    EXPECT_EQ(outcome.pieces, 1u);
    for (std::size_t i = 0; i + 1 < outcome.stamps.size(); ++i) {
      // Length is measured along the polyline of hits: a chord over a bend is a little shorter, never longer.
      EXPECT_GT(gap(outcome, i), 0.0125 * 0.95) << count << " points, stamp " << i;
      EXPECT_LT(gap(outcome, i), 0.0125 + 2 * kRounding) << count << " points, stamp " << i;
    }
  }
}

TEST(Brush, TwoFarPointsFollowTheSurfaceBetweenThem) {
  // The straight line of the screen becomes an arc over the sphere: stamps must not lie on the chord through
  // it.
  const Brush brush{.radius = 0.05f, .spacing = 0.25f};
  const auto outcome = stamped({pixel(440, 300), pixel(840, 420)}, brush, onUnitSphere);
  EXPECT_EQ(outcome.pieces, 1u);
  ASSERT_GT(outcome.stamps.size(), 90u);
  const double chord = 0.0125;
  for (const auto& stamp : outcome.stamps)
    EXPECT_NEAR(length(DVec3(stamp.center)), 1, chord * chord / 8 + kRounding + 1e-7);
}

TEST(Brush, WideSpacingStillFollowsTheSurface) {
  const auto outcome =
      stamped({pixel(400, 300), pixel(880, 420)}, {.radius = 0.1f, .spacing = 4}, onUnitSphere);
  ASSERT_EQ(outcome.stamps.size(), 4u);
  for (const auto& stamp : outcome.stamps)
    EXPECT_NEAR(length(DVec3(stamp.center)), 1, 0.05 * 0.05 / 8 + kRounding + 1e-7);
  for (std::size_t i = 0; i + 1 < outcome.stamps.size(); ++i) EXPECT_NEAR(gap(outcome, i), 0.4, 0.01);
}

TEST(Brush, MissesSplitTheStrokeAndItsPiecesReachTheEdge) {
  // A band without surface between the pixels 600 and 700.
  const auto bands = [](const Ray& ray, ScreenPoint p) -> std::optional<DVec3> {
    if (p.x > 600 * kSubPixels && p.x < 700 * kSubPixels) return std::nullopt;
    return plane(ray, 0);
  };
  const Brush fine{.radius = 0.01f};
  const double pitch = 0.0025;
  const auto checkEdges = [&](const StrokeOutcome& outcome) {
    EXPECT_EQ(outcome.pieces, 2u);
    std::size_t last = 0;
    while (last + 1 < outcome.stamps.size() && gap(outcome, last) < 2 * pitch) ++last;
    ASSERT_LT(last + 1, outcome.stamps.size());
    const double left = (600 - 640) * kPixel, right = (700 - 640) * kPixel;
    EXPECT_LE(static_cast<double>(outcome.stamps[last].center.x), left + kRounding);
    EXPECT_GT(static_cast<double>(outcome.stamps[last].center.x), left - kPixel - pitch - kRounding);
    EXPECT_GE(static_cast<double>(outcome.stamps[last + 1].center.x), right - kRounding);
    EXPECT_LT(static_cast<double>(outcome.stamps[last + 1].center.x), right + kPixel + kRounding)
        << "a piece's first stamp stands where it begins";
  };
  const auto missed =
      stamped({pixel(500, 360), pixel(650, 360), pixel(651, 360), pixel(800, 360)}, fine, bands);
  EXPECT_EQ(missed.misses, 2u);
  checkEdges(missed);
  // No input point falls into the band: it splits the stroke all the same.
  const auto jumped = stamped({pixel(500, 360), pixel(800, 360)}, fine, bands);
  EXPECT_EQ(jumped.misses, 0u);
  checkEdges(jumped);
}

TEST(Brush, JumpInDepthSplitsTheStroke) {
  const auto step = [](double depth) {
    return [depth](const Ray& ray, ScreenPoint p) { return plane(ray, p.x < 640 * kSubPixels ? 0 : -depth); };
  };
  const auto far = stamped({pixel(600, 360), pixel(680, 360)}, {}, step(1));
  EXPECT_EQ(far.pieces, 2u);
  EXPECT_EQ(far.misses, 0u);
  for (const auto& stamp : far.stamps)
    EXPECT_TRUE(stamp.center.z == 0 || stamp.center.z == -1) << "no stamp hangs between the surfaces";
  // A step that the brush spans is one surface to it.
  const auto low = stamped({pixel(600, 360), pixel(680, 360)}, {}, step(0.04));
  EXPECT_EQ(low.pieces, 1u);
}

TEST(Brush, SteepSurfaceIsNoJump) {
  // Seven units deep for one across: steeper than the brush is wide within a pixel, but a surface.
  const auto slope = [](const Ray& ray, ScreenPoint) -> std::optional<DVec3> {
    const double t = 4 / (1 + 7 * std::fabs(ray.direction.x) / -ray.direction.z);
    return ray.at(t);
  };
  const auto outcome = stamped({pixel(645, 360), pixel(700, 360)}, {.radius = 0.004f}, slope);
  EXPECT_EQ(outcome.pieces, 1u);
  for (std::size_t i = 0; i + 1 < outcome.stamps.size(); ++i)
    EXPECT_LT(gap(outcome, i), 0.001 + 2 * kRounding);
}

TEST(Brush, PressureVariesRadiusAndSpacing) {
  const Brush brush{.radius = 0.05f, .spacing = 0.5f, .pressureToRadius = 1};
  const auto outcome = stamped({pixel(340, 360, 1023), pixel(940, 360, 0)}, brush);
  ASSERT_GT(outcome.stamps.size(), 50u);
  EXPECT_EQ(outcome.stamps.front().radius, 0.05f);
  EXPECT_NEAR(static_cast<double>(outcome.stamps.back().radius), 0.05 / 16, 1e-6)
      << "never below a sixteenth";
  for (std::size_t i = 0; i + 1 < outcome.stamps.size(); ++i) {
    const auto radius = static_cast<double>(outcome.stamps[i].radius);
    EXPECT_LE(outcome.stamps[i + 1].radius, outcome.stamps[i].radius);
    EXPECT_NEAR(gap(outcome, i), 0.5 * radius, 2 * kRounding);
    const double along = (static_cast<double>(outcome.stamps[i].center.x) + 1) / 2;
    EXPECT_NEAR(radius, 0.05 * std::max(1.0 / 16, 1 - along), 1e-4);
  }
}

TEST(Brush, HalfTheEffectOfPressureMixesLinearly) {
  const auto outcome = stamped({pixel(640, 360, 0)}, {.radius = 0.5f, .pressureToRadius = 0.5f});
  ASSERT_EQ(outcome.stamps.size(), 1u);
  EXPECT_EQ(outcome.stamps[0].radius, 0.25f);
  EXPECT_EQ(stamped({pixel(640, 360, 0)}, {.radius = 0.5f}).stamps[0].radius, 0.5f);
}

TEST(Brush, CentresAreRoundedToTheGridHalfToEven) {
  const auto centreOf = [](DVec3 place, float grid) {
    FunctionCaster caster({}, [&](const Ray&, ScreenPoint) { return place; });
    return stampsAlong({.camera = {}, .points = {pixel(0, 0)}}, {}, grid, caster).stamps.at(0).center;
  };
  EXPECT_EQ(centreOf({0.125, 0.375, 0.625}, 0.25f), Point(0, 0.5, 0.5));
  EXPECT_EQ(centreOf({-0.125, -0.375, -0.625}, 0.25f), Point(0, -0.5, -0.5));
  EXPECT_EQ(centreOf({-0.25, 0.13, -0.37}, 0.25f), Point(-0.25, 0.25, -0.25));
  EXPECT_EQ(centreOf({3, -3, 0}, 2), Point(4, -4, 0));
  EXPECT_FALSE(std::signbit(centreOf({-0.1, 0, 0}, 0.25f).x)) << "there is one zero";
  EXPECT_EQ(centreOf({1e6, -1e6, 0}, 0x1p-100f), Point(1e6f, -1e6f, 0))
      << "finer than the coordinates' own digits";
}

TEST(Brush, EveryCentreLiesOnTheGrid) {
  for (const auto& stamp : stamped({pixel(440, 300), pixel(840, 420)}, {}, onUnitSphere).stamps)
    for (int a = 0; a < 3; ++a) {
      const float cells = stamp.center[a] / kGrid;
      EXPECT_EQ(cells, std::nearbyint(cells));
    }
}

TEST(Brush, GridThatIsNoPowerOfTwoIsRejected) {
  for (const float grid : {0.0f, -0.25f, 0.3f, 1e-40f, std::numeric_limits<float>::infinity(),
                           std::numeric_limits<float>::quiet_NaN()}) {
    FunctionCaster caster({}, onPlane);
    EXPECT_THROW(static_cast<void>(stampsAlong({.camera = {}, .points = {pixel(0, 0)}}, {}, grid, caster)),
                 InputError)
        << grid;
  }
}

TEST(Brush, TooManyStampsAreRejected) {
  const Brush tiny{.radius = 1e-6f, .spacing = 0.01f};
  try {
    static_cast<void>(stamped({pixel(340, 360), pixel(940, 360)}, tiny));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("more than 1000000 stamps"), std::string::npos) << error.what();
  }
  EXPECT_THROW(static_cast<void>(stamped({pixel(340, 360), pixel(940, 360)}, {.radius = 1e-45f})),
               InputError);
}

TEST(Brush, CastsGrowWithPointsAndStampsOnly) {
  FunctionCaster caster({}, onUnitSphere);
  const Stroke stroke{.camera = {},
                      .points = {pixel(440, 300), pixel(840, 420), pixel(20, 20), pixel(440, 300)}};
  const auto outcome = stampsAlong(stroke, {}, kGrid, caster);
  EXPECT_LT(caster.casts, 4 + 4 * outcome.stamps.size() + 2 * 26);
}

TEST(Brush, StrokeOfAMillionPoints) {
  std::vector<StrokePoint> points;
  for (int i = 0; i < 1'000'000; ++i) {
    const double angle = i * 1e-4, r = 100 + 1e-4 * i;
    points.push_back(pixel(640 + r * std::cos(angle), 360 + r * std::sin(angle)));
  }
  const auto outcome = stamped(std::move(points), {}, onUnitSphere);
  EXPECT_EQ(outcome.pieces, 1u);
  EXPECT_GT(outcome.stamps.size(), 3000u);
}

TEST(Brush, ExtremesOfTheScreenAreWalked) {
  const std::int32_t most = retarget::kMaxScreen;
  std::vector<StrokePoint> points(3);
  points[0].screen = {-most, -most};
  points[1].screen = {640 * kSubPixels, 360 * kSubPixels};
  points[2].screen = {most, most};
  const auto outcome = stamped(points, {}, onUnitSphere);
  EXPECT_EQ(outcome.misses, 2u);
  EXPECT_EQ(outcome.pieces, 1u);
  EXPECT_GT(outcome.stamps.size(), 50u);
}

TEST(Brush, EveryRangeIsChecked) {
  const auto rejected = [](Brush brush, const std::string& word) {
    try {
      validate(brush, "line 3");
      ADD_FAILURE() << word;
    } catch (const InputError& error) {
      EXPECT_EQ(std::string(error.what()).rfind("line 3: ", 0), 0u) << error.what();
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  const float nan = std::numeric_limits<float>::quiet_NaN(),
              infinity = std::numeric_limits<float>::infinity();
  for (const float radius : {0.0f, -1.0f, nan, infinity, 2e6f}) rejected({.radius = radius}, "radius");
  for (const float spacing : {0.0f, 0.009f, 4.1f, nan, infinity}) rejected({.spacing = spacing}, "spacing");
  for (const float effect : {-0.1f, 1.1f, nan}) rejected({.pressureToRadius = effect}, "pressure");
  EXPECT_NO_THROW(validate(Brush{}, "line 3"));
  EXPECT_NO_THROW(validate(Brush{.radius = 1e6f, .spacing = 0.01f, .pressureToRadius = 1}, "line 3"));
}

}  // namespace
}  // namespace restroke::sculpt
