#pragma once
// What both kinds of CPU picture do with tiles of the screen. Internal to the CPU renderer.

#include <tbb/blocked_range2d.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "points/images/screen_disc.h"

namespace restroke::points {

/// A tile and a pixel's margin on each side of it, as far as the viewport reaches.
inline TileWindow clippedWindow(const Camera& camera, int x0, int y0) {
  TileWindow window;
  window.x0 = std::max(x0, 0);
  window.y0 = std::max(y0, 0);
  window.width = std::min(x0 + kTileSide, static_cast<int>(camera.width)) - window.x0;
  window.height = std::min(y0 + kTileSide, static_cast<int>(camera.height)) - window.y0;
  return window;
}

inline void clear(NearestPlane& plane, const TileWindow& window, float farW) {
  const std::size_t cells = static_cast<std::size_t>(window.height) * kTileStride;
  std::fill_n(plane.w, cells, farW);
  std::fill_n(plane.disc, cells, -1);
}

inline void clear(BlendPlane& plane, const TileWindow& window) {
  const std::size_t cells = static_cast<std::size_t>(window.height) * kTileStride;
  for (float* layer : {plane.normalX, plane.normalY, plane.normalZ, plane.weight, plane.added, plane.carved})
    std::fill_n(layer, cells, 0.0f);
}

/// Memory that a thread uses for one tile after the other.
struct Workspace {
  std::vector<const ScreenDisc*> discs;
  NearestPlane nearest;
  BlendPlane blended;
  RowMasks edges;
  /// Of pixels at edges, row by row: sums over samples, and how many of them were covered.
  Vec3 color[kTileSide * kTileSide];
  float covered[kTileSide * kTileSide];

  [[nodiscard]] DiscList list() const { return {discs.data(), discs.size()}; }
};

using Workspaces = tbb::enumerable_thread_specific<std::unique_ptr<Workspace>>;

/// Calls draw(column, row, workspace) for every tile, in parallel, with the tile's discs in the workspace.
template <class Draw>
void forTiles(const TiledDiscs& tiles, Workspaces& workspaces, Draw draw) {
  tbb::parallel_for(tbb::blocked_range2d<int>(0, tiles.rows(), 1, 0, tiles.columns(), 1),
                    [&](const auto& range) {
                      std::unique_ptr<Workspace>& mine = workspaces.local();
                      if (!mine) mine = std::make_unique_for_overwrite<Workspace>();
                      for (int row = range.rows().begin(); row != range.rows().end(); ++row)
                        for (int column = range.cols().begin(); column != range.cols().end(); ++column) {
                          mine->discs.clear();
                          tiles.list(column, row, mine->discs);
                          draw(column, row, *mine);
                        }
                    });
}

}  // namespace restroke::points
