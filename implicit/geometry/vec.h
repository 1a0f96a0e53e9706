#pragma once
// Vectors. Model coordinates are float32 (what the log holds); rays and their intersections are computed in
// double.

#include <cmath>
#include <glm/vec3.hpp>

namespace restroke {

using Point = glm::vec3;
using Vec3 = glm::vec3;
using DVec3 = glm::dvec3;

/// Coordinates and radii beyond this (model units) are refused: float32 has too few digits left there to tell
/// samples apart at any useful density.
inline constexpr float kMaxCoordinate = 1e6f;

/// Sums in a fixed order, so that scalar and SIMD code give the same bits.
[[nodiscard]] inline float dot(Vec3 a, Vec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[nodiscard]] inline double dot(DVec3 a, DVec3 b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
[[nodiscard]] inline DVec3 cross(DVec3 a, DVec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[nodiscard]] inline float length(Vec3 a) {
  return std::sqrt(dot(a, a));
}
[[nodiscard]] inline double length(DVec3 a) {
  return std::sqrt(dot(a, a));
}
/// Unit vector along `a`, which must not be zero.
[[nodiscard]] inline DVec3 normalized(DVec3 a) {
  return a / length(a);
}
[[nodiscard]] inline bool isFinite(Vec3 a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

}  // namespace restroke
