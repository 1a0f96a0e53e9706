#pragma once
// Drawing discs into one tile of the screen, four pixels at a time. Internal to the CPU renderer.

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "points/images/screen_disc.h"

namespace restroke::points {

/// Side of a tile's arrays. Two arrays of nearest discs and six of blended values stay within a level-2
/// cache.
inline constexpr int kTileSide = 64;
/// Groups of four may run over the right edge; what they write there is never read.
inline constexpr int kTileStride = kTileSide + 4;
inline constexpr std::size_t kTileCells = std::size_t{kTileSide} * kTileStride;

/// The part of the screen that a tile's arrays hold: pixel (x0 + i, y0 + j) at [j * kTileStride + i], 0 <= i
/// < width.
struct TileWindow {
  int x0 = 0, y0 = 0;
  int width = kTileSide, height = kTileSide;
};

/// Where in each pixel the sample lies, from its centre, within (-0.5, 0.5).
struct SampleOffset {
  float x = 0, y = 0;
};

/// Bits of the pixels of each row that are wanted; bit i is pixel x0 + i.
using RowMasks = std::array<std::uint64_t, kTileSide>;

/// Nearest disc at every sample of one plane.
struct NearestPlane {
  alignas(64) std::array<float, kTileCells> w;  ///< largest 1 / depth
  alignas(
      64) std::array<std::int32_t, kTileCells> disc;  ///< number in the tile's list; -1 where there is none
};

/// Sums over the discs that count as the visible surface.
struct BlendPlane {
  using Cells = std::array<float, kTileCells>;
  alignas(64) Cells normalX, normalY, normalZ, weight, added, carved;
};

namespace raster {

// Vector extensions of GCC and clang: four floats, an SSE2 or NEON register.
using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

inline Float4 loadFloats(const float* p) {
  Float4 v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
inline Int4 loadInts(const std::int32_t* p) {
  Int4 v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
template <class Vector, class Cell>
inline void store(Cell* p, Vector v) {
  std::memcpy(p, &v, sizeof v);
}
inline Float4 all(float value) {
  return Float4{value, value, value, value};
}
inline Float4 select(Int4 mask, Float4 yes, Float4 no) {
  Int4 a, b;
  std::memcpy(&a, &yes, sizeof a);
  std::memcpy(&b, &no, sizeof b);
  const Int4 bits = (mask & a) | (~mask & b);
  Float4 result;
  std::memcpy(&result, &bits, sizeof result);
  return result;
}

/// Pixels whose sample may lie in the disc's box: x0 <= x <= x1, y0 <= y <= y1, clipped to the window.
struct PixelBox {
  int x0, x1, y0, y1;
};
inline PixelBox pixelBox(const ScreenDisc& disc, const TileWindow& window, SampleOffset offset) {
  // All arguments are > -1, so that truncation rounds down; no sample lies exactly on the box, which has a
  // margin.
  const auto first = [](float min, float o) { return static_cast<int>(min + 0.5f - o); };
  const auto last = [](float max, float o) { return static_cast<int>(max + 0.5f - o) - 1; };
  return {std::max(first(disc.minX, offset.x), window.x0),
          std::min(last(disc.maxX, offset.x), window.x0 + window.width - 1),
          std::max(first(disc.minY, offset.y), window.y0),
          std::min(last(disc.maxY, offset.y), window.y0 + window.height - 1)};
}

/// Calls cell(index, w, s) for groups of four samples, s = U^2 + V^2. What a sample gets does not depend on
/// the window: its distance from the reference place is an exact integer plus a constant.
template <class Group>
inline void forGroups(const ScreenDisc& disc, const TileWindow& window, SampleOffset offset,
                      const RowMasks* wanted, Group group) {
  const PixelBox box = pixelBox(disc, window, offset);
  if (box.x0 > box.x1) return;
  const float shiftX = (0.5f - disc.fractionX) + offset.x, shiftY = (0.5f - disc.fractionY) + offset.y;
  const Float4 iota = {0, 1, 2, 3};
  const std::uint64_t span = (~std::uint64_t{0} >> (63 - (box.x1 - box.x0))) << (box.x0 - window.x0);
  for (int y = box.y0; y <= box.y1; ++y) {
    const int row = y - window.y0;
    if (wanted && !((*wanted)[static_cast<std::size_t>(row)] & span)) continue;
    const float dy = static_cast<float>(y - disc.pixelY) + shiftY;
    const Float4 wRow = all(disc.w0 + disc.wY * dy), uRow = all(disc.u0 + disc.uY * dy),
                 vRow = all(disc.v0 + disc.vY * dy);
    std::size_t index = static_cast<std::size_t>(row * kTileStride + box.x0 - window.x0);
    for (int x = box.x0; x <= box.x1; x += 4, index += 4) {
      const Float4 dx = (all(static_cast<float>(x - disc.pixelX)) + iota) + all(shiftX);
      const Float4 w = wRow + all(disc.wX) * dx;
      const Float4 u = uRow + all(disc.uX) * dx;
      const Float4 v = vRow + all(disc.vX) * dx;
      group(index, w, u * u + v * v);
    }
  }
}

}  // namespace raster

inline void clear(NearestPlane& plane, const TileWindow& window, float farW) {
  const std::size_t cells = static_cast<std::size_t>(window.height) * kTileStride;
  std::fill_n(plane.w.begin(), cells, farW);
  std::fill_n(plane.disc.begin(), cells, -1);
}

inline void clear(BlendPlane& plane, const TileWindow& window) {
  const std::size_t cells = static_cast<std::size_t>(window.height) * kTileStride;
  for (BlendPlane::Cells* layer :
       {&plane.normalX, &plane.normalY, &plane.normalZ, &plane.weight, &plane.added, &plane.carved})
    std::fill_n(layer->begin(), cells, 0.0f);
}

/// What stays the same while a tile's discs are drawn.
struct TilePass {
  TileWindow window;
  SampleOffset offset;
  float nearW = 0;
  const RowMasks* wanted =
      nullptr;  ///< rows without a wanted pixel under the disc are skipped; null: all are drawn
};

/// Depth test: the disc with the largest w wins, the first one among equals.
inline void drawNearest(NearestPlane& plane, const ScreenDisc& disc, std::int32_t number,
                        const TilePass& pass) {
  using namespace raster;
  const Float4 nearW = all(pass.nearW);
  const Int4 numbers = {number, number, number, number};
  forGroups(disc, pass.window, pass.offset, pass.wanted, [&](std::size_t i, Float4 w, Float4 s) {
    const Float4 best = loadFloats(&plane.w[i]);
    const Int4 hit = (s <= w * w) & (w > best) & (w <= nearW);
    store(&plane.w[i], select(hit, w, best));
    store(&plane.disc[i], (hit & numbers) | (~hit & loadInts(&plane.disc[i])));
  });
}

/// Adds the disc's normal and kind where it lies within its window behind the nearest disc of the plane, and
/// not before it.
inline void blend(BlendPlane& plane, const NearestPlane& nearest, const ScreenDisc& disc,
                  const TilePass& pass) {
  using namespace raster;
  const Float4 window = all(disc.window), zero = all(0);
  const Float4 normalX = all(disc.normalX), normalY = all(disc.normalY), normalZ = all(disc.normalZ);
  // A disc that is alone on a pixel at its very rim must count for something.
  const Float4 floor = all(1e-4f);
  BlendPlane::Cells* const kind = disc.kind == SurfaceKind::Added    ? &plane.added
                                  : disc.kind == SurfaceKind::Carved ? &plane.carved
                                                                     : nullptr;
  const auto add = [](float* cell, Float4 value) { store(cell, loadFloats(cell) + value); };
  forGroups(disc, pass.window, pass.offset, pass.wanted, [&](std::size_t i, Float4 w, Float4 s) {
    const Float4 w2 = w * w;
    const Float4 best = loadFloats(&nearest.w[i]);
    const Int4 hit = (s <= w2) & (w <= best) & (w + window >= best);
    const Float4 inside = all(1) - s / w2;  // 1 at the centre, 0 at the rim
    const Float4 weight = select(hit, inside * inside + floor, zero);
    add(&plane.normalX[i], weight * normalX);
    add(&plane.normalY[i], weight * normalY);
    add(&plane.normalZ[i], weight * normalZ);
    add(&plane.weight[i], weight);
    if (kind) add(&(*kind)[i], weight);
  });
}

}  // namespace restroke::points
