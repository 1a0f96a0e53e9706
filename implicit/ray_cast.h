#pragma once
// Exact intersection of rays with the shape that a list describes (SPEC S7, "geometric casting").

#include <optional>

#include "implicit/primitive_list.h"

namespace restroke::implicit {

struct RayHit {
  double t = 0;             ///< ray parameter
  DVec3 position{0};        ///< ray.at(t)
  DVec3 normal{0, 0, 1};    ///< unit, out of the whole shape (on a carved surface: into the hollow)
  PrimitiveId primitive{};  ///< whose boundary was hit
};

/// First crossing from outside to inside of the prefix's whole shape with tMin < t < tMax, in double
/// precision. A ray that starts inside must first leave. Rays that only touch a boundary do not count.
/// Nothing is built beforehand. O(cells along the ray + primitives in them).
[[nodiscard]] std::optional<RayHit> castRay(const PrimitiveList& list, const Ray& ray, Prefix prefix = {});

}  // namespace restroke::implicit
