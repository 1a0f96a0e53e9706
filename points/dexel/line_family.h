#pragma once
// Families of lines: what a line of a Dexels container is in space (SPEC R1).

#include <limits>

#include "implicit/execution.h"
#include "implicit/geometry/camera.h"
#include "implicit/geometry/ray.h"
#include "implicit/primitive_list.h"
#include "points/dexel/dexels.h"

namespace restroke::points {

/// width x height lines in rows: parallel ones in any direction, or the rays of a perspective frustum, which
/// have one origin. A depth is the distance from the line's origin along its unit direction, in model units.
struct LineFamily {
  int width = 0, height = 0;
  DVec3 origin{0}, direction{0, 0, 1};  ///< of line (0, 0); the direction is not 0, and need not be unit
  /// What the next line of a row, and the next row, add to the origin.
  DVec3 originStep{0}, originRowStep{0};
  /// And to the direction, before it is brought to length 1.
  DVec3 directionStep{0}, directionRowStep{0};
  /// Where lines begin: what is before is not looked at, and a solid that is there enters here, its normal
  /// against the line.
  double from = -std::numeric_limits<double>::infinity();

  /// Of unit direction. In double, from + - * / and sqrt in a fixed order.
  [[nodiscard]] Ray line(int column, int row) const;
};

/// A lattice of parallel lines, `cell` apart, that covers `bounds` seen along `direction` (of any length but
/// 0); depths count from the plane through the middle of the bounds. Throws InputError when the bounds are
/// empty, the direction is 0 or not finite, the cell not > 0, or a row or column would have more than 8,192
/// lines.
[[nodiscard]] LineFamily latticeAlong(DVec3 direction, const Box& bounds, double cell);

/// The rays through the middles of a camera's pixels; depths count from the camera. Throws InputError as
/// validate(camera) does.
[[nodiscard]] LineFamily raysOf(const Camera& camera);

/// Where the lines are inside the shape of (a prefix of) a list: exact intervals of each primitive, in list
/// order, rounded to float32 as they are. The operation of a primitive is its position, as in triDexelOf. The
/// same bits for any number of threads. O(lines x primitives).
[[nodiscard]] Dexels dexelsOf(const implicit::PrimitiveList& list, const LineFamily& family,
                              implicit::Prefix prefix = {}, const Execution& execution = {});

}  // namespace restroke::points
