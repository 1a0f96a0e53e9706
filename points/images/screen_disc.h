#pragma once
// A surfel as one camera sees it: three functions that are linear in screen coordinates say everything about
// its disc. Shared by the renderers on the CPU; the vertex shader of gl_renderer.cpp repeats the same
// algebra.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "implicit/execution.h"
#include "implicit/geometry/camera.h"
#include "points/images/scene.h"

namespace restroke::points {

/// Discs seen more edge-on than this (cosine between normal and line of sight) are not drawn: they cover no
/// pixel worth speaking of, and the division by the cosine would cost all digits.
inline constexpr double kEdgeOnCosine = 1e-4;

/// A front-facing disc on the screen.
///
/// With d the direction through a pixel (component 1 along the view), n and c the disc's normal and centre in
/// camera coordinates, the plane is met at depth 1 / w, w = (n.d) / (n.c), which is linear in screen
/// coordinates. So are U = w * (disc coordinate along its axis u, in radii) and V. The pixel's ray meets the
/// disc where U^2 + V^2 <= w^2: no division, and w itself is the depth test (nearest is largest).
///
/// The functions are taken about a reference pixel near the disc, in which U and V are 0 or small, so that
/// float32 has all its digits where they matter.
struct ScreenDisc {
  std::int32_t pixelX = 0, pixelY = 0;  ///< reference place, whole pixels ...
  float fractionX = 0, fractionY = 0;   ///< ... and the rest, [0, 1)
  float w0 = 0, wX = 0, wY = 0;  ///< w = w0 + wX * dx + wY * dy, dx and dy in pixels from the reference place
  float u0 = 0, uX = 0, uY = 0;
  float v0 = 0, vX = 0, vY = 0;
  float minX = 0, maxX = 0, minY = 0, maxY = 0;  ///< box around the disc, pixels, within the viewport
  float window = 0;  ///< difference in w within which this disc counts as the same surface
  float normalX = 0, normalY = 0, normalZ = 0;  ///< camera space: right, up, towards the viewer
  std::uint32_t surfel = 0;
  SurfaceKind kind = SurfaceKind::Base;
};

/// Camera and the step from pixel to pixel.
class ScreenSetup {
 public:
  explicit ScreenSetup(const Camera& camera);

  /// False when the disc is not seen: behind the camera, beyond the far plane or in front of the near one,
  /// off the screen, facing away, edge-on, without size, or not finite.
  [[nodiscard]] bool project(const Surfel& surfel, ScreenDisc& disc) const;

  [[nodiscard]] const CameraFrame& frame() const { return frame_; }
  /// Direction through the screen place (pixels) in camera space: (x, y, 1 along the view).
  [[nodiscard]] float directionX(float x) const {
    return static_cast<float>(firstX_) + static_cast<float>(stepX_) * x;
  }
  [[nodiscard]] float directionY(float y) const {
    return static_cast<float>(firstY_) + static_cast<float>(stepY_) * y;
  }
  [[nodiscard]] float nearW() const { return nearW_; }  ///< 1 / near: the largest w that is drawn
  [[nodiscard]] float farW() const { return farW_; }

 private:
  CameraFrame frame_;
  double width_, height_;
  double firstX_, stepX_, firstY_, stepY_;
  double near_, far_;
  float nearW_, farW_;
};

/// All visible discs, sorted into square tiles of the screen. Within a tile discs stand in the order of their
/// surfels, whatever the number of threads.
class TiledDiscs {
 public:
  /// `tile` is the side of a tile in pixels; discs are listed in every tile that they touch when it is grown
  /// by `apron` pixels on each side.
  struct Layout {
    int tile = 64;
    int apron = 0;
  };
  TiledDiscs(const Scene& scene, const Camera& camera, Layout layout);

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  [[nodiscard]] const ScreenSetup& setup() const { return setup_; }

  /// Calls visit(const ScreenDisc&) for the discs of a tile, in order.
  template <class Visit>
  void forEach(int column, int row, Visit visit) const {
    const std::size_t tile =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
    for (const Chunk& chunk : chunks_)
      for (std::uint32_t i = chunk.first[tile]; i < chunk.first[tile + 1]; ++i)
        visit(chunk.discs[chunk.entries[i]]);
  }

 private:
  /// Discs of consecutive surfels, and for each tile (first[tile] to first[tile + 1]) which of them touch it.
  struct Chunk {
    std::vector<ScreenDisc> discs;
    std::vector<std::uint32_t> first;
    std::vector<std::uint32_t> entries;
  };
  void fill(Chunk& chunk, const Scene& scene, std::size_t begin) const;
  struct TileRange {
    int column0, column1, row0, row1;
  };
  [[nodiscard]] TileRange tilesOf(const ScreenDisc& disc) const;

  ScreenSetup setup_;
  Layout layout_;
  int columns_ = 0, rows_ = 0;
  std::vector<Chunk> chunks_;
};

}  // namespace restroke::points
