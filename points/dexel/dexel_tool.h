#pragma once
// A mesh as a tool that cuts or adds in one pose after the other (SPEC D4, D6).

#include <vector>

#include "implicit/execution.h"
#include "implicit/geometry/triangle_mesh.h"
#include "points/dexel/tool_pose.h"
#include "points/dexel/tri_dexel.h"

namespace restroke::points {

/// A mesh that is known to have an inside, whatever the direction it is looked at from: an even number of
/// triangles meets at each of its edges. It may face either way, and meet itself: what is inside is told by
/// parity, so that shells which overlap have an outside where they do (repairByWinding unites them).
class DexelTool {
 public:
  /// Throws InputError when there are no triangles, a triangle names a vertex that is not there, a coordinate
  /// is not finite, or an edge belongs to an odd number of triangles (how many edges, and where). Vertices
  /// are the same when their numbers are: readMesh makes equal ones one. O(n log n).
  explicit DexelTool(TriangleMesh mesh, const Execution& execution = {});

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  /// The tool's vertices in a pose, in double, and their box, rounded outwards. Throws InputError as
  /// checkPose, or when the pose takes a vertex beyond what float32 can hold. O(vertices).
  struct Posed {
    std::vector<DVec3> vertices;
    Box box;
  };
  [[nodiscard]] Posed in(const PoseMatrix& pose) const;

 private:
  TriangleMesh mesh_;
};

/// One application of a tool.
struct ToolStep {
  PoseMatrix pose = kIdentityPose;
  DexelOperation operation = DexelOperation::Subtraction;
  OperationId id{};
};

/// Unites a model with the tool in a pose, subtracts the tool, or leaves only what is in it. The tool is
/// sampled on the model's own lines, where they meet its box: the result is that of TriDexel::apply with the
/// tri-dexel of the posed mesh. What a union adds beyond the grid is cut off at its outermost lines: growTo
/// `tool.in(pose).box` first. Throws InputError as DexelTool::in; the model is then as it was. O(lines in the
/// tool's box + triangles), an intersection O(all lines).
void apply(TriDexel& model, const DexelTool& tool, const ToolStep& step, const Execution& execution = {});

}  // namespace restroke::points
