// R. Takeuchi, T. Watanabe et al., Stroke history management for digital sculpting, section 2.2: draw the
// shape from the stroke's camera, read the depth buffer at each stroke point. We differ in where a point is
// put: the paper has whole pixels, we have sixteenths, so the depth is the pixel's and the ray is the point's
// own.

#include "retarget/methods/depth.h"

#include <cmath>
#include <utility>

#include "implicit/errors.h"
#include "points/images/cpu_renderer.h"

namespace restroke::retarget {
namespace {

class DepthCaster final : public Caster {
 public:
  DepthCaster(points::DepthImage image, const Camera& camera) : image_(std::move(image)), camera_(camera) {
    RESTROKE_CHECK_EQ(image_.width, camera.width);
    RESTROKE_CHECK_EQ(image_.height, camera.height);
  }

  std::optional<SurfaceHit> cast(const StrokePlace& place) override {
    const ScreenPoint p = place.screen;
    const Pixel pixel{p.x >> 4, p.y >> 4};
    static_assert(kSubPixels == 16);
    const double depth = depthAt(pixel);
    if (!std::isfinite(depth)) return std::nullopt;
    const Ray ray = rayThrough(camera_, p);
    return SurfaceHit{Point(ray.at(depth)), Vec3(normalAt(pixel, ray))};
  }

 private:
  struct Pixel {
    std::int32_t x, y;
  };

  /// Infinite outside the viewport and where there is no surface.
  [[nodiscard]] double depthAt(Pixel p) const {
    if (p.x < 0 || p.y < 0 || p.x >= static_cast<std::int32_t>(image_.width) ||
        p.y >= static_cast<std::int32_t>(image_.height))
      return HUGE_VAL;
    return static_cast<double>(image_.at(static_cast<std::uint32_t>(p.x), static_cast<std::uint32_t>(p.y)));
  }
  /// The surface point at the centre of the pixel, which shows a surface.
  [[nodiscard]] DVec3 pointAt(Pixel p) const {
    const ScreenPoint centre{p.x * kSubPixels + kSubPixels / 2, p.y * kSubPixels + kSubPixels / 2};
    return rayThrough(camera_, centre).at(depthAt(p));
  }
  /// Step over the surface per pixel, from the one of the two neighbours that is nearer in depth: the other
  /// one may be another piece of surface. Zero when neither shows a surface.
  [[nodiscard]] DVec3 step(Pixel p, Pixel before, Pixel after) const {
    const double depth = depthAt(p);
    const double toBefore = std::fabs(depthAt(before) - depth), toAfter = std::fabs(depthAt(after) - depth);
    if (!std::isfinite(toBefore) && !std::isfinite(toAfter)) return DVec3(0);
    return toAfter <= toBefore ? pointAt(after) - pointAt(p) : pointAt(p) - pointAt(before);
  }
  [[nodiscard]] DVec3 normalAt(Pixel p, const Ray& ray) const {
    const DVec3 right = step(p, {p.x - 1, p.y}, {p.x + 1, p.y});
    const DVec3 down = step(p, {p.x, p.y - 1}, {p.x, p.y + 1});
    const DVec3 normal = cross(down, right);
    // Down the screen, then right: towards the viewer. A zero product has no direction, nor has one seen
    // edge-on.
    if (!(dot(normal, ray.direction) < 0)) return -normalized(ray.direction);
    return normalized(normal);
  }

  points::DepthImage image_;
  Camera camera_;
};

}  // namespace

std::unique_ptr<Caster> makeDepthImageCaster(points::DepthImage image, const Camera& camera) {
  return std::make_unique<DepthCaster>(std::move(image), camera);
}

std::unique_ptr<Caster> makeDepthCpuCaster(const CasterInput& input) {
  const auto surfels = input.model.surfels(input.prefix, input.execution);
  return makeDepthImageCaster(points::renderDepth(surfels, input.camera, input.execution), input.camera);
}

}  // namespace restroke::retarget
