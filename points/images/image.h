#pragma once
// What the renderers make. All layers are row-major, the top left pixel first.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include "implicit/geometry/camera.h"

namespace restroke::points {

/// In the id layers: nothing was drawn here, or no stroke is known.
inline constexpr std::uint32_t kNoId = std::numeric_limits<std::uint32_t>::max();

/// Renderers refuse larger viewports (67 million pixels: 0.3 GB of depth, 2.7 GB with all layers).
inline constexpr std::size_t kMaxPixels = std::size_t{1} << 26;

/// Depth seen through every pixel's centre.
struct DepthImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  /// width * height distances along the view (not along the ray), model units; +infinity where there is no
  /// surface.
  std::vector<float> depth;

  [[nodiscard]] float at(std::uint32_t x, std::uint32_t y) const { return depth[std::size_t{y} * width + x]; }
};

/// A picture without layers.
struct ColorImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  std::vector<float> rgba;  ///< as RenderedImage::rgba
};

/// A picture with its layers. Colour is anti-aliased; the other layers are those of the one disc that is
/// nearest at the pixel's centre, and nothing in them is blended: an edge pixel has either the one surface or
/// the other.
struct RenderedImage {
  std::uint32_t width = 0;
  std::uint32_t height = 0;
  /// 4 a pixel: linear red, green, blue (Rec. 709 primaries), premultiplied by alpha, the covered part of the
  /// pixel. There is no background in it.
  std::vector<float> rgba;
  std::vector<float> depth;   ///< as DepthImage::depth; bit for bit that of renderDepth
  std::vector<float> normal;  ///< 3 a pixel: unit, model space, out of the shape; 0 where there is no surface
  std::vector<std::uint32_t> primitive;  ///< list position of the owner; kNoId where there is no surface
  std::vector<std::uint32_t> stroke;     ///< history node of the owner; kNoId where there is none

  [[nodiscard]] std::size_t pixels() const { return std::size_t{width} * height; }
};

/// Throws InputError unless the camera is valid and its viewport has at most kMaxPixels pixels.
void validateForImage(const Camera& camera, std::string_view where);

}  // namespace restroke::points
