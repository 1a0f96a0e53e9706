#pragma once
// The points that an alignment works with: fewer, evenly spread, in coordinates of size 1.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "retarget/alignment.h"

namespace restroke::retarget::alignment {

struct Sample {
  DVec3 position{0};
  DVec3 normal{0, 0, 1};  ///< unit
};

/// Points of one side. Coordinates are (model - center) / radius, with `center` the centroid and `radius` the
/// RMS distance from it, both of the first `spread` samples.
struct Cloud {
  /// The first `spread` of them are one from each cell of a grid, whatever the density of the points given;
  /// any beginning of them is a random choice. The rest are as evenly spread and fill the gaps.
  std::vector<Sample> samples;
  std::size_t spread = 0;
  DVec3 center{0};
  double radius = 1;
};

struct CloudSizes {
  std::size_t spread = 2000;  ///< at most about so many, at most half of the points given
  std::size_t all = 20000;    ///< at most about so many
};

/// O(points * log points). There must be a point; where all are at one place the radius is 1.
[[nodiscard]] Cloud cloudOf(std::span<const OrientedPoint> points, const CloudSizes& sizes,
                            std::uint64_t seed);

/// `count` of the numbers below `size` in random order; all of them where there are no more.
[[nodiscard]] std::vector<std::uint32_t> drawn(std::size_t size, std::size_t count, std::uint64_t seed);

}  // namespace restroke::retarget::alignment
