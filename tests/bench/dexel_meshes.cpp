// Rows of bench_dexel about meshes: building models from them, cutting with them, making them; and OpenGL's.

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>

#include "implicit/errors.h"
#include "implicit/parallel.h"
#include "points/dexel/dexel_contour.h"
#include "points/dexel/dexel_tool.h"
#include "points/dexel/gl/gl_tri_dexel.h"
#include "points/dexel/mesh_dexels.h"
#include "tests/bench/dexel_figures.h"
#include "tests/bench/embree_lines.h"
#include "tests/bench/openvdb_meshing.h"
#include "tests/bench/rivals_table.h"
#include "tests/support/meshes.h"

namespace restroke::bench {
namespace {

using points::DexelGrid;
using points::DexelOperation;
using points::OperationId;
using points::TriDexel;

constexpr Execution kOneThread{.threads = 1}, kTwoThreads{.threads = 2};

template <class F>
double medianMilliseconds(std::size_t rounds, const F& f) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> times;
  for (std::size_t i = 0; i < rounds; ++i) {
    const auto begin = Clock::now();
    f(i);
    times.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
  }
  return quantile(std::move(times), 0.5);
}

void measureBuilding(const TriangleMesh& mesh, const DexelGrid& grid, const MeshSize& size,
                     Results& results) {
  const double ours =
      medianMilliseconds(size.rounds, [&](std::size_t) { (void)triDexelOf(mesh, grid, kOneThread); });
  EmbreeLines embree;
  const double cast = medianMilliseconds(size.rounds, [&](std::size_t) { embree = castLines(mesh, grid); });
  results.figures.push_back({.what = fmt::format("build from a mesh of {} triangles, {} lines, 1 thread",
                                                 mesh.triangles.size(), grid.lineCount()),
                             .unit = "ms",
                             .value = ours,
                             .rival = "Embree: scene, and a ray for each crossing, 1 thread",
                             .rivalValue = cast,
                             .goal = Goal{500}});
  const std::size_t ends = triDexelOf(mesh, grid).endCount();
  results.checks.emplace_back(
      std::fabs(static_cast<double>(ends) - static_cast<double>(embree.crossings)) <=
          1e-3 * static_cast<double>(ends),
      fmt::format("the mesh's model has {} ends; Embree found {} crossings", ends, embree.crossings));
}

points::PoseMatrix poseAt(std::size_t i, double scale) {
  const double turn = 0.05 * static_cast<double>(i);
  return {scale, 0, 0, 0.8 * std::cos(turn), 0, scale, 0, 0.8 * std::sin(turn), 0, 0, scale, 0.1, 0, 0, 0, 1};
}

void measureTool(const TriangleMesh& solid, const DexelGrid& grid, const MeshSize& size, Results& results) {
  const points::DexelTool tool(restroke::testing::ballMesh(4));
  TriDexel model = triDexelOf(solid, grid);
  const double ours = medianMilliseconds(size.poses, [&](std::size_t i) {
    apply(model, tool, {poseAt(i, 0.1), DexelOperation::Subtraction, static_cast<OperationId>(i + 1)},
          kOneThread);
  });
  results.figures.push_back(
      {.what = fmt::format("cut with a mesh tool of {} triangles, radius 0.1, a pose, 1 thread",
                           tool.mesh().triangles.size()),
       .unit = "ms",
       .value = ours,
       .rival = "the paper: GTX 660, with display",
       .rivalValue = 3});
}

void measureMeshing(const TriangleMesh& solid, const MeshSize& size, Results& results) {
  const DexelGrid grid = points::dexelGridFor(boundsOf(solid), {.resolution = size.meshResolution});
  std::size_t triangles = 0;
  const double ours = medianMilliseconds(size.rounds, [&](std::size_t) {
    triangles = isosurfaceOf(triDexelOf(solid, grid, kTwoThreads), kTwoThreads).mesh.triangles.size();
  });
  OpenVdbMeshing openVdb;
  const double rival = medianMilliseconds(size.rounds, [&](std::size_t) {
    inArena(kTwoThreads, [&] { openVdb = meshThroughOpenVdb(solid, grid.cell()); });
  });
  results.figures.push_back({.what = fmt::format("mesh to tri-dexel to mesh, {}^3, {} triangles, 2 threads",
                                                 size.meshResolution, triangles),
                             .unit = "ms",
                             .value = ours,
                             .rival = fmt::format("OpenVDB: mesh to level set to {} quads", openVdb.quads),
                             .rivalValue = rival,
                             .goal = Goal{5, true}});
}

// On a software driver these say only that it works.
void measureOpenGl(const TriangleMesh& solid, const DexelGrid& grid, const MeshSize& size, Results& results) {
  std::optional<points::GlDexelContext> context;
  try {
    context.emplace();
  } catch (const InputError& error) {
    results.checks.emplace_back(true, fmt::format("without OpenGL: {}", error.what()));
    return;
  }
  const points::GlMesh mesh(*context, solid), small(*context, restroke::testing::ballMesh(4));
  points::GlTriDexel model(*context, grid), tool(*context, grid);
  const double peeled = medianMilliseconds(size.rounds, [&](std::size_t) {
    model.peel(mesh);
    (void)model.endCount();
  });
  results.figures.push_back({.what = fmt::format("OpenGL, {}: build from the same mesh", context->driver()),
                             .unit = "ms",
                             .value = peeled});
  TriDexel expected = model.download();
  results.checks.emplace_back(expected.endCount() == triDexelOf(solid, grid).endCount(),
                              "drawn, the mesh has as many ends as scanned");
  std::vector<double> applied;
  for (std::size_t i = 0; i < size.poses; ++i) {
    tool.peel(small, {.pose = poseAt(i, 0.1)});
    (void)tool.endCount();
    applied.push_back(medianMilliseconds(1, [&](std::size_t) {
      model.apply(tool, DexelOperation::Subtraction, static_cast<OperationId>(i + 1));
      (void)model.endCount();
    }));
    expected.apply(tool.download(), DexelOperation::Subtraction, static_cast<OperationId>(i + 1));
  }
  results.figures.push_back({.what = "OpenGL: a Boolean with a small tool, a work item a line",
                             .unit = "ms",
                             .value = quantile(std::move(applied), 0.5),
                             .rival = "the paper: GTX 660, with display",
                             .rivalValue = 3});
  results.checks.emplace_back(model.download() == expected,
                              "Booleans in OpenGL give the CPU's model, bit for bit");
}

}  // namespace

void measureMeshes(const MeshSize& size, Results& results) {
  const TriangleMesh solid = restroke::testing::ballMesh(size.levels);
  const DexelGrid grid = points::dexelGridFor(boundsOf(solid), {.resolution = size.resolution});
  measureBuilding(solid, grid, size, results);
  measureTool(solid, grid, size, results);
  measureMeshing(solid, size, results);
  measureOpenGl(solid, grid, size, results);
}

}  // namespace restroke::bench
