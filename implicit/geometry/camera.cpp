#include "implicit/geometry/camera.h"

#include "implicit/errors.h"

namespace restroke {

void validate(const Camera& c, const std::string& where) {
  const auto reject = [&](const std::string& what, const char* rule) {
    throw InputError(fmt::format("{}: {}; {}", where, what, rule));
  };
  for (int a = 0; a < 3; ++a)
    if (!(std::fabs(c.position[a]) <= kMaxCameraCoordinate))
      reject(fmt::format("the camera's position has the coordinate {}", c.position[a]),
             "every coordinate must lie within +-1e7 model units");
  if (!isFinite(c.view) || !(dot(c.view, c.view) > 1e-20f) || !(dot(c.view, c.view) < 1e20f))
    reject(fmt::format("the view vector is ({}, {}, {})", c.view.x, c.view.y, c.view.z),
           "it must be finite, with a length between 1e-10 and 1e10");
  if (!isFinite(c.up) || !(dot(c.up, c.up) > 1e-20f) || !(dot(c.up, c.up) < 1e20f))
    reject(fmt::format("the up vector is ({}, {}, {})", c.up.x, c.up.y, c.up.z),
           "it must be finite, with a length between 1e-10 and 1e10");
  const DVec3 side = cross(normalized(DVec3(c.view)), normalized(DVec3(c.up)));
  if (!(length(side) > 1e-6))
    reject("the up vector is parallel to the view vector", "they must span a plane");
  if (!(c.halfHeight >= 1e-6f && c.halfHeight <= 1e3f))
    reject(fmt::format("the half height is {}", c.halfHeight), "it must lie between 1e-6 and 1000");
  if (c.width < 1 || c.width > 65536 || c.height < 1 || c.height > 65536)
    reject(fmt::format("the viewport is {} x {} pixels", c.width, c.height), "each side must be 1 to 65,536");
  if (!(c.near > 0 && c.near < c.far && std::isfinite(c.far)))
    reject(fmt::format("near is {} and far is {}", c.near, c.far), "0 < near < far must hold");
}

CameraFrame frameOf(const Camera& c) {
  CameraFrame f;
  f.position = DVec3(c.position);
  f.forward = normalized(DVec3(c.view));
  f.right = normalized(cross(f.forward, DVec3(c.up)));
  f.up = cross(f.right, f.forward);
  f.halfHeight = static_cast<double>(c.halfHeight);
  f.halfWidth = f.halfHeight * static_cast<double>(c.width) / static_cast<double>(c.height);
  return f;
}

Ray rayThrough(const Camera& c, ScreenPoint p) {
  const CameraFrame f = frameOf(c);
  // Screen coordinates are small integers, so these are exact up to the division.
  const double x =
      (2.0 * p.x - kSubPixels * static_cast<double>(c.width)) / (kSubPixels * static_cast<double>(c.width));
  const double y =
      (kSubPixels * static_cast<double>(c.height) - 2.0 * p.y) / (kSubPixels * static_cast<double>(c.height));
  Ray ray;
  ray.origin = f.position;
  ray.direction = f.forward + (x * f.halfWidth) * f.right + (y * f.halfHeight) * f.up;
  ray.tMin = static_cast<double>(c.near);
  ray.tMax = static_cast<double>(c.far);
  return ray;
}

Projection project(const CameraFrame& f, const Camera& c, DVec3 p) {
  const DVec3 d = p - f.position;
  Projection out;
  out.depth = dot(d, f.forward);
  if (!(out.depth > 0)) return out;
  out.x = (dot(d, f.right) / (out.depth * f.halfWidth) + 1.0) * 0.5 * static_cast<double>(c.width);
  out.y = (1.0 - dot(d, f.up) / (out.depth * f.halfHeight)) * 0.5 * static_cast<double>(c.height);
  return out;
}

Camera frameSphere(Point center, float radius, const Framing& framing) {
  const double r = radius > 0 ? static_cast<double>(radius) : 1.0;
  const DVec3 forward = normalized(DVec3(framing.view));
  Camera c;
  c.width = framing.width;
  c.height = framing.height;
  c.halfHeight = 0.3f;
  // At distance d the silhouette's tangent is r / sqrt(d^2 - r^2).
  const double aspect = static_cast<double>(framing.width) / static_cast<double>(framing.height);
  const double tangent =
      static_cast<double>(c.halfHeight) * (aspect < 1 ? aspect : 1.0) * static_cast<double>(framing.fill);
  const double distance = r * std::sqrt(1.0 + 1.0 / (tangent * tangent));
  c.position = Point(DVec3(center) - distance * forward);
  c.view = Vec3(forward);
  c.up = std::fabs(forward.y) > 0.99 ? Vec3(0, 0, forward.y > 0 ? 1 : -1) : Vec3(0, 1, 0);
  c.near = static_cast<float>(std::fmax((distance - r) * 0.1, distance * 1e-4));
  c.far = static_cast<float>(distance + 20.0 * r);
  return c;
}

}  // namespace restroke
