// What CGAL's polygon mesh processing says about the meshes of isosurfaceOf. That package is under the GPL:
// it is used in this test program only. It takes about half a minute to compile, so that nothing else is in
// this file.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <gtest/gtest.h>

#include "points/isosurface/isosurface.h"
#include "tests/points/isosurface_support.h"

namespace restroke::points {
namespace {

namespace Pmp = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

// Vertices become what they are in our mesh: nothing is welded, turned around or left out.
void expectSolid(const TriangleMesh& ours, double volume) {
  std::vector<Kernel::Point_3> points;
  for (const Point p : ours.vertices)
    points.emplace_back(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
  std::vector<std::vector<std::size_t>> polygons;
  for (const auto& t : ours.triangles) polygons.push_back({t[0], t[1], t[2]});
  ASSERT_TRUE(Pmp::is_polygon_soup_a_polygon_mesh(polygons));
  Mesh mesh;
  Pmp::polygon_soup_to_polygon_mesh(points, polygons, mesh);
  EXPECT_EQ(mesh.number_of_vertices(), ours.vertices.size());
  EXPECT_EQ(mesh.number_of_faces(), ours.triangles.size());
  EXPECT_TRUE(CGAL::is_valid_polygon_mesh(mesh));
  EXPECT_TRUE(CGAL::is_closed(mesh));
  EXPECT_FALSE(Pmp::does_self_intersect(mesh));
  EXPECT_TRUE(Pmp::is_outward_oriented(mesh));
  EXPECT_TRUE(Pmp::does_bound_a_volume(mesh));
  EXPECT_NEAR(CGAL::to_double(Pmp::volume(mesh)), volume, 1e-6);
}

TEST(IsosurfaceByCgal, S13ACarvedListIsASolid) {
  restroke::testing::Random random(21);
  implicit::PrimitiveList list;
  std::vector<implicit::Primitive> plain{{{{0, 0, 0}, 1}, implicit::Sign::Positive}};
  for (int i = 0; i < 80; ++i) plain.push_back(restroke::testing::randomPrimitive(random, plain));
  for (const implicit::Primitive& p : plain) list.append(p);
  for (const int resolution : {15, 64}) {
    const Isosurface out = isosurfaceOf(ListSource(list), {.resolution = resolution});
    expectSolid(out.mesh, volumeOf(out.mesh));
  }
}

TEST(IsosurfaceByCgal, S13AShapeOfAllKindsIsASolid) {
  const implicit::PrimitiveList list = testing::shapeOfAllKinds();
  const Isosurface out = isosurfaceOf(ListSource(list), {.resolution = 64});
  expectSolid(out.mesh, volumeOf(out.mesh));
}

TEST(IsosurfaceByCgal, S13TurnedBoxesAreSolids) {
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    const Isosurface out = isosurfaceOf(testing::BoxSource::random(seed, {1, 0.6, 0.35}), {.resolution = 20});
    expectSolid(out.mesh, volumeOf(out.mesh));
  }
}

TEST(IsosurfaceByCgal, S13RandomGridsAreSolids) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    restroke::testing::Random random(seed);
    std::vector<bool> bits(6 * 6 * 6);
    for (std::size_t i = 0; i < bits.size(); ++i) bits[i] = random.below(2) == 0;
    const testing::BitSource source({6, 6, 6}, bits, testing::BitSource::Crossings::Random);
    const Isosurface out = isosurfaceOf(source, {.cell = 1.0});
    expectSolid(out.mesh, volumeOf(out.mesh));
  }
}

}  // namespace
}  // namespace restroke::points
