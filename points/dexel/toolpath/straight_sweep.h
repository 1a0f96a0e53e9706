#pragma once
// A cutter that moves in a straight line, as lines see it. Internal to points/dexel/toolpath.

#include <limits>

#include "implicit/geometry/vec.h"
#include "points/dexel/toolpath/cutter.h"

namespace restroke::points {

/// A line in a cutter's frame, in which the cutter stands along z; the direction is of length 1.
struct LocalLine {
  DVec3 origin{0}, direction{0, 0, 1};
  [[nodiscard]] DVec3 at(double t) const { return origin + t * direction; }
};

/// A stretch of a line with the outward unit normals at its ends; none when not enter <= exit.
struct LocalSpan {
  double enter = std::numeric_limits<double>::infinity(), exit = -std::numeric_limits<double>::infinity();
  DVec3 enterNormal{0}, exitNormal{0};
  [[nodiscard]] bool empty() const { return !(enter <= exit); }
};

/// The sizes of a cutter, whatever its orientation.
struct CutterProfile {
  Cutter::Kind kind = Cutter::Kind::Flat;
  double radius = 1, length = 1, cornerRadius = 0;
  explicit CutterProfile(const Cutter& cutter)
      : kind(cutter.kind),
        radius(cutter.radius),
        length(cutter.length),
        cornerRadius(cutter.kind == Cutter::Kind::BullNose ? cutter.cornerRadius : 0) {}
  /// Where the cylinder begins, above the tip.
  [[nodiscard]] double shankBegin() const {
    return kind == Cutter::Kind::Flat ? 0 : kind == Cutter::Kind::Ball ? radius : cornerRadius;
  }
};

/// Turns below this, as part of the other sizes that they stand beside, are taken as none: a move that is off
/// a plane or an axis by less is straightened.
inline constexpr double kStraight = 0x1p-40;

/// The union of the cutter in all places from `from` to `to`. It is convex: the sum of the cutter and a
/// segment. So where a line enters it is the first place where it enters any of a few simple solids that
/// together are the whole: the cutter's cylinder at both ends; the discs at the cylinder's lower and upper
/// end, moved (oblique circular cylinders); what the cylinder's middle plane moves through (a
/// parallelepiped); and what the ball or the rounded edge below moves through. All but the last are quadrics
/// and planes; the rounded edge of a bull nose is the set of points within the corner radius of a moved disc,
/// a convex distance whose root Newton's method finds.
class StraightSweep {
 public:
  /// In the cutter's frame.
  StraightSweep(const CutterProfile& cutter, DVec3 from, DVec3 to);

  [[nodiscard]] LocalSpan intersect(const LocalLine& line) const;
  /// The same without the ball or the rounded edge: the cylinder alone.
  [[nodiscard]] LocalSpan intersectShank(const LocalLine& line) const;
  /// By the definition: is the point in the cutter anywhere on its way? Boundary included, but for rounding.
  [[nodiscard]] bool contains(DVec3 p) const;

 private:
  [[nodiscard]] LocalLine nearby(const LocalLine& line, double& shift) const;
  [[nodiscard]] LocalSpan cylinder(const LocalLine& line) const;
  void addBall(const LocalLine& line, LocalSpan& span) const;
  void addRoundedEdge(const LocalLine& line, LocalSpan& span) const;
  struct Nearest {
    DVec3 away{0};  ///< from the nearest point of the moved disc
    double distance = 0;
  };
  [[nodiscard]] Nearest nearestOfDisc(DVec3 q) const;

  CutterProfile cutter_;
  DVec3 from_, move_;
  double across_ = 0;     // length of the move across the axis
  double forward_[2]{};   // its direction
  double slope_ = 0;      // of the move, height over length across
  double perHeight_ = 0;  // its inverse
  double length_ = 0;     // of the move
};

}  // namespace restroke::points
