// Tri-dexels of meshes by drawing, against crossings by exact predicates.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <iostream>

#include "points/dexel/gl/gl_tri_dexel.h"
#include "points/files/mesh_files.h"
#include "tests/points/dexel_gl_support.h"
#include "tests/support/meshes.h"

namespace restroke::points {
namespace {

namespace fs = std::filesystem;
using restroke::testing::ballMesh;
using restroke::testing::boxMesh;
using restroke::testing::Random;
using restroke::testing::together;
using testing::differenceFrom;
using testing::PeelDifference;
using testing::wholeGrid;

using GlPeeling = testing::GlDexelTest;

// Both methods give the same bits, and these what the exact predicates say.
TriDexel checkedPeel(const GlDexelContext& gl, const TriangleMesh& mesh, const DexelGrid& grid) {
  const PeeledModel model = peel(gl, mesh, grid);
  const PeeledModel layers = peel(gl, mesh, grid, {.method = PeelMethod::Layers});
  EXPECT_EQ(model.model, layers.model);
  EXPECT_EQ(model.odd.count, 0u);
  EXPECT_EQ(layers.odd.count, 0u);
  const PeelDifference difference = differenceFrom(mesh, model.model);
  EXPECT_LE(static_cast<double>(difference.otherCount),
            kPeelOtherPart * static_cast<double>(difference.lines));
  EXPECT_LE(difference.depth, difference.depthBound);
  EXPECT_EQ(difference.otherNormals, 0u) << "of " << difference.ends;
  std::cout << "  " << difference.lines << " lines, " << difference.otherCount
            << " with another number of ends; " << difference.ends << " ends, depths off by at most "
            << difference.depth << " (bound " << difference.depthBound << ")\n";
  return model.model;
}

TEST_F(GlPeeling, OfABallCrossesAsTheExactPredicatesDo) {
  const TriangleMesh mesh = ballMesh(5);
  const TriDexel model = checkedPeel(gl(), mesh, dexelGridFor(boundsOf(mesh), {.resolution = 100}));
  EXPECT_NEAR(model.volume(), volumeOf(mesh), 2e-3 * volumeOf(mesh));
  LineEnds ends;
  model.family(1).read(model.family(1).lineAt(50, 50), ends);
  ASSERT_EQ(ends.size(), 2u);
  for (const SpanEnd& end : ends) {
    EXPECT_FALSE(end.isCut());
    EXPECT_EQ(end.inner, OperationId::Initial);
    EXPECT_EQ(end.outer, OperationId::None);
  }
}

// Lines run in the faces, along the edges and through the corners.
TEST_F(GlPeeling, OfABoxOnTheLatticeHasEveryLineOnOneSide) {
  const TriangleMesh mesh = boxMesh({2, 3, 4}, {9, 8, 10});
  const DexelGrid grid = wholeGrid({12, 12, 12});
  const TriDexel model = checkedPeel(gl(), mesh, grid);
  // A line in a face is as if moved by nearly nothing towards +u and +v: the lower faces' lines are inside.
  EXPECT_DOUBLE_EQ(model.volume(), 7.0 * 5 * 6);
  EXPECT_EQ(model.family(0).endCount(), 2u * 5 * 6);
  EXPECT_EQ(model.family(1).endCount(), 2u * 7 * 6);
  EXPECT_EQ(model.family(2).endCount(), 2u * 7 * 5);
}

TEST_F(GlPeeling, OfManyBoxesWithFacesInCommonLosesNoLayer) {
  // 5 x 5 x 5 cubes that touch: their common faces vanish in pairs; with a turned copy inside and one afar.
  TriangleMesh mesh;
  for (int i = 0; i < 125; ++i) {
    const Point low(static_cast<float>(2 * (i % 5)), static_cast<float>(2 * (i / 5 % 5)),
                    static_cast<float>(2 * (i / 25)));
    mesh = together(mesh, boxMesh(low, low + Vec3(2)));
  }
  mesh = together(mesh, boxMesh({20, 1, 1}, {21, 9, 9}));
  const TriDexel model = checkedPeel(gl(), mesh, wholeGrid({24, 11, 11}));
  EXPECT_DOUBLE_EQ(model.volumeOf(0), 1000 + 64);
  LineEnds ends;
  model.family(0).read(model.family(0).lineAt(3, 3), ends);
  ASSERT_EQ(ends.size(), 4u);
  const float expected[] = {0, 10, 20, 21};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(ends[i].depth, expected[i]);
    EXPECT_EQ(unpackNormal(ends[i].normal), Vec3(i % 2 == 0 ? -1 : 1, 0, 0));
  }
}

TEST_F(GlPeeling, GoesThroughHundredsOfLayers) {
  TriangleMesh mesh;
  for (int i = 0; i < 150; ++i) {
    const auto z = static_cast<float>(i);
    mesh = together(mesh, boxMesh({-3.1f, -2.7f, z}, {3.3f, 2.9f, z + 0.25f}));
  }
  const TriDexel model = checkedPeel(gl(), mesh, dexelGridFor(boundsOf(mesh), {.cell = 0.9}));
  EXPECT_EQ(model.family(2).endCount(2 * 7 + 3), 300u);
}

TEST_F(GlPeeling, OfRandomTrianglesInPairsIsEvenWhereverLinesPass) {
  // Closed, and as bad as can be: tetrahedra with corners on the lattice, slivers and flat ones among them.
  // From 1 on: at 0 float32 tells apart what rounding makes of one depth.
  Random random(4);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 150; ++i) {
    for (int k = 0; k < 4; ++k) {
      Point p(static_cast<float>(1 + random.below(16)), static_cast<float>(1 + random.below(16)),
              static_cast<float>(1 + random.below(16)));
      if (random.below(3) == 0) p += random.inCube(1e-3f);
      mesh.vertices.push_back(p);
    }
    const std::uint32_t a = 4 * i, b = a + 1, c = a + 2, d = a + 3;
    for (const auto& t : {std::array{a, b, c}, std::array{a, c, d}, std::array{a, d, b}, std::array{b, d, c}})
      mesh.triangles.push_back(t);
  }
  const DexelGrid grid = wholeGrid({17, 17, 17});
  const PeeledModel model = peel(gl(), mesh, grid);
  EXPECT_EQ(model.odd.count, 0u);
  EXPECT_EQ(model.model, peel(gl(), mesh, grid, {.method = PeelMethod::Layers}).model);
  const PeelDifference difference = differenceFrom(mesh, model.model);
  EXPECT_EQ(difference.otherCount, 0u);
  EXPECT_LE(difference.depth, difference.depthBound);
  EXPECT_GT(difference.ends, 5'000u);
}

// Drivers round places on the screen to some part of a pixel: polygons are no longer convex then, and a piece
// may be turned around or drawn twice.
TEST_F(GlPeeling, OfTrianglesWithCornersVeryNearEachOtherDrawsEachOnce) {
  Random random(12);
  TriangleMesh mesh;
  for (std::uint32_t i = 0; i < 150; ++i) {
    const Point a = random.inCube(1), b = random.inCube(1);
    const float near = random.below(2) == 0 ? 3e-4f : 3e-5f;  // of cells of 0.05
    for (const Point& p :
         {a, a + random.inCube(near), b, b + random.inCube(random.below(2) == 0 ? near : 0.3f)})
      mesh.vertices.push_back(p);
    const std::uint32_t k = 4 * i;
    for (const auto& t : {std::array{k, k + 1, k + 2}, std::array{k, k + 2, k + 3},
                          std::array{k, k + 3, k + 1}, std::array{k + 1, k + 3, k + 2}})
      mesh.triangles.push_back(t);
  }
  checkedPeel(gl(), mesh, dexelGridFor(boundsOf(mesh), {.cell = 0.05}));
}

// Products of differences do not fit a double here: which side a line is on may be rounded, parity not.
TEST_F(GlPeeling, IsEvenAlsoWhereProductsAreRounded) {
  Random random(6);
  TriangleMesh mesh = ballMesh(4);
  for (Point& p : mesh.vertices) {
    p = p * 8.0f;
    for (int k = 0; k < 3; ++k)  // onto the lattice, but for next to nothing
      p[k] = std::round(p[k]) + (std::round(p[k]) == 0 ? 1e-20f * random.between(-1, 1) : 0.0f);
  }
  for (const PeelMethod method : {PeelMethod::Fragments, PeelMethod::Layers}) {
    const PeeledModel model =
        peel(gl(), mesh, DexelGrid({DVec3{-9}, 1.0, {}, {19, 19, 19}}), {.method = method});
    EXPECT_EQ(model.odd.count, 0u);
    EXPECT_NEAR(model.model.volume(), volumeOf(mesh), 0.1 * volumeOf(mesh));
  }
}

TEST_F(GlPeeling, IsTheSameInBandsOfAnySize) {
  const TriangleMesh mesh = together(ballMesh(4), boxMesh({-2, -2, -2}, {-1, 2, 2}));
  const DexelGrid grid = dexelGridFor(boundsOf(mesh), {.resolution = 61});
  const TriDexel expected = peel(gl(), mesh, grid).model;
  const GlMesh onCard(gl(), mesh);
  for (const PeelMethod method : {PeelMethod::Fragments, PeelMethod::Layers})
    for (const std::size_t lines : {std::size_t{1}, std::size_t{500}, std::size_t{1700}}) {
      GlTriDexel model(gl(), grid, {.linesPerBand = lines});
      model.peel(onCard, {.method = method});
      EXPECT_EQ(model.download(), expected);
    }
}

TEST_F(GlPeeling, ReportsLinesThatCrossAnOddNumberOfTimes) {
  TriangleMesh mesh = boxMesh({1, 1, 1}, {4, 5, 6});
  std::erase_if(mesh.triangles, [&](const auto& t) {  // without its upper face
    return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) { return mesh.vertices[v].z == 6; });
  });
  for (const PeelMethod method : {PeelMethod::Fragments, PeelMethod::Layers}) {
    const PeeledModel model = peel(gl(), mesh, wholeGrid({8, 8, 8}), {.method = method});
    EXPECT_EQ(model.odd.count, 3u * 4);
    ASSERT_EQ(model.odd.first.size(), 12u);
    EXPECT_EQ(model.odd.first.front(), (OddLines::Place{2, 1, 1}));
    EXPECT_EQ(model.odd.first.back(), (OddLines::Place{2, 3, 4}));
    EXPECT_EQ(model.model.family(2).endCount(), 0u) << "an entry without its exit is left out";
    EXPECT_EQ(model.model.family(0).endCount(), 2u * 4 * 5);
  }
  GlTriDexel again(gl(), wholeGrid({8, 8, 8}));
  EXPECT_EQ(again.oddLines().count, 0u);
  again.peel(GlMesh(gl(), mesh));
  EXPECT_EQ(again.oddLines().count, 12u);
  again.peel(GlMesh(gl(), boxMesh({1, 1, 1}, {4, 5, 6})));
  EXPECT_EQ(again.oddLines().count, 0u) << "of the last mesh";
}

