#pragma once
// The inner loops of side tests and surfel pruning: 16 points against a list of primitives. Spheres are
// tested here; what is no sphere is met through the ball around it, and then asked itself. One source
// (ball_kernels.inc), compiled once for each instruction set; every level gives the same bits, because each
// operation is a single IEEE float32 + - * or comparison, in the same order, never fused.

#include <cstddef>
#include <cstdint>
#include <span>

#include "implicit/simd/dispatch.h"

namespace restroke::implicit {

/// Points are handled in patches of this many.
inline constexpr std::size_t kPatch = 16;

/// Where the cells of a volume's grid (clearance_grid.h) lie in the model, and what is known of them. Every
/// PosedVolume is one.
struct GriddedVolume {
  const std::int8_t* const* cells;  ///< null there: nothing is known yet. To be read atomically
  bool sure;                        ///< float32 is precise enough to look a point up
  float origin[3];                  ///< of the volume's frame
  float toCells[9], shift[3];       ///< from there to cells: rows, and what is added
  float last[3];                    ///< cells are looked up within 0 and this
  float row, layer;                 ///< cells from one row, and from one layer, to the next
};

/// Balls as arrays, padded to a multiple of kPatch with balls that nothing meets (x = kNowhere). Ordered by
/// list position.
struct BallArrays {
  const float *x, *y, *z;
  const float* reach;  ///< radius for conservative overlap tests: no less than any distance at which a test
                       ///< below says yes
  const float* r2;     ///< squared radius: the exact side test
  const float*
      r2Drop;  ///< squared radius of the ball that drops older samples, boundary and rounding included
  const GriddedVolume* const* volume;  ///< null for a sphere; else what the ball is around, and r2 and r2Drop
                                       ///< mean nothing
  bool anyVolume;                      ///< is `volume` anywhere not null?
  const std::uint8_t* positive;        ///< 1 adds, 0 carves
  std::uint32_t count;                 ///< without the padding
  std::uint32_t earlier;  ///< the first `earlier` of them stand before the sampled primitive in the list
  std::uint32_t later;    ///< from here on they stand after it; one that is between is itself, and not asked
};
inline constexpr float kNowhere = 1e30f;

/// A primitive's samples before it is placed: positions and normals in patches of 16, under a tree of
/// bounding spheres of fan-out 16.
struct PatchTree {
  static constexpr int kMaxLevels = 7;
  const float *x, *y, *z;     ///< positions; of a sphere: unit directions
  const float *nx, *ny, *nz;  ///< outward unit normals; of a sphere: the same arrays
  struct Level {
    const float *x, *y, *z, *radius;  ///< bounding spheres, padded to multiples of 16
    std::uint32_t count;
  } level[kMaxLevels];  ///< level 0: the patches; level k: groups of 16^k patches
  int levels;
};

/// A rotation and a scaled one, rows first.
struct Rotations {
  float unit[9], scaled[9];
};

/// One placed primitive whose samples are asked about: they lie at center + scale * rotation * position.
struct SampledShape {
  const PatchTree* tree;
  float x, y, z;               ///< of a sphere the centre
  float scale;                 ///< of a sphere the radius
  const Rotations* rotations;  ///< null: none, as for spheres
  float keepScale;   ///< of a sphere: radius of the sphere on which the keep test is made, just outside
  float keepOffset;  ///< of others: distance along the normal at which it is made
  float slack;       ///< added to bounding radii: more than rounding can move a sample
  bool positive;
};

/// The samples of one patch where the primitive has them, one after the other.
struct PlacedPatch {
  struct Row {
    float x, y, z;     ///< place
    float nx, ny, nz;  ///< unit normal out of the whole shape: of a carving primitive into it
  } row[kPatch];
};

/// The primitive that drops older samples, boundary and rounding included.
struct DropBall {
  float x, y, z, reach, r2Drop;
  const GriddedVolume* volume;  ///< null for a sphere
};

/// Bounding sphere of a node of the shape's tree, widened by the margin. Static: each file has its own, since
/// code of one instruction set must never be linked into another's caller.
[[nodiscard]] static inline DropBall sphereOfNode(const SampledShape& shape, int level, std::uint32_t node,
                                                  float margin) {
  const PatchTree::Level& l = shape.tree->level[level];
  const float x = l.x[node], y = l.y[node], z = l.z[node], reach = shape.scale * l.radius[node] + margin;
  if (!shape.rotations)
    return {
        shape.x + shape.scale * x, shape.y + shape.scale * y, shape.z + shape.scale * z, reach, 0, nullptr};
  const float* m = shape.rotations->scaled;
  return {shape.x + (m[0] * x + m[1] * y + m[2] * z),
          shape.y + (m[3] * x + m[4] * y + m[5] * z),
          shape.z + (m[6] * x + m[7] * y + m[8] * z),
          reach,
          0,
          nullptr};
}

/// Up to 16 points, and a sphere that holds those in `lanes`.
struct PointGroup {
  const float *x, *y, *z;
  std::uint32_t lanes;  ///< bit i: point i counts
  DropBall sphere;
};

/// Those of the points that are in the volume or on its boundary; when dropping, also those just outside that
/// rounding may have moved there. The same bits at every instruction set: it is compiled once. The volume
/// must be a PosedVolume.
[[nodiscard]] std::uint32_t lanesInVolume(const GriddedVolume& volume, const PointGroup& group,
                                          bool dropping);

/// Spheres as they are kept: centre and radius, 16 bytes apart.
struct PackedBall {
  float x, y, z, radius;
};

/// The kernels of one instruction set.
struct BallKernels {
  /// Of the balls that `slots` names, writes (to `out`, which has room for all) the slots of those that may
  /// meet the sphere (x, y, z, reach), in order; returns how many. `reach` is widened by the caller for what
  /// the balls' tests reach beyond them; the tests here allow for their own rounding.
  std::size_t (*meetingSlots)(const PackedBall* balls, std::span<const std::uint32_t> slots,
                              const DropBall& sphere, std::uint32_t* out);
  /// Of 16 points in a sphere, those (of its lanes) whose last containing primitive is positive. All of the
  /// arrays count.
  std::uint32_t (*insideLanes)(const PointGroup& group, const BallArrays& balls);
  /// Visibility (SPEC S3) of the samples of the listed patches: bit k of masks[p] becomes that of sample k of
  /// patch p. Returns by how much the number of visible samples has grown.
  std::ptrdiff_t (*evaluatePatches)(const SampledShape& shape, std::span<const std::uint32_t> patches,
                                    const BallArrays& balls, std::uint16_t* masks);
  /// The same for all patches under a node of the tree. Returns how many samples are visible.
  std::size_t (*evaluateNode)(const SampledShape& shape, int level, std::uint32_t node,
                              const BallArrays& balls, std::uint16_t* masks);
  /// Clears the samples that lie in the ball; returns how many were visible before.
  std::size_t (*dropSamples)(const SampledShape& shape, const DropBall& drop, std::uint16_t* masks);
  /// Marks the patches that may meet the ball: bit k of blocks[b] is patch 16 b + k. Others stay.
  void (*touchedPatches)(const SampledShape& shape, const DropBall& drop, std::uint16_t* blocks);
  /// Writes all samples of a patch, visible or not: those of placedSample (shape.h), bit for bit.
  void (*placePatch)(const SampledShape& shape, std::uint32_t patch, PlacedPatch& out);
};

[[nodiscard]] const BallKernels& ballKernels();
[[nodiscard]] const BallKernels& ballKernels(SimdLevel level);

}  // namespace restroke::implicit
