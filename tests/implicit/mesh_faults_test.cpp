// Meshes that are, and are not, the boundary of a solid (S13).

#include "implicit/geometry/mesh_faults.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <string>

#include "implicit/errors.h"
#include "implicit/geometry/exact_predicates.h"
#include "implicit/geometry/triangle_tree.h"
#include "tests/support/meshes.h"

namespace restroke {
namespace {

using testing::ballMesh;
using testing::boxMesh;
using testing::insideOut;
using testing::together;

/// How many faults of each kind: borders, crowded, inconsistent, degenerate, pinched, crossings, shells.
std::vector<std::size_t> countsOf(const MeshFaults& f) {
  return {f.borders.count, f.crowded.count,   f.inconsistent.count, f.degenerate.count,
          f.pinched.count, f.crossings.count, f.shells.count};
}
using Counts = std::vector<std::size_t>;

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(MeshFaults, AClosedMeshHasNone) {
  for (const TriangleMesh& mesh : {boxMesh({-1, 2, 3}, {4, 5, 6}), ballMesh(3)}) {
    const MeshFaults f = faultsOf(mesh);
    EXPECT_TRUE(f.none()) << describe(f);
    EXPECT_TRUE(f.closed());
    EXPECT_EQ(f.shellCount, 1u);
    EXPECT_EQ(describe(f), "nothing is wrong");
  }
  EXPECT_DOUBLE_EQ(faultsOf(boxMesh({-1, 2, 3}, {4, 5, 6})).volume, 45);
}

TEST(MeshFaults, AMeshWithoutTrianglesIsNoSolid) {
  TriangleMesh mesh;
  EXPECT_FALSE(faultsOf(mesh).none());
  EXPECT_TRUE(faultsOf(mesh).empty);
  EXPECT_FALSE(faultsOf(mesh).inwards);
  EXPECT_EQ(describe(faultsOf(mesh)), "it has no triangles");
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}};
  EXPECT_TRUE(faultsOf(mesh).empty);
}

TEST(MeshFaults, IndicesOutOfRangeAndCoordinatesThatAreNotFiniteAreRefused) {
  TriangleMesh mesh = boxMesh({0, 0, 0}, {1, 1, 1});
  mesh.triangles[5][2] = 8;
  try {
    (void)faultsOf(mesh);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "triangle 5 names vertex 8, but the mesh has 8 vertices, from 0 on");
  }
  mesh = boxMesh({0, 0, 0}, {1, 1, std::numeric_limits<float>::infinity()});
  EXPECT_THROW((void)faultsOf(mesh), InputError);
  mesh = boxMesh({0, 0, 0}, {1, 1, 1});
  mesh.vertices.push_back(Point(std::numeric_limits<float>::quiet_NaN()));
  EXPECT_TRUE(faultsOf(mesh).none()) << "a vertex that no triangle uses is no matter";
}

TEST(MeshFaults, AMissingTriangleLeavesThreeBorderEdgesThatRunAsTheirTrianglesDo) {
  TriangleMesh mesh = boxMesh({0, 0, 0}, {1, 2, 3});
  mesh.triangles.erase(mesh.triangles.begin());  // 0 2 3
  const MeshFaults f = faultsOf(mesh);
  EXPECT_EQ(countsOf(f), (Counts{3, 0, 0, 0, 0, 0, 0}));
  EXPECT_FALSE(f.closed());
  ASSERT_EQ(f.borders.first.size(), 3u);
  // The neighbour of 0 -> 2 runs from 2 to 0.
  EXPECT_EQ(f.borders.first[0], (MeshFaults::Edge{{{{2, {0, 2, 0}}, {0, {0, 0, 0}}}}, 1}));
  EXPECT_EQ(f.borders.first[1].ends[0].index, 0u);
  EXPECT_EQ(f.borders.first[1].ends[1].index, 3u);
  EXPECT_EQ(describe(f),
            "3 edges belong to one triangle only: 2-0 from (0, 2, 0) to (0, 0, 0); 0-3 from (0, 0, 0) to (1, "
            "2, 0); "
            "3-2 from (1, 2, 0) to (0, 2, 0)");
}

