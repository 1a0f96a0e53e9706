#pragma once
// Surfels as one camera sees them: discs on the screen, sorted into tiles. Internal to the CPU renderer; the
// vertex shader of gl_renderer.cpp repeats the algebra of simd/project.inc.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "implicit/geometry/camera.h"
#include "points/images/scene.h"
#include "points/images/simd/picture_kernels.h"

namespace restroke::points {

/// Camera and the step from pixel to pixel.
class ScreenSetup {
 public:
  explicit ScreenSetup(const Camera& camera);

  [[nodiscard]] const CameraFrame& frame() const { return frame_; }
  [[nodiscard]] const ProjectionSetup& projection() const { return projection_; }
  /// Direction through the screen place (pixels) in camera space: (x, y, 1 along the view).
  [[nodiscard]] float directionX(float x) const { return firstX_ + stepX_ * x; }
  [[nodiscard]] float directionY(float y) const { return firstY_ + stepY_ * y; }
  [[nodiscard]] float firstX() const { return firstX_; }
  [[nodiscard]] float firstY() const { return firstY_; }
  [[nodiscard]] float stepX() const { return stepX_; }
  [[nodiscard]] float stepY() const { return stepY_; }
  [[nodiscard]] float nearW() const { return nearW_; }  ///< 1 / near: the largest w that is drawn
  [[nodiscard]] float farW() const { return farW_; }

 private:
  CameraFrame frame_;
  ProjectionSetup projection_ = {};
  float firstX_, stepX_, firstY_, stepY_;
  float nearW_, farW_;
};

/// All visible discs, sorted into square tiles of the screen. Within a tile discs stand in the order of their
/// surfels, whatever the number of threads. Filled again, it uses the memory that it has.
class TiledDiscs {
 public:
  /// `tile` is the side of a tile in pixels; discs are listed in every tile that they touch when it is grown
  /// by `apron` pixels on each side.
  struct Layout {
    int tile = kTileSide;
    int apron = 0;
  };
  void fill(const Scene& scene, const ScreenSetup& setup, Layout layout);

  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }

  /// Appends the discs of a tile, in order.
  void list(int column, int row, std::vector<const ScreenDisc*>& discs) const;

 private:
  struct TileRange {
    std::uint16_t column0, column1, row0, row1;
  };
  /// Discs of consecutive surfels, and for each tile (from end[tile - 1] to end[tile]) which of them touch
  /// it.
  struct Chunk {
    std::unique_ptr<ScreenDisc[]> discs;
    std::size_t capacity = 0;
    std::vector<TileRange> ranges;
    std::vector<std::uint32_t> end, entries;
  };
  void fillChunk(Chunk& chunk, const Scene& scene, const ScreenSetup& setup, std::size_t begin) const;
  void sortChunk(Chunk& chunk) const;
  [[nodiscard]] TileRange tilesOf(const ScreenDisc& disc) const;
  template <class Visit>
  void forTiles(const TileRange& range, Visit visit) const;

  Layout layout_;
  int columns_ = 0, rows_ = 0;
  std::size_t chunkCount_ = 0;
  std::vector<Chunk> chunks_;
  std::vector<std::uint16_t> columnOf_, rowOf_;  // of a pixel
};

}  // namespace restroke::points
