#pragma once
// The colour picture. Internal to the CPU renderer.

#include "points/images/cpu_renderer.h"
#include "points/images/occlusion.h"
#include "points/images/shading.h"
#include "points/images/tiles.h"

namespace restroke::points {

/// Tiles in which the picture before shows nothing, so that a picture of the same kind in the same memory
/// need not write them again.
struct BlankTiles {
  std::uint32_t width = 0, height = 0;
  int tile = 0;
  bool occluded = false;
  std::vector<std::uint8_t> blank;  ///< row by row
};

/// Memory kept from one picture to the next, which go into the same image.
struct PaintMemory {
  BlankTiles blanks;
  TiledDiscs tiles;
  Workspaces workspaces;
  SurfaceBuffer smooth;
};

/// One picture in the making.
class Painter {
 public:
  struct Task {
    const Scene& scene;
    const Camera& camera;
    const RenderOptions& options;
    Layers layers;
  };
  /// The image has its size, and room for its layers; every pixel of them is written.
  Painter(const Task& task, PaintMemory& memory, RenderedImage& image);
  void paint();

 private:
  void paintTile(int column, int row, Workspace& ws);
  void drawSamples(Workspace& ws, const TilePass& pass) const;
  void writeCentres(const Workspace& ws, const TileWindow& window, const TileWindow& inner);
  void writeNothing(const TileWindow& inner);
  void forgetOtherBlanks();
  void writeIds(const Workspace& ws, const TileWindow& window, const TileWindow& inner);
  void paintEdges(Workspace& ws, TilePass pass, const TileWindow& inner);
  void shadeEdges(Workspace& ws, const TilePass& pass, const TileWindow& inner) const;
  void castEdges(Workspace& ws, const TilePass& pass, const TileWindow& inner);
  void writeEdges(const Workspace& ws, const TileWindow& window, const TileWindow& inner);
  void occlude();

  [[nodiscard]] std::size_t pixel(int x, int y) const {
    return static_cast<std::size_t>(y) * image_.width + static_cast<std::size_t>(x);
  }
  [[nodiscard]] bool supersampled() const { return task_.options.samples > 1; }
  [[nodiscard]] bool occluded() const { return task_.options.occlusion == Occlusion::ScreenSpace; }

  const Task task_;
  PaintMemory& memory_;
  RenderedImage& image_;
  const PictureKernels& kernels_;
  const ScreenSetup setup_;
  const Look look_;
  ShadingSetup shading_;
  TiledDiscs::Layout layout_;
};

}  // namespace restroke::points