TEST(MeshFaults, ATurnedTriangleIsWoundInconsistentlyAlongItsThreeEdges) {
  TriangleMesh mesh = boxMesh({0, 0, 0}, {1, 1, 1});
  std::swap(mesh.triangles[0][0], mesh.triangles[0][1]);
  const MeshFaults f = faultsOf(mesh);
  EXPECT_EQ(countsOf(f), (Counts{0, 0, 3, 0, 0, 0, 0}));
  EXPECT_TRUE(contains(describe(f), "3 edges have two triangles that are wound in opposite senses: 0-2 from"))
      << describe(f);
}

TEST(MeshFaults, TwoBoxesThatShareAnEdgeHaveAnEdgeOfFourTriangles) {
  // The upper box takes over the lower one's vertices 6 and 7.
  const TriangleMesh upper = boxMesh({0, 1, 1}, {1, 2, 2});
  TriangleMesh mesh = together(boxMesh({0, 0, 0}, {1, 1, 1}), upper);
  for (auto& t : mesh.triangles)
    for (auto& v : t) v = v == 8 ? 6 : v == 9 ? 7 : v;
  const MeshFaults f = faultsOf(mesh);
  EXPECT_EQ(countsOf(f), (Counts{0, 1, 0, 0, 0, 0, 0}));
  ASSERT_EQ(f.crowded.first.size(), 1u);
  EXPECT_EQ(f.crowded.first[0].triangles, 4u);
  EXPECT_EQ(describe(f), "one edge belongs to more than two triangles: 6-7 from (0, 1, 1) to (1, 1, 1)");
}

TEST(MeshFaults, EdgesOfAnOddNumberOfTrianglesAreFoundAndNoOthers) {
  const TriangleMesh box = boxMesh({0, 0, 0}, {1, 1, 1});
  EXPECT_EQ(oddEdgesOf(box).count, 0u);
  EXPECT_EQ(oddEdgesOf({}).count, 0u);
  TriangleMesh open = box;
  open.triangles.pop_back();
  const auto odd = oddEdgesOf(open);
  EXPECT_EQ(odd.count, 3u);
  EXPECT_EQ(odd.first, faultsOf(open).borders.first);
  TriangleMesh finned = box;  // three triangles at the edge 0-1
  finned.vertices.push_back({0.5f, -1, 0});
  finned.triangles.push_back({0, 1, 8});
  EXPECT_EQ(oddEdgesOf(finned).count, 3u);
  EXPECT_EQ(oddEdgesOf(finned).first[0].triangles, 3u);
  finned.triangles.push_back({0, 1, 8});  // and four
  finned.triangles.push_back({0, 0, 1});  // a triangle that is an edge has no say
  EXPECT_EQ(oddEdgesOf(finned).count, 0u);
  finned.triangles.push_back({0, 1, 9});
  EXPECT_THROW((void)oddEdgesOf(finned), InputError);
}

TEST(MeshFaults, TwoBoxesThatShareAVertexArePinchedThere) {
  TriangleMesh mesh = together(boxMesh({0, 0, 0}, {1, 1, 1}), boxMesh({1, 1, 1}, {2, 2, 2}));
  for (auto& t : mesh.triangles)
    for (auto& v : t) v = v == 8 ? 7 : v;
  const MeshFaults f = faultsOf(mesh);
  EXPECT_EQ(countsOf(f), (Counts{0, 0, 0, 0, 1, 0, 0}));
  EXPECT_TRUE(f.closed());
  EXPECT_FALSE(f.none());
  EXPECT_EQ(f.pinched.first[0], (MeshFaults::Vertex{7, {1, 1, 1}}));
  EXPECT_EQ(describe(f), "one vertex joins surfaces that touch only there: 7 at (1, 1, 1)");
}

TEST(MeshFaults, BoxesThatTouchInAPointWithoutSharingItMeet) {
  const MeshFaults f = faultsOf(together(boxMesh({0, 0, 0}, {1, 1, 1}), boxMesh({1, 1, 1}, {2, 2, 2})));
  EXPECT_EQ(f.pinched.count, 0u);
  EXPECT_GT(f.crossings.count, 0u);
}

