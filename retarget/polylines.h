#pragma once
// Curves as the measures see them: polylines in pieces.

#include <span>
#include <vector>

#include "implicit/geometry/vec.h"

namespace restroke::retarget {

/// The runs of a curve between its gaps. A piece of one vertex is a point; empty pieces count for nothing.
using Polylines = std::vector<std::vector<DVec3>>;

[[nodiscard]] double lengthOf(const Polylines& curve);

/// Distance from p to the nearest point of the curve; infinite where the curve is empty. O(vertices).
[[nodiscard]] double distanceTo(const Polylines& curve, DVec3 p);

/// The Hausdorff distance of two curves: how far a point of either may be from the nearest point of the other
/// one. Segments are halved until their bound leaves no room for more than 2^-10 of the answer (or 2^-40 of
/// the curves' extent, where they all but coincide), so the answer is below the true one by no more than that
/// and never above it. 0 when both are empty, infinite when one is. About O(vertices) where the curves run
/// alike, at worst O(vertices^2) a halving.
[[nodiscard]] double hausdorffDistance(const Polylines& a, const Polylines& b);

}  // namespace restroke::retarget