TEST_F(GlPeeling, TurnsNormalsOutwardsAlsoOfMeshesThatAreInsideOut) {
  const TriangleMesh mesh = ballMesh(3);
  const DexelGrid grid = dexelGridFor(boundsOf(mesh), {.resolution = 40});
  const TriDexel model = peel(gl(), mesh, grid).model;
  const TriDexel inverted = peel(gl(), restroke::testing::insideOut(mesh), grid).model;
  EXPECT_EQ(inverted.endCount(), model.endCount());
  LineEnds ends, others;
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t line = 0; line < model.family(axis).lineCount(); ++line) {
      model.family(axis).read(line, ends);
      inverted.family(axis).read(line, others);
      ASSERT_EQ(ends.size(), others.size());
      for (std::size_t i = 0; i < ends.size(); ++i) {
        EXPECT_NEAR(ends[i].depth, others[i].depth, 1e-7);
        EXPECT_TRUE(testing::isNearNormal(ends[i].normal, others[i].normal));
      }
    }
}

TEST_F(GlPeeling, OfNothingIsNothing) {
  const DexelGrid grid = wholeGrid({5, 6, 7});
  EXPECT_EQ(peel(gl(), {}, grid).model, TriDexel(grid));
  EXPECT_EQ(peel(gl(), boxMesh({20, 20, 20}, {30, 30, 30}), grid).model, TriDexel(grid))
      << "beyond the lines";
  EXPECT_EQ(peel(gl(), boxMesh({1.1f, 1.1f, 1.1f}, {1.9f, 1.9f, 1.9f}), grid).model, TriDexel(grid))
      << "between the lines";
  GlTriDexel model(gl(), grid);
  model.peel(GlMesh(gl(), boxMesh({1, 1, 1}, {3, 3, 3})));
  EXPECT_GT(model.endCount(), 0u);
  model.peel(GlMesh(gl(), TriangleMesh{}));
  EXPECT_EQ(model.download(), TriDexel(grid)) << "what was there is gone";
}