TEST(MeshFaults, TrianglesWithoutAreaAreNamedButLeaveNoBorder) {
  TriangleMesh mesh = boxMesh({0, 0, 0}, {1, 1, 1});
  // A corner named twice, and an edge split in its middle on one side only.
  mesh.triangles.push_back({0, 0, 5});
  EXPECT_EQ(countsOf(faultsOf(mesh)), (Counts{0, 0, 0, 1, 0, 0, 0}));
  mesh = boxMesh({0, 0, 0}, {1, 1, 1});
  mesh.vertices.push_back({0.5f, 0, 0});  // on 0-1
  mesh.triangles[1] = {0, 3, 8};
  mesh.triangles.push_back({8, 3, 1});
  mesh.triangles.push_back({0, 8, 1});  // fills the gap of no area
  const MeshFaults f = faultsOf(mesh);
  // The triangles on its two sides meet along the edge without sharing it.
  EXPECT_EQ(countsOf(f), (Counts{0, 0, 0, 1, 0, 2, 0}));
  EXPECT_EQ(f.degenerate.first[0].triangle, 13u);
  EXPECT_FALSE(f.closed());
  EXPECT_TRUE(contains(describe(f), "one triangle has no area: 13 at (0, 0, 0), (0.5, 0, 0), (1, 0, 0)"));
}

TEST(MeshFaults, BoxesThatPassThroughEachOtherMeetInPairsOfTriangles) {
  const TriangleMesh mesh = together(boxMesh({0, 0, 0}, {2, 2, 2}), boxMesh({1, 1, 1}, {3, 3, 3}));
  const MeshFaults f = faultsOf(mesh);
  EXPECT_TRUE(f.closed());
  std::size_t pairs = 0;
  const auto corners = [&](std::size_t t) {
    return Triangle{mesh.vertices[mesh.triangles[t][0]], mesh.vertices[mesh.triangles[t][1]],
                    mesh.vertices[mesh.triangles[t][2]]};
  };
  for (std::size_t t = 0; t < 12; ++t)
    for (std::size_t u = 12; u < 24; ++u) pairs += meet(corners(t), corners(u));
  EXPECT_GT(pairs, 6u);
  EXPECT_EQ(f.crossings.count, pairs);
  EXPECT_EQ(f.crossings.first.size(), std::min<std::size_t>(pairs, 10));
  EXPECT_TRUE(contains(describe(f), "pairs of triangles meet other than in a shared vertex or edge: "));
}

TEST(MeshFaults, NeighboursThatFoldOntoEachOtherOrReachThroughASharedVertexMeet) {
  TriangleMesh mesh;
  // Two triangles on the same side of their common edge, in one plane.
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {1, 0, 3}};
  EXPECT_EQ(faultsOf(mesh).crossings.count, 1u);
  mesh.vertices[3] = {1, 1, 1e-30f};
  EXPECT_EQ(faultsOf(mesh).crossings.count, 0u) << "exact: the smallest angle is no fold";
  mesh.vertices[3] = {1, -1, 0};
  EXPECT_EQ(faultsOf(mesh).crossings.count, 0u);
  // The same triangle twice, there and back.
  mesh.triangles = {{0, 1, 2}, {0, 2, 1}};
  EXPECT_EQ(faultsOf(mesh).crossings.count, 1u);
  // A triangle that passes through another's side opposite to their common vertex.
  mesh.vertices = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {2, 1, -1}, {2, 1, 2}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
  EXPECT_EQ(faultsOf(mesh).crossings.count, 1u);
  mesh.vertices[3] = {2, 1, 1};
  EXPECT_EQ(faultsOf(mesh).crossings.count, 0u);
}

