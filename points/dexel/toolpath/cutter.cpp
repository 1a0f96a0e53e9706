#include "points/dexel/toolpath/cutter.h"

#include <algorithm>
#include <cmath>

#include "implicit/errors.h"
#include "points/dexel/tool_pose.h"

namespace restroke::points {

namespace {

void requirePositive(const char* what, double value) {
  if (!(std::isfinite(value) && value > 0))
    throw InputError(
        fmt::format("a cutter has the {} {}; it must be finite and greater than 0", what, value));
}

}  // namespace

void validate(const Cutter& cutter) {
  requirePositive("radius", cutter.radius);
  requirePositive("length", cutter.length);
  if (cutter.kind == Cutter::Kind::Ball && !(cutter.length >= cutter.radius))
    throw InputError(
        fmt::format("a cutter has a ball of radius {} and the length {}; it must be at least as long",
                    cutter.radius, cutter.length));
  if (cutter.kind == Cutter::Kind::BullNose) {
    requirePositive("corner radius", cutter.cornerRadius);
    if (!(cutter.cornerRadius < cutter.radius))
      throw InputError(
          fmt::format("a cutter has the corner radius {} and the radius {}; the corner's must be "
                      "smaller",
                      cutter.cornerRadius, cutter.radius));
    if (!(cutter.cornerRadius <= cutter.length))
      throw InputError(
          fmt::format("a cutter has the corner radius {} and the length {}; it must be at least as "
                      "long",
                      cutter.cornerRadius, cutter.length));
  } else if (cutter.cornerRadius != 0) {
    throw InputError(fmt::format("a cutter has the corner radius {}; it must be 0 but of a bull nose",
                                 cutter.cornerRadius));
  }
  const auto& m = cutter.orientation;
  PoseMatrix pose = kIdentityPose;
  for (std::size_t i = 0; i < 9; ++i) pose[i / 3 * 4 + i % 3] = m[i];
  try {
    checkPose(pose);
  } catch (const InputError& error) {
    throw InputError(fmt::format("a cutter has an orientation that is no rotation: {}", error.what()));
  }
  const double size = length(DVec3(m[0], m[3], m[6]));
  if (std::fabs(size - 1) > kPoseTolerance)
    throw InputError(
        fmt::format("a cutter has an orientation that scales by {:.6g}; it must be a rotation (to "
                    "within {})",
                    size, kPoseTolerance));
}

void validate(const PathElement& element) {
  for (const DVec3& p : {element.from, element.to, element.center})
    for (int a = 0; a < 3; ++a)
      if (!(std::fabs(p[a]) <= static_cast<double>(kMaxCoordinate)))
        throw InputError(fmt::format("a path element has the coordinate {}; it must be within +-{:g}", p[a],
                                     static_cast<double>(kMaxCoordinate)));
  if (element.axis < 0 || element.axis > 2)
    throw InputError(fmt::format("a path element turns about axis {}; it must be 0, 1 or 2", element.axis));
}

}  // namespace restroke::points
