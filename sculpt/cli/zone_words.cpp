#include "sculpt/cli/zone_words.h"

#include <algorithm>
#include <cmath>

#include "implicit/errors.h"
#include "sculpt/cli/words.h"

namespace restroke::cli {

namespace {

using points::OrientedBox;
using points::Zone;

constexpr std::string_view kRule =
    "must be box:x,y,z,x,y,z (two corners; with ,qx,qy,qz,qw turned about its middle), sphere:x,y,z,r, "
    "frustum (what --view sees) or frustum:near,far";

[[noreturn]] void refuse(std::string_view text) {
  throw InputError(fmt::format("--zone: \"{}\" {}", text, kRule));
}

Zone boxOf(const std::vector<double>& n) {
  OrientedBox box;
  for (int a = 0; a < 3; ++a) {
    const auto i = static_cast<std::size_t>(a);
    box.center[a] = (n[i] + n[i + 3]) / 2;
    box.half[a] = std::fabs(n[i + 3] - n[i]) / 2;
  }
  if (n.size() == 10) {
    double x = n[6], y = n[7], z = n[8], w = n[9];
    const double size = std::sqrt(x * x + y * y + z * z + w * w);
    if (!(size > 0))
      throw InputError("--zone: the box is turned by a quaternion of length 0; it must have one");
    x /= size;
    y /= size;
    z /= size;
    w /= size;
    // Columns of the rotation, each brought to length 1.
    box.axes = {normalized(DVec3(1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w))),
                normalized(DVec3(2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w))),
                normalized(DVec3(2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)))};
  }
  return Zone(box);
}

Zone parsed(std::string_view text, const Camera& camera) {
  if (text == "frustum") return Zone(camera);
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) refuse(text);
  const std::string_view kind = text.substr(0, colon);
  const auto numbers = numbersIn(text.substr(colon + 1), ',');
  if (!numbers) refuse(text);
  if (kind == "box" && (numbers->size() == 6 || numbers->size() == 10)) return boxOf(*numbers);
  if (kind == "sphere" && numbers->size() == 4)
    return Zone(implicit::Sphere{{static_cast<float>((*numbers)[0]), static_cast<float>((*numbers)[1]),
                                  static_cast<float>((*numbers)[2])},
                                 static_cast<float>((*numbers)[3])});
  if (kind == "frustum" && numbers->size() == 2) {
    Camera cut = camera;
    cut.near = static_cast<float>((*numbers)[0]);
    cut.far = static_cast<float>((*numbers)[1]);
    return Zone(cut);
  }
  refuse(text);
}

}  // namespace

Zone zoneNamed(std::string_view text, const Camera& camera) {
  try {
    return parsed(text, camera);
  } catch (const InputError& error) {
    if (std::string_view(error.what()).starts_with("--zone")) throw;
    throw InputError(fmt::format("--zone: \"{}\": {}", text, error.what()));
  }
}

}  // namespace restroke::cli
