#pragma once
// Words of the command line that stand for bases, transforms, views and sizes. Bad ones throw InputError,
// which names the option.

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "implicit/geometry/camera.h"
#include "implicit/shapes/sphere.h"
#include "sculpt/stroke_log.h"

namespace restroke::cli {

/// "sphere" (radius 1 around the origin) or "sphere:x,y,z,r". A file name is refused: mesh bases are not read
/// yet.
[[nodiscard]] implicit::Sphere baseNamed(std::string_view text);

/// Carries out "translate x y z; rotate ax ay az degrees; scale s" on a sphere, from left to right, about the
/// origin; each part may occur any number of times. Computed in double, rounded to float32 at the end. "scale
/// sx sy sz" is understood, and refused unless the three are equal, since a sphere would not stay one.
[[nodiscard]] implicit::Sphere transformed(const implicit::Sphere& base, std::string_view transform);

/// "WxH", each 1 to 65,536.
[[nodiscard]] std::pair<std::uint32_t, std::uint32_t> sizeNamed(std::string_view text);

/// What a view is seen of.
struct ViewSubject {
  const sculpt::StrokeLog& log;
  implicit::Sphere bounds;  ///< holds what is to be seen; named views frame it
  std::uint32_t width = 0, height = 0;
};

/// front, back, left, right, top, bottom, three-quarter: frames the bounds. "stroke:N": the recorded camera
/// of history node N, widened to the picture's shape. "px,py,pz:vx,vy,vz": from that place in that direction.
[[nodiscard]] Camera viewNamed(std::string_view text, const ViewSubject& subject);

/// Density given on the command line. Throws InputError unless it is finite and more than 0.
[[nodiscard]] float checkedDensity(float density);

}  // namespace restroke::cli
