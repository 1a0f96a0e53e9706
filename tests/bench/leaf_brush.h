#pragma once
// The strongest rival of OpenVDB's kind: no grid for each stamp, but a brush that writes into the level set's
// leaves. Behind a header of its own, because OpenVDB's take half a minute to compile.

#include <cstddef>
#include <memory>

#include "implicit/primitive_list.h"

namespace restroke::bench {

struct OpenVdbGrid;

/// A level set with a narrow band of 3 voxels, stamped with balls.
///
/// A stamp visits the leaves that the ball's box, band included, meets. It passes over those that the band
/// does not reach and tiles that cannot change, turns a leaf that lies deep in the ball into a tile, and else
/// writes min(old, d) or max(old, -d) into the leaf's buffer: by loops that are left to the compiler, or 4, 8
/// or 16 voxels at a time (brush_kernels.h). The values are those of OpenVDB's CSG, but for rounding.
///
/// Undo is a replay without the stroke. Leaves saved before each stroke would take back the last one only:
/// under later strokes min and max have forgotten what the stroke in the middle had hidden, so that no set
/// of saved leaves brings it back, and the later strokes must be stamped again.
class LeafBrush {
 public:
  enum class Loops { Plain, Simd };
  /// The voxel is in model units. Simd: at the level that Restroke uses.
  explicit LeafBrush(double voxel, Loops loops = Loops::Simd);
  ~LeafBrush();
  LeafBrush(const LeafBrush&) = delete;
  LeafBrush& operator=(const LeafBrush&) = delete;

  /// The primitive must be a sphere; of others the ball around them is taken.
  void stamp(const implicit::Primitive& primitive);
  /// Turns leaves without a band into tiles, as OpenVDB's CSG does after each call.
  void prune();

  [[nodiscard]] std::size_t bytes() const;
  [[nodiscard]] std::size_t activeVoxels() const;

  /// Greatest difference to the other grid, in voxels, over all voxels in the band of either.
  [[nodiscard]] double differenceFrom(const OpenVdbGrid& other) const;
  struct Signs {
    std::size_t asked = 0, wrong = 0;
  };
  /// Asks `tries` random voxels in and around the list's bounds (the same ones each time); those that are
  /// more than one voxel from the surface should have the sign that sideOf says.
  [[nodiscard]] Signs compareSigns(const implicit::PrimitiveList& list, std::size_t tries) const;

 private:
  std::unique_ptr<OpenVdbGrid> grid_;
  double voxel_;
  Loops loops_;
};

}  // namespace restroke::bench
