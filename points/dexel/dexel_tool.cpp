#include "points/dexel/dexel_tool.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <utility>

#include "implicit/errors.h"
#include "implicit/geometry/mesh_faults.h"
#include "implicit/parallel.h"
#include "points/dexel/lattice_frame.h"
#include "points/dexel/mesh_scan.h"

namespace restroke::points {

namespace {

// Fewer lines and triangles than this are not worth waking other threads for.
constexpr double kFewLines = 20'000;
constexpr std::size_t kFewTriangles = 20'000;

float roundedDown(double x) {
  const auto near = static_cast<float>(x);
  return static_cast<double>(near) <= x ? near
                                        : std::nextafter(near, -std::numeric_limits<float>::infinity());
}
float roundedUp(double x) {
  return -roundedDown(-x);
}

// Those points of an axis of the grid that are in a box.
IndexRange pointsBetween(const DexelGrid& grid, int axis, const Box& box) {
  const float to = box.max[axis];
  const int begin = grid.firstFrom(axis, static_cast<double>(box.min[axis]));
  int end = grid.firstFrom(axis, static_cast<double>(to));
  if (end < grid.counts()[static_cast<std::size_t>(axis)] && !(grid.at(axis, end) > to)) ++end;
  return {begin, std::max(begin, end)};
}

double linesToVisit(const DexelGrid& grid, const Box& box, DexelOperation operation) {
  if (operation == DexelOperation::Intersection) return static_cast<double>(grid.lineCount());
  double points[3];
  for (int axis = 0; axis < 3; ++axis) points[axis] = pointsBetween(grid, axis, box).size();
  return points[0] * points[1] + points[1] * points[2] + points[2] * points[0];
}

// A tool where it is, in model space.
struct ToolInPlace {
  const DexelTool::Posed& posed;
  const std::vector<std::array<std::uint32_t, 3>>& triangles;
  const FaceNormals& normals;
};

// The lines of one family that a tool's box meets, and the tool as they see it.
class FamilyUnderTool {
 public:
  FamilyUnderTool(Dexels& dexels, const DexelGrid& grid, int axis, const ToolInPlace& tool)
      : dexels_(dexels),
        hulls_(dexels.hulls()),
        columns_(pointsBetween(grid, (axis + 1) % 3, tool.posed.box)),
        rows_(pointsBetween(grid, (axis + 2) % 3, tool.posed.box)),
        frame_(grid, axis, columns_, rows_),
        vertices_(inFrameOf(axis, tool.posed.vertices)),
        scan_({vertices_, tool.triangles}, frame_.lattice()),
        normals_(tool.normals) {}

  [[nodiscard]] int bandCount() const { return scan_.bandCount(); }

  void applyBand(int band, const ToolStep& step) {
    RowCrossings crossings;
    scan_.scan(band, crossings);
    if (crossings.all.empty() && step.operation != DexelOperation::Intersection) return;
    ParitySpans found;
    LineEnds ends;
    for (int row = crossings.firstRow; row < crossings.firstRow + crossings.rows; ++row)
      for (int column = 0; column < crossings.width; ++column) {
        const std::size_t line = dexels_.lineAt(columns_.begin + column, rows_.begin + row);
        findSpans(crossings.of(column, row), normals_, frame_.along(), found);
        // The tool has no odd edges.
        RESTROKE_CHECK_EQ(found.isOdd, false);
        if (step.operation != DexelOperation::Intersection) {
          const bool fills = step.operation == DexelOperation::Union;
          for (const ToolSpan& span : found.spans) applySpan(line, span, fills, step.id);
        } else if (!dexels_.isEmpty(line)) {
          dexels_.read(line, ends);
          if (applyToLine(ends, found.spans, step.operation, step.id)) {
            dexels_.write(line, ends);
            if (dexels_.keepsHistory()) dexels_.noteChange(line, step.id);
          }
        }
      }
  }

  // What the tool's box does not meet is not in the tool.
  void clearBeyond(int row, OperationId id) {
    const bool isMet = row >= rows_.begin && row < rows_.end;
    for (int column = 0; column < dexels_.width(); ++column) {
      if (isMet && column >= columns_.begin && column < columns_.end) continue;
      if (const std::size_t line = dexels_.lineAt(column, row); !dexels_.isEmpty(line)) {
        dexels_.write(line, {});
        if (dexels_.keepsHistory()) dexels_.noteChange(line, id);
      }
    }
  }

