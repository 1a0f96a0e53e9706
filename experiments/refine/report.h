#pragma once
// The refine experiment as text and as one page that needs nothing else.

#include <string>
#include <utility>
#include <vector>

#include "experiments/output.h"
#include "experiments/refine.h"

namespace restroke::experiments {

/// What was lost, model by model, seconds, and the claims, as text.
[[nodiscard]] std::string refinementTable(const RefinementResults& results);

struct RefinementImages {
  std::vector<std::pair<std::string, std::string>> figures;  ///< name (a sweep's, thin, time), SVG
  struct Picture {
    std::string history, caption, surfacePng, slicePng;
  };
  std::vector<Picture> pictures;
};
[[nodiscard]] std::string refinementReport(const RefinementResults& results, const RefinementImages& images,
                                           const Setup& setup, const Provenance& origin);

}  // namespace restroke::experiments
