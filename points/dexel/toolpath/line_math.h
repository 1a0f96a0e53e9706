#pragma once
// Where a line is between two planes, or in a circle of a plane. Internal to points/dexel/toolpath.

#include <algorithm>
#include <cmath>
#include <limits>

namespace restroke::points::lines {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Flat2 {
  double x = 0, y = 0;
};
[[nodiscard]] inline double dot(Flat2 a, Flat2 b) {
  return a.x * b.x + a.y * b.y;
}
[[nodiscard]] inline double cross(Flat2 a, Flat2 b) {
  return a.x * b.y - a.y * b.x;
}

/// What a stretch ends at.
enum Face : int { kSide, kLower, kUpper };

/// A stretch, and its ends' faces; none when not enter <= exit.
struct Stretch {
  double enter = kInfinity, exit = -kInfinity;
  int enterFace = kLower, exitFace = kUpper;

  [[nodiscard]] bool empty() const { return !(enter <= exit); }
  /// Where both are; the other's faces count where it is the shorter one.
  void clip(const Stretch& other) {
    if (other.enter > enter) {
      enter = other.enter;
      enterFace = other.enterFace;
    }
    if (other.exit < exit) {
      exit = other.exit;
      exitFace = other.exitFace;
    }
  }
};

/// Where low <= origin + t direction <= high.
[[nodiscard]] inline Stretch between(double origin, double direction, double low, double high) {
  if (direction == 0)
    return low <= origin && origin <= high ? Stretch{-kInfinity, kInfinity, kLower, kUpper} : Stretch{};
  const double atLow = (low - origin) / direction, atHigh = (high - origin) / direction;
  return direction > 0 ? Stretch{atLow, atHigh, kLower, kUpper} : Stretch{atHigh, atLow, kUpper, kLower};
}

/// Where |q + t w| <= r; both faces are sides.
[[nodiscard]] inline Stretch inCircle(Flat2 q, Flat2 w, double r) {
  const double a = dot(w, w);
  if (!(a > 1e-300)) return dot(q, q) <= r * r ? Stretch{-kInfinity, kInfinity, kSide, kSide} : Stretch{};
  const double c = cross(w, q), discriminant = a * r * r - c * c;
  if (!(discriminant >= 0)) return {};
  const double root = std::sqrt(discriminant), b = dot(w, q);
  return {(-b - root) / a, (-b + root) / a, kSide, kSide};
}

}  // namespace restroke::points::lines
