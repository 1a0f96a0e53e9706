// Tri-dexels of triangle meshes: hand-made ones that lie on the lines, and the files that other people made
// (D1, D10).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "implicit/errors.h"
#include "implicit/geometry/winding_number.h"
#include "points/dexel/mesh_dexels.h"
#include "points/files/mesh_files.h"
#include "tests/points/dexel_mesh_support.h"
#include "tests/support/brute_force.h"
#include "tests/support/effort.h"
#include "tests/support/meshes.h"
#include "tests/support/shared_meshes.h"

namespace restroke::points {
namespace {

namespace fs = std::filesystem;
using restroke::testing::ballMesh;
using restroke::testing::boxMesh;
using restroke::testing::insideOut;
using restroke::testing::kSanitized;
using restroke::testing::meshesIn;
using restroke::testing::meshFolder;
using restroke::testing::Random;
using restroke::testing::together;
using testing::crossingsByDefinition;
using testing::wholeNumbers;

LineEnds endsOf(const TriDexel& model, int axis, int column, int row) {
  LineEnds ends;
  model.family(axis).read(model.family(axis).lineAt(column, row), ends);
  return ends;
}

TEST(MeshDexels, LinesInFacesOfABoxAreDecidedOnce) {
  const DexelGrid grid = wholeNumbers(-1, 8);
  const SampledMesh box = sampleMesh(boxMesh({0, 1, 2}, {4, 6, 8}), grid);
  EXPECT_EQ(box.lines, MeshLines{});
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_EQ(box.model.volumeOf(axis), 4 * 5 * 6);
    const Point low(0, 1, 2), high(4, 6, 8);
    for (int row = 0; row < grid.height(axis); ++row)
      for (int column = 0; column < grid.width(axis); ++column) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        // As if moved a little towards greater coordinates.
        const bool isIn = grid.at(u, column) >= low[u] && grid.at(u, column) < high[u] &&
                          grid.at(v, row) >= low[v] && grid.at(v, row) < high[v];
        const LineEnds ends = endsOf(box.model, axis, column, row);
        ASSERT_EQ(ends.size(), isIn ? 2u : 0u);
        if (!isIn) continue;
        Vec3 out(0);
        out[axis] = 1;
        EXPECT_EQ(ends[0], (SpanEnd{low[axis], packNormal(-out), OperationId::Initial, OperationId::None}));
        EXPECT_EQ(ends[1], (SpanEnd{high[axis], packNormal(out), OperationId::Initial, OperationId::None}));
      }
  }
}

TEST(MeshDexels, StackedBoxesThatShareAFaceAreOneSolid) {
  const DexelGrid grid = wholeNumbers(-1, 9);
  const TriangleMesh stacked = together(boxMesh({0, 0, 0}, {4, 4, 4}), boxMesh({0, 0, 4}, {4, 4, 7}));
  const SampledMesh both = sampleMesh(stacked, grid);
  EXPECT_EQ(both.lines, MeshLines{});
  EXPECT_EQ(both.model, triDexelOf(boxMesh({0, 0, 0}, {4, 4, 7}), grid));
}

TEST(MeshDexels, AnOctahedronWithItsVerticesOnLinesHasItsLengthOnEachOfThem) {
  TriangleMesh mesh = ballMesh(0);
  for (Point& p : mesh.vertices) p *= 5.0f;
  const DexelGrid grid = wholeNumbers(-6, 6);
  const SampledMesh octahedron = sampleMesh(mesh, grid);
  EXPECT_EQ(octahedron.lines, MeshLines{});
  for (int axis = 0; axis < 3; ++axis)
    for (int row = 0; row < 13; ++row)
      for (int column = 0; column < 13; ++column) {
        const int half = 5 - std::abs(column - 6) - std::abs(row - 6);
        const LineEnds ends = endsOf(octahedron.model, axis, column, row);
        ASSERT_EQ(ends.size(), half > 0 ? 2u : 0u);
        if (half <= 0) continue;
        EXPECT_EQ(ends[0].depth, static_cast<float>(-half));
        EXPECT_EQ(ends[1].depth, static_cast<float>(half));
      }
}

