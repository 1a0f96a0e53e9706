// Meshes of tri-dexels: sound whatever the lines say, sharp, and within a cell of the solid.

#include "points/dexel/dexel_contour.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "implicit/errors.h"
#include "implicit/geometry/triangle_tree.h"
#include "implicit/shapes/kinds.h"
#include "points/dexel/dexel_surfels.h"
#include "points/files/mesh_files.h"
#include "points/isosurface/side_grid.h"
#include "tests/points/isosurface_support.h"
#include "tests/support/admesh.h"
#include "tests/support/effort.h"
#include "tests/support/random_volumes.h"

namespace restroke::points {
namespace {

using implicit::Primitive;
using implicit::PrimitiveList;
using implicit::Side;
using implicit::Sign;
using testing::Random;

PrimitiveList listOf(const std::vector<Primitive>& primitives) {
  PrimitiveList list;
  for (const Primitive& primitive : primitives) list.append(primitive);
  return list;
}

implicit::Shape boxAt(Point center, Vec3 half, std::array<float, 4> rotation = {0, 0, 0, 1}) {
  const implicit::VolumeParameters parameters{{{half.x}, {half.y}, {half.z}, {0}}, {}};
  implicit::Pose pose;
  pose.position = center;
  pose.rotation = rotation;
  return std::make_shared<const implicit::PosedVolume>(implicit::boxKind().make(parameters), pose);
}

TriDexel modelOf(const PrimitiveList& list, int resolution) {
  return triDexelOf(list, dexelGridFor(list.bounds(), {.resolution = resolution}));
}

void expectSound(const Isosurface& out) {
  const MeshFaults faults = faultsOf(out.mesh);
  EXPECT_TRUE(faults.none() || (faults.empty && out.cutCells == 0)) << describe(faults);
  EXPECT_EQ(out.selfIntersections, 0u);
  EXPECT_EQ(testing::eulerCharacteristic(out.mesh) % 2, 0);
}

// Greatest distance from points to a mesh, looked for up to `reach`.
double farthest(const std::vector<Surfel>& points, const TriangleMesh& mesh, double reach) {
  const TriangleTree tree(mesh);
  double most = 0;
  for (const Surfel& s : points) {
    const auto r = static_cast<float>(reach);
    double least = reach;
    tree.forEachTouching({s.position - Vec3(r), s.position + Vec3(r)}, [&](std::uint32_t t) {
      const auto& c = mesh.triangles[t];
      least = std::min(least, testing::distanceFrom(DVec3(s.position), DVec3(mesh.vertices[c[0]]),
                                                    DVec3(mesh.vertices[c[1]]), DVec3(mesh.vertices[c[2]])));
    });
    most = std::max(most, least);
  }
  return most;
}

// The ends that grid points must know of: span and gap beside them are at least a cell long.
std::vector<Surfel> endsBetweenPoints(const TriDexel& model) {
  std::vector<Surfel> out;
  LineEnds ends;
  const DexelGrid& grid = model.grid();
  for (int axis = 0; axis < 3; ++axis) {
    const Dexels& dexels = model.family(axis);
    for (int row = 0; row < dexels.height(); ++row)
      for (int column = 0; column < dexels.width(); ++column) {
        dexels.read(dexels.lineAt(column, row), ends);
        const auto isLong = [&](std::size_t i) {
          return i + 1 >= ends.size() ||
                 static_cast<double>(ends[i + 1].depth) - static_cast<double>(ends[i].depth) > grid.cell();
        };
        for (std::size_t i = 0; i < ends.size(); ++i) {
          if (!isLong(i) || (i > 0 && !isLong(i - 1))) continue;
          Surfel end;
          end.position[axis] = ends[i].depth;
          end.position[(axis + 1) % 3] = grid.at((axis + 1) % 3, column);
          end.position[(axis + 2) % 3] = grid.at((axis + 2) % 3, row);
          out.push_back(end);
        }
      }
  }
  return out;
}

// Both ways, in cells: each vertex of the mesh has a span end or a point of the other side within a cell, and
// each end that lies between points of the grid the mesh.
void expectNear(const Isosurface& out, const TriDexel& model, const PrimitiveList& list) {
  const std::vector<Surfel> ends = surfelsOf(model, {.ends = DexelEnds::All});
  TriangleMesh points;  // the ends, as triangles of one point each, for the tree
  for (const Surfel& end : ends) {
    const auto i = static_cast<std::uint32_t>(points.vertices.size());
    points.vertices.push_back(end.position);
    points.triangles.push_back({i, i, i});
  }
  const TriangleTree tree(points);
  Random random(1);
  std::size_t far = 0;
  const auto cell = static_cast<float>(out.cell);
  for (const Point p : out.mesh.vertices) {
    float least = 2 * cell;
    tree.forEachTouching({p - Vec3(least), p + Vec3(least)},
                         [&](std::uint32_t t) { least = std::min(least, length(points.vertices[t] - p)); });
    bool near = least <= cell;
    // A vertex is in a cell with a crossing: a cell's diagonal is the most there can be.
    EXPECT_LT(least, 1.74f * cell);
    const Side side = sideOf(list, p);
    for (int k = 0; k < 2000 && !near; ++k) {
      const Vec3 d = random.inCube(1);
      near = length(d) <= 1 && sideOf(list, p + d * cell) != side;
    }
    far += near ? 0 : 1;
  }
  // Planes that meet nowhere near each other, of a thin ridge, may put one at the far end of its cell.
  EXPECT_LE(far, out.mesh.vertices.size() / 5'000) << "of " << out.mesh.vertices.size() << " vertices";
  EXPECT_LE(farthest(endsBetweenPoints(model), out.mesh, 3 * out.cell) / out.cell, 1.0);
}

// The oracle: every point asked by itself, of another object.
class SlowSource final : public GridSource {
 public:
  explicit SlowSource(const TriDexel& model) : model_(model), source_(model) {}
  [[nodiscard]] Box bounds() const override { return source_.bounds(); }
  [[nodiscard]] Grid grid() const override { return source_.grid(); }
  void sides(std::span<const Point> points, std::span<Side> sides) const override {
    source_.sides(points, sides);
  }
  [[nodiscard]] Crossing crossing(Point inside, Point outside) const override {
    return source_.crossing(inside, outside);
  }
  void fillSides(std::size_t words, std::span<std::uint64_t> bits) const override {
    const GridCounts& n = model_.grid().counts();
    for (int z = 0; z < n[2]; ++z)
      for (int y = 0; y < n[1]; ++y)
        for (int x = 0; x < n[0]; ++x)
          if (model_.isInside({x, y, z}))
            bits[(static_cast<std::size_t>(z + 1) * static_cast<std::size_t>(n[1] + 2) +
                  static_cast<std::size_t>(y + 1)) *
                     words +
                 static_cast<std::size_t>((x + 1) / 64)] |= std::uint64_t{1} << (x + 1) % 64;
  }

 private:
  const TriDexel& model_;
  TriDexelSource source_;
};

std::vector<Primitive> randomPrimitives(std::uint64_t seed, std::size_t count) {
  Random random(seed);
  std::vector<Primitive> list = {{{{0, 0, 0}, 1.0f}, Sign::Positive}};
  while (list.size() < count) list.push_back(restroke::testing::randomPrimitive(random, list));
  return list;
}

TEST(DexelContour, D8AxisParallelBoxesAreThoseBoxes) {
  // On the grid, between its points, and with faces through its points.
  for (const Vec3 half : {Vec3(1, 0.6f, 0.35f), Vec3(0.97f, 0.613f, 0.351f), Vec3(0.5f, 0.5f, 0.5f)})
    for (const int resolution : {7, 16, 33}) {
      const Point center(0.01f, -0.02f, 0.03f);
      const PrimitiveList list = listOf({{boxAt(center, half), Sign::Positive}});
      Box bounds = list.bounds();
      bounds.max += Vec3(0.11f, 0.2f, 0.05f);
      const TriDexel model = triDexelOf(list, dexelGridFor(bounds, {.resolution = resolution}));
      const Isosurface out = isosurfaceOf(model);
      expectSound(out);
      // Vertices keep a 512th of a cell from the planes of the grid.
      const float inset = 1e-6f + static_cast<float>(out.cell) / 512;
      EXPECT_NEAR(volumeOf(out.mesh) / static_cast<double>(8 * half.x * half.y * half.z), 1,
                  static_cast<double>(6 * inset));
      // All corners are vertices, and no vertex is off the box.
      for (int c = 0; c < 8; ++c) {
        const Point corner = center + half * Vec3((c & 1) != 0 ? 1.f : -1.f, (c & 2) != 0 ? 1.f : -1.f,
                                                  (c & 4) != 0 ? 1.f : -1.f);
        float least = 1;
        for (const Point p : out.mesh.vertices) least = std::min(least, length(p - corner));
        EXPECT_LT(least, 1.8f * inset) << resolution;
      }
      for (const Point p : out.mesh.vertices) {
        const Vec3 d = p - center;
        EXPECT_NEAR(std::max({std::fabs(d.x) - half.x, std::fabs(d.y) - half.y, std::fabs(d.z) - half.z}), 0,
                    inset);
      }
    }
}

TEST(DexelContour, D8EdgesOfTurnedBoxesAreKeptToWithinHalfACell) {
  double sum = 0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= (restroke::testing::kSanitized ? 3u : 20u); ++seed) {
    Random random(seed);
    std::array<float, 4> rotation;
    for (float& q : rotation) q = random.between(-1, 1);
    const Vec3 half(1, 0.6f, 0.35f);
    const implicit::Shape shape = boxAt(random.inCube(0.1f), half, rotation);
    const PrimitiveList list = listOf({{shape, Sign::Positive}});
    const Isosurface out = isosurfaceOf(modelOf(list, static_cast<int>(14 + seed)));
    expectSound(out);
    EXPECT_NEAR(volumeOf(out.mesh) / (8 * 0.6 * 0.35), 1, 0.02) << seed;
    for (int e = 0; e < 12; ++e)
      for (int i = 0; i <= 50; ++i) {
        DVec3 local((e & 1) != 0 ? 1 : -1);
        local[(e / 4 + 1) % 3] = (e & 2) != 0 ? 1 : -1;
        local[e / 4] = i / 25.0 - 1;
        const double distance =
            testing::distanceFrom(out.mesh, shape.volume()->toModel(local * DVec3(half)), 4 * out.cell) /
            out.cell;
        ASSERT_LT(distance, 0.5) << "seed " << seed << ", edge " << e << ", sample " << i;
        sum += distance;
        ++count;
      }
  }
  EXPECT_LT(sum / count, 0.03);  // most of them exactly
}

TEST(DexelContour, D8ABallHasItsVolume) {
  const PrimitiveList list = listOf({{{{0.1f, -0.2f, 0.3f}, 1.0f}, Sign::Positive}});
  const TriDexel model = modelOf(list, 128);
  const Isosurface out = isosurfaceOf(model);
  expectSound(out);
  EXPECT_DOUBLE_EQ(out.cell, model.grid().cell());
  EXPECT_NEAR(volumeOf(out.mesh), 4 * std::numbers::pi / 3, 4e-4);
  EXPECT_EQ(testing::eulerCharacteristic(out.mesh), 2);
  for (const Point p : out.mesh.vertices)
    ASSERT_NEAR(length(DVec3(p) - DVec3(0.1f, -0.2f, 0.3f)), 1, out.cell * out.cell);
}

TEST(DexelContour, D8ListsOf200PrimitivesAreClosedManifoldAndWithinACell) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    const PrimitiveList list = listOf(randomPrimitives(seed, 200));
    const TriDexel model = modelOf(list, 64);
    const Isosurface out = isosurfaceOf(model);
    expectSound(out);
    expectNear(out, model, list);
  }
}

