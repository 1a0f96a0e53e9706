#pragma once
// A cutter on an element of its path, by the definition: a point is in the sweep when the cutter is there at
// any moment.

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "points/dexel/toolpath/cutter.h"

namespace restroke::testing {

/// Negative in the cutter, 0 on its surface, at most the distance outside. Convex. `p` in the cutter's frame.
inline double gapOfCutter(const points::Cutter& cutter, DVec3 p) {
  const double rho = std::hypot(p.x, p.y), top = p.z - cutter.length;
  using Kind = points::Cutter::Kind;
  if (cutter.kind == Kind::Flat) return std::max({rho - cutter.radius, -p.z, top});
  const double round = cutter.kind == Kind::Ball ? cutter.radius : cutter.cornerRadius;
  const double out = std::max(0.0, rho - (cutter.radius - round)), down = std::max(0.0, round - p.z);
  return std::max(std::hypot(out, down) - round, top);
}

class SweepOracle {
 public:
  SweepOracle(const points::Cutter& cutter, const points::PathElement& element)
      : cutter_(cutter), element_(element) {
    if (element.kind != points::PathElement::Kind::Arc) return;
    const int u = (element.axis + 1) % 3, v = (element.axis + 2) % 3;
    const double fu = element.from[u] - element.center[u], fv = element.from[v] - element.center[v];
    const double tu = element.to[u] - element.center[u], tv = element.to[v] - element.center[v];
    radius_ = std::hypot(fu, fv);
    first_ = std::atan2(fv, fu);
    turn_ = std::atan2(tv, tu) - first_;
    constexpr double kTurn = 6.283185307179586;
    if (element.clockwise) {
      while (turn_ >= 0) turn_ -= kTurn;
    } else {
      while (turn_ <= 0) turn_ += kTurn;
    }
    if (element.from[u] == element.to[u] && element.from[v] == element.to[v])
      turn_ = element.clockwise ? -kTurn : kTurn;
    for (std::size_t i = 0; i <= kParts; ++i) tips_[i] = tip(static_cast<double>(i) / kParts);
  }

  /// The tip at s of the way, 0 to 1.
  [[nodiscard]] DVec3 tip(double s) const {
    DVec3 p = element_.from + s * (element_.to - element_.from);
    if (radius_ > 0) {
      const int u = (element_.axis + 1) % 3, v = (element_.axis + 2) % 3;
      p[u] = element_.center[u] + radius_ * std::cos(first_ + s * turn_);
      p[v] = element_.center[v] + radius_ * std::sin(first_ + s * turn_);
    }
    return p;
  }
  /// Least gap on the way: negative inside, 0 on the boundary.
  [[nodiscard]] double gap(DVec3 p) const {
    if (radius_ == 0) return leastBetween(p, 0, 1);
    std::array<double, kParts + 1> gaps;
    double least = 1e300;
    for (std::size_t i = 0; i <= kParts; ++i) least = std::min(least, gaps[i] = gapAt(p, tips_[i]));
    // Between two of the places it is less by no more than the way from one to the other.
    const double step = length(tips_[1] - tips_[0]), nearly = least + step;
    for (std::size_t i = 0; i <= kParts; ++i) {
      const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(kParts, i + 1);
      if (gaps[i] > nearly || gaps[i] > gaps[before] || (i < kParts && gaps[i] >= gaps[after])) continue;
      least = std::min(
          least, leastBetween(p, static_cast<double>(before) / kParts, static_cast<double>(after) / kParts));
    }
    return least;
  }
  [[nodiscard]] DVec3 gradient(DVec3 p, double step) const {
    DVec3 g{0};
    for (int a = 0; a < 3; ++a) {
      DVec3 d{0};
      d[a] = step;
      g[a] = (gap(p + d) - gap(p - d)) / (2 * step);
    }
    return g;
  }

 private:
  [[nodiscard]] double gapAt(DVec3 p, DVec3 tip) const {
    const DVec3 q = p - tip;
    const auto& m = cutter_.orientation;
    return gapOfCutter(cutter_, {m[0] * q.x + m[3] * q.y + m[6] * q.z, m[1] * q.x + m[4] * q.y + m[7] * q.z,
                                 m[2] * q.x + m[5] * q.y + m[8] * q.z});
  }
  [[nodiscard]] double leastBetween(DVec3 p, double a, double b) const {
    for (int k = 0; k < 50; ++k) {
      const double c = a + (b - a) * 0.382, d = a + (b - a) * 0.618;
      if (gapAt(p, tip(c)) < gapAt(p, tip(d)))
        b = d;
      else
        a = c;
    }
    return std::min({gapAt(p, tip((a + b) / 2)), gapAt(p, tip(0)), gapAt(p, tip(1))});
  }

  static constexpr std::size_t kParts = 120;
  std::array<DVec3, kParts + 1> tips_;
  points::Cutter cutter_;
  points::PathElement element_;
  double radius_ = 0, first_ = 0, turn_ = 0;
};

}  // namespace restroke::testing