TEST_F(GlPeeling, ReachesFarBeyondTheGrid) {
  // Lines see a small part of triangles that are large and slanted; most of those are nowhere near.
  for (const float scale : {1.0f, 1e3f, 1e6f}) {
    TriangleMesh mesh = boxMesh({-1, -1, -1}, {1, 1, 1});
    for (Point& p : mesh.vertices)
      p = Point(scale * (40000 * p.x + 3000 * p.y), scale * (30000 * p.y - 7000 * p.z), 500 * p.z + p.x);
    mesh.vertices[0] += Vec3(17, 3, 1);
    const TriDexel model =
        checkedPeel(gl(), mesh, dexelGridFor({{-20, -20, -700}, {20, 20, 700}}, {.cell = 9}));
    EXPECT_GE(model.family(2).endCount(), 2u * 5 * 5);
  }
}

// The same motion on the CPU: double, rounded once.
TriangleMesh posed(TriangleMesh mesh, const PoseMatrix& m) {
  for (Point& p : mesh.vertices) {
    const DVec3 d(p);
    for (int k = 0; k < 3; ++k) {
      const double* const row = &m[static_cast<std::size_t>(4 * k)];
      p[k] = static_cast<float>(((row[0] * d.x + row[1] * d.y) + row[2] * d.z) + row[3]);
    }
  }
  return mesh;
}

