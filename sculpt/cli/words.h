#pragma once
// Words of the command line that stand for bases, transforms, views and sizes. Bad ones throw InputError,
// which names the option.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "implicit/geometry/camera.h"
#include "implicit/shape.h"
#include "points/surfel.h"
#include "sculpt/shape_text.h"
#include "sculpt/stroke_log.h"

namespace restroke::cli {

/// The numbers between separators; nothing when one of them is not a finite number.
[[nodiscard]] std::optional<std::vector<double>> numbersIn(std::string_view text, char separator);

/// The ending of a file's name with its dot, in small letters: what is to be written.
[[nodiscard]] std::string extensionOf(const std::string& file);

/// What --repair says: "winding" or nothing.
[[nodiscard]] sculpt::Repair repairNamed(std::string_view text);

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

/// What is seen of surfels, for ViewSubject: the sphere of a list's primitives would count those parts of
/// them that later ones took away.
[[nodiscard]] implicit::Sphere framed(std::span<const points::Surfel> surfels);

/// Density given on the command line. Throws InputError unless it is finite and more than 0.
[[nodiscard]] float checkedDensity(float density);

}  // namespace restroke::cli