TEST(MeshDexels, SheetsWithoutThicknessVanish) {
  TriangleMesh sheet;
  sheet.vertices = {{0, 0, 1}, {5, 0, 2}, {0, 5, 3}};
  sheet.triangles = {{0, 1, 2}, {2, 1, 0}};
  const SampledMesh sampled = sampleMesh(sheet, wholeNumbers(-1, 6));
  EXPECT_EQ(sampled.lines, MeshLines{});
  EXPECT_EQ(sampled.model, TriDexel(wholeNumbers(-1, 6)));
}

TEST(MeshDexels, AnInsideOutMeshIsTheSameSolid) {
  const TriangleMesh ball = ballMesh(3);
  const DexelGrid grid = dexelGridFor(boundsOf(ball), {.resolution = 40});
  const SampledMesh turned = sampleMesh(insideOut(ball), grid);
  const TriDexel expected = triDexelOf(ball, grid);
  EXPECT_EQ(turned.lines, MeshLines{});
  LineEnds a, b;
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t line = 0; line < expected.family(axis).lineCount(); ++line) {
      turned.model.family(axis).read(line, a);
      expected.family(axis).read(line, b);
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].depth, b[i].depth);
        EXPECT_GT(dot(unpackNormal(a[i].normal), unpackNormal(b[i].normal)), 0.999f);
      }
    }
}

TEST(MeshDexels, OverlapsOfShellsAreReportedAndAreOutside) {
  const DexelGrid grid = wholeNumbers(-1, 8);
  const SampledMesh both =
      sampleMesh(together(boxMesh({0, 0, 0}, {4, 4, 4}), boxMesh({2, 2, 2}, {6, 6, 6})), grid);
  EXPECT_EQ(both.lines.odd, MeshLines::List{});
  EXPECT_EQ(both.lines.overlapping.counts, (std::array<std::size_t, 3>{4, 4, 4}));
  ASSERT_EQ(both.lines.overlapping.first.size(), 10u);
  EXPECT_EQ(both.lines.overlapping.first[0], (MeshLines::Line{0, 2, 2}));
  EXPECT_EQ(both.lines.overlapping.first[4], (MeshLines::Line{1, 2, 2}));
  const LineEnds ends = endsOf(both.model, 2, 3, 3);
  ASSERT_EQ(ends.size(), 4u);
  EXPECT_EQ(ends[1].depth, 2);
  EXPECT_EQ(ends[2].depth, 4);
  // A cavity is no overlap, nor is a shell that faces in by itself.
  const TriangleMesh hollow =
      together(boxMesh({0, 0, 0}, {6, 6, 6}), insideOut(boxMesh({2, 2, 2}, {4, 4, 4})));
  EXPECT_EQ(sampleMesh(hollow, grid).lines, MeshLines{});
  EXPECT_EQ(sampleMesh(hollow, grid).model.volume(), 6 * 6 * 6 - 2 * 2 * 2);
}

