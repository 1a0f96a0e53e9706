#pragma once
// What the refine experiment says: zones taken together, promises with what was measured.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "experiments/output.h"
#include "experiments/refine.h"

namespace restroke::experiments {

/// The zones of one model by one method, taken together.
struct PooledLoss {
  const LossRow* first = nullptr;  ///< history, value, resolution, method of all of them
  std::size_t zones = 0;
  /// Parts of the length inside the reference. Nothing where that is empty.
  std::optional<double> missing, extra, wrong, volume;
  double worst = 0;  ///< wrong of the worst zone
  /// Parts that were missed; nothing where there were none to miss.
  std::optional<double> trimmingMissed, sidesMissed, endsMissed;
  /// The greatest of the zones, in cells of the model; nothing where one of the two has no ends anywhere.
  std::optional<double> toJudged, toReference;
  double collected = 0;  ///< ids that were replayed by those that meet the zone
};
/// In the order of the rows.
[[nodiscard]] std::vector<PooledLoss> pooled(const std::vector<LossRow>& rows);

/// How often and how badly a method fails.
struct Failures {
  std::size_t zones = 0;   ///< in which the reference has some length
  std::size_t beyond = 0;  ///< with more wrong than the target
  std::size_t badly = 0;   ///< with more than a hundredth wrong
  double worst = 0;
};
/// What the target allows, a part of the length.
inline constexpr double kTargetWrong = 0.0002;
inline constexpr double kBadlyWrong = 0.01;
[[nodiscard]] Failures failuresOf(const std::vector<LossRow>& rows, LossSweep sweep,
                                  const std::string& method);

/// The row of a growth, a size and a method; null where there is none.
[[nodiscard]] const GrowthRow* find(const std::vector<GrowthRow>& rows, Growth growth, std::size_t operations,
                                    const std::string& method);

/// From how many operations on powers of growth are fitted: of less the lines alone take most of the time.
inline constexpr std::size_t kFittedFrom = 10'000;

/// What the hypothesis and the targets promise.
[[nodiscard]] std::vector<Claim> claims(const RefinementResults& results);

}  // namespace restroke::experiments
