#pragma once
// What the scaling experiment says: promises with what was measured, tables, the page.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/output.h"
#include "experiments/scaling.h"

namespace restroke::experiments {

/// Of list and clusters, all indices included; of the visibility of all samples, by those that are seen.
[[nodiscard]] double bytesPerPrimitive(const Measured& m);
[[nodiscard]] double bytesPerSurfel(const Measured& m);

/// The figure that a sweep is drawn in.
[[nodiscard]] std::string_view figureOf(Sweep sweep);

/// What hypothesis and targets promise.
[[nodiscard]] std::vector<Claim> claims(const ScalingResults& results);

/// All rows as text, sweep by sweep, and the claims.
[[nodiscard]] std::string scalingTable(const ScalingResults& results);

struct ScalingImages {
  struct Picture {
    Sweep sweep;
    std::string part;  ///< "whole" or "part"
    std::string png;
  };
  std::vector<Picture> pictures;
  std::vector<std::pair<std::string, std::string>> figures;  ///< name, SVG
};
[[nodiscard]] std::string scalingReport(const ScalingResults& results, const ScalingImages& images,
                                        const Setup& setup, const Provenance& origin);

}  // namespace restroke::experiments