TEST(DexelContour, D8VolumesOfEveryKindAreClosedManifoldAndWithinACell) {
  for (const std::uint64_t seed : {1, 2}) {
    Random random(seed);
    std::vector<Primitive> primitives = {{{{0, 0, 0}, 1.0f}, Sign::Positive}};
    while (primitives.size() < 60)
      primitives.push_back(restroke::testing::randomMixedPrimitive(random, primitives));
    const PrimitiveList list = listOf(primitives);
    const TriDexel model = modelOf(list, 48);
    const Isosurface out = isosurfaceOf(model);
    expectSound(out);
    expectNear(out, model, list);
  }
}

TEST(DexelContour, TheSidesOfTheGridAreWhatMostLinesSay) {
  for (const std::uint64_t seed : {5, 6}) {
    const PrimitiveList list = listOf(randomPrimitives(seed, 150));
    for (const int resolution : {20, 62, 63, 70}) {
      const TriDexel model = modelOf(list, resolution);
      const SlowSource slow(model);
      const TriDexelSource fast(model);
      const SideGrid a(slow), b(fast);
      ASSERT_EQ(a.points(), b.points());
      const std::array<int, 3>& n = a.points();
      for (int z = 0; z < n[2]; ++z)
        for (int y = 0; y < n[1]; ++y)
          for (int x = 0; x < n[0]; ++x) ASSERT_EQ(a.inside({x, y, z}), b.inside({x, y, z}));
      EXPECT_EQ(isosurfaceOf(slow).mesh, isosurfaceOf(model).mesh);
    }
  }
}

