// Zones, and the lines that are laid through them (SPEC R3).

#include <gtest/gtest.h>

#include <cmath>

#include "implicit/errors.h"
#include "tests/points/refine_support.h"

namespace restroke::points {
namespace {

using restroke::testing::Random;
using testing::someZones;

DVec3 randomPoint(Random& random, const Box& box) {
  DVec3 p;
  for (int a = 0; a < 3; ++a)
    p[a] = static_cast<double>(random.between(box.min[a] - 0.1f, box.max[a] + 0.1f));
  return p;
}

TEST(Zone, R3ItsBoundsHoldItAndItsVolumeIsThatOfItsPoints) {
  Random random(1);
  for (const Zone& zone : someZones()) {
    std::size_t in = 0;
    constexpr std::size_t kAsked = 40'000;
    for (std::size_t i = 0; i < kAsked; ++i) {
      const DVec3 p = randomPoint(random, zone.bounds());
      if (!zone.contains(p)) continue;
      ++in;
      for (int a = 0; a < 3; ++a) {
        EXPECT_GE(p[a], static_cast<double>(zone.bounds().min[a]));
        EXPECT_LE(p[a], static_cast<double>(zone.bounds().max[a]));
      }
    }
    const Vec3 size = zone.bounds().max - zone.bounds().min + Vec3(0.2f);
    const double volume = static_cast<double>(size.x * size.y * size.z) * static_cast<double>(in) / kAsked;
    EXPECT_NEAR(volume, zone.volume(), 0.06 * zone.volume());
  }
}

TEST(Zone, R3ALineIsInTheZoneWhereItsPointsAre) {
  Random random(2);
  for (const Zone& zone : someZones())
    for (int i = 0; i < 2000; ++i) {
      const DVec3 a = randomPoint(random, zone.bounds()), b = randomPoint(random, zone.bounds());
      const Ray ray{a, normalized(b - a)};
      const auto in = zone.clip(ray);
      for (int k = 0; k < 8; ++k) {
        const double t = static_cast<double>(random.between(-2, 2));
        const bool within = in && t >= in->enter && t <= in->exit;
        const bool close = in && (std::fabs(t - in->enter) < 1e-9 || std::fabs(t - in->exit) < 1e-9);
        if (!close) {
          EXPECT_EQ(zone.contains(ray.at(t)), within);
        }
      }
    }
}

TEST(Zone, ABoxThatHasAPointOfTheZoneMayMeetItAndOneFarAwayDoesNot) {
  Random random(3);
  for (const Zone& zone : someZones()) {
    std::size_t refused = 0;
    for (int i = 0; i < 5000; ++i) {
      const Point p(randomPoint(random, zone.bounds()));
      const Vec3 half(random.between(0, 0.1f), random.between(0, 0.1f), random.between(0, 0.1f));
      const Box box{p - half, p + half};
      if (!zone.mayMeet(box)) {
        ++refused;
        for (int k = 0; k < 8; ++k) {
          const Point q =
              p + half * Vec3((k & 1) != 0 ? 1 : -1, (k & 2) != 0 ? 1 : -1, (k & 4) != 0 ? 1 : -1);
          EXPECT_FALSE(zone.contains(DVec3(q)));
        }
      }
    }
    EXPECT_GT(refused, 300u);
    EXPECT_FALSE(zone.mayMeet({{20, 20, 20}, {21, 21, 21}}));
    EXPECT_FALSE(zone.mayMeet(Box()));
  }
}

TEST(Zone, WidenedItHoldsWhatIsNear) {
  Random random(4);
  for (const Zone& zone : someZones()) {
    const Zone wide = zone.widened(0.05);
    std::size_t near = 0;
    for (int i = 0; i < 20'000; ++i) {
      const DVec3 p = randomPoint(random, zone.bounds());
      if (!zone.contains(p)) continue;
      const DVec3 q = p + 0.05 * normalized(DVec3(random.inCube(1)));
      ++near;
      EXPECT_TRUE(wide.contains(q));
      EXPECT_TRUE(wide.mayMeet({Point(q), Point(q)}));
    }
    EXPECT_GT(near, 100u);
    EXPECT_TRUE(wide.contains(randomPoint(random, {zone.bounds().center(), zone.bounds().center()})));
  }
}

TEST(Zone, RefusesWhatIsNone) {
  EXPECT_THROW(Zone(OrientedBox{.half = {1, 0, 1}}), InputError);
  EXPECT_THROW(Zone(OrientedBox{.center = {std::nan(""), 0, 0}}), InputError);
  EXPECT_THROW(Zone(OrientedBox{.axes = {DVec3{1, 0, 0}, DVec3{1, 0, 0}, DVec3{0, 0, 1}}}), InputError);
  EXPECT_THROW(Zone(implicit::Sphere{{0, 0, 0}, 0}), InputError);
  Camera camera;
  camera.far = camera.near;
  EXPECT_THROW(Zone{camera}, InputError);
}

TEST(NewLines, R3FillTheZoneAtTheDensityThatIsAskedFor) {
  for (const Zone& zone : someZones()) {
    const bool frustum = std::holds_alternative<Camera>(zone.shape());
    const auto families = newLines(zone, {.resolution = 40});
    EXPECT_EQ(families.size(), frustum ? 1u : 3u);
    for (const LineFamily& family : families) {
      EXPECT_LE(family.width, 40);
      EXPECT_LE(family.height, 40);
      const LinesInZone lines = linesInZone(family, zone);
      EXPECT_GT(lines.count(), 500u);
      // The length of all lines times their spacing is the zone's volume.
      if (frustum) continue;
      double sum = 0;
      for (std::size_t i = 0; i < lines.from.size(); ++i)
        if (lines.from[i] < lines.to[i])
          sum += static_cast<double>(lines.to[i]) - static_cast<double>(lines.from[i]);
      EXPECT_NEAR(sum * length(cross(family.originStep, family.originRowStep)), zone.volume(),
                  0.04 * zone.volume());
    }
  }
}

TEST(NewLines, R3TheModelsOwnLinesAreAmongTheNewOnesAndTheOthersAreDropped) {
  Box box;
  box.add({Point(-1), Point(1.3f)});
  const DexelGrid grid = dexelGridFor(box, {.resolution = 37});
  const Zone zone = someZones()[1];
  for (const int times : {1, 4}) {
    const ZoneGrid found = gridFor(zone, {.among = NewLines::Among{grid, times}}).value();
    for (int a = 0; a < 3; ++a) {
      const DexelGrid::Range kept = grid.pointsIn(a, zone.bounds());
      const int first = found.grid.firstFrom(a, static_cast<double>(grid.at(a, kept.begin)));
      for (int i = kept.begin; i < kept.end; ++i)
        EXPECT_EQ(found.grid.at(a, first + times * (i - kept.begin)), grid.at(a, i));
      EXPECT_NEAR(found.grid.counts()[static_cast<std::size_t>(a)], times * (kept.end - kept.begin), times);
    }
    EXPECT_EQ(newLines(zone, {.among = NewLines::Among{grid, times}}).size(), 3u);
  }
  EXPECT_THROW((void)gridFor(zone, {.among = NewLines::Among{grid, 0}}), InputError);
  EXPECT_THROW((void)gridFor(someZones()[0], {.among = NewLines::Among{grid, 2}}), InputError);
}

TEST(NewLines, R3OneALinePixel) {
  const Zone zone = someZones()[3];
  const auto families = newLines(zone, {.perPixel = true});
  ASSERT_EQ(families.size(), 1u);
  EXPECT_EQ(families[0].width, 60);
  EXPECT_EQ(families[0].height, 40);
  const auto half = newLines(zone, {.resolution = 30});
  EXPECT_EQ(half[0].width, 30);
  EXPECT_EQ(half[0].height, 20);
}

TEST(NewLines, RefuseWhatDoesNotFit) {
  const auto zones = someZones();
  EXPECT_THROW((void)newLines(zones[0], {.resolution = 0}), InputError);
  EXPECT_THROW((void)newLines(zones[0], {.resolution = 10, .cell = 0.1}), InputError);
  EXPECT_THROW((void)newLines(zones[0], {.cell = -1.0}), InputError);
  EXPECT_THROW((void)newLines(zones[1], {.cell = 1e-7}), InputError);
  EXPECT_THROW((void)newLines(zones[1], {.perPixel = true}), InputError);
  EXPECT_THROW((void)newLines(zones[3], {.cell = 0.1}), InputError);
  EXPECT_THROW((void)newLines(zones[3], {.direction = DVec3(1, 0, 0)}), InputError);
  EXPECT_THROW((void)newLines(zones[3], {.resolution = 10, .perPixel = true}), InputError);
  EXPECT_THROW((void)newLines(zones[0], {.direction = DVec3(0)}), InputError);
}

}  // namespace
}  // namespace restroke::points
