#pragma once
// The steps of a replay, and which lines of a family each may change. Internal to points/dexel.

#include <cstdint>
#include <span>
#include <vector>

#include "points/dexel/refine/family_raster.h"
#include "points/dexel/refine/history.h"

namespace restroke::points {

/// Those of the ids, in order.
[[nodiscard]] std::vector<HistoryStep> stepsOf(const DexelHistory& history, std::span<const OperationId> ids);

/// A step, by its number, and the lines that it may change.
struct PlacedStep {
  std::uint32_t step;
  LineRectangle lines;
};
/// Those that may change a line, in order. O(steps).
[[nodiscard]] std::vector<PlacedStep> placedSteps(std::span<const HistoryStep> steps,
                                                  const LineFamily& family);

}  // namespace restroke::points
