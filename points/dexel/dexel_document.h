#pragma once
// A tri-dexel model with its past: what it takes to refine it (SPEC R2, R10).

#include <cstdint>
#include <variant>
#include <vector>

#include "implicit/geometry/triangle_mesh.h"
#include "implicit/primitive.h"
#include "points/dexel/tool_pose.h"
#include "points/dexel/toolpath/cutter.h"
#include "points/dexel/tri_dexel.h"

namespace restroke::points {

/// What a tri-dexel is and how it came about. `operations[i]` was applied as OperationId{i + 1}; 0 is the
/// initial solid.
struct TriDexelDocument {
  /// Nothing, a mesh, or signed primitives.
  std::variant<std::monostate, TriangleMesh, std::vector<implicit::Primitive>> initial;
  /// Meshes that operations use.
  std::vector<TriangleMesh> tools;
  std::vector<Cutter> cutters;

  /// A tool mesh in a pose.
  struct PosedTool {
    std::uint32_t tool = 0;  ///< index in `tools`
    /// From the tool's coordinates to the model's: 4 x 4, row by row, finite.
    PoseMatrix pose = kIdentityPose;
    bool operator==(const PosedTool&) const = default;
  };
  struct Operation {
    DexelOperation operation = DexelOperation::Subtraction;
    std::variant<implicit::Shape, PosedTool, CutterMove> tool;
    bool operator==(const Operation&) const = default;
  };
  std::vector<Operation> operations;

  /// Operations that follow each other, which the histories of the model's lines name as one: by the first
  /// (SPEC R7; refine/resultants.h). To replay it is to replay all of them.
  struct Run {
    OperationId first{};
    std::uint32_t count = 0;  ///< 2 or more
    bool operator==(const Run&) const = default;
  };
  /// Ascending and apart from each other. An operation in none of them stands for itself.
  std::vector<Run> runs;

  TriDexel model;
};

}  // namespace restroke::points
