#pragma once
// The sphere primitive: f(p) = |p - c|^2 - r^2 <= 0 (SPEC S1).

#include <optional>

#include "implicit/geometry/box.h"
#include "implicit/geometry/ray.h"

namespace restroke::implicit {

/// Closed ball, boundary included. Centre finite, radius finite and > 0, both in model units.
struct Sphere {
  Point center{0};
  float radius = 1;
  bool operator==(const Sphere&) const = default;
};

/// True in the ball and on its boundary. The float32 operations and their order are the definition: SIMD code
/// repeats them, so the answer is the same bits everywhere.
[[nodiscard]] inline bool contains(const Sphere& s, Point p) {
  const float dx = p.x - s.center.x, dy = p.y - s.center.y, dz = p.z - s.center.z;
  return dx * dx + dy * dy + dz * dz <= s.radius * s.radius;
}

[[nodiscard]] Box boundsOf(const Sphere& s);

/// Outward unit normal at a surface point (towards +x for the centre itself).
[[nodiscard]] DVec3 outwardNormal(const Sphere& s, DVec3 p);

/// Where the ray's whole line is inside; nothing when it misses.
[[nodiscard]] std::optional<RayInterval> intersect(const Sphere& s, const Ray& ray);

}  // namespace restroke::implicit