// Families that know nothing of each other: still a closed surface, wherever it is.
TEST(DexelContour, LinesThatDisagreeStillGiveAClosedManifold) {
  Box box;
  box.add({{-1, -1, -1}, {1, 1, 1}});
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    Random random(seed);
    TriDexel model(dexelGridFor(box, {.resolution = 12}));
    for (int axis = 0; axis < 3; ++axis)
      for (std::size_t line = 0; line < model.family(axis).lineCount(); ++line) {
        LineEnds ends;
        float depth = -1.2f;
        for (std::size_t k = 2 * random.below(4); k > 0; --k) {
          depth += random.between(0.001f, 0.5f);
          ends.push_back({depth, packNormal(random.inCube(1) + Vec3(1e-3f, 0, 0))});
        }
        model.family(axis).write(line, ends);
      }
    const Isosurface out = isosurfaceOf(model, {.threads = 2});
    EXPECT_GT(out.cutCells, 100u);
    // Which way is out, lines that contradict each other cannot tell.
    const MeshFaults faults = faultsOf(out.mesh);
    EXPECT_TRUE(faults.closed()) << describe(faults);
    EXPECT_EQ(faults.pinched.count + faults.crossings.count, 0u) << describe(faults);
    EXPECT_EQ(out.selfIntersections, 0u);
  }
}

