#include "implicit/shapes/ray_intervals.h"

#include <algorithm>
#include <cmath>

namespace restroke::implicit {

void appendMarchedIntervals(const Volume& volume, const Ray& ray, std::vector<RayInterval>& intervals) {
  const VolumeMeasures& ball = volume.measures();
  const DVec3 o = ray.origin - ball.center, d = ray.direction;
  const double dd = dot(d, d), middle = -dot(o, d) / dd;
  const DVec3 q = o + middle * d;
  const double r = 1.0001 * ball.radius, square = r * r - dot(q, q);
  if (!(square > 0)) return;
  const double half = std::sqrt(square / dd), speed = std::sqrt(dd);
  double least = ball.radius * 0x1p-21 / speed;
  constexpr int kPatience = 1024, kMorePatience = 256;  // steps before the least step begins to double
  const double end = middle + half;
  double t = middle - half;
  const auto isInside = [&](double at) { return volume.contains(ray.at(at), 0); };
  double distance = volume.clearance(ray.at(t));
  bool inside = isInside(t);
  double enter = t;
  for (int steps = 0; t < end; ++steps) {
    if (steps >= kPatience && (steps - kPatience) % kMorePatience == 0) least *= 2;
    const double next = std::min(t + std::max(std::fabs(distance) / speed, least), end);
    const double before = distance;
    distance = volume.clearance(ray.at(next));
    if (isInside(next) != inside) {
      // The distance changes its sign there: false position (the Illinois variant), then halving. Which end
      // moves is the side test's word.
      double same = t, other = next;
      double atSame = before, atOther = distance;
      for (int k = 0;; ++k) {
        double m = same + (other - same) / 2;
        if (!(m > same && m < other)) break;
        if (k < 24 && k % 3 != 2 && (atSame < 0) != (atOther < 0)) {
          const double guess = same + (other - same) * atSame / (atSame - atOther);
          if (guess > same && guess < other) m = guess;
        }
        const double atM = volume.clearance(ray.at(m));
        if (isInside(m) == inside) {
          same = m;
          atSame = atM;
          atOther /= 2;
        } else {
          other = m;
          atOther = atM;
          atSame /= 2;
        }
        if (other - same <= (std::fabs(same) + std::fabs(other)) * 0x1p-52) break;
      }
      if (inside)
        intervals.push_back({enter, other});
      else
        enter = other;
      inside = !inside;
    }
    t = next;
  }
  if (inside) intervals.push_back({enter, end});
}

}  // namespace restroke::implicit
