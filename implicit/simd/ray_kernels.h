#pragma once
// The inner loops of ray casting: which of a cell's balls a stretch of a ray may meet, and where a ray's line
// is inside of spheres. One source (ray_kernels.inc), compiled once for each instruction set; every level
// gives the same bits: the first may say yes too often, and does so equally often everywhere.

#include <cstddef>
#include <cstdint>

#include "implicit/simd/dispatch.h"

namespace restroke::implicit {

/// A stretch of a ray in float32.
struct RayStretch {
  float x, y, z;     ///< its middle
  float dx, dy, dz;  ///< unit direction
  float half;        ///< half its length
  float pad;         ///< added to every reach: more than rounding can move anything
};

/// A ray's line in double.
struct RayLine {
  double ox, oy, oz;  ///< origin
  double dx, dy, dz;  ///< direction
  double dd;          ///< its squared length, > 0
};

/// Spheres as columns, and what is found of them. Columns may be read and written to the end of the batch,
/// whatever is there.
struct RayBatch {
  static constexpr std::size_t kSize = 64;
  alignas(64) double x[kSize], y[kSize], z[kSize], r[kSize];  ///< centres and radii
  alignas(64) double enter[kSize], exit[kSize];  ///< where the line is inside; both NaN where it is not
};

/// The kernels of one instruction set.
struct RayKernels {
  /// Of 1 to RayBatch::kSize slots, those (bit i is slots[i]) whose balls the stretch may meet: none that it
  /// does is left out. `balls` has x, y, z, reach for each slot.
  std::uint64_t (*meeting)(const RayStretch& stretch, const float* balls, const std::uint32_t* slots,
                           std::size_t count);
  /// intersect(Sphere, Ray) for the first `count` spheres, bit for bit.
  void (*intersect)(const RayLine& line, RayBatch& batch, std::size_t count);
};

[[nodiscard]] const RayKernels& rayKernels();
[[nodiscard]] const RayKernels& rayKernels(SimdLevel level);

}  // namespace restroke::implicit
