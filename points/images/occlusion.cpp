// Obscurance from the depth buffer, after "Scalable Ambient Obscurance" (M. McGuire, M. Mara, D. Luebke, High
// Performance Graphics 2012), with a fixed spiral instead of a random one: no noise, no blur of the noise.
// Evaluated on every second pixel and interpolated where depths agree. On top, curvature from the differences
// of neighbouring normals.

#include "points/images/occlusion.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "points/images/shading.h"

namespace restroke::points {
namespace {

using namespace occlusion;

class Probe {
 public:
  Probe(const SurfaceBuffer& surface, const ScreenSetup& setup) : surface_(surface), setup_(setup) {}

  /// Light that is blocked at a pixel, 0 to 1.
  [[nodiscard]] float blocked(int x, int y) const {
    const float depth = depthAt(x, y);
    if (!std::isfinite(depth)) return 0;
    const Vec3 p = positionAt(x, y, depth);
    const Vec3 n = normalAt(x, y);
    const float pixels = kRadius * static_cast<float>(surface_.height);
    const float pixelSize = setup_.directionX(1) - setup_.directionX(0);
    const float reach = pixels * pixelSize * depth;
    const float reach2 = reach * reach;
    float sum = 0;
    for (const Tap& tap : kTaps) {
      const int tx = x + static_cast<int>(tap.x * pixels), ty = y + static_cast<int>(tap.y * pixels);
      if (tx < 0 || ty < 0 || tx >= surface_.width || ty >= surface_.height || (tx == x && ty == y)) continue;
      const float tapDepth = depthAt(tx, ty);
      if (!std::isfinite(tapDepth)) continue;
      const Vec3 d = positionAt(tx, ty, tapDepth) - p;
      const float d2 = dot(d, d);
      if (d2 >= reach2) continue;
      const float falloff = 1.0f - d2 / reach2;
      const float sine = dot(d, n) / std::sqrt(d2 + 1e-20f) - kBias;
      if (sine > 0) sum += sine * falloff;
    }
    return std::min(sum * kStrength / static_cast<float>(kTaps.size()), 1.0f);
  }

  /// Positive on ridges, negative in creases, about -1 to 1.
  [[nodiscard]] float curvature(int x, int y) const {
    const float depth = depthAt(x, y);
    if (!std::isfinite(depth)) return 0;
    const int step = std::max(1, surface_.height / 500);
    const float pixelSize = (setup_.directionX(1) - setup_.directionX(0)) * depth;
    const auto normal = [&](int nx, int ny) {
      const bool inside = nx >= 0 && ny >= 0 && nx < surface_.width && ny < surface_.height;
      // Across a silhouette there is no curvature to speak of.
      if (!inside || !(std::fabs(depthAt(nx, ny) - depth) < 6.0f * static_cast<float>(step) * pixelSize))
        return normalAt(x, y);
      return normalAt(nx, ny);
    };
    const float bend =
        normal(x + step, y).x - normal(x - step, y).x + normal(x, y - step).y - normal(x, y + step).y;
    return std::clamp(bend, -1.0f, 1.0f);
  }

  [[nodiscard]] float depthAt(int x, int y) const { return surface_.depth[index(x, y)]; }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(surface_.width) +
           static_cast<std::size_t>(x);
  }
  [[nodiscard]] Vec3 normalAt(int x, int y) const { return surface_.normal[index(x, y)]; }
  [[nodiscard]] Vec3 positionAt(int x, int y, float depth) const {
    return Vec3(setup_.directionX(static_cast<float>(x) + 0.5f) * depth,
                setup_.directionY(static_cast<float>(y) + 0.5f) * depth, -depth);
  }

  const SurfaceBuffer& surface_;
  const ScreenSetup& setup_;
};

}  // namespace

std::vector<float> occlusionOf(const SurfaceBuffer& surface, const ScreenSetup& setup) {
  const Probe probe(surface, setup);
  const int halfWidth = (surface.width + 1) / 2, halfHeight = (surface.height + 1) / 2;
  std::vector<float> coarse(static_cast<std::size_t>(halfWidth) * static_cast<std::size_t>(halfHeight));
  tbb::parallel_for(0, halfHeight, [&](int y) {
    for (int x = 0; x < halfWidth; ++x)
      coarse[static_cast<std::size_t>(y) * static_cast<std::size_t>(halfWidth) +
             static_cast<std::size_t>(x)] = probe.blocked(2 * x, 2 * y);
  });
  std::vector<float> factor(
      static_cast<std::size_t>(surface.width) * static_cast<std::size_t>(surface.height), 1.0f);
  const float pixelSize = setup.directionX(1) - setup.directionX(0);
  tbb::parallel_for(0, surface.height, [&](int y) {
    for (int x = 0; x < surface.width; ++x) {
      const float depth = probe.depthAt(x, y);
      if (!std::isfinite(depth)) continue;
      float sum = 0, weights = 0;
      for (int j = y / 2; j <= std::min((y + 1) / 2, halfHeight - 1); ++j)
        for (int i = x / 2; i <= std::min((x + 1) / 2, halfWidth - 1); ++i) {
          const float difference =
              std::fabs(probe.depthAt(2 * i, 2 * j) - depth) / (8.0f * pixelSize * depth);
          const float weight = difference < 1.0f ? 1.0f - difference : 0.0f;
          sum += weight * coarse[static_cast<std::size_t>(j) * static_cast<std::size_t>(halfWidth) +
                                 static_cast<std::size_t>(i)];
          weights += weight;
        }
      const float blocked = weights > 0 ? sum / weights : probe.blocked(x, y);
      const float bend = probe.curvature(x, y);
      const float cavity = bend < 0 ? 1.0f + kCavityDark * bend : 1.0f + kCavityLight * bend;
      factor[static_cast<std::size_t>(y) * static_cast<std::size_t>(surface.width) +
             static_cast<std::size_t>(x)] = (1.0f - (1.0f - kDarkest) * blocked) * cavity;
    }
  });
  return factor;
}

}  // namespace restroke::points
