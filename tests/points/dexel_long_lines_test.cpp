// Tri-dexels in OpenGL whose lines cross meshes thousands of times: Mesa's software driver ends long loops
// without a word (points/dexel/gl/gl_dexel_shaders.h).

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <utility>
#include <vector>

#include "implicit/errors.h"
#include "points/dexel/gl/gl_tri_dexel.h"
#include "tests/points/dexel_gl_support.h"
#include "tests/support/effort.h"

namespace restroke::points {
namespace {

using restroke::testing::kSanitized;
using restroke::testing::Random;
using testing::appliedLineByLine;
using testing::differenceFrom;
using testing::PeelDifference;
using testing::randomLine;
using testing::wholeGrid;

using GlLongLines = testing::GlDexelTest;

// Faces across the z lines at these depths, facing down and up in turn, their triangles in random order.
TriangleMesh walls(Random& random, const std::vector<float>& depths, float size) {
  TriangleMesh mesh;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (const auto& [x, y] : {std::pair{-0.3f, -0.4f}, {size, -0.4f}, {size, size}, {-0.3f, size}})
      mesh.vertices.push_back({x, y, depths[i]});
    const std::uint32_t a = first, b = first + (i % 2 == 0 ? 3 : 1), c = first + 2,
                        d = first + (i % 2 == 0 ? 1 : 3);
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
  for (std::size_t i = mesh.triangles.size(); i > 1; --i)
    std::swap(mesh.triangles[i - 1], mesh.triangles[random.below(i)]);
  return mesh;
}

std::vector<float> depthsUpTo(std::size_t count) {
  std::vector<float> depths;
  for (std::size_t i = 0; i < count; ++i) depths.push_back(static_cast<float>(i) / 64);
  return depths;
}

void expectExact(const TriangleMesh& mesh, const TriDexel& model) {
  const PeelDifference difference = differenceFrom(mesh, model);
  EXPECT_EQ(difference.otherCount, 0u) << "of " << difference.lines << " lines";
  EXPECT_LE(difference.depth, difference.depthBound);
  EXPECT_EQ(difference.otherNormals, 0u) << "of " << difference.ends;
}

TEST_F(GlLongLines, OfWallsInAnyOrderAreThoseOfTheExactScan) {
  Random random(21);
  const DexelGrid grid = wholeGrid({18, 18, 26});
  // Around the numbers at which lines are sorted in another way, and more.
  for (const std::size_t count : {256u, 258u, 514u, 3200u}) {
    SCOPED_TRACE(count);
    const TriangleMesh mesh = walls(random, depthsUpTo(count), 17.3f);
    const PeeledModel model = peel(gl(), mesh, grid);
    EXPECT_EQ(model.odd.count, 0u);
    EXPECT_EQ(model.model.family(2).endCount(), count * 18 * 18);
    expectExact(mesh, model.model);
  }
}

TEST_F(GlLongLines, NextToShortOnesAreSortedAsThese) {
  Random random(22);
  // 3,000 walls over a few lines, 200 over more of them, 10 over all.
  TriangleMesh mesh = walls(random, depthsUpTo(3000), 3.4f);
  for (const auto& [count, size] : {std::pair{200u, 8.2f}, {10u, 17.1f}}) {
    const TriangleMesh more = walls(random, depthsUpTo(count), size);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
    for (const auto& t : more.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    mesh.vertices[i].z += 1 + 0x1p-9f * static_cast<float>(i % 7);  // slanted, by no more than their distance
  const DexelGrid grid = wholeGrid({18, 18, 26});
  const PeeledModel model = peel(gl(), mesh, grid);
  EXPECT_EQ(model.odd.count, 0u);
  expectExact(mesh, model.model);
  GlTriDexel inBands(gl(), grid, {.linesPerBand = 50});
  inBands.peel(GlMesh(gl(), mesh));
  EXPECT_EQ(inBands.download(), model.model);
}

TEST_F(GlLongLines, OfTenThousandWallsArePaired) {
  Random random(23);
  // Thousands at one depth are one wall or none, and no wall's faces tell from which of them it came.
  std::vector<float> depths = depthsUpTo(6000);
  depths.insert(depths.end(), 4001, 100.0f);
  depths.insert(depths.end(), 3000, 101.0f);
  depths.push_back(102.0f);
  const TriangleMesh mesh = walls(random, depths, 4.3f);
  const PeeledModel model = peel(gl(), mesh, wholeGrid({6, 4, 26}));
  EXPECT_EQ(model.odd.count, 0u);
  LineEnds ends;
  for (std::size_t line = 0; line < model.model.family(2).lineCount(); ++line) {
    model.model.family(2).read(line, ends);
    if (line % 6 == 5) {
      EXPECT_TRUE(ends.empty()) << "beside the walls";
      continue;
    }
    ASSERT_EQ(ends.size(), 6002u);
    for (std::size_t i = 0; i < ends.size(); ++i) {
      ASSERT_EQ(ends[i].depth, i < 6001 ? depths[i] : 102.0f);
      ASSERT_EQ(unpackNormal(ends[i].normal).z, i % 2 == 0 ? -1 : 1);
    }
  }
}

void expectChangedAsOnTheCpu(GlDexelContext& gl, const TriDexel& model, const TriDexel& tool,
                             std::initializer_list<DexelOperation> operations = {
                                 DexelOperation::Union, DexelOperation::Subtraction,
                                 DexelOperation::Intersection}) {
  for (const DexelOperation operation : operations) {
    GlTriDexel onCard(gl, model.grid()), toolOnCard(gl, model.grid());
    onCard.upload(model);
    toolOnCard.upload(tool);
    onCard.apply(toolOnCard, operation, OperationId{77});
    EXPECT_EQ(onCard.download(), appliedLineByLine(model, tool, operation, OperationId{77}))
        << "operation " << static_cast<int>(operation);
  }
}

// A model in which one line of each row is long.
TriDexel modelOfLongLines(Random& random, const DexelGrid& grid, int most) {
  TriDexel model(grid);
  for (int axis = 0; axis < 3; ++axis)
    for (std::size_t line = 0; line < model.family(axis).lineCount(); ++line)
      model.family(axis).write(line, randomLine(random, line % 5 == 1 ? most : 3));
  return model;
}

TEST_F(GlLongLines, AreChangedAsOnTheCpu) {
  Random random(24);
  const DexelGrid grid = wholeGrid({5, 4, 3});
  const int most = kSanitized ? 2500 : 6000;
  for (const auto& [ends, toolEnds] : {std::pair{most, most}, {most, 2}, {2, most}, {most, 0}}) {
    SCOPED_TRACE(fmt::format("{} and {} spans at most", ends, toolEnds));
    expectChangedAsOnTheCpu(gl(), modelOfLongLines(random, grid, ends),
                            modelOfLongLines(random, grid, toolEnds));
  }
}

// Items whose loops are counted together, and each has many rounds to go while the others have none.
TEST_F(GlLongLines, AreChangedWhereEachHasItsWorkAtAnotherTime) {
  const DexelGrid grid = wholeGrid({4, 4, 4});
  TriDexel model(grid), tool(grid);
  const auto endAt = [](float depth, bool exits) {
    return SpanEnd{depth, packNormal({exits ? 1.0f : -1.0f, 0, 0}), OperationId::Initial, OperationId::None};
  };
  LineEnds ends, toolEnds;
  for (std::size_t line = 0; line < 16; ++line) {
    ends.clear();
    toolEnds.clear();
    for (int i = 0; i < 10000; ++i) ends.push_back(endAt(static_cast<float>(100 + i), i % 2 == 1));
    // So many before the line's own, and one over nearly all of these.
    for (std::size_t i = 0; i < 2 * line; ++i) toolEnds.push_back(endAt(static_cast<float>(i), i % 2 == 1));
    toolEnds.push_back(endAt(110.5f, false));
    toolEnds.push_back(endAt(10000.5f, true));
    model.family(2).write(line, ends);
    tool.family(2).write(line, toolEnds);
  }
  expectChangedAsOnTheCpu(gl(), model, tool, {DexelOperation::Union, DexelOperation::Subtraction});
}

TEST_F(GlLongLines, OfWallsAreCutByWalls) {
  Random random(25);
  const DexelGrid grid = wholeGrid({7, 6, 26});
  GlTriDexel onCard(gl(), grid), toolOnCard(gl(), grid);
  onCard.peel(GlMesh(gl(), walls(random, depthsUpTo(1600), 4.2f)));
  TriDexel expected = onCard.download();
  for (std::uint32_t i = 1; i <= 4; ++i) {
    std::vector<float> depths;
    float at = 0;
    for (int k = 0; k < 1700; ++k) depths.push_back(at += random.between(0.001f, 0.02f));
    toolOnCard.peel(GlMesh(gl(), walls(random, depths, 5.1f)));
    const DexelOperation operation = i % 2 == 1 ? DexelOperation::Union : DexelOperation::Subtraction;
    onCard.apply(toolOnCard, operation, OperationId{i});
    expected.apply(toolOnCard.download(), operation, OperationId{i});
  }
  EXPECT_GT(expected.family(2).endCount(), 1000u * 25);
  EXPECT_EQ(onCard.download(), expected);
}

}  // namespace
}  // namespace restroke::points
