#pragma once
// Near-uniform samples of triangles, however many and however small they are.

#include <cstdint>
#include <span>
#include <vector>

#include "implicit/sampling/sample_table.h"

namespace restroke::implicit {

/// A flat piece of surface.
struct SurfaceTriangle {
  DVec3 a, b, c;
  DVec3 normal;              ///< unit, outwards
  std::uint32_t region = 0;  ///< the same for triangles that make one smooth face, counted from 0
};

/// Exactly `count` samples; every region gets its area's share of them. Within that, samples keep apart (by
/// about 0.8 of the root of the area per sample on wide faces), unless their normals turn by more than 120
/// degrees (the two sides of a plate): darts are thrown at a radius that shrinks when the surface is full,
/// until there are enough (McCool and Fiume, "Hierarchical Poisson disk sampling distributions", Graphics
/// Interface 1992). Darts come from a low-discrepancy sequence over the area, so that the same triangles give
/// the same samples. Triangles without area are passed over; there must be others. O(count log triangles).
[[nodiscard]] std::vector<SurfaceSample> samplePoisson(std::span<const SurfaceTriangle> triangles,
                                                       std::uint32_t count);

}  // namespace restroke::implicit
