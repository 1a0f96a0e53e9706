// Tri-dexels of triangle meshes: which triangles a line passes through against the exact predicate, hand-made
// meshes that lie on the lines, and the files that other people made (D1, D10).

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "implicit/errors.h"
#include "implicit/geometry/exact_predicates.h"
#include "implicit/geometry/winding_number.h"
#include "points/dexel/lattice_frame.h"
#include "points/dexel/mesh_dexels.h"
#include "points/dexel/mesh_scan.h"
#include "points/files/mesh_files.h"
#include "tests/support/brute_force.h"
#include "tests/support/effort.h"
#include "tests/support/meshes.h"

namespace restroke::points {
namespace {

namespace fs = std::filesystem;
using restroke::testing::ballMesh;
using restroke::testing::boxMesh;
using restroke::testing::insideOut;
using restroke::testing::kSanitized;
using restroke::testing::Random;
using restroke::testing::together;

fs::path dataFolder() {
  return fs::path(RESTROKE_SHARED_DIR) / "data" / "meshes";
}

std::vector<fs::path> filesIn(const char* folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(dataFolder() / folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

// Points at whole numbers, from `first` to `last` on every axis.
DexelGrid wholeNumbers(int first, int last) {
  const float low = static_cast<float>(first) - 0.5f, high = static_cast<float>(last) + 0.5f;
  return DexelGrid({Point(low), Point(high)}, 1);
}

// The definition: the exact predicate of a ray along +x, with the axes moved around. +1 for each triangle
// through which the line leaves, -1 for each through which it enters.
std::vector<int> crossingsByDefinition(const TriangleMesh& mesh, int axis, float u, float v) {
  const auto seen = [&](Point p) { return Point(p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]); };
  std::vector<int> sides;
  for (const auto& t : mesh.triangles)
    sides.push_back(
        crossingOf({seen(mesh.vertices[t[0]]), seen(mesh.vertices[t[1]]), seen(mesh.vertices[t[2]])},
                   {-1e30, static_cast<double>(u), static_cast<double>(v)}));
  return sides;
}

// Every line of every family, triangle by triangle.
void compareWithDefinition(const TriangleMesh& mesh, const DexelGrid& grid, bool isClosed) {
  const std::vector<DVec3> vertices(mesh.vertices.begin(), mesh.vertices.end());
  for (int axis = 0; axis < 3; ++axis) {
    const AxisFrame frame(grid, axis);
    const std::vector<DVec3> own = inFrameOf(axis, vertices);
    const MeshScan scan({own, mesh.triangles}, frame.lattice());
    RowCrossings rows;
    for (int band = 0; band < scan.bandCount(); ++band) {
      scan.scan(band, rows);
      for (int row = rows.firstRow; row < rows.firstRow + rows.rows; ++row)
        for (int column = 0; column < rows.width; ++column) {
          const float u = grid.at((axis + 1) % 3, column), v = grid.at((axis + 2) % 3, row);
          std::vector<int> found(mesh.triangles.size());
          const auto crossings = rows.of(column, row);
          for (const LineCrossing& crossing : crossings) {
            found[crossing.triangle] += crossing.leaves ? 1 : -1;
            const auto& t = mesh.triangles[crossing.triangle];
            const float a = mesh.vertices[t[0]][axis], b = mesh.vertices[t[1]][axis],
                        c = mesh.vertices[t[2]][axis];
            ASSERT_GE(crossing.depth, std::min({a, b, c}));
            ASSERT_LE(crossing.depth, std::max({a, b, c}));
          }
          ASSERT_TRUE(std::is_sorted(crossings.begin(), crossings.end(),
                                     [](const auto& a, const auto& b) { return a.depth < b.depth; }));
          ASSERT_EQ(found, crossingsByDefinition(mesh, axis, u, v))
              << "axis " << axis << " at " << u << ", " << v;
          ASSERT_TRUE(!isClosed || crossings.size() % 2 == 0) << "axis " << axis << " at " << u << ", " << v;
        }
    }
  }
}

Point wholePoint(Random& random, int most) {
  const auto one = [&] { return static_cast<float>(random.below(static_cast<std::size_t>(most) + 1)); };
  const float x = one(), y = one(), z = one();
  return {x, y, z};
}

TEST(MeshScan, PassesThroughTheTrianglesThatTheExactPredicateSaysOnLinesInFacesEdgesAndVertices) {
  for (std::uint64_t seed = 1; seed <= (kSanitized ? 5 : 40); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    TriangleMesh soup;
    for (std::uint32_t i = 0; i < 60; ++i) soup.vertices.push_back(wholePoint(random, 11));
    for (int i = 0; i < 100; ++i) {
      const auto one = [&] { return static_cast<std::uint32_t>(random.below(60)); };
      const std::uint32_t a = one(), b = one(), c = one();
      soup.triangles.push_back({a, b, c});  // degenerate ones included
    }
    compareWithDefinition(soup, wholeNumbers(-1, 12), false);
  }
}

// Coordinates of which nothing is exact in double: the neighbours of lattice points, in float32.
TEST(MeshScan, DecidesLinesAHairBesideEdgesAsTheExactPredicateDoes) {
  for (std::uint64_t seed = 1; seed <= (kSanitized ? 5 : 40); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    TriangleMesh soup;
    for (std::uint32_t i = 0; i < 60; ++i) {
      Point p = wholePoint(random, 11);
      for (int a = 0; a < 3; ++a) {
        const std::size_t kind = random.below(4);
        if (kind == 0) p[a] = std::nextafter(p[a], 100.0f);
        if (kind == 1) p[a] = std::nextafter(p[a], -100.0f);
        if (kind == 2) p[a] += random.between(-0.5f, 0.5f);
      }
      soup.vertices.push_back(p);
    }
    for (int i = 0; i < 100; ++i) {
      const auto one = [&] { return static_cast<std::uint32_t>(random.below(60)); };
      const std::uint32_t a = one(), b = one(), c = one();
      soup.triangles.push_back({a, b, c});
    }
    compareWithDefinition(soup, wholeNumbers(-1, 12), false);
  }
}

TEST(MeshScan, MeetsAClosedMeshAnEvenNumberOfTimesOnEveryLine) {
  for (const float scale : {3.0f, 5.5f, 8.0f}) {
    // Snapped to the lattice, with folds and triangles that have lost their area.
    TriangleMesh mesh = ballMesh(kSanitized ? 2 : 3);
    for (Point& p : mesh.vertices)
      p = {std::round(scale * p.x), std::round(scale * p.y), std::round(scale * p.z)};
    compareWithDefinition(mesh, wholeNumbers(-9, 9), true);
  }
  compareWithDefinition(boxMesh({0, 0, 0}, {4, 5, 6}), wholeNumbers(-1, 7), true);
}

// A box that lies on the lines, turned by what cosines and sines of quarter turns are in double: its edges
// are beside the lines by less than float32 can tell, and most doubles.
TEST(MeshScan, TakesVerticesInDoubleAsTheyAre) {
  Random random(29);
  std::vector<double> places;
  for (int i = -8; i <= 8; ++i) places.push_back(i);
  int crossed = 0;
  for (int round = 0; round < 100; ++round) {
    const TriangleMesh box = boxMesh({-3, -2, -1}, {3, 4, 5});
    const auto tiny = [&] { return static_cast<double>(random.between(-1, 1)) * 0x1p-52; };
    std::vector<DVec3> vertices;
    const double c = tiny(), s = 1 + tiny(), d = tiny();
    for (const Point& p : box.vertices) {
      const DVec3 q(p);
      vertices.emplace_back(c * q.x - s * q.y + d * q.z, s * q.x + c * q.y, q.z + d * q.x);
    }
    const MeshScan scan({vertices, box.triangles}, {places, places});
    RowCrossings rows;
    for (int band = 0; band < scan.bandCount(); ++band) {
      scan.scan(band, rows);
      for (int row = rows.firstRow; row < rows.firstRow + rows.rows; ++row)
        for (int column = 0; column < rows.width; ++column) {
          const DVec2 line(places[static_cast<std::size_t>(column)], places[static_cast<std::size_t>(row)]);
          const auto sideOf = [&](std::uint32_t from, std::uint32_t to) {
            const DVec3 &a = vertices[from], &b = vertices[to];
            if (const int side = sideOfLine({a.x, a.y}, {b.x, b.y}, line); side != 0) return side;
            if (a.y != b.y) return a.y > b.y ? 1 : -1;
            return a.x == b.x ? 0 : a.x < b.x ? 1 : -1;
          };
          std::vector<int> found(box.triangles.size()), expected;
          for (const LineCrossing& crossing : rows.of(column, row)) {
            found[crossing.triangle] += crossing.leaves ? 1 : -1;
            // However steep the triangle.
            const auto& [i, j, k] = box.triangles[crossing.triangle];
            const double depths[] = {vertices[i].z, vertices[j].z, vertices[k].z};
            ASSERT_GE(crossing.depth, static_cast<float>(*std::min_element(depths, depths + 3)));
            ASSERT_LE(crossing.depth, static_cast<float>(*std::max_element(depths, depths + 3)));
          }
          for (const auto& [i, j, k] : box.triangles) {
            const int side = sideOf(i, j);
            expected.push_back(sideOf(j, k) == side && sideOf(k, i) == side ? side : 0);
          }
          ASSERT_EQ(found, expected) << line.x << ", " << line.y;
          crossed += !rows.of(column, row).empty();
        }
    }
  }
  EXPECT_GT(crossed, 100 * 25);
}

TEST(MeshScan, FindsDepthsOnThePlaneOfTheTriangle) {
  Random random(3);
  for (int round = 0; round < 200; ++round) {
    TriangleMesh one;
    for (int i = 0; i < 3; ++i) one.vertices.push_back(random.inCube(10));
    one.triangles = {{0, 1, 2}};
    const std::vector<DVec3> vertices(one.vertices.begin(), one.vertices.end());
    const DVec3 n = cross(vertices[1] - vertices[0], vertices[2] - vertices[0]);
    std::vector<double> places;
    for (int i = 0; i < 50; ++i) places.push_back(-10 + 0.4 * i);
    const MeshScan scan({vertices, one.triangles}, {places, places});
    RowCrossings rows;
    for (int band = 0; band < scan.bandCount(); ++band) {
      scan.scan(band, rows);
      for (int row = rows.firstRow; row < rows.firstRow + rows.rows; ++row)
        for (int column = 0; column < rows.width; ++column)
          for (const LineCrossing& crossing : rows.of(column, row)) {
            const double u = places[static_cast<std::size_t>(column)],
                         v = places[static_cast<std::size_t>(row)];
            const double depth =
                vertices[0].z - (n.x * (u - vertices[0].x) + n.y * (v - vertices[0].y)) / n.z;
            // Rounded once to float32, and what the steepness of the triangle makes of the rounding of
            // doubles.
            const double steep = length(n) / std::fabs(n.z);
            EXPECT_NEAR(static_cast<double>(crossing.depth), depth, 10 * 0x1p-24 + 1e-13 * steep);
          }
    }
  }
}

// Also the same bits as a search that is not given evenly spaced lines.
TEST(MeshScan, TakesLinesAtAnyAscendingCoordinates) {
  const TriangleMesh mesh = ballMesh(3);
  const std::vector<DVec3> vertices(mesh.vertices.begin(), mesh.vertices.end());
  std::vector<double> uneven;
  for (int i = 0; i < 40; ++i) uneven.push_back(-1.2 + 1e-3 * i * i);
  const MeshScan all({vertices, mesh.triangles}, {uneven, uneven});
  RowCrossings rows, single;
  for (int band = 0; band < all.bandCount(); ++band) {
    all.scan(band, rows);
    for (int row = rows.firstRow; row < rows.firstRow + rows.rows; ++row)
      for (int column = 0; column < rows.width; ++column) {
        const double u = uneven[static_cast<std::size_t>(column)], v = uneven[static_cast<std::size_t>(row)];
        const MeshScan one({vertices, mesh.triangles}, {{&u, 1}, {&v, 1}});
        one.scan(0, single);
        const auto expected = single.of(0, 0), found = rows.of(column, row);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
          EXPECT_EQ(found[i].depth, expected[i].depth);
          EXPECT_EQ(found[i].triangle, expected[i].triangle);
        }
      }
  }
}

TEST(ParitySpans, AnEndHasTheNormalOfATriangleThatFacesAsItDoes) {
  const std::vector<DVec3> vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {4, 0, 3}, {4, 0, -3}, {0, 4, -3}};
  const std::vector<std::array<std::uint32_t, 3>> triangles = {{0, 2, 1}, {0, 2, 3}, {0, 1, 5}, {0, 2, 4}};
  const FaceNormals normals(vertices, triangles);
  const PackedNormal along = packNormal({0, 0, 1});
  ParitySpans line;
  const std::vector<LineCrossing> crossings = {{0, 0, false}, {1, 1, false}, {1, 2, true},
                                               {1, 3, false}, {2, 3, true},  {2, 1, false}};
  findSpans(crossings, normals, along, line);
  ASSERT_EQ(line.spans.size(), 1u);
  EXPECT_EQ(line.spans[0].enter, 0);
  EXPECT_EQ(line.spans[0].exit, 1);
  EXPECT_EQ(line.spans[0].enterNormal, packNormal({0, 0, -1}));
  EXPECT_EQ(line.spans[0].exitNormal, packNormal({0, 0.6f, 0.8f}));
  EXPECT_TRUE(line.overlaps);
  // None does: the first, turned around. A triangle without a normal has the line's direction.
  const std::vector<std::array<std::uint32_t, 3>> withThin = {{0, 2, 1}, {0, 1, 1}};
  const FaceNormals thin(vertices, withThin);
  findSpans(std::vector<LineCrossing>{{0, 1, false}, {1, 0, false}}, thin, along, line);
  ASSERT_EQ(line.spans.size(), 1u);
  EXPECT_EQ(line.spans[0].enterNormal, turnedAround(along));
  EXPECT_EQ(line.spans[0].exitNormal, along);
  findSpans(std::vector<LineCrossing>{{0, 0, false}}, thin, along, line);
  EXPECT_TRUE(line.isOdd);
  EXPECT_TRUE(line.spans.empty());
  findSpans({}, thin, along, line);
  EXPECT_FALSE(line.isOdd);
  EXPECT_TRUE(line.spans.empty());
}

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
    if (!fs::is_directory(dataFolder())) GTEST_SKIP() << "no shared data: " << dataFolder();
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
  for (const fs::path& file : filesIn("closed")) {
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
  for (const fs::path& file : filesIn("closed")) {
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
    for (const fs::path& file : filesIn(folder)) {
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
