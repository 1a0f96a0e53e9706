#pragma once

#include "implicit/geometry/vec.h"

namespace restroke {

/// The points origin + t * direction for tMin <= t <= tMax. The direction need not be a unit vector; t counts
/// in lengths of it.
struct Ray {
  DVec3 origin{0};
  DVec3 direction{0, 0, -1};
  double tMin = 0;
  double tMax = 1e30;

  [[nodiscard]] DVec3 at(double t) const { return origin + t * direction; }
};

/// A stretch of a ray's line, as parameters enter <= exit.
struct RayInterval {
  double enter = 0, exit = 0;
};

}  // namespace restroke
