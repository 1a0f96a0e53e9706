#pragma once
// The inner loops of side tests and surfel pruning: 16 points against a list of balls. One source
// (ball_kernels.inc), compiled once for each instruction set; every level gives the same bits, because each
// operation is a single IEEE float32 + - * or comparison, in the same order, never fused.

#include <cstddef>
#include <cstdint>

#include "implicit/simd/dispatch.h"

namespace restroke::implicit {

/// Points are handled in patches of this many.
inline constexpr std::size_t kPatch = 16;

/// Balls as arrays, padded to a multiple of kPatch with balls that nothing meets (x = kNowhere). Ordered by
/// list position.
struct BallArrays {
  const float *x, *y, *z;
  const float* reach;  ///< radius for conservative overlap tests: no less than any distance at which a test
                       ///< below says yes
  const float* r2;     ///< squared radius: the exact side test
  const float*
      r2Drop;  ///< squared radius of the ball that drops older samples, boundary and rounding included
  const std::uint8_t* positive;  ///< 1 adds, 0 carves
  std::uint32_t count;           ///< without the padding
  std::uint32_t earlier;  ///< the first `earlier` of them stand before the sampled primitive in the list, the
                          ///< rest after it
};
inline constexpr float kNowhere = 1e30f;

/// A sphere's samples: a table of unit directions in patches of 16, under a tree of bounding spheres of
/// fan-out 16.
struct PatchTree {
  static constexpr int kMaxLevels = 7;
  const float *dx, *dy, *dz;  ///< unit directions
  struct Level {
    const float *x, *y, *z,
        *radius;  ///< bounding spheres, in units of the sphere's radius, padded to multiples of 16
    std::uint32_t count;
  } level[kMaxLevels];  ///< level 0: the patches; level k: groups of 16^k patches
  int levels;
};

/// One sphere whose samples are asked about.
struct PatchedBall {
  PatchTree tree;
  float x, y, z, radius;
  float keepRadius;  ///< radius of the sphere on which the keep test is made, just outside
  float slack;       ///< added to bounding radii: more than rounding can move a sample
  bool positive;
};

struct DropBall {
  float x, y, z, reach, r2Drop;
};

/// The kernels of one instruction set.
struct BallKernels {
  /// Of 16 points, those (of the lanes in `lanes`) whose last containing ball is positive. r2 decides; all
  /// balls count.
  std::uint32_t (*insideLanes)(const float* px, const float* py, const float* pz, std::uint32_t lanes,
                               const BallArrays& balls);
  /// Visibility (SPEC S3) of the samples of the listed patches: bit k of masks[i] is sample k of patches[i].
  void (*evaluatePatches)(const PatchedBall& ball, const std::uint32_t* patches, std::size_t count,
                          const BallArrays& balls, std::uint16_t* masks);
  /// The same for all patches under a node of the tree; masks is indexed by patch number.
  void (*evaluateNode)(const PatchedBall& ball, int level, std::uint32_t node, const BallArrays& balls,
                       std::uint16_t* masks);
  /// Clears the samples that lie in the ball; returns how many were visible before.
  std::size_t (*dropSamples)(const PatchedBall& ball, const DropBall& drop, std::uint16_t* masks);
  /// Writes the numbers of the patches that may meet the ball, in order; returns how many. `out` has room for
  /// all.
  std::size_t (*touchedPatches)(const PatchedBall& ball, const DropBall& drop, std::uint32_t* out);
};

[[nodiscard]] const BallKernels& ballKernels();
[[nodiscard]] const BallKernels& ballKernels(SimdLevel level);

}  // namespace restroke::implicit
