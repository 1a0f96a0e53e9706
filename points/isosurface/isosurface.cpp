#include "points/isosurface/isosurface.h"

#include <algorithm>
#include <cmath>

#include "implicit/errors.h"
#include "implicit/parallel.h"
#include "points/isosurface/dual_mesh.h"
#include "points/isosurface/meetings.h"
#include "points/isosurface/side_grid.h"

namespace restroke::points {

namespace {

// Each round moves something towards a mesh without meetings, at most five times at any one place; a chain of
// neighbours may take longer. Ordinary shapes take 2 to 4 rounds.
constexpr int kMaxRounds = 64;

// 64 float32 numbers across a cell.
constexpr double kLeastCellOfCoordinate = 0x1p-18;

struct Extent {
  double longest = 0, coordinate = 0;
};

Extent extentOf(const Box& box) {
  Extent out;
  for (int a = 0; a < 3; ++a) {
    const double low = static_cast<double>(box.min[a]), high = static_cast<double>(box.max[a]);
    out.longest = std::max(out.longest, high - low);
    out.coordinate = std::max({out.coordinate, std::fabs(low), std::fabs(high)});
  }
  return out;
}

void refuseTooMany(const std::array<double, 3>& points, double cell) {
  if (!(points[0] * points[1] * points[2] <= kMaxGridPoints))
    throw InputError(
        fmt::format("a mesh with cells of {:.6g} needs a grid of {} x {} x {} points; at most {} are allowed",
                    cell, points[0], points[1], points[2], kMaxGridPoints));
}

double cellFor(const Box& bounds, const IsosurfaceOptions& options) {
  const Extent extent = extentOf(bounds);
  const double least = kLeastCellOfCoordinate * extent.coordinate;
  // A coarser default for what is small and far away.
  const double cell = options.cell         ? *options.cell
                      : options.resolution ? extent.longest / *options.resolution
                                           : std::max(extent.longest / kDefaultResolution, least);
  if (!(cell >= least))
    throw InputError(fmt::format(
        "a mesh with cells of {:.6g} was asked for; so far from the origin ({:.6g}) float32 needs cells "
        "of at least {:.6g}",
        cell, extent.coordinate, least));
  refuseTooMany(SideGrid::pointsFor(bounds, cell), cell);
  return cell;
}

void validate(const IsosurfaceOptions& options) {
  if (options.resolution && options.cell)
    throw InputError("both a resolution and a cell size were given; they say the same thing, give one");
  if (options.resolution && (*options.resolution < 1 || *options.resolution > kMaxResolution))
    throw InputError(
        fmt::format("the resolution is {}; it must be 1 to {}", *options.resolution, kMaxResolution));
  if (options.cell && !(std::isfinite(*options.cell) && *options.cell > 0))
    throw InputError(fmt::format("the cell size is {}; it must be greater than 0", *options.cell));
}

// Until nothing meets any more. What surely meets nothing is not looked at, later only what has changed.
void untangle(DualMesh& dual, Isosurface& out) {
  DualMesh::Triangles triangles = dual.triangles();
  std::vector<bool> fresh(triangles.mesh.triangles.size());
  const std::vector<bool> doubtful = dual.doubtfulQuads();
  for (std::size_t t = 0; t < fresh.size(); ++t) fresh[t] = doubtful[triangles.quad[t]];
  const std::size_t before = dual.count(VertexPlace::NextCell);
  for (int round = 0;; ++round) {
    const auto pairs = meetingPairs(triangles.mesh, fresh);
    if (round == 0) out.pairsParted = pairs.size();
    out.selfIntersections = pairs.size();
    if (pairs.empty() || round == kMaxRounds) break;
    const std::vector<bool> changed = dual.makeSafer(triangles, pairs);
    triangles = dual.triangles();
    fresh.assign(triangles.mesh.triangles.size(), false);
    for (std::size_t t = 0; t < fresh.size(); ++t) fresh[t] = changed[triangles.quad[t]];
  }
  out.fans = dual.fans();
  out.movedVertices = before - dual.count(VertexPlace::NextCell) + dual.count(VertexPlace::MeanCone);
  out.mesh = std::move(triangles.mesh);
}

void meshOf(const SideGrid& grid, const ContourSource& source, Isosurface& out) {
  out.cutCells = grid.cellCount();
  if (grid.edgeCount() > DualMesh::kMaxQuads)
    throw InputError(
        fmt::format("with cells of {:.6g} the surface crosses {} edges of the grid; at most {} are allowed",
                    out.cell, grid.edgeCount(), DualMesh::kMaxQuads));
  DualMesh dual(grid, source);
  untangle(dual, out);
}

}  // namespace

Isosurface isosurfaceOf(const ContourSource& source, const IsosurfaceOptions& options,
                        const Execution& execution) {
  validate(options);
  Isosurface out;
  const Box bounds = source.bounds();
  if (bounds.empty() || extentOf(bounds).longest == 0) return out;
  out.cell = cellFor(bounds, options);
  out.resolution = extentOf(bounds).longest / out.cell;
  inArena(execution, [&] { meshOf(SideGrid(source, bounds, out.cell), source, out); });
  return out;
}

Isosurface isosurfaceOf(const GridSource& source, const Execution& execution) {
  Isosurface out;
  const Box bounds = source.bounds();
  if (bounds.empty()) return out;
  const GridSource::Grid grid = source.grid();
  std::array<double, 3> points{};
  for (std::size_t a = 0; a < 3; ++a) points[a] = static_cast<double>(grid.coordinates[a].size());
  out.cell = grid.cell;
  out.resolution = extentOf(bounds).longest / out.cell;
  refuseTooMany(points, out.cell);
  inArena(execution, [&] { meshOf(SideGrid(source), source, out); });
  return out;
}

}  // namespace restroke::points
