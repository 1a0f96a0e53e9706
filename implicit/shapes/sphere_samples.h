#pragma once
// The sphere's samples (SPEC S3): equal-area directions in a fixed order, made without libm.

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "implicit/sampling/sample_table.h"
#include "implicit/shapes/sphere.h"

namespace restroke::implicit {

/// The table of `count` unit directions: a spherical Fibonacci lattice (equal area per sample; Gonzalez,
/// "Measurement of areas on a sphere using Fibonacci and latitude-longitude lattices", Mathematical
/// Geosciences 42, 2010). Made at the first call and shared from then on, when it costs a look into an array.
/// Thread-safe. `count` is a value of sampleCountFor.
[[nodiscard]] const SampleTable& sphereSamples(std::uint32_t count);

/// Bytes of all sphere tables made so far.
[[nodiscard]] std::size_t bytesOfSphereSamples();

/// The tolerances that settle coincident boundaries (SPEC S3), from the rounding that float32 leaves: the
/// coordinates of a sphere's surface are at most `m` = max |c| + r, a computed sample is off the sphere by
/// less than 2^-21.4 m, and so is a side test's verdict.
struct SphereTolerance {
  float keepRadius;  ///< of the sphere just outside, on which the keep test is made: r + 2^-18 m
  float dropRadius;  ///< of the ball that drops older samples: r + 2^-19 m, less than keepRadius, so that no
                     ///< gap opens between the tests
  float slack;       ///< 2^-17 m, more than either plus all rounding
};
[[nodiscard]] inline SphereTolerance toleranceOf(const Sphere& s) {
  const float m =
      std::max(std::max(std::fabs(s.center.x), std::fabs(s.center.y)), std::fabs(s.center.z)) + s.radius;
  return {s.radius + m * 0x1p-18f, s.radius + m * 0x1p-19f, m * 0x1p-17f};
}

}  // namespace restroke::implicit
