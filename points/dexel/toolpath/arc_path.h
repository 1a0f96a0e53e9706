#pragma once
// The arc or helix along which a cutter's tip moves. Internal to points/dexel/toolpath.

#include <array>
#include <optional>

#include "points/dexel/toolpath/cutter.h"
#include "points/dexel/toolpath/line_math.h"

namespace restroke::points {

/// In a cutter's frame: about the axis w through `center`, counter-clockwise seen against w, from the
/// direction `begin` to the direction `end` of the plane of u and v, all of length 1. u, v, w are
/// right-handed. A clockwise arc is the same path backwards.
struct ArcPath {
  DVec3 center{0};
  DVec3 u{1, 0, 0}, v{0, 1, 0}, w{0, 0, 1};
  lines::Flat2 begin{1, 0}, end{1, 0};
  double radius = 0;                      ///< > 0
  double heightBegin = 0, heightEnd = 0;  ///< along w, from the centre
  bool isWhole = false;                   ///< a whole turn
  bool isLong = false;                    ///< more than half a turn, but not a whole one

  [[nodiscard]] DVec3 at(lines::Flat2 direction, double height) const {
    return center + radius * direction.x * u + radius * direction.y * v + height * w;
  }
  /// Is it in the wedge between the directions of the arc's ends?
  [[nodiscard]] bool isBeside(lines::Flat2 p) const {
    const bool fromBegin = lines::cross(begin, p) >= 0, toEnd = lines::cross(p, end) >= 0;
    return isWhole || (isLong ? fromBegin || toEnd : fromBegin && toEnd);
  }
  /// The point of a plane arc (heightBegin is heightEnd) that is nearest to p.
  [[nodiscard]] DVec3 nearest(DVec3 p) const;
};

/// The arc of an element, in the frame whose axes in model coordinates are the columns of `axes`, relative to
/// the element's beginning. Nothing when the element is straight: a line, or an arc whose centre is where it
/// begins.
[[nodiscard]] std::optional<ArcPath> arcPathOf(const PathElement& element, const std::array<DVec3, 3>& axes);

/// The direction in the middle of the turn from a to b, by + - * / and sqrt. `isLong`: the turn is more than
/// half a whole one.
[[nodiscard]] lines::Flat2 middleOf(lines::Flat2 a, lines::Flat2 b, bool isLong);

}  // namespace restroke::points