TEST(MeshDexels, AnOpenMeshIsRefusedWithHowManyLinesAndWhere) {
  TriangleMesh open = boxMesh({0, 0, 0}, {4, 4, 4});
  open.triangles.pop_back();  // half of the face at x = 4
  const DexelGrid grid = wholeNumbers(-1, 5);
  const SampledMesh sampled = sampleMesh(open, grid);
  std::array<std::size_t, 3> odd{};
  std::vector<MeshLines::Line> first;
  for (int axis = 0; axis < 3; ++axis)
    for (int row = 0; row < 7; ++row)
      for (int column = 0; column < 7; ++column) {
        const float u = grid.at((axis + 1) % 3, column), v = grid.at((axis + 2) % 3, row);
        const auto sides = crossingsByDefinition(open, axis, u, v);
        if (std::count(sides.begin(), sides.end(), 0) % 2 == static_cast<std::ptrdiff_t>(sides.size() % 2))
          continue;
        ++odd[static_cast<std::size_t>(axis)];
        if (first.size() < MeshLines::kListed) first.push_back({axis, u, v});
      }
  EXPECT_EQ(odd, (std::array<std::size_t, 3>{6, 0, 0}));
  EXPECT_EQ(sampled.lines.odd.counts, odd);
  EXPECT_EQ(sampled.lines.odd.first, first);
  try {
    (void)triDexelOf(open, grid);
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(error.what(),
              "lines that pass through the mesh an odd number of times: " + describe(sampled.lines.odd) +
                  "; a line has to leave a solid as often as it enters");
    EXPECT_NE(std::string(error.what()).find("6 along x, first along x at y = 0, z = 1;"), std::string::npos)
        << error.what();
  }
}

TEST(MeshDexels, RefusesWhatIsNoMesh) {
  const DexelGrid grid = wholeNumbers(-1, 5);
  TriangleMesh mesh = boxMesh({0, 0, 0}, {4, 4, 4});
  mesh.vertices[3].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW((void)triDexelOf(mesh, grid), InputError);
  mesh = boxMesh({0, 0, 0}, {4, 4, 4});
  mesh.triangles[5][1] = 8;
  EXPECT_THROW((void)triDexelOf(mesh, grid), InputError);
  EXPECT_THROW((void)meshModelOf(mesh), InputError);
  EXPECT_THROW((void)meshModelOf({}), InputError);
  EXPECT_EQ(triDexelOf(TriangleMesh{}, grid), TriDexel(grid));
  TriangleMesh point;
  point.vertices = {{0, 0, 0}};
  point.triangles = {{0, 0, 0}};
  EXPECT_THROW((void)meshModelOf(point), InputError);
}

TEST(MeshDexels, WhatIsBeyondTheGridIsCutOff) {
  const TriangleMesh box = boxMesh({-20, -20, -20}, {20, 20, 20});
  const TriDexel model = triDexelOf(box, wholeNumbers(0, 9));
  EXPECT_EQ(model.volume(), 10 * 10 * 40);
  EXPECT_EQ(triDexelOf(boxMesh({100, 100, 100}, {101, 102, 103}), wholeNumbers(0, 9)),
            TriDexel(wholeNumbers(0, 9)));
}

TEST(MeshDexels, MeshesOfAnySizeThatFloat32HoldsAreSampled) {
  for (const float size : {1e-30f, 1e-12f, 1e12f, 1e30f}) {
    TriangleMesh ball = ballMesh(3);
    for (Point& p : ball.vertices) p *= size;
    const TriDexel model = triDexelOf(ball, dexelGridFor(boundsOf(ball), {.resolution = 64}));
    const double scale = static_cast<double>(size);
    EXPECT_NEAR(model.volumeOf(0) / scale / scale / scale, 4.12, 0.03);
    EXPECT_EQ(model.endCount(),
              triDexelOf(ballMesh(3), dexelGridFor(boundsOf(ballMesh(3)), {.resolution = 64})).endCount());
  }
}

TEST(MeshDexels, TheWindingNumberAgreesAtPointsOfTheGrid) {
  Random random(17);
  for (int round = 0; round < 3; ++round) {
    TriangleMesh mesh = ballMesh(kSanitized ? 2 : 4);
    for (Point& p : mesh.vertices) p *= random.between(0.7f, 1.1f);  // spikes, star-shaped
    const DexelGrid grid = dexelGridFor(boundsOf(mesh), {.resolution = 32});
    const SampledMesh sampled = sampleMesh(mesh, grid);
    EXPECT_EQ(sampled.lines, MeshLines{});
    const WindingNumber winding(mesh);
    for (int i = 0; i < 4000; ++i) {
      GridCounts at;
      for (std::size_t a = 0; a < 3; ++a)
        at[a] = static_cast<int>(random.below(static_cast<std::size_t>(grid.counts()[a])));
      const bool isInside = winding.isInside(DVec3(grid.at(at)));
      for (int axis = 0; axis < 3; ++axis) {
        const auto u = static_cast<std::size_t>((axis + 1) % 3), v = static_cast<std::size_t>((axis + 2) % 3);
        const Dexels& family = sampled.model.family(axis);
        EXPECT_EQ(family.contains(family.lineAt(at[u], at[v]), grid.at(at)[axis]), isInside);
      }
    }
  }
}

