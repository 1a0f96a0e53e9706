#pragma once
// A cutter that moves along an arc, as lines see it. Internal to points/dexel/toolpath.

#include <vector>

#include "points/dexel/toolpath/arc_path.h"
#include "points/dexel/toolpath/line_pieces.h"
#include "points/dexel/toolpath/straight_sweep.h"

namespace restroke::points {

/// Along a plane arc about the cutter's own axis, exactly. Across the axis the cutter covers what is within
/// its radius of the arc: a sector of a ring and two discs. The ball covers a ring with a round section and
/// two balls, the rounded edge of a bull nose such rings along all borders of what its flat tip covers.
class PlaneArcSweep {
 public:
  /// The arc is in the cutter's frame, w along z or against it, its height 0 at both ends.
  PlaneArcSweep(const CutterProfile& cutter, const ArcPath& arc);
  void intersect(const LocalLine& line, LinePieces& pieces) const;
  /// By the definition.
  [[nodiscard]] bool contains(DVec3 p) const;

 private:
  class Cut;
  CutterProfile cutter_;
  ArcPath arc_;
};

/// Along any arc or helix, by the straight sweeps between points of it, so many (a power of two, at even
/// turns) that none of them is farther than `tolerance` from the arc between them: each point of the sweep is
/// within the tolerance of the exact one, and the other way round. They are told apart by bisection of the
/// arc for each line: O(logarithm of the points + those that the line passes near).
class ChordSweep {
 public:
  /// Throws InputError when more than 2^18 straight sweeps would be needed.
  ChordSweep(const CutterProfile& cutter, const ArcPath& arc, double tolerance);
  void intersect(const LocalLine& line, LinePieces& pieces) const;
  [[nodiscard]] bool contains(DVec3 p) const;
  /// A ball on a plane arc about any axis: the ball's ring is exact, the shank above it is of straight
  /// sweeps.
  void takeBallExactly() { isBallExact_ = true; }

 private:
  struct Part {
    lines::Flat2 begin, end;
    double heightBegin, heightEnd;
    int level;
    bool isLong;
  };
  [[nodiscard]] Part whole() const;
  template <class Meets, class Leaf>
  void descend(const Part& part, const Meets& meets, const Leaf& leaf) const;

  CutterProfile cutter_;
  ArcPath arc_;
  int levels_ = 0;
  bool isBallExact_ = false;
};

}  // namespace restroke::points
