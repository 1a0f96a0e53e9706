#include "implicit/sampling/rings.h"

#include <algorithm>
#include <cmath>
#include <mutex>

namespace restroke::implicit {

std::span<const RingPlace> ringPlaces(std::uint32_t columns) {
  static std::array<std::once_flag, kMostColumns + 1> made;
  static std::array<std::vector<RingPlace>, kMostColumns + 1> places;
  std::call_once(made[columns], [&] {
    constexpr double kGolden = 0.6180339887498949;
    std::vector<std::pair<double, std::uint32_t>> fractions(columns * kPatch);
    for (std::uint32_t k = 0; k < fractions.size(); ++k) {
      const double turns = k * kGolden;
      fractions[k] = {turns - static_cast<double>(static_cast<std::uint32_t>(turns)), k};
    }
    std::sort(fractions.begin(), fractions.end());
    for (const auto& [fraction, k] : fractions) places[columns].push_back({k, sineCosineOfTurns(fraction)});
  });
  return places[columns];
}

std::uint32_t ringColumns(double radius, double patchArea) {
  const double columns = 6.283185307179586 * radius / std::sqrt(patchArea);
  return static_cast<std::uint32_t>(std::clamp(columns + 0.5, 1.0, static_cast<double>(kMostColumns)));
}

}  // namespace restroke::implicit
