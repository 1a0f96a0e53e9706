// Which triangles of a mesh a line passes through, against the exact predicate; and spans by parity.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "implicit/geometry/exact_predicates.h"
#include "points/dexel/lattice_frame.h"
#include "points/dexel/mesh_scan.h"
#include "tests/points/dexel_mesh_support.h"
#include "tests/support/brute_force.h"
#include "tests/support/effort.h"
#include "tests/support/meshes.h"

namespace restroke::points {
namespace {

using restroke::testing::ballMesh;
using restroke::testing::boxMesh;
using restroke::testing::kSanitized;
using restroke::testing::Random;
using testing::crossingsByDefinition;
using testing::wholeNumbers;

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

}  // namespace
}  // namespace restroke::points
