#pragma once
// The inner loops of tri-dexel Booleans, many lines of a row at a time: where they meet a ball, and which of
// them an operation changes. One source (span_kernels.inc), compiled once for each instruction set of
// implicit/simd/dispatch.h; every level gives the same bits, because each operation is a single IEEE
// operation in the same order, never fused. Plain data only: code of one instruction set must never be linked
// into another's caller.

#include <cstddef>
#include <cstdint>

namespace restroke::points {

/// A ball as the lines of one row see it.
struct BallRow {
  double column;  ///< the centre along the columns' axis
  double depth;   ///< the centre along the lines
  double square;  ///< radius^2 - (distance of the row from the centre)^2
  float beside;   ///< the row's coordinate less the centre's
  float side;     ///< 1: normals point out of the ball, -1: into it
  int axis;       ///< that the lines run along
};

/// Spans of a ball on neighbouring lines, with packed normals (packed_normal.h).
struct BallLanes {
  static constexpr std::size_t kCount = 64;
  alignas(64) float enter[kCount], exit[kCount];
  alignas(64) std::uint32_t enterNormal[kCount], exitNormal[kCount];
};

/// Lines next to each other in a row: of the solid, and a tool's span on each.
struct SpanLanes {
  const float *enter, *exit;          ///< of the solid's hulls
  const std::uint32_t* more;          ///< ~0: the line has not several spans
  const float *toolEnter, *toolExit;  ///< enter >= exit: the tool misses the line
};

/// A ball in model space.
struct BallPlace {
  double x, y, z;
  double square;  ///< radius^2
};

/// Lines next to each other, in any directions: origin + t direction, each between two depths only.
struct LineLanes {
  const double* origin[3];
  const double* direction[3];
  const float *from, *to;  ///< from > to: not at all
};

struct SpanKernels {
  static constexpr std::size_t kLanes = BallLanes::kCount;  ///< most lines of one call

  /// Spans of a ball on `count` lines at the coordinates `columns`, each end rounded to float32. Lines that
  /// miss it get enter > exit. May write up to the next multiple of 16, and read so far.
  void (*ballRow)(const BallRow& ball, const float* columns, std::size_t count, BallLanes& lanes);
  /// Where lines are inside a ball: what implicit::intersect(Sphere, Ray) says, each end rounded to float32
  /// and cut to the line's depths. Lines that miss it there get enter >= exit. May write up to the next
  /// multiple of 16, and read so far.
  void (*ballOnLines)(const BallPlace& ball, const LineLanes& lines, std::size_t count, float* enter,
                      float* exit);
  /// Bits of the lines that an operation may change. With several spans on a line: whenever the tool meets
  /// it.
  std::uint64_t (*changedByUnion)(const SpanLanes& lanes, std::size_t count);
  std::uint64_t (*changedBySubtraction)(const SpanLanes& lanes, std::size_t count);
};

/// Those of the level in use.
[[nodiscard]] const SpanKernels& spanKernels();

}  // namespace restroke::points