TEST(MeshFaults, InsideOutIsToldFromOtherFaults) {
  const MeshFaults box = faultsOf(insideOut(boxMesh({0, 0, 0}, {1, 1, 2})));
  EXPECT_TRUE(box.inwards);
  EXPECT_TRUE(box.closed());
  EXPECT_FALSE(box.none());
  EXPECT_EQ(countsOf(box), (Counts(7, 0)));
  EXPECT_EQ(describe(box), "it is inside out, all triangles face inwards (signed volume -2)");
  // Two shells apart, and a cavity, all turned around.
  const TriangleMesh apart = together(boxMesh({0, 0, 0}, {1, 1, 1}), boxMesh({2, 0, 0}, {3, 1, 1}));
  EXPECT_TRUE(faultsOf(apart).none());
  EXPECT_TRUE(faultsOf(insideOut(apart)).inwards);
  const TriangleMesh hollow =
      together(boxMesh({0, 0, 0}, {3, 3, 3}), insideOut(boxMesh({1, 1, 1}, {2, 2, 2})));
  EXPECT_TRUE(faultsOf(hollow).none());
  EXPECT_EQ(faultsOf(hollow).shellCount, 2u);
  EXPECT_DOUBLE_EQ(faultsOf(hollow).volume, 26);
  EXPECT_TRUE(faultsOf(insideOut(hollow)).inwards);
}

TEST(MeshFaults, ShellsThatFaceTheWrongWayAreNamedWithTheirWindingNumbers) {
  const TriangleMesh outer = boxMesh({0, 0, 0}, {5, 5, 5}), inner = boxMesh({1, 1, 1}, {4, 4, 4}),
                     core = boxMesh({2, 2, 2}, {3, 3, 3}), beside = boxMesh({6, 0, 0}, {7, 1, 1});
  // Outwards inside another.
  MeshFaults f = faultsOf(together(outer, inner));
  EXPECT_EQ(countsOf(f), (Counts{0, 0, 0, 0, 0, 0, 1}));
  EXPECT_FALSE(f.inwards);
  EXPECT_EQ(f.shells.first[0].face.triangle, 12u);
  EXPECT_EQ(f.shells.first[0].before, 1);
  EXPECT_EQ(f.shells.first[0].behind, 2);
  EXPECT_TRUE(contains(describe(f),
                       "one shell is inside out or inside another: that of triangle 12 near (1, 1, 1), "
                       "with winding number 2 behind it and 1 before it"))
      << describe(f);
  // Inwards beside a good one.
  f = faultsOf(together(outer, insideOut(beside)));
  EXPECT_EQ(f.shells.count, 1u);
  EXPECT_EQ(f.shells.first[0].behind, 0);
  EXPECT_EQ(f.shells.first[0].before, -1);
  // A solid in a cavity is as it should be; a cavity in a cavity is not.
  EXPECT_TRUE(faultsOf(together(together(outer, insideOut(inner)), core)).none());
  EXPECT_EQ(faultsOf(together(together(outer, insideOut(inner)), insideOut(core))).shells.count, 1u);
}

TEST(MeshFaults, ShellsAreSortedOutWhereTheirTestRayRunsThroughVerticesAndEdges) {
  // All boxes have corners on the line y = z = 0 or edges in the plane y = 0: the ray from each passes
  // through them.
  TriangleMesh mesh = boxMesh({0, 0, 0}, {1, 1, 1});
  for (int i = 1; i < 6; ++i) {
    const float x = 2.0f * static_cast<float>(i);
    mesh = together(mesh, boxMesh({x, -1, i % 2 == 0 ? 0.0f : -1.0f}, {x + 1, i % 3 == 0 ? 0.0f : 1.0f, 1}));
  }
  EXPECT_TRUE(faultsOf(mesh).none()) << describe(faultsOf(mesh));
  const TriangleMesh around = boxMesh({-1, -2, -2}, {20, 2, 2});
  const MeshFaults f = faultsOf(together(mesh, around));
  EXPECT_EQ(f.shells.count, 6u);
  EXPECT_TRUE(faultsOf(together(insideOut(mesh), around)).none());
}

TEST(MeshFaults, ListsKeepTheFirstTenAndCountAll) {
  TriangleMesh mesh;
  for (int i = 0; i < 20; ++i) {
    const auto x = static_cast<float>(3 * i);
    const auto v = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}});
    mesh.triangles.push_back({v, v + 1, v + 2});
  }
  const MeshFaults f = faultsOf(mesh);
  EXPECT_EQ(f.borders.count, 60u);
  EXPECT_EQ(f.borders.first.size(), MeshFaults::kListed);
  EXPECT_EQ(f.shellCount, 20u);
  EXPECT_TRUE(describe(f).ends_with("; ...")) << describe(f);
}

