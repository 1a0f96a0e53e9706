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
/// within the tolerance of the exact one, and the other way round. Those that matter are found by
/// bisection of the arc for each line: O(logarithm of the points + those that the line passes near).
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
  /// Of the arc, of 2^level straight parts.
  struct Part {
    lines::Flat2 beginAt, endAt;  ///< directions from the centre
    DVec3 begin{0}, end{0};       ///< of the tip
    double heightBegin = 0, heightEnd = 0;
    int level = 0;
    bool isLong = false;
  };
  [[nodiscard]] Part whole() const;
  /// Appends both halves, and returns where they meet.
  DVec3 splitInto(std::vector<Part>& parts, const Part& part) const;
  /// The tip is within `beside` of a segment: so far to both sides of its middle.
  struct Way {
    DVec3 middle{0}, half{0};
    double beside = 0;
    [[nodiscard]] double reach() const { return length(half) + beside; }
  };
  [[nodiscard]] Way wayOf(const Part& part) const;
  class Probe;

  CutterProfile cutter_;
  ArcPath arc_;
  std::vector<double> above_;  // how far the arc is from the chord, of parts of each level
  bool isBallExact_ = false;
};

}  // namespace restroke::points
