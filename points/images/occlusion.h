#pragma once
// Screen-space occlusion: what makes creases and hollows readable. Internal to the CPU renderer.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "points/images/screen_disc.h"

namespace restroke::points {

/// What one sees at every pixel's centre, smoothed as for shading. Row-major.
struct SurfaceBuffer {
  int width = 0, height = 0;
  std::vector<float> depth;  ///< along the view, +infinity: nothing
  std::vector<Vec3> normal;  ///< unit, camera space (x right, y up, z towards the viewer); means nothing
                             ///< where there is nothing

  void resize(std::uint32_t w, std::uint32_t h) {
    width = static_cast<int>(w);
    height = static_cast<int>(h);
    depth.resize(std::size_t{w} * h);
    normal.resize(std::size_t{w} * h);
  }
};

/// Factor for the colour of every pixel: about 0.35 in deep creases, 1 on open ground, up to 1.12 on ridges;
/// 1 where there is nothing. Same bits whatever the number of threads.
[[nodiscard]] std::vector<float> occlusionOf(const SurfaceBuffer& surface, const ScreenSetup& setup);

}  // namespace restroke::points
