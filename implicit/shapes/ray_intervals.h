#pragma once
// Where a ray is inside a volume, for volumes that are given by a function of the point.

#include <vector>

#include "implicit/volume.h"

namespace restroke::implicit {

/// Value and gradient of a function at a point.
struct ValueAndGradient {
  double value = 0;
  DVec3 gradient{0};
};

/// The interval of a ray inside a convex volume f <= 0, where f is convex (a kink may have any of its
/// gradients). Newton's method from both sides of the bounding ball: a tangent of a convex function never
/// overshoots its root, so it converges, quadratically where the ray crosses and by halves where it touches.
/// Ends are exact to a few units in the last place of the coordinates.
template <class F>
void appendConvexInterval(const F& f, const VolumeMeasures& ball, const Ray& ray,
                          std::vector<RayInterval>& intervals) {
  const DVec3 o = ray.origin - ball.center, d = ray.direction;
  const double dd = dot(d, d), middle = -dot(o, d) / dd;
  const DVec3 q = o + middle * d;
  const double r = 1.0001 * ball.radius, square = r * r - dot(q, q);
  if (!(square > 0)) return;
  const double half = std::sqrt(square / dd), tiny = 0x1p-52 * ball.radius;
  constexpr int kMostSteps = 128;
  double ends[2];
  for (int side = 0; side < 2; ++side) {
    const double inwards = side == 0 ? 1 : -1;
    double t = middle - inwards * half;
    for (int k = 0; k < kMostSteps; ++k) {
      const ValueAndGradient at = f(ray.at(t));
      if (!(at.value > tiny)) break;
      const double slope = inwards * dot(at.gradient, d);
      if (!(slope < 0)) return;  // it grows from here on: the ray misses
      const double next = t - inwards * at.value / slope;
      if (next == t) break;
      t = next;
      if (inwards * (t - middle) > half) return;
    }
    ends[side] = t;
  }
  if (ends[0] <= ends[1]) intervals.push_back({ends[0], ends[1]});
}

/// The intervals of a ray inside a volume of which only `clearance` and the side test are known: the ray is
/// walked in steps of the clearance, never less than 2^-21 of the ball's radius, and a change of side is
/// halved down to double precision. A stretch shorter than that least step may be passed over, and a longer
/// one on a ray that runs along the surface for a thousand steps.
void appendMarchedIntervals(const Volume& volume, const Ray& ray, std::vector<RayInterval>& intervals);

}  // namespace restroke::implicit
