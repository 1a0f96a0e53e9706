#pragma once
// A mesh in a pose, as lines in any direction see it.

#include <memory>

#include "implicit/geometry/triangle_mesh.h"
#include "implicit/geometry/triangle_tree.h"
#include "points/dexel/tool_pose.h"
#include "points/dexel/tool_solid.h"

namespace restroke::points {

/// A mesh with the tree that lines are cast against; shared by its poses. Refers to the mesh.
class MeshForLines {
 public:
  /// Throws InputError when a triangle names a vertex that is not there or a coordinate is not finite.
  /// O(n log n).
  explicit MeshForLines(const TriangleMesh& mesh);
  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }
  [[nodiscard]] const TriangleTree& tree() const { return tree_; }
  /// Half the diagonal of its box.
  [[nodiscard]] double radius() const { return radius_; }

 private:
  const TriangleMesh& mesh_;
  TriangleTree tree_;
  double radius_;
};

/// What is inside by the parity of a line's crossings, as of a DexelTool (dexel_tool.h) in the same pose, but
/// for rounding: lines are brought into the mesh's frame. Crossings at one depth vanish in pairs. Of a mesh
/// with an open edge a line may have an odd number of crossings; it has no spans then.
class MeshSolid final : public ToolSolid {
 public:
  /// Throws InputError as checkPose, and when the pose takes the mesh beyond what float32 can hold.
  MeshSolid(std::shared_ptr<const MeshForLines> mesh, const PoseMatrix& pose);
  void intersect(const Ray& line, std::vector<SolidSpan>& spans) const override;

 private:
  std::shared_ptr<const MeshForLines> mesh_;
  // From the model to the mesh: rotation^T / scale^2 (rows) after the translation is undone.
  DVec3 rows_[3];
  DVec3 translation_;
};

}  // namespace restroke::points