 private:
  void applySpan(std::size_t line, const ToolSpan& span, bool fills, OperationId id) {
    const float enter = hulls_.enter[line], exit = hulls_.exit[line];
    if (fills) {
      if (!dexels_.hasMore(line) && enter <= span.enter && span.exit <= exit) return;
      dexels_.change(line, span, true, id);
    } else if (span.enter < exit && enter < span.exit) {
      dexels_.change(line,
                     {span.enter, span.exit, turnedAround(span.enterNormal), turnedAround(span.exitNormal)},
                     false, id);
    }
  }

  Dexels& dexels_;
  Dexels::Hulls hulls_;
  IndexRange columns_, rows_;
  AxisFrame frame_;
  std::vector<DVec3> vertices_;
  MeshScan scan_;
  const FaceNormals& normals_;
};

// `forEach(count, f)` calls f(0) to f(count - 1) in any order, also at the same time.
template <class ForEach>
void applyToFamilies(TriDexel& model, const ToolInPlace& tool, const ToolStep& step, const ForEach& forEach) {
  forEach(3, [&](int axis) {
    Dexels& dexels = model.family(axis);
    FamilyUnderTool family(dexels, model.grid(), axis, tool);
    forEach(family.bandCount(), [&](int band) { family.applyBand(band, step); });
    if (step.operation == DexelOperation::Intersection)
      forEach(dexels.height(), [&](int row) { family.clearBeyond(row, step.id); });
  });
}

}  // namespace

DexelTool::DexelTool(TriangleMesh mesh, const Execution& execution) : mesh_(std::move(mesh)) {
  if (mesh_.triangles.empty()) throw InputError("the tool has no triangles; it must be a solid");
  const auto odd = oddEdgesOf(mesh_, execution);
  if (odd.count == 0) return;
  const MeshFaults::Edge& first = odd.first.front();
  const auto text = [](const MeshFaults::Vertex& v) {
    return fmt::format("({}, {}, {})", v.position.x, v.position.y, v.position.z);
  };
  throw InputError(
      fmt::format("edges of the tool that belong to an odd number of triangles: {}, the first, of {}, from "
                  "{} to {}; a line has to "
                  "leave a solid as often as it enters (--repair winding makes a solid of the mesh)",
                  odd.count, first.triangles, text(first.ends[0]), text(first.ends[1])));
}

DexelTool::Posed DexelTool::in(const PoseMatrix& pose) const {
  checkPose(pose);
  Posed to;
  to.vertices.reserve(mesh_.vertices.size());
  for (const Point& p : mesh_.vertices) to.vertices.push_back(posed(pose, DVec3(p)));
  DVec3 low(std::numeric_limits<double>::infinity()), high = -low;
  for (const auto& triangle : mesh_.triangles)
    for (const std::uint32_t v : triangle) {
      low = glm::min(low, to.vertices[v]);
      high = glm::max(high, to.vertices[v]);
    }
  to.box = {{roundedDown(low.x), roundedDown(low.y), roundedDown(low.z)},
            {roundedUp(high.x), roundedUp(high.y), roundedUp(high.z)}};
  if (!isFinite(to.box.min) || !isFinite(to.box.max))
    throw InputError(
        fmt::format("the pose takes the tool to ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}); "
                    "float32 has no such numbers",
                    low.x, low.y, low.z, high.x, high.y, high.z));
  return to;
}

void apply(TriDexel& model, const DexelTool& tool, const ToolStep& step, const Execution& execution) {
  const DexelTool::Posed posed = tool.in(step.pose);
  const auto& triangles = tool.mesh().triangles;
  const FaceNormals normals(posed.vertices, triangles);
  const ToolInPlace inPlace{posed, triangles, normals};
  const bool isSmall =
      linesToVisit(model.grid(), posed.box, step.operation) < kFewLines && triangles.size() < kFewTriangles;
  if (isSmall) {
    applyToFamilies(model, inPlace, step, [](int count, const auto& f) {
      for (int i = 0; i < count; ++i) f(i);
    });
    return;
  }
  inArena(execution, [&] {
    applyToFamilies(model, inPlace, step, [](int count, const auto& f) { tbb::parallel_for(0, count, f); });
  });
}

}  // namespace restroke::points
