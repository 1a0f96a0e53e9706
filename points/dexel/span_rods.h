#pragma once
// Pictures of the lines themselves: spans drawn as rods (figures 4 to 10 of US 2013/0116983).

#include <vector>

#include "points/dexel/refine/line_replay.h"
#include "points/dexel/refine/zone.h"
#include "points/surfel.h"

namespace restroke::points {

/// How rods look: Surfel::primitive and sign decide the colour (kindOf, points/images/scene.h).
struct RodLook {
  float radius = 0.01f;  ///< model units, > 0
  std::uint32_t primitive = 0;
  implicit::Sign sign = implicit::Sign::Positive;
};

/// Appends surfels of a rod for each span of the lines, as thick as the look says. Throws InputError when
/// these would be more than kMostRodSurfels. O(length of the spans / radius).
void appendRods(const Dexels& dexels, const LineFamily& lines, const RodLook& look, std::vector<Surfel>& out);
/// The edges of a box or a frustum as rods; of a ball three great circles.
void appendEdges(const Zone& zone, const RodLook& look, std::vector<Surfel>& out);
inline constexpr std::size_t kMostRodSurfels = 30'000'000;

}  // namespace restroke::points
