#pragma once
// A stroke as it was drawn: press to release, in screen space, with its camera (SPEC S5; DESIGN invariant 4).

#include <cstdint>
#include <string>
#include <vector>

#include "implicit/geometry/camera.h"

namespace restroke::retarget {

/// Highest pressure: pressures are counted in 1/1023.
inline constexpr int kMaxPressure = 1023;
/// Largest screen coordinate, either sign, in 1/16 pixels: a million pixels.
inline constexpr std::int32_t kMaxScreen = 1 << 24;
/// Latest time in milliseconds (24 days).
inline constexpr std::uint32_t kMaxTime = 0x7fffffff;

/// One event of the pen, fixed-point from the moment it is recorded.
struct StrokePoint {
  ScreenPoint screen;      ///< 1/16 pixels, each coordinate within +-kMaxScreen
  std::uint32_t time = 0;  ///< milliseconds since the stroke's first point; never decreases, at most kMaxTime
  std::uint16_t pressure = kMaxPressure;  ///< 0 to kMaxPressure
  bool operator==(const StrokePoint&) const = default;
};

/// What the user drew, and from where. Never changed by retargeting.
struct Stroke {
  Camera camera;
  std::vector<StrokePoint> points;  ///< one or more
  bool operator==(const Stroke&) const = default;
};

/// Throws InputError (`where` begins the sentence) unless the camera and every point are in range, there is a
/// point, the first time is 0 and times never decrease. O(points).
void validate(const Stroke& stroke, const std::string& where);

}  // namespace restroke::retarget
