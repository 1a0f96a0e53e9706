#pragma once
// A rival for tri-dexels of meshes: Embree's rays, one crossing after the other on each line.

#include <cstddef>

#include "implicit/geometry/triangle_mesh.h"
#include "points/dexel/dexel_grid.h"

namespace restroke::bench {

struct EmbreeLines {
  double seconds = 0;  ///< building the scene and casting all lines, on one thread
  std::size_t crossings = 0;
};
/// Robust mode. Throws InputError when Embree cannot be started.
[[nodiscard]] EmbreeLines castLines(const TriangleMesh& mesh, const points::DexelGrid& grid);

}  // namespace restroke::bench
