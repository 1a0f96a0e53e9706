#pragma once
// The camera as a stroke records it (SPEC S5): float32, and no angle whose tangent must be taken.

#include <cstdint>
#include <string>

#include "implicit/geometry/box.h"
#include "implicit/geometry/ray.h"

namespace restroke {

/// Sub-pixel units of screen coordinates: 1/16 pixel.
inline constexpr int kSubPixels = 16;

/// A place on the screen in 1/16 pixels, x to the right, y down, (0, 0) the top left corner of the top left
/// pixel. The centre of pixel (i, j) is (16 i + 8, 16 j + 8).
struct ScreenPoint {
  std::int32_t x = 0;
  std::int32_t y = 0;
  bool operator==(const ScreenPoint&) const = default;
};

/// Cameras may stand this far from the origin on every axis (model units): ten times farther than any
/// primitive.
inline constexpr float kMaxCameraCoordinate = 1e7f;

/// Perspective camera. Everything that it computes uses + - * / and sqrt in double, in a fixed order.
struct Camera {
  Point position{0, 0, 4};  ///< within +-kMaxCameraCoordinate
  Vec3 view{0, 0, -1};      ///< direction of sight, any length but 0
  Vec3 up{0, 1, 0};         ///< not parallel to `view`
  float halfHeight =
      0.3f;  ///< half the image's height at unit distance (tangent of half the field of view), > 0
  std::uint32_t width = 1280;  ///< viewport in pixels, 1 to 65,536
  std::uint32_t height = 720;
  float near = 0.01f;  ///< clipping distances along `view`, 0 < near < far
  float far = 100.0f;

  bool operator==(const Camera&) const = default;
};

/// The camera's orthonormal frame.
struct CameraFrame {
  DVec3 position, right, up, forward;
  double halfWidth = 0, halfHeight = 0;  ///< half extents of the image at unit distance
};

/// Throws InputError (`where` begins the sentence) unless every field is in its range.
void validate(const Camera& camera, const std::string& where);

[[nodiscard]] CameraFrame frameOf(const Camera& camera);

/// Ray through a screen point; direction has component 1 along the view, so t is the depth and runs from near
/// to far.
[[nodiscard]] Ray rayThrough(const Camera& camera, ScreenPoint p);

/// Screen place in pixels (not rounded) and depth along the view of a model point; depth <= 0 is behind the
/// camera, and then x and y mean nothing.
struct Projection {
  double x = 0, y = 0, depth = 0;
};
[[nodiscard]] Projection project(const CameraFrame& frame, const Camera& camera, DVec3 p);

/// How a picture is to be filled.
struct Framing {
  Vec3 view{0, 0, -1};         ///< direction of sight, not 0
  std::uint32_t width = 1280;  ///< viewport in pixels
  std::uint32_t height = 960;
  float fill = 0.9f;  ///< part of the image's shorter side that the sphere's silhouette spans, > 0
};

/// A camera that looks along the framing's view at the sphere's centre, from where the sphere's silhouette
/// spans `fill` of the shorter side of the image. Half height 0.3. World y is up, or z where the camera looks
/// along y. A radius that is not positive is taken as 1.
[[nodiscard]] Camera frameSphere(Point center, float radius, const Framing& framing = {});

}  // namespace restroke
