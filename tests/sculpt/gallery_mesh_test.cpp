// The shipped log of all kinds as a mesh: what restroke export makes of it (SPEC S13).

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <vector>

#include "implicit/geometry/mesh_faults.h"
#include "implicit/side.h"
#include "points/isosurface/isosurface.h"
#include "sculpt/replay.h"
#include "sculpt/stroke_log.h"
#include "tests/support/brute_force.h"

namespace restroke::sculpt {
namespace {

TEST(GalleryLog, S13ItsMeshIsSoundAndHasItsMonteCarloVolume) {
  StrokeLog log =
      readLog(std::filesystem::path(RESTROKE_SOURCE_DIR) / "experiments" / "examples" / "gallery.log");
  log.header.density = 10;  // surfels are not looked at
  const Document document = replay(log);
  const implicit::PrimitiveList& list = document.model().list();
  ASSERT_GE(list.size(), 21u);
  const points::Isosurface out = points::isosurfaceOf(points::ListSource(list), {.resolution = 96});
  const MeshFaults faults = faultsOf(out.mesh);
  EXPECT_TRUE(faults.none()) << describe(faults);
  EXPECT_EQ(out.selfIntersections, 0u);

  // The Monte Carlo volume's standard deviation is 0.13 %: it fills 0.43 of its box.
  restroke::testing::Random random(96);
  const Box box = list.bounds();
  const DVec3 size = DVec3(box.max) - DVec3(box.min);
  std::vector<Point> points(800'000);
  for (Point& p : points)
    p = {random.between(box.min.x, box.max.x), random.between(box.min.y, box.max.y),
         random.between(box.min.z, box.max.z)};
  std::vector<implicit::Side> sides(points.size());
  implicit::sidesOf(list, points, sides);
  const auto inside = static_cast<double>(std::count(sides.begin(), sides.end(), implicit::Side::Inside));
  const double expected = inside / static_cast<double>(points.size()) * size.x * size.y * size.z;
  EXPECT_NEAR(volumeOf(out.mesh) / expected, 1, 0.01);
}

}  // namespace
}  // namespace restroke::sculpt
