#include "points/dexel/toolpath/torus_sector.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace restroke::points {

namespace {

using lines::Flat2;
using lines::Stretch;

constexpr std::size_t kDegree = 4;

// The coefficient of t^i is c[i].
struct Polynomial {
  std::array<double, kDegree + 1> c{};
  std::size_t degree = 0;

  [[nodiscard]] double at(double t) const {
    double value = c[degree];
    for (std::size_t i = degree; i-- > 0;) value = value * t + c[i];
    return value;
  }
  [[nodiscard]] Polynomial derivative() const {
    Polynomial d;
    d.degree = degree - 1;
    for (std::size_t i = 1; i <= degree; ++i) d.c[i - 1] = static_cast<double>(i) * c[i];
    return d;
  }
};

struct Roots {
  std::array<double, kDegree> at{};
  std::size_t count = 0;
};

// The one place between a and b where the polynomial changes its sign: Newton's steps, halves where these
// leave the bracket.
double rootBetween(const Polynomial& p, const Polynomial& derivative, double a, double b, bool rises) {
  double t = a + (b - a) / 2;
  constexpr int kMostSteps = 100;
  for (int k = 0; k < kMostSteps; ++k) {
    const double value = p.at(t);
    if (value == 0) return t;
    ((value < 0) == rises ? a : b) = t;
    const double slope = derivative.at(t);
    double next = t - value / slope;
    if (!(next > a && next < b)) next = a + (b - a) / 2;
    if (!(next > a && next < b) || std::fabs(next - t) <= 0x1p-52 * (std::fabs(t) + std::fabs(b - a)))
      return next;
    t = next;
  }
  return t;
}

// Where a polynomial changes its sign between low and high: once at most between neighbouring roots of its
// derivative.
void findRoots(const Polynomial& p, double low, double high, Roots& roots) {
  roots.count = 0;
  if (p.degree == 1) {
    const double t = -p.c[0] / p.c[1];
    if (t > low && t < high) roots.at[roots.count++] = t;
    return;
  }
  const Polynomial derivative = p.derivative();
  Roots turns;
  findRoots(derivative, low, high, turns);
  double a = low, atA = p.at(a);
  for (std::size_t i = 0; i <= turns.count; ++i) {
    const double b = i < turns.count ? turns.at[i] : high, atB = p.at(b);
    if ((atA < 0) != (atB < 0)) roots.at[roots.count++] = rootBetween(p, derivative, a, b, atA < 0);
    a = b;
    atA = atB;
  }
}

struct Ring {
  double circle, tube;
  DVec3 origin, direction;

  // From the middle of the tube; the slope is its derivative along the line.
  [[nodiscard]] double distanceAt(double t, double* slope = nullptr) const {
    const DVec3 p = origin + t * direction;
    const double rho = std::sqrt(p.x * p.x + p.y * p.y), across = rho - circle;
    const double distance = std::sqrt(across * across + p.z * p.z);
    if (slope) {
      const double outward = rho > 0 ? (p.x * direction.x + p.y * direction.y) / rho : 0;
      *slope = distance > 0 ? (across * outward + p.z * direction.z) / distance : 0;
    }
    return distance;
  }
  // A root of the polynomial has lost digits where the ring is thin.
  [[nodiscard]] double polished(double t) const {
    for (int k = 0; k < 2; ++k) {
      double slope;
      const double beyond = distanceAt(t, &slope) - tube;
      constexpr double kCrosses = 1e-3, kNear = 1e-3;
      if (!(std::fabs(slope) > kCrosses)) return t;
      const double step = beyond / slope;
      if (!(std::fabs(step) < kNear * tube)) return t;
      t -= step;
    }
    return t;
  }
};

}  // namespace

