// Meshes that stand for images of shapes: closed, on the surface, and as close to the image as they say (SPEC
// X2).

#include "experiments/retarget/fine_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "experiments/retarget/bases.h"
#include "experiments/retarget/changes.h"
#include "implicit/errors.h"
#include "implicit/geometry/deformations.h"
#include "implicit/geometry/mesh_faults.h"
#include "implicit/volume.h"

namespace restroke::experiments {
namespace {

TEST(FineMesh, OfEveryBaseIsTheBoundaryOfASolidWithShortEdges) {
  for (const RetargetBase& base : builtInBases()) {
    const double edge = 0.06 * sizeOf(base.shape);
    const SurfaceMesh surface = fineMeshOf(base.shape, {.edge = edge});
    const MeshFaults faults = faultsOf(surface.mesh);
    EXPECT_TRUE(faults.none()) << base.name << ": " << describe(faults);
    for (const auto& t : surface.mesh.triangles)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_LE(length(DVec3(surface.mesh.vertices[t[k]]) - DVec3(surface.mesh.vertices[t[(k + 1) % 3]])),
                  edge);
  }
}

TEST(FineMesh, VerticesLieOnTheSphere) {
  const implicit::Shape sphere(Point(1, 2, 3), 0.7f);
  for (const Point& v : fineMeshOf(sphere, {.edge = 0.2}).mesh.vertices)
    EXPECT_NEAR(length(DVec3(v) - DVec3(1, 2, 3)), static_cast<double>(0.7f), 1e-6);
}

TEST(FineMesh, ChordErrorOfASphereIsThatOfItsTriangles) {
  const SurfaceMesh surface = fineMeshOf(implicit::Shape(Point(0), 1), {.edge = 0.2});
  const MappedMesh image = mapped(surface, AffineMap(Affine{}));
  // Many points of each triangle.
  double farthest = 0;
  for (const auto& t : surface.mesh.triangles) {
    const DVec3 a(surface.mesh.vertices[t[0]]), b(surface.mesh.vertices[t[1]]),
        c(surface.mesh.vertices[t[2]]);
    constexpr int n = 12;
    for (int i = 0; i <= n; ++i)
      for (int j = 0; i + j <= n; ++j) {
        const double u = static_cast<double>(i) / n, v = static_cast<double>(j) / n;
        farthest = std::max(farthest, 1 - length(u * a + v * b + (1 - u - v) * c));
      }
  }
  // The bound is one to second order: the next ones are of the order of the edge's square, less.
  EXPECT_GE(image.chordError, 0.98 * farthest);
  EXPECT_LT(image.chordError, 2 * farthest);
}

TEST(FineMesh, ChordErrorFallsWithTheSquareOfTheEdges) {
  const BendMap bend({}, 0.8);
  const implicit::Shape sphere(Point(0), 1);
  const double coarse = mapped(fineMeshOf(sphere, {.edge = 0.2}), bend).chordError;
  const double fine = mapped(fineMeshOf(sphere, {.edge = 0.1}), bend).chordError;
  EXPECT_GT(coarse / fine, 3);
  EXPECT_LT(coarse / fine, 5.5);
}

TEST(FineMesh, OfAMeshKeepsItsVerticesAndItsSurface) {
  const RetargetBase lump = builtInBases().back();
  const TriangleMesh& before = lump.shape.volume()->volume().parameters().mesh->mesh;
  const SurfaceMesh after =
      fineMeshOf(lump.shape, {.edge = 0.05, .mostTriangles = 2 * before.triangles.size()});
  EXPECT_GT(after.mesh.triangles.size(), before.triangles.size());
  EXPECT_LE(after.mesh.triangles.size(), 2 * before.triangles.size());
  ASSERT_GE(after.mesh.vertices.size(), before.vertices.size());
  EXPECT_TRUE(std::equal(before.vertices.begin(), before.vertices.end(), after.mesh.vertices.begin()));
  EXPECT_NEAR(volumeOf(after.mesh), volumeOf(before), 1e-6 * volumeOf(before));
  // And does nothing more to what is fine already.
  EXPECT_EQ(fineMeshOf(lump.shape, {.edge = 1e9}).mesh, before);
}

TEST(FineMesh, RefusesAMapThatFoldsTheShape) {
  // Bent so sharply that its inner side passes through the circle's centre.
  const BendMap bend({}, 1.5);
  EXPECT_THROW((void)shapeOf(mapped(fineMeshOf(implicit::Shape(Point(0), 1), {.edge = 0.3}), bend).mesh),
               InputError);
}

TEST(Changes, ImagesOfMotionsHoldTheImagesOfPoints) {
  for (const RetargetBase& base : builtInBases()) {
    const ChangeSite site{.base = base.shape, .seed = 5};
    const double size = sizeOf(base.shape);
    for (const ChangeKind kind : {ChangeKind::Translate, ChangeKind::Rotate, ChangeKind::Scale,
                                  ChangeKind::Motion, ChangeKind::Stretch}) {
      const double strength = kind == ChangeKind::Rotate                                 ? 30
                              : kind == ChangeKind::Scale || kind == ChangeKind::Stretch ? 1.3
                                                                                         : 0.4;
      const KnownChange change = makeChange(kind, strength, site);
      EXPECT_TRUE(change.exactImage);
      // Just inside and just outside along lines through the centre.
      for (const DVec3& d : {DVec3(1, 0.2, 0.1), DVec3(-0.3, 1, 0.4), DVec3(0.2, -0.5, -1)}) {
        std::vector<RayInterval> inside;
        const DVec3 center(base.shape.ball().center);
        implicit::intersect(base.shape, {.origin = center, .direction = d}, inside);
        ASSERT_FALSE(inside.empty());
        const double t = inside.back().exit;
        EXPECT_TRUE(
            implicit::contains(change.image, Point(change.map->point(center + (t - 1e-5 * size) * d))))
            << base.name << ", " << infoOf(kind).name;
        EXPECT_FALSE(
            implicit::contains(change.image, Point(change.map->point(center + (t + 1e-5 * size) * d))))
            << base.name << ", " << infoOf(kind).name;
      }
    }
  }
}

TEST(Changes, OfTheSameSeedAreTheSame) {
  const ChangeSite site{.base = implicit::Shape(), .seed = 9};
  const DVec3 p(0.1, 0.2, 0.3);
  EXPECT_EQ(makeChange(ChangeKind::Motion, 0.5, site).map->point(p),
            makeChange(ChangeKind::Motion, 0.5, site).map->point(p));
  ChangeSite other = site;
  other.seed = 10;
  EXPECT_NE(makeChange(ChangeKind::Motion, 0.5, site).map->point(p),
            makeChange(ChangeKind::Motion, 0.5, other).map->point(p));
}

TEST(Changes, APatchIsMovedAndNothingElseIs) {
  const RetargetBase lump = builtInBases().back();
  std::vector<Point> kept;
  const TriangleMesh& mesh = lump.shape.volume()->volume().parameters().mesh->mesh;
  for (const Point& v : mesh.vertices)
    if (length(v - mesh.vertices.front()) < 0.2f) kept.push_back(v);
  const ChangeSite site{.base = lump.shape, .kept = kept, .seed = 3};
  const KnownChange change = makeChange(ChangeKind::Patch, 0.5, site, {.mostTriangles = 4000});
  const KnownChange motion = makeChange(ChangeKind::Motion, 0.5, site);
  ASSERT_GT(change.patchRadius, 0);
  std::size_t elsewhere = 0;
  for (const Point& v : mesh.vertices) {
    double distance = 1e9;
    for (const Point& k : kept) distance = std::min(distance, length(DVec3(v) - DVec3(k)));
    const double moved = length(change.map->point(DVec3(v)) - motion.map->point(DVec3(v)));
    if (distance < change.patchRadius) {
      EXPECT_LT(moved, 1e-12);
    } else if (moved > 1e-3) {
      ++elsewhere;
    }
  }
  EXPECT_GT(elsewhere, mesh.vertices.size() / 3);
}

}  // namespace
}  // namespace restroke::experiments
