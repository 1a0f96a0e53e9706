#include "tests/retarget/test_shapes.h"

#include <cmath>

namespace restroke::retarget {

using implicit::Primitive;
using implicit::Sign;

points::SurfelModel sphereModel(float density) {
  points::SurfelModel model({.density = density});
  const Primitive base{{Point(0), 1}, Sign::Positive};
  model.append({&base, 1});
  return model;
}

points::SurfelModel bumpyModel(float density) {
  points::SurfelModel model = sphereModel(density);
  std::vector<Primitive> stamps;
  for (int row = 0; row < 6; ++row)
    for (int i = 0; i < 24; ++i) {
      const float x = -0.95f + 0.08f * static_cast<float>(i), y = -0.8f + 0.3f * static_cast<float>(row);
      const float z = std::sqrt(std::fmax(0.0f, 1 - x * x - y * y));
      stamps.push_back({{{x, y, z}, 0.06f + 0.01f * static_cast<float>(row)},
                        row % 2 == 0 ? Sign::Positive : Sign::Negative});
    }
  model.append(stamps);
  return model;
}

Camera smallCamera() {
  return {.width = 320, .height = 240};
}

std::vector<ScreenPoint> screenGrid(const Camera& camera, std::int32_t step) {
  std::vector<ScreenPoint> screen;
  for (std::int32_t y = -35; y < static_cast<std::int32_t>(camera.height) * kSubPixels + 35; y += step)
    for (std::int32_t x = -35; x < static_cast<std::int32_t>(camera.width) * kSubPixels + 35; x += step)
      screen.push_back({x, y});
  return screen;
}

std::vector<std::optional<SurfaceHit>> castAll(Caster& caster, const std::vector<ScreenPoint>& screen) {
  std::vector<std::optional<SurfaceHit>> hits;
  hits.reserve(screen.size());
  for (const ScreenPoint p : screen) hits.push_back(caster.cast(p));
  return hits;
}

std::optional<SpherePoint> unitSphereAt(const Ray& ray) {
  const double dd = dot(ray.direction, ray.direction), od = dot(ray.origin, ray.direction);
  const double discriminant = od * od - dd * (dot(ray.origin, ray.origin) - 1);
  if (discriminant <= 0) return std::nullopt;
  const double t = (-od - std::sqrt(discriminant)) / dd;
  return SpherePoint{t, ray.at(t)};
}

}  // namespace restroke::retarget
