#include "points/images/cpu_renderer.h"

#include "implicit/parallel.h"
#include "points/images/painter.h"
#include "points/images/tiles.h"

namespace restroke::points {

struct CpuRenderer::State {
  Layers layers;
  PaintMemory memory;
  RenderedImage image;
  DepthImage depth;
};

CpuRenderer::CpuRenderer(Layers layers) : state_(std::make_unique<State>()) {
  state_->layers = layers;
}
CpuRenderer::~CpuRenderer() = default;
CpuRenderer::CpuRenderer(CpuRenderer&&) noexcept = default;
CpuRenderer& CpuRenderer::operator=(CpuRenderer&&) noexcept = default;

const RenderedImage& CpuRenderer::render(const Scene& scene, const Camera& camera,
                                         const RenderOptions& options, const Execution& execution) {
  validateForImage(camera, "picture");
  validate(options, "picture");
  RenderedImage& image = state_->image;
  const Layers layers = state_->layers;
  image.width = camera.width;
  image.height = camera.height;
  image.rgba.resize(4 * image.pixels());
  if (layers.depth) image.depth.resize(image.pixels());
  if (layers.normal) image.normal.resize(3 * image.pixels());
  if (layers.ids) {
    image.primitive.resize(image.pixels());
    image.stroke.resize(image.pixels());
  }
  inArena(execution, [&] { Painter({scene, camera, options, layers}, state_->memory, image).paint(); });
  return image;
}

const DepthImage& CpuRenderer::renderDepth(std::span<const Surfel> surfels, const Camera& camera,
                                           const Execution& execution) {
  validateForImage(camera, "depth image");
  DepthImage& image = state_->depth;
  image.width = camera.width;
  image.height = camera.height;
  image.depth.resize(std::size_t{camera.width} * camera.height);
  inArena(execution, [&] {
    const ScreenSetup setup(camera);
    const PictureKernels& kernels = pictureKernels();
    TiledDiscs& tiles = state_->memory.tiles;
    tiles.fill({.surfels = surfels}, setup, {});
    forTiles(tiles, state_->memory.workspaces, [&](int column, int row, Workspace& ws) {
      TilePass pass;
      pass.window = clippedWindow(camera, column * kTileSide, row * kTileSide);
      pass.nearW = setup.nearW();
      std::fill_n(ws.nearest.w, static_cast<std::size_t>(pass.window.height) * kTileStride, setup.farW());
      kernels.drawDepth(ws.nearest, ws.list(), pass);
      TileTarget target = {};
      target.x0 = pass.window.x0, target.y0 = pass.window.y0;
      target.width = pass.window.width, target.height = pass.window.height;
      target.pitch = image.width;
      target.depth = image.depth.data();
      kernels.writeDepth(ws.nearest, setup.farW(), target);
    });
  });
  return image;
}

DepthImage renderDepth(std::span<const Surfel> surfels, const Camera& camera, const Execution& execution) {
  CpuRenderer renderer;
  (void)renderer.renderDepth(surfels, camera, execution);
  return std::move(renderer.state_->depth);
}

RenderedImage render(const Scene& scene, const Camera& camera, const RenderOptions& options,
                     const Execution& execution) {
  CpuRenderer renderer;
  (void)renderer.render(scene, camera, options, execution);
  return std::move(renderer.state_->image);
}

}  // namespace restroke::points