TEST(MeshFaults, TheAnswerDoesNotDependOnTheNumberOfThreads) {
  std::mt19937_64 random(7);
  const auto next = [&] { return static_cast<float>(random() >> 40) * 0x1p-24f; };
  TriangleMesh mesh;
  for (std::uint32_t t = 0; t < 3000; ++t) {
    const Point p(next(), next(), next());
    for (int i = 0; i < 3; ++i) mesh.vertices.push_back(p + Point(next(), next(), next()) * 0.1f);
    mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
  }
  const MeshFaults one = faultsOf(mesh, {.threads = 1});
  EXPECT_GT(one.crossings.count, 500u);
  std::size_t bruteForce = 0;
  const auto corners = [&](std::size_t t) {
    return Triangle{mesh.vertices[3 * t], mesh.vertices[3 * t + 1], mesh.vertices[3 * t + 2]};
  };
  for (std::size_t t = 0; t < 300; ++t)
    for (std::size_t u = t + 1; u < 300; ++u) bruteForce += meet(corners(t), corners(u));
  TriangleMesh few = mesh;
  few.triangles.resize(300);
  EXPECT_EQ(faultsOf(few).crossings.count, bruteForce);
  for (const int threads : {2, 8}) {
    const MeshFaults many = faultsOf(mesh, {.threads = threads});
    EXPECT_EQ(countsOf(one), countsOf(many));
    EXPECT_EQ(one.crossings.first, many.crossings.first);
    EXPECT_EQ(one.borders.first, many.borders.first);
    EXPECT_EQ(describe(one), describe(many));
  }
}

TEST(TriangleTree, FindsEveryTriangleWhoseBoxTouches) {
  const TriangleMesh mesh = ballMesh(4);
  const TriangleTree tree(mesh);
  std::mt19937_64 random(3);
  const auto next = [&] { return static_cast<float>(random() >> 40) * 0x1p-23f - 1; };
  for (int i = 0; i < 200; ++i) {
    Box box;
    const Point p(next(), next(), next());
    box.add({p, p + Point(0.2f) * (i % 2 == 0 ? 1.0f : 0.0f)});
    std::vector<std::uint32_t> found, expected;
    tree.forEachTouching(box, [&](std::uint32_t t) { found.push_back(t); });
    std::sort(found.begin(), found.end());
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const Box& b = tree.boxOf(t);
      bool touches = true;
      for (int k = 0; k < 3; ++k) touches = touches && b.min[k] <= box.max[k] && box.min[k] <= b.max[k];
      if (touches) expected.push_back(t);
    }
    EXPECT_EQ(found, expected);
  }
  EXPECT_TRUE(TriangleTree({}).nodes().empty());
  TriangleTree({}).forEachTouching({{0, 0, 0}, {1, 1, 1}}, [](std::uint32_t) { FAIL(); });
}

TEST(TriangleTree, EqualBoxesAreHalvedToo) {
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles.assign(1000, {0, 1, 2});
  const TriangleTree tree(mesh);
  for (const auto& node : tree.nodes())
    if (node.right == 0) {
      EXPECT_LE(node.count, TriangleTree::kLeafTriangles);
    }
  for (std::uint32_t i = 0; i < 1000; ++i) EXPECT_EQ(tree.order()[i], i);
}