TEST_F(GlPeeling, OfAToolInAnyPoseIsThatOfThePosedMeshAndCutsAsOnTheCpu) {
  const TriangleMesh base = ballMesh(4),
                     tool = together(ballMesh(3), boxMesh({-0.2f, -0.3f, 0.5f}, {0.2f, 0.3f, 3}));
  const DexelGrid grid = dexelGridFor(boundsOf(base), {.resolution = 70});
  const GlMesh toolMesh(gl(), tool);
  GlTriDexel onCard(gl(), grid), toolOnCard(gl(), grid);
  onCard.peel(GlMesh(gl(), base));
  TriDexel expected = onCard.download();
  Random random(9);
  for (std::uint32_t i = 1; i <= 12; ++i) {
    PoseMatrix pose = kIdentityPose;
    for (std::size_t k = 0; k < 12; ++k)
      pose[k] = static_cast<double>(random.between(-1, 1)) * (k % 4 == 3 ? 1.0 : 0.3);
    toolOnCard.peel(toolMesh, {.pose = pose});
    EXPECT_EQ(toolOnCard.oddLines().count, 0u);
    const TriangleMesh moved = posed(tool, pose);
    const TriDexel sampled = toolOnCard.download();
    EXPECT_EQ(sampled, peel(gl(), moved, grid).model) << "pose " << i;
    const PeelDifference difference = differenceFrom(moved, sampled);
    EXPECT_EQ(difference.otherCount, 0u);
    EXPECT_LE(difference.depth, difference.depthBound);
    EXPECT_EQ(difference.otherNormals, 0u);
    const DexelOperation operation = i % 3 == 0 ? DexelOperation::Union : DexelOperation::Subtraction;
    onCard.apply(toolOnCard, operation, OperationId{i});
    expected.apply(sampled, operation, OperationId{i});
  }
  EXPECT_EQ(onCard.download(), expected);
}

TEST_F(GlPeeling, RefusesPosesAndMeshesThatAreNotNumbers) {
  const DexelGrid grid = wholeGrid({5, 6, 7});
  const GlMesh mesh(gl(), boxMesh({1, 1, 1}, {3, 3, 3}));
  GlTriDexel model(gl(), grid);
  PoseMatrix pose = kIdentityPose;
  pose[5] = std::nan("");
  EXPECT_THROW(model.peel(mesh, {.pose = pose}), InputError);
  pose = kIdentityPose;
  pose[14] = 0.5;
  EXPECT_THROW(model.peel(mesh, {.pose = pose}), InputError);
  pose = kIdentityPose;
  pose[3] = 1e38;
  EXPECT_THROW(model.peel(mesh, {.pose = pose}), InputError);
  TriangleMesh bad = boxMesh({1, 1, 1}, {3, 3, 3});
  bad.vertices[3].y = std::numeric_limits<float>::infinity();
  EXPECT_THROW(GlMesh(gl(), bad), InputError);
  const GlDexelContext second;
  EXPECT_THROW(model.peel(GlMesh(second, boxMesh({1, 1, 1}, {3, 3, 3}))), InternalError);
  model.peel(mesh);
  EXPECT_GT(model.endCount(), 0u) << "it still works afterwards";
}

// SPEC D10: models with more than two crossings along many lines.
class GlPeelingOfData : public GlPeeling, public ::testing::WithParamInterface<const char*> {};

TEST_P(GlPeelingOfData, CrossesAsTheExactPredicatesDo) {
  const fs::path file = fs::path(RESTROKE_SHARED_DIR) / "data/meshes/closed" / GetParam();
  if (!fs::exists(file))
    GTEST_SKIP() << file << " is not there; it is data of others and not in the repository";
  const TriangleMesh mesh = readMesh(file);
  checkedPeel(gl(), mesh, dexelGridFor(boundsOf(mesh), {.resolution = 96}));
  // Finer, for the volume: thingi112932 has walls of which 96 lines see one or none.
  const TriDexel fine = peel(gl(), mesh, dexelGridFor(boundsOf(mesh), {.resolution = 256})).model;
  EXPECT_NEAR(fine.volume(), volumeOf(mesh), 5e-3 * volumeOf(mesh));
}

INSTANTIATE_TEST_SUITE_P(Meshes, GlPeelingOfData,
                         ::testing::Values("elephant.off", "knot1.off", "thingi112932.stl"),
                         [](const auto& given) {
                           const std::string name = given.param;
                           return name.substr(0, name.find('.'));
                         });

}  // namespace
}  // namespace restroke::points
