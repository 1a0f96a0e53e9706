#pragma once
// The method "exact": rays against the list itself, what the paper calls geometric casting (SPEC S7).

#include <memory>

#include "implicit/ray_cast.h"
#include "retarget/method.h"

namespace restroke::retarget {

/// Hits are those of implicit::castRay, rounded to float32. Builds nothing: free to make, and a stroke's
/// first point is hit as quickly as its last. Same bits everywhere.
[[nodiscard]] std::unique_ptr<Caster> makeExactCaster(const CasterInput& input);

/// A hit of the list as casters give it: the double-precision result rounded to float32.
[[nodiscard]] SurfaceHit rounded(const implicit::RayHit& hit);

}  // namespace restroke::retarget
