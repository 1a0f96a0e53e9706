#pragma once
// Shapes and screens for the tests of the methods.

#include <cstdint>
#include <vector>

#include "implicit/geometry/camera.h"
#include "points/surfel_model.h"
#include "retarget/method.h"

namespace restroke::retarget {

/// The unit sphere.
[[nodiscard]] points::SurfelModel sphereModel(float density);
/// The unit sphere with rows of stamps added and carved over the side that looks at the default camera:
/// bumps, hollows, hollows in bumps, silhouettes within the image.
[[nodiscard]] points::SurfelModel bumpyModel(float density);

/// The default camera with a smaller viewport.
[[nodiscard]] Camera smallCamera();

/// Screen points over the whole viewport and a little beyond, off the pixels' centres, every `step`
/// sixteenths of a pixel.
[[nodiscard]] std::vector<ScreenPoint> screenGrid(const Camera& camera, std::int32_t step);

/// One caster's answers.
[[nodiscard]] std::vector<std::optional<SurfaceHit>> castAll(Caster& caster,
                                                             const std::vector<ScreenPoint>& screen);

/// The exact surface of the unit sphere, for a camera outside it.
struct SpherePoint {
  double depth;
  DVec3 place;
};
[[nodiscard]] std::optional<SpherePoint> unitSphereAt(const Ray& ray);

}  // namespace restroke::retarget
