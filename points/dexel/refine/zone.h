#pragma once
// The part of a model that is looked at more closely (SPEC R3).

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "implicit/geometry/box.h"
#include "implicit/geometry/camera.h"
#include "implicit/geometry/ray.h"
#include "implicit/shapes/sphere.h"

namespace restroke::points {

/// A box in any orientation.
struct OrientedBox {
  DVec3 center{0};
  std::array<DVec3, 3> axes{DVec3{1, 0, 0}, DVec3{0, 1, 0}, DVec3{0, 0, 1}};  ///< orthonormal, right-handed
  DVec3 half{1};  ///< half extents along the axes, model units, > 0
};
/// The box with faces along the axes.
[[nodiscard]] OrientedBox orientedBoxOf(const Box& box);

/// A convex part of space: a box, a ball, or the view frustum of a camera from its near to its far plane.
/// Its boundary belongs to it. Everything is computed in double, from + - * / and sqrt in a fixed order.
class Zone {
 public:
  /// Throw InputError ("the zone ...") when a number is not finite, an extent or a radius not > 0, the axes
  /// are not orthonormal (to 1e-6), or as validate(camera) does.
  explicit Zone(const OrientedBox& box);
  explicit Zone(const implicit::Sphere& ball);
  explicit Zone(const Camera& camera);

  [[nodiscard]] const std::variant<OrientedBox, implicit::Sphere, Camera>& shape() const { return shape_; }
  /// Of a box or a frustum before it was widened: bits 0 to 2 of a corner's number say which side it is on
  /// along the first, second and third axis (of a frustum right, up and far). Of a ball those of its box.
  [[nodiscard]] std::array<DVec3, 8> corners() const;
  /// Holds the zone; rounded outwards.
  [[nodiscard]] const Box& bounds() const { return bounds_; }
  /// Of the zone as it was before it was widened.
  [[nodiscard]] double volume() const { return volume_; }
  [[nodiscard]] bool contains(DVec3 p) const;
  /// Where the whole line through a ray is in the zone; nothing when it misses it or only touches it.
  [[nodiscard]] std::optional<RayInterval> clip(const Ray& ray) const;
  /// False only if the box has no point in common with the zone.
  [[nodiscard]] bool mayMeet(const Box& box) const;
  /// The zone and all that is nearer to it than a distance >= 0, and somewhat more at edges and corners.
  [[nodiscard]] Zone widened(double distance) const;

 private:
  Zone() = default;
  /// Points p with dot(normal, p) <= offset; the normal is of length 1.
  struct Plane {
    DVec3 normal{0};
    double offset = 0;
  };
  void takePlanes(std::vector<Plane> planes, const std::array<DVec3, 8>& corners);

  std::variant<OrientedBox, implicit::Sphere, Camera> shape_;
  double widening_ = 0;
  std::vector<Plane> planes_;  // none of a ball
  Box bounds_;
  double volume_ = 0;
};

}  // namespace restroke::points