void appendInWedge(const ArcPath& wedge, Flat2 origin, Flat2 direction, const Stretch& stretch,
                   std::vector<Stretch>& parts) {
  const auto add = [&](double enter, double exit) {
    Stretch part = stretch;
    part.clip({enter, exit, lines::kSide, lines::kSide});
    if (!part.empty()) parts.push_back(part);
  };
  if (wedge.isWhole) {
    parts.push_back(stretch);
    return;
  }
  // On the inner side of either border: a half line or all.
  struct HalfLine {
    double enter = -lines::kInfinity, exit = lines::kInfinity;
  };
  const auto halfOf = [](double value, double slope) {
    if (slope == 0) return value >= 0 ? HalfLine{} : HalfLine{lines::kInfinity, -lines::kInfinity};
    const double t = -value / slope;
    return slope > 0 ? HalfLine{t, lines::kInfinity} : HalfLine{-lines::kInfinity, t};
  };
  const HalfLine a = halfOf(lines::cross(wedge.begin, origin), lines::cross(wedge.begin, direction));
  const HalfLine b = halfOf(lines::cross(origin, wedge.end), lines::cross(direction, wedge.end));
  if (!wedge.isLong) {
    add(std::max(a.enter, b.enter), std::min(a.exit, b.exit));
    return;
  }
  // Their union.
  const HalfLine& first = a.enter <= b.enter ? a : b;
  const HalfLine& second = a.enter <= b.enter ? b : a;
  if (second.enter <= first.exit && second.enter <= second.exit) {
    add(first.enter, std::max(first.exit, second.exit));
    return;
  }
  add(first.enter, first.exit);
  add(second.enter, second.exit);
}

void appendRing(const ArcPath& wedge, double circle, double tube, DVec3 origin, DVec3 direction,
                std::vector<Stretch>& stretches) {
  // From where the line is nearest to the centre, in units of the ring's size.
  const double size = circle + tube, shift = -dot(origin, direction);
  const Ring ring{circle / size, tube / size, (origin + shift * direction) / size, direction};
  const DVec3 o = ring.origin, e = ring.direction;
  const Flat2 flatOrigin{o.x, o.y}, flatDirection{e.x, e.y};
  Stretch all = lines::between(o.z, e.z, -ring.tube, ring.tube);
  all.clip(lines::inCircle(flatOrigin, flatDirection, 1));
  if (all.empty()) return;

  const double b = dot(o, e), R = ring.circle;
  const double k = dot(o, o) + R * R - ring.tube * ring.tube, four = 4 * R * R;
  const Polynomial p{{k * k - four * lines::dot(flatOrigin, flatOrigin),
                      4 * b * k - 2 * four * lines::dot(flatOrigin, flatDirection),
                      4 * b * b + 2 * k - four * lines::dot(flatDirection, flatDirection), 4 * b, 1},
                     kDegree};
  Roots roots;
  findRoots(p, all.enter, all.exit, roots);
  // The polynomial has roots inside a thick ring too: what is between two neighbours tells its middle.
  std::vector<Stretch> inside;
  double from = all.enter;
  bool wasInside = false;
  for (std::size_t i = 0; i <= roots.count; ++i) {
    const double to = i < roots.count ? roots.at[i] : all.exit;
    const bool isInside = ring.distanceAt(from + (to - from) / 2) <= ring.tube;
    if (isInside && wasInside)
      inside.back().exit = to;
    else if (isInside)
      inside.push_back({from, to, lines::kSide, lines::kSide});
    wasInside = isInside;
    from = to;
  }
  const std::size_t first = stretches.size();
  for (Stretch s : inside) {
    s.enter = ring.polished(s.enter);
    s.exit = ring.polished(s.exit);
    if (!s.empty()) appendInWedge(wedge, flatOrigin, flatDirection, s, stretches);
  }
  for (std::size_t i = first; i < stretches.size(); ++i) {
    stretches[i].enter = stretches[i].enter * size + shift;
    stretches[i].exit = stretches[i].exit * size + shift;
  }
}

}  // namespace restroke::points