TEST(ExactPredicates, DecideWhereDoublesRound) {
  // Differences of these coordinates have more digits than a double.
  const float tiny = 1e-30f;
  const Triangle floor = {Point(0, 0, 0), Point(1, 0, 0), Point(0, 1, 0)};
  EXPECT_EQ(sideOfPlane(floor, {1e20f, -1e20f, tiny}), 1);
  EXPECT_EQ(sideOfPlane(floor, {1e20f, -1e20f, -tiny}), -1);
  EXPECT_EQ(sideOfPlane(floor, {1e20f, -1e20f, 0}), 0);
  EXPECT_TRUE(areCollinear({Point(0, 0, 0), Point(1e10f, 1e10f, 0), Point(tiny, tiny, 0)}));
  EXPECT_FALSE(areCollinear({Point(0, 0, 0), Point(1e10f, 1e10f, 0), Point(tiny, 2 * tiny, 0)}));
  EXPECT_TRUE(areCollinear({Point(1, 2, 3), Point(1, 2, 3), Point(4, 5, 6)}));
  EXPECT_TRUE(meet(floor, Segment{Point(0.25f, 0.25f, 0), Point(0.25f, 0.25f, 1)}));
  EXPECT_FALSE(meet(floor, Segment{Point(0.25f, 0.25f, tiny), Point(0.25f, 0.25f, 1)}));
}

TEST(ExactPredicates, TheSideOfALineIsTheSignOfADeterminantOfWholeNumbers) {
  // Numbers of 53 digits in a small part of the plane: doubles cannot tell their products apart.
  std::uint64_t state = 5;
  const auto next = [&] {
    return static_cast<std::int64_t>((state = state * 6364136223846793005u + 1) >> 61);
  };
  int zeros = 0;
  for (int i = 0; i < 2000; ++i) {
    constexpr std::int64_t kFar = std::int64_t{1} << 52;
    const std::int64_t ax = kFar + next(), ay = kFar + next(), bx = 2 * kFar - 64 + next(),
                       by = 2 * kFar - 64 + next();
    const std::int64_t px = kFar / 2 * 3 + next(), py = kFar / 2 * 3 + next();
    // (far + a) (far / 2 + b) - (far + c) (far / 2 + d), without what cancels.
    const std::int64_t a = bx - ax - kFar, b = py - ay - kFar / 2, c = by - ay - kFar, d = px - ax - kFar / 2;
    const std::int64_t determinant = kFar / 2 * (a + 2 * b - c - 2 * d) + a * b - c * d;
    const int expected = determinant > 0 ? 1 : determinant < 0 ? -1 : 0;
    zeros += expected == 0;
    const auto point = [](std::int64_t x, std::int64_t y) {
      return DVec2(static_cast<double>(x), static_cast<double>(y));
    };
    EXPECT_EQ(sideOfLine(point(ax, ay), point(bx, by), point(px, py)), expected);
    EXPECT_EQ(sideOfLine(point(bx, by), point(ax, ay), point(px, py)), -expected);
  }
  EXPECT_GT(zeros, 5);
  EXPECT_EQ(sideOfLine({1, 2}, {1, 2}, {5, 7}), 0);
}

TEST(ExactPredicates, CrossingsOfAClosedMeshSumToItsWindingNumberAlsoThroughVerticesAndEdges) {
  const TriangleMesh box = boxMesh({0, 0, 0}, {2, 2, 2});
  for (const TriangleMesh& mesh : {box, insideOut(box), together(box, boxMesh({-1, -1, -1}, {3, 3, 3}))}) {
    const int sign = mesh == insideOut(box) ? -1 : 1;
    // Rays along faces, edges and diagonals, and through corners, from a grid of points that are not on the
    // surface.
    for (const float x : {-0.5f, 0.5f, 1.0f, 2.5f})
      for (const float y : {-2.0f, -0.5f, 0.0f, 0.5f, 1.0f, 2.0f, 2.5f})
        for (const float z : {-2.0f, -0.5f, 0.0f, 0.5f, 1.0f, 2.0f, 2.5f}) {
          const Point p(x, y, z);
          const auto within = [&](float low, float high) {
            return std::min({x, y, z}) > low && std::max({x, y, z}) < high;
          };
          const bool onBox = x >= 0 && x <= 2 && y >= 0 && y <= 2 && z >= 0 && z <= 2 && !within(0, 2);
          if (onBox) continue;
          int sum = 0;
          for (const auto& t : mesh.triangles)
            sum += crossingOf({mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]}, p);
          int expected = within(0, 2) ? sign : 0;
          if (mesh.triangles.size() == 24 && within(-1, 3)) ++expected;
          EXPECT_EQ(sum, expected) << x << ' ' << y << ' ' << z;
        }
  }
}

}  // namespace
}  // namespace restroke
