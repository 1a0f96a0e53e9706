// A. A. Taha and A. Hanbury, "An efficient algorithm for calculating the exact Hausdorff distance", 2015: the
// search for a near point of the other curve stops when it is nearer than the farthest distance known. We add
// bounds for the insides of segments.

#include "retarget/polylines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace restroke::retarget {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kRelative = 0x1p-10, kOfExtent = 0x1p-40;

struct Segment {
  DVec3 from{0}, to{0};
};

std::vector<Segment> segmentsOf(const Polylines& curve) {
  std::vector<Segment> segments;
  for (const auto& piece : curve) {
    if (piece.size() == 1) segments.push_back({piece[0], piece[0]});
    for (std::size_t i = 0; i + 1 < piece.size(); ++i) segments.push_back({piece[i], piece[i + 1]});
  }
  return segments;
}

double distanceTo(const Segment& s, DVec3 p) {
  const DVec3 along = s.to - s.from;
  const double squared = dot(along, along);
  const double t = squared > 0 ? std::clamp(dot(p - s.from, along) / squared, 0.0, 1.0) : 0;
  return length(p - (s.from + t * along));
}

/// Finds how far points are from a curve, starting where the last one was nearest: curves run alike.
class Distance {
 public:
  explicit Distance(const std::vector<Segment>& segments) : segments_(segments) {}

  /// A point's distance, or where that is at most `enough`, any number from it up to `enough`: the distance
  /// to one of the segments.
  struct Found {
    double distance = kInfinite;
    std::size_t segment = 0;
  };
  Found operator()(DVec3 p, double enough) {
    const std::size_t n = segments_.size(), start = last_;
    Found found;
    // Outwards from the last one, to both sides by turns.
    for (std::size_t step = 0; step < 2 * n && found.distance > enough; ++step) {
      const std::size_t away = (step + 1) / 2;
      if (step % 2 == 0 ? away > start : start + away >= n) continue;
      const std::size_t i = step % 2 == 0 ? start - away : start + away;
      const double d = distanceTo(segments_[i], p);
      if (d < found.distance) found = {d, i};
    }
    last_ = found.segment;
    return found;
  }

  /// No point of `part` is farther than this from the curve. Its ends were found as given.
  [[nodiscard]] double bound(const Segment& part, const Found& from, const Found& to) const {
    // Distances change by at most as much as the point moves.
    double least = (from.distance + to.distance + length(part.to - part.from)) / 2;
    // The distance to one segment is convex, so it is greatest at an end.
    for (const std::size_t middle : {from.segment, to.segment})
      for (std::size_t i = middle > 0 ? middle - 1 : 0; i <= middle + 1 && i < segments_.size(); ++i)
        least =
            std::min(least, std::max(distanceTo(segments_[i], part.from), distanceTo(segments_[i], part.to)));
    return least;
  }

 private:
  const std::vector<Segment>& segments_;
  std::size_t last_ = 0;
};

/// The greatest distance of a point of `from` to `to`, at least `known`.
double directed(const std::vector<Segment>& from, const std::vector<Segment>& to, double known,
                double tolerance) {
  Distance distance(to);
  struct Part {
    Segment segment;
    Distance::Found first, last;  // of the ends
  };
  std::vector<Part> parts;
  for (const Segment& segment : from) {
    parts.push_back({segment, distance(segment.from, known), distance(segment.to, known)});
    while (!parts.empty()) {
      const Part part = parts.back();
      parts.pop_back();
      known = std::max({known, part.first.distance, part.last.distance});
      if (distance.bound(part.segment, part.first, part.last) <= known * (1 + kRelative) + tolerance)
        continue;
      const DVec3 middle = (part.segment.from + part.segment.to) * 0.5;
      const Distance::Found there = distance(middle, known);
      parts.push_back({{part.segment.from, middle}, part.first, there});
      parts.push_back({{middle, part.segment.to}, there, part.last});
    }
  }
  return known;
}

}  // namespace

double lengthOf(const Polylines& curve) {
  double sum = 0;
  for (const Segment& s : segmentsOf(curve)) sum += length(s.to - s.from);
  return sum;
}

double distanceTo(const Polylines& curve, DVec3 p) {
  double least = kInfinite;
  for (const Segment& s : segmentsOf(curve)) least = std::min(least, distanceTo(s, p));
  return least;
}

double hausdorffDistance(const Polylines& a, const Polylines& b) {
  const auto segmentsA = segmentsOf(a), segmentsB = segmentsOf(b);
  if (segmentsA.empty() && segmentsB.empty()) return 0;
  if (segmentsA.empty() || segmentsB.empty()) return kInfinite;
  DVec3 low = segmentsA.front().from, high = low;
  for (const auto* segments : {&segmentsA, &segmentsB})
    for (const Segment& s : *segments)
      for (const DVec3 p : {s.from, s.to})
        for (int axis = 0; axis < 3; ++axis) {
          low[axis] = std::min(low[axis], p[axis]);
          high[axis] = std::max(high[axis], p[axis]);
        }
  const double tolerance = kOfExtent * length(high - low);
  return directed(segmentsB, segmentsA, directed(segmentsA, segmentsB, 0, tolerance), tolerance);
}

}  // namespace restroke::retarget
