#pragma once
// The inner loops of the CPU pictures: which discs may be seen, how they lie on the screen, drawing them into
// a tile, shading. One source (picture_kernels.inc), compiled once for each instruction set of
// implicit/simd/dispatch.h; every level gives the same bits, because each operation is a single IEEE
// operation in the same order, never fused. Plain data only: code of one instruction set must never be linked
// into another's caller. Internal to the CPU renderer.

#include <cstddef>
#include <cstdint>

#include "implicit/simd/dispatch.h"

namespace restroke::points {

enum class SurfaceKind : std::uint8_t;  // scene.h

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
/// float32 has all its digits where they matter. Laid out in fours, as the kernels write it.
struct alignas(16) ScreenDisc {
  std::int32_t pixelX, pixelY;  ///< reference place, whole pixels ...
  float fractionX, fractionY;   ///< ... and the rest, [0, 1)
  float w0, wX, wY;             ///< w = w0 + wX * dx + wY * dy, dx and dy in pixels from the reference place
  float window;                 ///< difference in w within which this disc counts as the same surface
  float u0, uX, uY;
  float normalX;  ///< camera space: right, up, towards the viewer
  float v0, vX, vY;
  float normalY;
  /// Box around the disc: the pixels whose centres may lie in it, within the viewport. Empty where the last
  /// is before the first.
  std::int32_t firstX, lastX, firstY, lastY;
  float normalZ;
  std::uint32_t surfel;
  std::uint32_t primitive;
  SurfaceKind kind;
};
static_assert(sizeof(ScreenDisc) == 96);

/// The camera as the kernels need it. Arrays are x, y, z.
struct ProjectionSetup {
  double position[3], right[3], up[3], forward[3];
  double width, height;
  double firstX, stepX, firstY, stepY;  ///< direction through screen place (x, y): first + step * place
  double near, far;

  // For the rejection in float32: the same camera, and the planes through it and the sides of the picture,
  // unit normals inwards.
  float eye[3], view[3], side[4][3];
  float looseness;  ///< for each unit of distance, how far beyond a side a disc must be to be sure
};

/// Surfels as they lie in memory.
struct SurfelFloats {
  static constexpr std::size_t kStride = 9;  ///< floats from one surfel to the next
  const float* first;                        ///< position, normal, radius, then no floats
};

struct SurfelNumbers {
  std::uint32_t* numbers;
  std::size_t count;
};

/// Side of a tile's arrays. Two arrays of nearest discs and six of blended values stay within a level-2
/// cache.
inline constexpr int kTileSide = 64;
/// Cells of one row and the next. Groups of pixels may run over the right edge: to the next row, where they
/// write what is there, and behind the last one.
inline constexpr int kTileStride = kTileSide;
inline constexpr std::size_t kTileCells = std::size_t{kTileSide} * kTileStride + 16;

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
struct RowMasks {
  std::uint64_t row[kTileSide];
};

/// Nearest disc at every sample of one plane.
struct NearestPlane {
  alignas(64) float w[kTileCells];            ///< largest 1 / depth; 1 / far where there is no disc
  alignas(64) std::int32_t disc[kTileCells];  ///< number in the tile's list; -1 where there is none
};

/// Sums over the discs that count as the visible surface.
struct BlendPlane {
  alignas(64) float normalX[kTileCells], normalY[kTileCells], normalZ[kTileCells], weight[kTileCells],
      added[kTileCells], carved[kTileCells];
};

/// What stays the same while a tile's discs are drawn.
struct TilePass {
  TileWindow window;
  SampleOffset offset;
  float nearW = 0;                   ///< 1 / near: the largest w that is drawn
  const RowMasks* wanted = nullptr;  ///< rows without a wanted pixel under the disc are skipped; null: all
                                     ///< are drawn
};

struct DiscList {
  const ScreenDisc* const* discs;
  std::size_t count;
};

/// Camera, light (shading.h) and palette. Colours are red, green, blue.
struct ShadingSetup {
  float farW;
  float firstX, stepX, firstY, stepY;  ///< as in ProjectionSetup
  float key[3], fill[3], rim[3];
  float keyColor[3], fillColor[3], rimColor[3], sky[3], ground[3];
  float wrap, gloss, sheen;
  float base[3], added[3], carved[3];
};

/// Where a tile goes: pixels from (x0, y0) on, of a picture that is `pitch` wide. Null pointers are not
/// written.
struct TileTarget {
  int x0, y0, width, height;
  std::size_t cell;  ///< of the first pixel in the tile's arrays
  std::size_t pitch;
  float* rgba;          ///< 4 a pixel
  float* depth;         ///< +infinity where there is nothing
  float* smoothNormal;  ///< 3 a pixel: the normal that was shaded; not written where there is nothing
};

/// The kernels of one instruction set.
struct PictureKernels {
  /// Writes the numbers of the surfels that may be seen, in order, and returns how many. Conservative: what
  /// it leaves out faces away or lies beyond a side of the picture, and `project` would refuse it. `out` has
  /// room for `count`.
  std::size_t (*cull)(const ProjectionSetup& setup, SurfelFloats surfels, std::size_t count,
                      std::uint32_t* out);
  /// Writes the discs that are seen among the numbered surfels, in order, and returns how many: all but those
  /// behind the camera, beyond the far plane or in front of the near one, off the screen, facing away,
  /// edge-on, without size, or not finite. Sets all but `primitive` and `kind`. `out` has room for one more
  /// than there are numbers; `numbers` may be written up to a multiple of 8.
  std::size_t (*project)(const ProjectionSetup& setup, SurfelFloats surfels, SurfelNumbers numbers,
                         ScreenDisc* out);
  /// Depth test: the disc with the largest w wins, the first one among equals. A disc covers the pixels in
  /// its box (one pixel larger on each side when the sample is not the centre) whose sample obeys U^2 + V^2
  /// <= w^2. drawDepth does not write which disc it was.
  void (*drawNearest)(NearestPlane& plane, DiscList discs, const TilePass& pass);
  void (*drawDepth)(NearestPlane& plane, DiscList discs, const TilePass& pass);
  /// Adds each disc's normal and kind where it lies within its window behind the nearest disc of the plane,
  /// and not before it.
  void (*blend)(BlendPlane& plane, const NearestPlane& nearest, DiscList discs, const TilePass& pass);
  /// Depth of the tile's pixels.
  void (*writeDepth)(const NearestPlane& nearest, float farW, const TileTarget& target);
  /// Colour of the tile's pixels at their centres: alpha is 1 or 0.
  void (*shade)(const ShadingSetup& setup, const NearestPlane& nearest, const BlendPlane& blended,
                const TileTarget& target);
};

/// Those of the level in use (implicit::simdLevel).
[[nodiscard]] const PictureKernels& pictureKernels();

}  // namespace restroke::points
