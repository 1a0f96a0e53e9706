#pragma once
// Which pixels of a tile need more than one sample. Internal to the CPU renderer.

#include <bit>
#include <cmath>

#include "points/images/tiles.h"

namespace restroke::points {

/// Sum of blending weights under which a surface thins out: inside a surface whose discs are 0.95 of the
/// lattice's spacing the sum is about 0.9, on a straight edge of it half as much, and where discs stick out
/// beyond their surface it is less.
inline constexpr float kThin = 0.75f;
/// Parts of the weights that one kind, and lengths of the mean normal, under which a pixel shows more than
/// one surface. The latter is the cosine of 9 degrees; discs on the curve of one stamp differ by less.
inline constexpr float kPure = 0.99f, kCoherent = 0.988f;

/// Calls visit(x, y, cell) for the pixels of `inner`, whose cells are those of the tile `window`.
template <class Visit>
void forPixels(const TileWindow& window, const TileWindow& inner, Visit visit) {
  for (int y = inner.y0; y < inner.y0 + inner.height; ++y)
    for (int x = inner.x0; x < inner.x0 + inner.width; ++x)
      visit(x, y, static_cast<std::size_t>((y - window.y0) * kTileStride + x - window.x0));
}

/// Calls visit(x, y, cell) for the marked pixels of `inner`.
template <class Visit>
void forMarked(const RowMasks& marks, const TileWindow& window, const TileWindow& inner, Visit visit) {
  for (int y = inner.y0; y < inner.y0 + inner.height; ++y) {
    std::uint64_t row = marks.row[y - window.y0];
    for (; row; row &= row - 1) {
      const int i = std::countr_zero(row), cell = (y - window.y0) * kTileStride + i;
      visit(window.x0 + i, y, static_cast<std::size_t>(cell));
    }
  }
}

/// Discs of different surfaces were blended here: a crease.
inline bool isMixed(const BlendPlane& b, std::size_t cell) {
  const float all = b.weight[cell], most = kPure * all;
  if (std::max({b.added[cell], b.carved[cell], all - b.added[cell] - b.carved[cell]}) < most) return true;
  const Vec3 sum(b.normalX[cell], b.normalY[cell], b.normalZ[cell]);
  return dot(sum, sum) < kCoherent * kCoherent * all * all;
}

inline bool isEdge(const Workspace& ws, std::size_t cell, std::size_t other) {
  const std::int32_t a = ws.nearest.disc[cell], b = ws.nearest.disc[other];
  if ((a < 0) != (b < 0)) return true;
  const ScreenDisc& p = *ws.discs[static_cast<std::size_t>(a)];
  const ScreenDisc& q = *ws.discs[static_cast<std::size_t>(b)];
  if (p.kind != q.kind) return true;
  if (p.normalX * q.normalX + p.normalY * q.normalY + p.normalZ * q.normalZ < 0.9f) return true;
  return std::fabs(ws.nearest.w[cell] - ws.nearest.w[other]) > p.window + q.window;
}

/// Marks pixels of `inner` that need more than one sample: where the surface thins out, and where a neighbour
/// shows another one (another coverage, a jump in depth, a crease, another kind). True when there are any.
inline bool findEdges(Workspace& ws, const TileWindow& window, const TileWindow& inner) {
  std::fill_n(ws.edges.row, kTileSide, std::uint64_t{0});
  bool any = false;
  const auto mark = [&](int x, int y) {
    if (x < inner.x0 || y < inner.y0 || x >= inner.x0 + inner.width || y >= inner.y0 + inner.height) return;
    ws.edges.row[y - window.y0] |= std::uint64_t{1} << (x - window.x0);
    any = true;
  };
  const auto compare = [&](int x, int y, std::size_t cell, std::size_t other) {
    if (ws.nearest.disc[cell] == ws.nearest.disc[other] || !isEdge(ws, cell, other)) return;
    const bool below = other == cell + kTileStride;
    mark(x, y);
    mark(below ? x : x + 1, below ? y + 1 : y);
  };
  forPixels(window, window, [&](int x, int y, std::size_t cell) {
    if (x + 1 < window.x0 + window.width) compare(x, y, cell, cell + 1);
    if (y + 1 < window.y0 + window.height) compare(x, y, cell, cell + kTileStride);
    if (ws.nearest.disc[cell] >= 0 && (ws.blended.weight[cell] < kThin || isMixed(ws.blended, cell)))
      mark(x, y);
  });
  return any;
}

}  // namespace restroke::points
