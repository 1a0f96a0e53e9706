#include "retarget/stroke.h"

#include <fmt/format.h>

#include <cstddef>

#include "implicit/errors.h"

namespace restroke::retarget {
namespace {

[[noreturn]] void reject(const std::string& where, std::size_t index, const std::string& sentence) {
  throw InputError(fmt::format("{}: point {}: {}", where, index, sentence));
}

}  // namespace

void validate(const Stroke& stroke, const std::string& where) {
  restroke::validate(stroke.camera, where);
  if (stroke.points.empty())
    throw InputError(where + ": the stroke has no points; it must have at least one");
  std::uint32_t previousTime = 0;
  for (std::size_t i = 0; i < stroke.points.size(); ++i) {
    const StrokePoint& p = stroke.points[i];
    if (p.screen.x < -kMaxScreen || p.screen.x > kMaxScreen || p.screen.y < -kMaxScreen ||
        p.screen.y > kMaxScreen)
      reject(where, i,
             fmt::format("screen place ({}, {}) is beyond +-{} (1/{} pixels)", p.screen.x, p.screen.y,
                         kMaxScreen, kSubPixels));
    if (p.time > kMaxTime)
      reject(where, i, fmt::format("time {} ms is above the highest, {}", p.time, kMaxTime));
    if (i == 0 && p.time != 0)
      reject(where, i,
             fmt::format("time is {} ms; times count from the stroke's first point, whose is 0", p.time));
    if (p.time < previousTime)
      reject(where, i,
             fmt::format("time {} ms is before the point ahead of it, {} ms; times never decrease", p.time,
                         previousTime));
    previousTime = p.time;
    if (p.pressure > kMaxPressure)
      reject(where, i, fmt::format("pressure {} is above the highest, {}", p.pressure, kMaxPressure));
  }
}

}  // namespace restroke::retarget
