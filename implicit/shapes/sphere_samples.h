#pragma once
// The sphere's samples (SPEC S3): equal-area directions in a fixed order, made without libm.

#include <cstdint>
#include <vector>

#include "implicit/shapes/sphere.h"
#include "implicit/simd/ball_kernels.h"

namespace restroke::implicit {

/// Most samples that one primitive may have.
inline constexpr std::uint32_t kMaxSamples = 1u << 26;

/// How many samples a sphere gets at a density (samples per square model unit): the nearest number of a
/// ladder whose steps are at most 1/32, so that few tables serve many radii; at least kPatch, always a
/// multiple of it. Throws InputError beyond kMaxSamples.
[[nodiscard]] std::uint32_t sampleCount(const Sphere& s, float density);

/// A table of unit directions: a spherical Fibonacci lattice (equal area per sample; Gonzalez, "Measurement
/// of areas on a sphere using Fibonacci and latitude-longitude lattices", Mathematical Geosciences 42, 2010),
/// reordered so that every run of 16^k directions from a multiple of 16^k on is a compact patch, with the
/// tree of those patches' bounding spheres.
class SphereSamples {
 public:
  /// The table of `count` directions (a value of sampleCount), made at the first call and shared from then
  /// on. Thread-safe.
  static const SphereSamples& ofCount(std::uint32_t count);
  /// Bytes of all tables made so far.
  static std::size_t bytesOfAll();

  [[nodiscard]] std::uint32_t count() const { return static_cast<std::uint32_t>(x_.size()); }
  [[nodiscard]] std::uint32_t patches() const { return count() / static_cast<std::uint32_t>(kPatch); }
  [[nodiscard]] Vec3 direction(std::uint32_t i) const { return {x_[i], y_[i], z_[i]}; }
  [[nodiscard]] const PatchTree& tree() const { return tree_; }
  [[nodiscard]] std::size_t bytes() const;

  SphereSamples(const SphereSamples&) = delete;
  SphereSamples& operator=(const SphereSamples&) = delete;

 private:
  explicit SphereSamples(std::uint32_t count);

  struct Bounds {
    std::vector<float> x, y, z, radius;
  };
  std::vector<float> x_, y_, z_;
  std::vector<Bounds> bounds_;
  PatchTree tree_{};
};

/// The tolerances that settle coincident boundaries (SPEC S3), from the rounding that float32 leaves: the
/// coordinates of a sphere's surface are at most `m` = max |c| + r, a computed sample is off the sphere by
/// less than 2^-21.4 m, and so is a side test's verdict.
struct SphereTolerance {
  float keepRadius;  ///< of the sphere just outside, on which the keep test is made: r + 2^-18 m
  float dropRadius;  ///< of the ball that drops older samples: r + 2^-19 m, less than keepRadius, so that no
                     ///< gap opens between the tests
  float slack;       ///< 2^-17 m, more than either plus all rounding
};
[[nodiscard]] SphereTolerance toleranceOf(const Sphere& s);

/// The sphere as the kernels take it.
[[nodiscard]] PatchedBall patchedBall(const Sphere& s, bool positive, const SphereSamples& samples);

/// Position of sample i: center + radius * direction, in float32.
[[nodiscard]] inline Point samplePosition(const Sphere& s, Vec3 direction) {
  return {s.center.x + s.radius * direction.x, s.center.y + s.radius * direction.y,
          s.center.z + s.radius * direction.z};
}

}  // namespace restroke::implicit
