#pragma once
// Screen-space occlusion: what makes creases and hollows readable. Internal to the CPU renderer.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "points/images/screen_disc.h"

namespace restroke::points {

/// What one sees at every pixel's centre, smoothed as for shading. Row-major.
struct SurfaceBuffer {
  SurfaceBuffer(std::uint32_t w, std::uint32_t h)
      : width(static_cast<int>(w)),
        height(static_cast<int>(h)),
        depth(std::size_t{w} * h, std::numeric_limits<float>::infinity()),
        normal(std::size_t{w} * h, Vec3(0)) {}

  int width, height;
  std::vector<float> depth;  ///< along the view, +infinity: nothing
  std::vector<Vec3> normal;  ///< unit, camera space (x right, y up, z towards the viewer)
};

/// Factor for the colour of every pixel: about 0.35 in deep creases, 1 on open ground, up to 1.12 on ridges;
/// 1 where there is nothing. Same bits whatever the number of threads.
[[nodiscard]] std::vector<float> occlusionOf(const SurfaceBuffer& surface, const ScreenSetup& setup);

}  // namespace restroke::points