TEST(MeshDexels, AreTheSameBitsForAnyNumberOfThreads) {
  TriangleMesh mesh =
      together(ballMesh(kSanitized ? 3 : 5), insideOut(boxMesh({-0.3f, -0.2f, -0.1f}, {0.2f, 0.3f, 0.4f})));
  mesh.triangles.pop_back();
  const DexelGrid grid = dexelGridFor(boundsOf(mesh), {.resolution = 100});
  const SampledMesh expected = sampleMesh(mesh, grid, {.threads = 1});
  EXPECT_GT(expected.lines.odd.count(), MeshLines::kListed);
  for (const int threads : {2, 8}) {
    const SampledMesh found = sampleMesh(mesh, grid, {.threads = threads});
    EXPECT_EQ(found.lines, expected.lines);
    EXPECT_EQ(found.model, expected.model);
  }
}

TEST(MeshDexels, ARepairMakesASolidOfAnOpenMeshAndSaysWhatWasWrong) {
  const MeshModel turned = meshModelOf(insideOut(ballMesh(2)), {.repair = MeshRepair::Winding});
  EXPECT_EQ(turned.repaired, Repaired::Way::TurnedAround);
  const MeshModel same = meshModelOf(ballMesh(2), {.repair = MeshRepair::Winding});
  EXPECT_EQ(same.repaired, Repaired::Way::None);
  EXPECT_EQ(same.solid, ballMesh(2));
  EXPECT_EQ(same.model, meshModelOf(ballMesh(2)).model);
  if (kSanitized) return;  // winding numbers of a whole grid
  TriangleMesh open = ballMesh(2);
  open.triangles.pop_back();
  EXPECT_THROW((void)meshModelOf(open, {.lines = {.resolution = 64}}), InputError);
  const MeshModel made = meshModelOf(open, {.lines = {.resolution = 64}, .repair = MeshRepair::Winding});
  EXPECT_EQ(made.repaired, Repaired::Way::Remeshed);
  EXPECT_EQ(made.faults.borders.count, 3u);
  EXPECT_EQ(made.lines, MeshLines{});
  EXPECT_NEAR(made.model.volume(), volumeOf(made.solid), 0.01);
  EXPECT_NEAR(made.model.volume(), volumeOf(ballMesh(2)), 0.05);
}

class MeshDexelsData : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::is_directory(meshFolder())) GTEST_SKIP() << "no shared data: " << meshFolder();
  }
};

// Area of the triangles that lie along an axis.
double areaAlong(const TriangleMesh& mesh, int axis) {
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const DVec3 a(mesh.vertices[t[0]]),
        n = cross(DVec3(mesh.vertices[t[1]]) - a, DVec3(mesh.vertices[t[2]]) - a) / 2.0;
    if (std::fabs(n[axis]) <= 1e-3 * length(n)) area += length(n);
  }
  return area;
}

