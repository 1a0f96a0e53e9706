#pragma once
// A rival for making meshes: OpenVDB's way from a mesh to a level set and back.

#include <cstddef>

#include "implicit/geometry/triangle_mesh.h"

namespace restroke::bench {

struct OpenVdbMeshing {
  double toLevelSet = 0, toMesh = 0;  ///< seconds, on as many threads as the caller's arena has
  std::size_t quads = 0;
};
/// meshToLevelSet with its usual band, then volumeToMesh without simplification.
[[nodiscard]] OpenVdbMeshing meshThroughOpenVdb(const TriangleMesh& mesh, double voxel);

}  // namespace restroke::bench
