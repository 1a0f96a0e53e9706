#pragma once
// Words of the command line that stand for zones of a model, and files of what was refined in them.

#include <cstdint>
#include <string>
#include <string_view>

#include "implicit/geometry/camera.h"
#include "points/dexel/refine/zone.h"

namespace restroke::cli {

/// "box:x,y,z,x,y,z" (two corners), with ",qx,qy,qz,qw" behind it turned about its middle by a quaternion;
/// "sphere:x,y,z,r"; "frustum", what `camera` sees, or "frustum:near,far" with other distances along its
/// view. Throws InputError that begins with "--zone".
[[nodiscard]] points::Zone zoneNamed(std::string_view text, const Camera& camera);

}  // namespace restroke::cli
