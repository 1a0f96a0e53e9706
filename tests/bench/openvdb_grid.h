#pragma once
// What the sources of the OpenVDB rivals share. Includes OpenVDB's headers: only those sources include it.

#include <openvdb/openvdb.h>

namespace restroke::bench {

/// A level set: distances in model units, narrow band of kHalfWidth voxels.
struct OpenVdbGrid {
  openvdb::FloatGrid::Ptr grid;
};
inline constexpr float kHalfWidth = 3;

}  // namespace restroke::bench
