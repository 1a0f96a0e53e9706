#include "points/dexel/mesh_dexels.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <span>
#include <utility>

#include "implicit/errors.h"
#include "implicit/parallel.h"
#include "points/dexel/lattice_frame.h"
#include "points/dexel/mesh_scan.h"

namespace restroke::points {

namespace {

using Line = MeshLines::Line;

// Of one band; the lists of all bands, put together in order, are those of the model.
struct BandLines {
  std::size_t odd = 0, overlapping = 0;
  std::vector<Line> firstOdd, firstOverlapping;
};

void note(std::size_t& count, std::vector<Line>& first, const Line& line) {
  if (count++ < MeshLines::kListed) first.push_back(line);
}

void append(MeshLines::List& list, int axis, std::size_t count, std::span<const Line> first) {
  list.counts[static_cast<std::size_t>(axis)] += count;
  const std::size_t room = MeshLines::kListed - list.first.size();
  list.first.insert(list.first.end(), first.begin(),
                    first.begin() + static_cast<std::ptrdiff_t>(std::min(room, first.size())));
}

// What the threads that work on a family hold.
struct Scratch {
  RowCrossings crossings;
  ParitySpans line;
  LineEnds ends;
};

class FamilyOfMesh {
 public:
  FamilyOfMesh(const DexelGrid& grid, int axis, const LatticeMesh& mesh, const FaceNormals& normals)
      : grid_(grid),
        axis_(axis),
        frame_(grid, axis),
        scan_(mesh, frame_.lattice()),
        normals_(normals),
        bands_(static_cast<std::size_t>(scan_.bandCount())) {}

  void fill(Dexels& dexels) {
    tbb::parallel_for(tbb::blocked_range<int>(0, scan_.bandCount()),
                      [&](const tbb::blocked_range<int>& range) {
                        Scratch scratch;
                        for (int band = range.begin(); band < range.end(); ++band)
                          fillBand(band, dexels, scratch);
                      });
  }

  void report(MeshLines& lines) const {
    for (const BandLines& band : bands_) {
      append(lines.odd, axis_, band.odd, band.firstOdd);
      append(lines.overlapping, axis_, band.overlapping, band.firstOverlapping);
    }
  }

 private:
  void fillBand(int band, Dexels& dexels, Scratch& scratch) {
    BandLines& lines = bands_[static_cast<std::size_t>(band)];
    scan_.scan(band, scratch.crossings);
    const RowCrossings& rows = scratch.crossings;
    if (rows.all.empty()) return;
    for (int row = rows.firstRow; row < rows.firstRow + rows.rows; ++row)
      for (int column = 0; column < rows.width; ++column) {
        const auto crossings = rows.of(column, row);
        if (crossings.empty()) continue;
        ParitySpans& line = scratch.line;
        findSpans(crossings, normals_, frame_.along(), line);
        const auto here = [&] {
          return Line{axis_, grid_.at((axis_ + 1) % 3, column), grid_.at((axis_ + 2) % 3, row)};
        };
        if (line.isOdd) note(lines.odd, lines.firstOdd, here());
        if (line.overlaps) note(lines.overlapping, lines.firstOverlapping, here());
        if (line.spans.empty()) continue;
        scratch.ends.clear();
        for (const ToolSpan& span : line.spans) {
          scratch.ends.push_back({span.enter, span.enterNormal, OperationId::Initial, OperationId::None});
          scratch.ends.push_back({span.exit, span.exitNormal, OperationId::Initial, OperationId::None});
        }
        dexels.write(dexels.lineAt(column, row), scratch.ends);
      }
  }

  const DexelGrid& grid_;
  int axis_;
  AxisFrame frame_;
  MeshScan scan_;
  const FaceNormals& normals_;
  std::vector<BandLines> bands_;
};

constexpr const char* kRule = "a line has to leave a solid as often as it enters";

void refuseOdd(const MeshLines& lines, const char* advice) {
  if (lines.odd.count() == 0) return;
  throw InputError(fmt::format("lines that pass through the mesh an odd number of times: {}; {}{}",
                               describe(lines.odd), kRule, advice));
}

}  // namespace

std::string describe(const MeshLines::List& list) {
  constexpr const char* kAxes[] = {"x", "y", "z"};
  std::string text;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (list.counts[axis] > 0)
      text += fmt::format("{}{} along {}", text.empty() ? "" : ", ", list.counts[axis], kAxes[axis]);
  if (text.empty()) return "none";
  const Line& first = list.first.front();
  return text + fmt::format(", first along {} at {} = {:.6g}, {} = {:.6g}", kAxes[first.axis],
                            kAxes[(first.axis + 1) % 3], first.u, kAxes[(first.axis + 2) % 3], first.v);
}

SampledMesh sampleMesh(const TriangleMesh& mesh, const DexelGrid& grid, const Execution& execution) {
  checkMesh(mesh);
  SampledMesh sampled{TriDexel(grid), {}};
  const std::vector<DVec3> vertices(mesh.vertices.begin(), mesh.vertices.end());
  const FaceNormals normals(vertices, mesh.triangles);
  std::array<MeshLines, 3> lines;
  inArena(execution, [&] {
    tbb::parallel_for(0, 3, [&](int axis) {
      const std::vector<DVec3> own = inFrameOf(axis, vertices);
      FamilyOfMesh family(grid, axis, {own, mesh.triangles}, normals);
      family.fill(sampled.model.family(axis));
      family.report(lines[static_cast<std::size_t>(axis)]);
    });
  });
  for (int axis = 0; axis < 3; ++axis) {
    const MeshLines& of = lines[static_cast<std::size_t>(axis)];
    append(sampled.lines.odd, axis, of.odd.count(), of.odd.first);
    append(sampled.lines.overlapping, axis, of.overlapping.count(), of.overlapping.first);
  }
  return sampled;
}

TriDexel triDexelOf(const TriangleMesh& mesh, const DexelGrid& grid, const Execution& execution) {
  SampledMesh sampled = sampleMesh(mesh, grid, execution);
  refuseOdd(sampled.lines, "");
  return std::move(sampled.model);
}

MeshModel meshModelOf(const TriangleMesh& mesh, const MeshModelOptions& options, const Execution& execution) {
  MeshModel made;
  if (options.repair == MeshRepair::Winding) {
    Repaired repaired = repairByWinding(mesh, {}, execution);
    made.solid = std::move(repaired.mesh);
    made.repaired = repaired.way;
    made.faults = std::move(repaired.faults);
  } else {
    checkMesh(mesh);
    made.solid = mesh;
  }
  SampledMesh sampled = sampleMesh(made.solid, dexelGridFor(boundsOf(made.solid), options.lines), execution);
  refuseOdd(sampled.lines, " (--repair winding makes a solid of the mesh)");
  made.model = std::move(sampled.model);
  made.lines = std::move(sampled.lines);
  return made;
}

}  // namespace restroke::points
