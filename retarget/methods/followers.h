#pragma once
// Methods that follow a change: they start from where the stroke was when it was first applied
// (Change::original), and cast as `exact` does while there is no such trail.

#include <memory>

#include "retarget/method.h"
#include "retarget/trail.h"

namespace restroke::retarget {

/// "fixed": the stroke stays where it was.
[[nodiscard]] std::unique_ptr<Caster> makeFixedCaster(const CasterInput& input);

/// "nearest": each place goes to the nearest point of the surface that the prefix's surfels show.
[[nodiscard]] std::unique_ptr<Caster> makeNearestCaster(const CasterInput& input);

/// "mapped": an affine map carries the camera's rays, which are then cast exactly; any other map carries the
/// places themselves. Without a known map: as `exact`.
[[nodiscard]] std::unique_ptr<Caster> makeMappedCaster(const CasterInput& input);

/// "surface": each place keeps its coordinates on the primitive that it lay on (Schmidt and Singh,
/// "Sketch-based procedural surface modeling and compositing using surface trees", 2008); as `nearest` when
/// that is gone.
[[nodiscard]] std::unique_ptr<Caster> makeSurfaceCaster(const CasterInput& input);

}  // namespace restroke::retarget
