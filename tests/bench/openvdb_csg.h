#pragma once
// A rival: the same stamps through OpenVDB's level set CSG. Behind a header of its own, because OpenVDB's
// take half a minute to compile.

#include <cstddef>
#include <memory>
#include <vector>

#include "implicit/primitive.h"

namespace restroke::bench {

struct OpenVdbGrid;

struct OpenVdbResult {
  std::vector<double> stampMicroseconds;  ///< of every primitive but the base
  double seconds = 0;                     ///< whole replay, the base included
  std::size_t bytes = 0;                  ///< of the final grid
  std::size_t activeVoxels = 0;
  std::shared_ptr<const OpenVdbGrid> grid;  ///< null after an empty list
};

/// Replays the list with createLevelSetSphere and csgUnion / csgDifference, narrow band of 3 voxels.
[[nodiscard]] OpenVdbResult replayWithOpenVdb(const std::vector<implicit::Primitive>& list, double voxel);

}  // namespace restroke::bench
