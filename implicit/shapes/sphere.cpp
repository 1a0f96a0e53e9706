#include "implicit/shapes/sphere.h"

namespace restroke::implicit {

Box boundsOf(const Sphere& s) {
  // Rounded outwards by more than the additions can lose.
  const float pad =
      s.radius +
      (std::fabs(s.center.x) + std::fabs(s.center.y) + std::fabs(s.center.z) + s.radius) * 0x1p-22f;
  return {s.center - Vec3(pad), s.center + Vec3(pad)};
}

DVec3 outwardNormal(const Sphere& s, DVec3 p) {
  const DVec3 d = p - DVec3(s.center);
  const double l = length(d);
  return l > 0 ? d / l : DVec3(1, 0, 0);
}

std::optional<RayInterval> intersect(const Sphere& s, const Ray& ray) {
  // From the point of closest approach (q), whose distance from the centre does not cancel as the textbook's
  // b^2 - 4ac does for far cameras (Haines, Guenther, Akenine-Moeller, "Precision improvements for ray/sphere
  // intersection", Ray Tracing Gems, 2019).
  const DVec3 toCenter = DVec3(s.center) - ray.origin;
  const double dd = dot(ray.direction, ray.direction);
  const double tq = dot(toCenter, ray.direction) / dd;
  const DVec3 q = toCenter - tq * ray.direction;
  const double r = static_cast<double>(s.radius);
  const double discriminant = r * r - dot(q, q);
  if (!(discriminant > 0)) return std::nullopt;  // a touch has no inside
  const double half = std::sqrt(discriminant / dd);
  return RayInterval{tq - half, tq + half};
}

}  // namespace restroke::implicit