TEST(DexelContour, ThinWallsHaveTwoSidesOrAreNotSeenButNeverOpen) {
  for (const float thickness : {0.3f, 0.1f, 0.06f, 0.03f, 0.01f, 0.001f}) {
    const PrimitiveList list = listOf({{{{0, 0, 0}, 1.0f}, Sign::Positive},
                                       {{{0, 0, 0}, 1.0f - thickness}, Sign::Negative},
                                       {boxAt({0, 0, 1}, {2, 2, 0.4f}), Sign::Negative}});
    const TriDexel model = modelOf(list, 40);
    const Isosurface out = isosurfaceOf(model);
    expectSound(out);
    if (static_cast<double>(thickness) < 2 * out.cell) continue;
    EXPECT_NEAR(volumeOf(out.mesh) / model.volume(), 1, 0.02) << thickness;
    EXPECT_EQ(faultsOf(out.mesh).shellCount, 1u);
  }
}

TEST(DexelContour, ShellsAndCavitiesComeOutAsPieces) {
  const PrimitiveList list = listOf({{{{0, 0, 0}, 1.0f}, Sign::Positive},
                                     {{{0, 0, 0}, 0.8f}, Sign::Negative},
                                     {{{0, 0, 0}, 0.5f}, Sign::Positive},
                                     {{{3, 0, 0}, 0.5f}, Sign::Positive}});
  const Isosurface out = isosurfaceOf(modelOf(list, 80));
  expectSound(out);
  EXPECT_EQ(faultsOf(out.mesh).shellCount, 4u);
}

