#pragma once
// Near-uniform samples of a surface of revolution, quickly: in order, so that no table need be sorted.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "implicit/geometry/powers.h"
#include "implicit/sampling/charts.h"
#include "implicit/sampling/sample_table.h"

namespace restroke::implicit {

/// Runs of the golden ratio's multiples, by size: where a sample stands in its run, and at which angle.
struct RingPlace {
  std::uint32_t number = 0;  ///< k, when sorted by the fraction of k times the golden ratio
  SineCosine angle;          ///< of that fraction of a turn
};
/// The places of a run of 16 * columns samples, sorted by angle. Made once and kept. Thread-safe.
[[nodiscard]] std::span<const RingPlace> ringPlaces(std::uint32_t columns);

/// Patches side by side around a ring of `radius`, so that each is about as high as wide where 16 samples
/// take `patchArea`; at most kMostColumns.
inline constexpr std::uint32_t kMostColumns = 256;
[[nodiscard]] std::uint32_t ringColumns(double radius, double patchArea);

/// `count` samples (a multiple of kPatch) on the surface of that area whose profile is `profile(area below)`:
/// the k-th where k + 1/2 of `count` equal parts of the area lie below it, k times the golden ratio around,
/// as sampleCharts has it. They come ring by ring, sorted by angle within each, so that patches are compact.
template <class Profile>
[[nodiscard]] SampleTable sampleRings(double area, std::uint32_t count, const Profile& profile) {
  constexpr double kGolden = 0.6180339887498949;
  SampleTable::Columns out;
  for (auto* column : {&out.x, &out.y, &out.z, &out.nx, &out.ny, &out.nz}) column->resize(count);
  const double step = area / count;
  const std::uint32_t patches = count / static_cast<std::uint32_t>(kPatch);
  for (std::uint32_t done = 0; done < patches;) {
    // As many patches as go around the ring's middle, which lies half its own width farther.
    const double start = done * static_cast<double>(kPatch) * step;
    std::uint32_t columns = ringColumns(profile(start).radius, kPatch * step);
    columns = ringColumns(profile(start + columns * kPatch * step / 2).radius, kPatch * step);
    columns = columns < patches - done ? columns : patches - done;
    const std::uint32_t first = done * static_cast<std::uint32_t>(kPatch);
    const double turns = 0.5 + first * kGolden;
    const SineCosine from = sineCosineOfTurns(turns - static_cast<double>(static_cast<std::uint32_t>(turns)));
    const std::span<const RingPlace> places = ringPlaces(columns);
    for (std::uint32_t i = 0; i < places.size(); ++i) {
      const RingPlace& place = places[i];
      const ProfilePoint p = profile((first + place.number + 0.5) * step);
      const double c = from.cosine * place.angle.cosine - from.sine * place.angle.sine,
                   s = from.sine * place.angle.cosine + from.cosine * place.angle.sine;
      const std::uint32_t k = first + i;
      out.x[k] = static_cast<float>(p.radius * c);
      out.y[k] = static_cast<float>(p.radius * s);
      out.z[k] = static_cast<float>(p.height);
      out.nx[k] = static_cast<float>(p.normalRadius * c);
      out.ny[k] = static_cast<float>(p.normalRadius * s);
      out.nz[k] = static_cast<float>(p.normalHeight);
    }
    done += columns;
  }
  return SampleTable(std::move(out));
}

}  // namespace restroke::implicit
