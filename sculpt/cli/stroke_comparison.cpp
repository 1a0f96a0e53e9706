#include "sculpt/cli/stroke_comparison.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "sculpt/base_change.h"

namespace restroke::cli {

namespace {

/// JSON has no NaN: what was not observed is null.
nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json json(const retarget::Measures& m, bool knowsTruth) {
  nlohmann::ordered_json out{
      {"places", m.places}, {"missed", m.missed}, {"gained", m.gained}, {"miss_rate", number(m.missRate)}};
  if (knowsTruth) {
    out["error_rms"] = number(m.errorRms);
    out["error_max"] = number(m.errorMax);
    out["error_rms_of_length"] = number(m.errorRmsOfLength);
    out["error_max_of_length"] = number(m.errorMaxOfLength);
    out["hausdorff"] = number(m.hausdorff);
    out["hausdorff_of_length"] = number(m.hausdorffOfLength);
    out["length_drift"] = number(m.lengthDrift);
    out["normal_error_mean_degrees"] = number(m.normalErrorMean);
    out["normal_error_max_degrees"] = number(m.normalErrorMax);
  }
  out["surface_distance_rms"] = number(m.surfaceDistanceRms);
  out["surface_distance_max"] = number(m.surfaceDistanceMax);
  out["stretch_median"] = number(m.stretchMedian);
  out["stretch_min"] = number(m.stretchMin);
  out["stretch_max"] = number(m.stretchMax);
  out["drift_rms_pixels"] = number(m.driftRms);
  out["drift_max_pixels"] = number(m.driftMax);
  out["hidden"] = m.hidden;
  out["behind"] = m.behind;
  return out;
}

}  // namespace

StrokeComparison::StrokeComparison(const sculpt::Document& before, const sculpt::Document& after,
                                   const RetargetOptions& options, const Execution& execution) {
  std::optional<Affine> map;
  if (options.base.empty())
    map = options.transform.empty()
              ? Affine{}
              : sculpt::affineOf(sculpt::matrixOf(sculpt::affineNamed(options.transform, "--transform")));
  knowsTruth_ = map.has_value();
  std::vector<retarget::StrokeObservations> all;
  for (const auto& place : after.strokesOnList()) {
    const retarget::Trail* result = after.trailOf(place.node);
    const retarget::Trail* original = before.trailOf(place.node);
    if (!result) continue;
    const auto stroke = std::get<sculpt::StrokeCommand>(after.history().command(place.node));
    std::optional<retarget::Trail> truth;
    if (map && original) truth = retarget::mapped(*original, AffineMap(*map));
    retarget::RetargetedStroke compared{
        .result = *result, .original = original, .camera = stroke.stroke.camera, .execution = execution};
    if (truth) compared.truth = &*truth;
    if (options.surfaceDistance) {
      compared.model = &after.model();
      compared.prefix = {place.prefix};
    }
    all.push_back(retarget::observe(compared));
    observed_[place.node] = all.back();
  }
  overall_ = retarget::summarise(all);
}

nlohmann::ordered_json StrokeComparison::of(sculpt::NodeId node) const {
  const auto found = observed_.find(node);
  if (found == observed_.end()) return nullptr;
  return json(retarget::summarise({&found->second, 1}), knowsTruth_);
}

nlohmann::ordered_json StrokeComparison::overall() const {
  return observed_.empty() ? nlohmann::ordered_json(nullptr) : json(overall_, knowsTruth_);
}

std::string StrokeComparison::text() const {
  if (observed_.empty()) return {};
  std::string text;
  if (knowsTruth_ && std::isfinite(overall_.errorRms))
    text += fmt::format(
        "against the transformed strokes: RMS {:.3g} ({:.3g} % of a stroke's length), greatest "
        "{:.3g}, normals {:.3g} degrees\n",
        overall_.errorRms, 100 * overall_.errorRmsOfLength, overall_.errorMax, overall_.normalErrorMean);
  if (std::isfinite(overall_.surfaceDistanceRms))
    text += fmt::format("distance to the surface: RMS {:.3g}, greatest {:.3g}\n", overall_.surfaceDistanceRms,
                        overall_.surfaceDistanceMax);
  if (std::isfinite(overall_.stretchMedian))
    text += fmt::format("stretch {:.3g} (median; {:.3g} to {:.3g}), drift on the screen {:.3g} pixels RMS\n",
                        overall_.stretchMedian, overall_.stretchMin, overall_.stretchMax, overall_.driftRms);
  return text;
}

}  // namespace restroke::cli