TEST(DexelContour, SolidsCutOffAtTheOutermostLinesAreClosed) {
  const PrimitiveList list = listOf({{{{0, 0, 0}, 1.0f}, Sign::Positive}});
  Box half;
  half.add({{-1, -1, -1}, {1, 0.2f, 0.3f}});
  const TriDexel model = triDexelOf(list, dexelGridFor(half, {.resolution = 30}));
  expectSound(isosurfaceOf(model));
}

TEST(DexelContour, EmptyModelsGiveEmptyMeshes) {
  EXPECT_TRUE(isosurfaceOf(TriDexel()).mesh.vertices.empty());
  Box box;
  box.add({{-1, -1, -1}, {1, 1, 1}});
  EXPECT_TRUE(isosurfaceOf(TriDexel(dexelGridFor(box, {.resolution = 10}))).mesh.triangles.empty());
  EXPECT_TRUE(isosurfaceOf(TriDexel(dexelGridFor(box, {.resolution = 1}))).mesh.triangles.empty());
}

TEST(DexelContour, AGrownModelHasTheSameMesh) {
  const PrimitiveList list = listOf(randomPrimitives(9, 60));
  TriDexel model = modelOf(list, 40);
  const Isosurface before = isosurfaceOf(model);
  Box wider = list.bounds();
  wider.max += Vec3(0.5f, 0.1f, 0);
  wider.min.z -= 0.7f;
  model.growTo(wider);
  const Isosurface after = isosurfaceOf(model);
  EXPECT_EQ(after.mesh.triangles.size(), before.mesh.triangles.size());
  EXPECT_NEAR(volumeOf(after.mesh), volumeOf(before.mesh), 1e-9);
}

TEST(DexelContour, ThreadsChangeNothing) {
  const PrimitiveList list = listOf(randomPrimitives(7, 200));
  const TriDexel model = modelOf(list, 70);
  const Isosurface one = isosurfaceOf(model, {.threads = 1});
  for (const int threads : {2, 8}) {
    const Isosurface many = isosurfaceOf(model, {.threads = threads});
    ASSERT_EQ(many.mesh.vertices.size(), one.mesh.vertices.size());
    for (std::size_t i = 0; i < one.mesh.vertices.size(); ++i)
      ASSERT_EQ(many.mesh.vertices[i], one.mesh.vertices[i]) << "vertex " << i << " at " << threads;
    ASSERT_EQ(many.mesh.triangles, one.mesh.triangles) << threads;
  }
}

TEST(DexelContour, D8EveryFormatHoldsTheMeshAndAdmeshFindsNothingToRepair) {
  const PrimitiveList list = listOf(randomPrimitives(8, 100));
  const Isosurface out = isosurfaceOf(modelOf(list, 50));
  const std::string stem =
      (std::filesystem::temp_directory_path() / fmt::format("restroke_dexel_{}", ::getpid())).string();
  for (const char* ending : {".ply", ".obj", ".3mf"}) {
    writeMesh(stem + ending, out.mesh);
    EXPECT_EQ(readMesh(stem + ending), out.mesh) << ending;
    std::filesystem::remove(stem + ending);
  }
  writeMesh(stem + ".stl", out.mesh, {.encoding = MeshEncoding::Ascii});
  EXPECT_TRUE(faultsOf(readMesh(stem + ".stl")).none());
  writeMesh(stem + ".stl", out.mesh);
  EXPECT_EQ(readMesh(stem + ".stl").triangles.size(), out.mesh.triangles.size());
  if (restroke::testing::hasAdmesh()) {
    EXPECT_EQ(restroke::testing::askAdmesh(out.mesh).repairs(), std::vector<std::string>{});
  }
  std::filesystem::remove(stem + ".stl");
}

}  // namespace
}  // namespace restroke::points
