#include "points/dexel/refine/placed_steps.h"

namespace restroke::points {

std::vector<HistoryStep> stepsOf(const DexelHistory& history, std::span<const OperationId> ids) {
  std::vector<HistoryStep> steps;
  steps.reserve(ids.size());
  for (const OperationId id : ids) history.stepsOf(id, steps);
  return steps;
}

std::vector<PlacedStep> placedSteps(std::span<const HistoryStep> steps, const LineFamily& family) {
  const FamilyRaster raster(family);
  std::vector<PlacedStep> placed;
  placed.reserve(steps.size());
  for (std::uint32_t i = 0; i < steps.size(); ++i) {
    const HistoryStep& step = steps[i];
    const LineRectangle rectangle = step.operation == DexelOperation::Intersection ? raster.whole()
                                    : step.ball                                    ? raster.of(*step.ball)
                                                : raster.of(step.solid->bounds());
    if (!rectangle.empty()) placed.push_back({i, rectangle});
  }
  return placed;
}

}  // namespace restroke::points
