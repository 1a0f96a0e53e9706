#pragma once
// The inner loops of the rivals, for each instruction set: a ball against a leaf of OpenVDB, and balls
// against a ball or a line. Nothing else is included here, because the sources of brush_kernels.inc are
// compiled with instruction sets that their callers may lack.

#include <cstddef>
#include <cstdint>

namespace restroke::bench {

/// A leaf of 8 x 8 x 8 voxels as OpenVDB keeps it: z fastest, then y, then x; one word of bits for each x.
struct BrushedLeaf {
  float* values;          ///< 512 distances, model units
  std::uint64_t* active;  ///< 8 words: which voxels are in the band
  float x, y, z;          ///< from the ball's centre to the first voxel, model units
};

struct BrushBall {
  float radius, band, voxel;  ///< model units; band is the background as well
  bool adds;                  ///< else it carves
};

/// Spheres as arrays, padded to a multiple of 16 with spheres that nothing meets.
struct BallColumns {
  const float *x, *y, *z, *radius;
  std::size_t count;
};

struct BrushKernels {
  /// min(old, distance to the ball) where it adds, max(old, -distance) where it carves.
  void (*brushLeaf)(const BrushedLeaf& leaf, const BrushBall& ball);
  /// Writes the numbers of the balls that may meet the sphere (x, y, z, radius), in order; returns how many.
  std::size_t (*ballsMeeting)(const BallColumns& balls, const float* sphere, std::uint32_t* out);
  /// The same for the line through origin[0..2] with the unit direction[0..2]; radii count as larger by
  /// `pad`.
  std::size_t (*ballsOnLine)(const BallColumns& balls, const float* origin, const float* direction, float pad,
                             std::uint32_t* out);
};

/// brushLeaf as plain loops, row by row, for the compiler to make the best of.
void brushLeafPlainly(const BrushedLeaf& leaf, const BrushBall& ball);

extern const BrushKernels kBrushKernelsSse2, kBrushKernelsAvx2, kBrushKernelsAvx512;

}  // namespace restroke::bench
