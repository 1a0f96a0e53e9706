#pragma once
// The same strokes on the original base, and on the changed one by each method: a row of the picture grid.

#include <span>

#include "experiments/retarget/trials.h"

namespace restroke::experiments {

struct RowOptions {
  std::uint32_t size = 300;              ///< pixels, both sides
  std::optional<std::size_t> only = {};  ///< show this stroke alone
};

/// Pictures, first of the original, then of the changed base by each method that looks different: `depth` and
/// `embree` look like `exact`. All are seen from where the strokes were drawn, from so far away that both
/// bases are in the picture.
[[nodiscard]] std::vector<std::pair<std::string, points::DisplayImage>> picturesOf(
    const Drawing& drawing, const ChangedBase& changed, const RowOptions& options,
    const Execution& execution);

}  // namespace restroke::experiments
