#pragma once
// Rotating cutters, and nozzles that add, as solids of revolution; elements of the paths that they follow
// (SPEC R2, R8).

#include <array>
#include <cstdint>

#include "implicit/geometry/vec.h"

namespace restroke::points {

/// What turns: a cylinder about its axis, whose lower end, the tip, is flat, a half ball, or flat with a
/// rounded corner. In its own frame the axis is z, the tip's lowest point the origin, the shank above it.
struct Cutter {
  enum class Kind : std::uint8_t { Flat, Ball, BullNose };
  Kind kind = Kind::Flat;
  double radius = 1;  ///< of the cylinder, model units, > 0
  double length = 1;  ///< from the tip to the upper end, model units, > 0; at least `radius` of a ball
  /// Of a bull nose, model units: 0 < cornerRadius < radius, and no more than the length. Else 0.
  double cornerRadius = 0;
  /// How it stands: its x, y and z axes as columns of a rotation, row by row. Where it is used, rounding of
  /// the numbers is straightened: z first, then x.
  std::array<double, 9> orientation{1, 0, 0, 0, 1, 0, 0, 0, 1};
  bool operator==(const Cutter&) const = default;
};

/// Throws InputError ("a cutter has ...; it must ...") when a number is not finite or not in its range, or
/// the orientation is no rotation (to kPoseTolerance, tool_pose.h).
void validate(const Cutter& cutter);

/// One element of a path: the tip moves in a straight line, or along an arc.
struct PathElement {
  enum class Kind : std::uint8_t { Line, Arc };
  Kind kind = Kind::Line;
  DVec3 from{0}, to{0};  ///< of the tip, model coordinates; the same: the cutter stays there
  /// Of an arc: its centre (of which the coordinate along `axis` means nothing), and the axis that it turns
  /// about, 0 to 2. Along the axis the tip moves evenly from `from` to `to`: a helix. Where both ends are
  /// above each other it is a whole turn. The distances of both ends from the centre may differ by rounding
  /// of the file that they come from; the arc is the one through `from`, and ends in the direction of `to`.
  DVec3 center{0};
  int axis = 2;
  bool clockwise = false;  ///< seen against the axis, from its positive end
  bool operator==(const PathElement&) const = default;
};

/// Throws InputError ("a path element has ...; it must ...") when a coordinate is not finite or beyond
/// kMaxCoordinate, or the axis is none. An arc whose centre is on its axis through `from` is a straight line.
void validate(const PathElement& element);

/// An operation of a path: (tool, path element).
struct CutterMove {
  std::uint32_t cutter = 0;  ///< index among the document's
  PathElement element;
  bool operator==(const CutterMove&) const = default;
};

}  // namespace restroke::points
