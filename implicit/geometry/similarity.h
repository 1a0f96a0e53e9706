#pragma once
// Similarity motions: turn, scale alike in all directions, move. They map pictures to pictures: what a camera
// saw of a shape, the moved camera sees of the moved shape.

#include <array>

#include "implicit/geometry/camera.h"

namespace restroke {

/// A unit quaternion x, y, z, w (implicit::Pose has the same order). Whoever fills it keeps it of length 1.
using Rotation = std::array<double, 4>;

/// The motion p -> scale * (p turned by `rotation`) + translation. Everything is computed in double from + -
/// * / and sqrt in a fixed order. The default is the identity, which changes no bit of what it is applied to.
struct Similarity {
  Rotation rotation{0, 0, 0, 1};
  double scale = 1;      ///< > 0
  DVec3 translation{0};  ///< model units
  bool operator==(const Similarity&) const = default;
};

[[nodiscard]] inline DVec3 turned(const Rotation& q, DVec3 v) {
  const DVec3 axis(q[0], q[1], q[2]);
  const DVec3 twice = 2.0 * cross(axis, v);
  return v + q[3] * twice + cross(axis, twice);
}

/// The rotation that first does `inner`, then `outer`; brought back to length 1.
[[nodiscard]] inline Rotation composed(const Rotation& outer, const Rotation& inner) {
  const DVec3 a(outer[0], outer[1], outer[2]), b(inner[0], inner[1], inner[2]);
  const DVec3 v = outer[3] * b + inner[3] * a + cross(a, b);
  const double w = outer[3] * inner[3] - dot(a, b);
  const double size = std::sqrt(dot(v, v) + w * w);
  return {v.x / size, v.y / size, v.z / size, w / size};
}

[[nodiscard]] inline Rotation inverted(const Rotation& q) {
  return {-q[0], -q[1], -q[2], q[3]};
}

/// The rotation of the angle with that tangent of its half, about the unit axis: a parameter that needs no
/// trigonometry. Half turns are Rotation{axis.x, axis.y, axis.z, 0}.
[[nodiscard]] inline Rotation rotationAbout(DVec3 axis, double tangentOfHalf) {
  const double w = 1.0 / std::sqrt(1.0 + tangentOfHalf * tangentOfHalf);
  const DVec3 v = (w * tangentOfHalf) * axis;
  return {v.x, v.y, v.z, w};
}

/// Where the motion takes a point.
[[nodiscard]] inline DVec3 moved(const Similarity& m, DVec3 p) {
  return m.scale * turned(m.rotation, p) + m.translation;
}

/// The motion that first does `inner`, then `outer`.
[[nodiscard]] inline Similarity composed(const Similarity& outer, const Similarity& inner) {
  return {composed(outer.rotation, inner.rotation), outer.scale * inner.scale,
          moved(outer, inner.translation)};
}

[[nodiscard]] inline Similarity inverted(const Similarity& m) {
  const Rotation back = inverted(m.rotation);
  const double scale = 1.0 / m.scale;
  return {back, scale, -scale * turned(back, m.translation)};
}

/// The camera that sees the moved shape as `camera` sees the shape: every point of the model and its image
/// are drawn at the same screen place, and depths (near and far too) are `scale` times what they were. Each
/// field is rounded once to float32; view and up keep their lengths. Whether the result is within a camera's
/// ranges is for validate() to say.
[[nodiscard]] inline Camera moved(const Similarity& m, const Camera& camera) {
  Camera out = camera;
  out.position = Point(moved(m, DVec3(camera.position)));
  out.view = Vec3(turned(m.rotation, DVec3(camera.view)));
  out.up = Vec3(turned(m.rotation, DVec3(camera.up)));
  out.near = static_cast<float>(m.scale * static_cast<double>(camera.near));
  out.far = static_cast<float>(m.scale * static_cast<double>(camera.far));
  return out;
}

}  // namespace restroke