// Half a percent, and what a family cannot see: where in the gap between two of its lines a face lies that is
// parallel to them. Such a face is off by half a cell at most. The other two families see it.
TEST_F(MeshDexelsData, EveryClosedMeshHasItsVolumeOnEachFamilyAndNoOddLine) {
  int exact = 0, all = 0;
  for (const fs::path& file : meshesIn("closed")) {
    SCOPED_TRACE(file.filename());
    const TriangleMesh mesh = readMesh(file);
    const MeshModel made = meshModelOf(mesh, {.lines = {.resolution = kSanitized ? 64 : 256}});
    EXPECT_EQ(made.lines, MeshLines{});
    if (kSanitized) continue;
    const double volume = volumeOf(mesh);
    bool isExact = true;
    for (int axis = 0; axis < 3; ++axis) {
      const double unseen = areaAlong(mesh, axis) * made.model.grid().cell() / 2,
                   found = made.model.volumeOf(axis);
      EXPECT_NEAR(found, volume, 0.005 * volume + unseen) << "axis " << axis;
      isExact = isExact && std::fabs(found - volume) <= 0.005 * volume;
      RecordProperty(file.filename().string() + "xyz"[axis], std::to_string(found / volume));
    }
    exact += isExact;
    ++all;
  }
  // Plates and print beds, a few cells thick, are the others.
  EXPECT_GE(exact, all - 5);
}

TEST_F(MeshDexelsData, ClosedMeshesAgreeWithTheWindingNumber) {
  Random random(23);
  for (const fs::path& file : meshesIn("closed")) {
    SCOPED_TRACE(file.filename());
    const WindingNumber winding(readMesh(file));
    const DexelGrid grid = dexelGridFor(boundsOf(winding.mesh()), {.resolution = 50});
    const TriDexel model = triDexelOf(winding.mesh(), grid);
    int wrong = 0;
    for (int i = 0; i < (kSanitized ? 50 : 500); ++i) {
      GridCounts at;
      for (std::size_t a = 0; a < 3; ++a)
        at[a] = static_cast<int>(random.below(static_cast<std::size_t>(grid.counts()[a])));
      const Point p = grid.at(at);
      const double w = winding.exactAt(DVec3(p));
      if (std::fabs(w - 0.5) < 0.4) continue;  // on the surface
      for (int axis = 0; axis < 3; ++axis) {
        const auto u = static_cast<std::size_t>((axis + 1) % 3), v = static_cast<std::size_t>((axis + 2) % 3);
        const Dexels& family = model.family(axis);
        wrong += family.contains(family.lineAt(at[u], at[v]), p[axis]) != (w > 0.5);
      }
    }
    EXPECT_EQ(wrong, 0);
  }
}

TEST_F(MeshDexelsData, BadMeshesGiveASentenceOrAModelAndARepairedModelWhereThereIsARepair) {
  for (const char* folder : {"bad", "formats"})
    for (const fs::path& file : meshesIn(folder)) {
      SCOPED_TRACE(file.filename());
      TriangleMesh mesh;
      try {
        mesh = readMesh(file);
      } catch (const InputError&) {
        EXPECT_EQ(file.filename(), "points_ascii_with_lists.ply");
        continue;
      }
      const DexelGridOptions lines{.resolution = 40};
      const bool hasHoles = oddEdgesOf(mesh).count > 0;
      try {
        const MeshModel made = meshModelOf(mesh, {.lines = lines});
        EXPECT_GT(made.model.endCount(), 0u);
      } catch (const InputError& error) {
        EXPECT_TRUE(hasHoles || mesh.triangles.empty()) << error.what();
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
        EXPECT_GT(std::string(error.what()).size(), 20u);
      }
      // A winding number for each of many points: of the smallest ones (mesh_volume_test repairs the others).
      if (kSanitized || mesh.triangles.size() > 60) continue;
      try {
        const MeshModel made = meshModelOf(mesh, {.lines = lines, .repair = MeshRepair::Winding});
        EXPECT_EQ(made.lines, MeshLines{});
        EXPECT_NEAR(made.model.volume(), volumeOf(made.solid), 0.1 * volumeOf(made.solid));
      } catch (const InputError& error) {
        EXPECT_TRUE(hasHoles || mesh.triangles.empty() || file.filename() == "cube-shuffled.off")
            << error.what();
      }
    }
}

}  // namespace
}  // namespace restroke::points
