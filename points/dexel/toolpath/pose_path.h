#pragma once
// Paths given as poses, one after the other (SPEC R8, D6).

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include "points/dexel/tool_pose.h"
#include "points/dexel/toolpath/cutter.h"

namespace restroke::points {

/// Poses whose orientations differ by no more than this in any number stand alike: numbers of a text file
/// have few digits.
inline constexpr double kSameOrientation = 1e-6;

/// Elements between poses. A cutter sweeps in a straight line from each pose to the next one that stands
/// alike (as the first of those does). Where it turns, no sweep is made: it is placed anew.
struct PosePath {
  struct Step {
    PathElement element;
    std::uint32_t orientation = 0;  ///< number in `orientations`
    bool operator==(const Step&) const = default;
  };
  std::vector<Step> steps;
  std::vector<std::array<double, 9>> orientations;  ///< as Cutter::orientation has them, each once
  std::size_t turns = 0;                            ///< from a pose to the next without a sweep
  std::size_t still = 0;                            ///< poses that are the one before: no steps
};

/// Throws InputError ("pose N ...") for a pose that scales: a cutter has its own size. O(poses logarithm of
/// the orientations).
[[nodiscard]] PosePath posePathOf(const std::vector<PoseMatrix>& poses);

/// Does a file hold poses (tool_pose.h), not G-code? The first that is neither blank nor a comment of either
/// is a number.
[[nodiscard]] bool looksLikePoses(std::string_view contents);

}  // namespace restroke::points
