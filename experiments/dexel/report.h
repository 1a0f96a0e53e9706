#pragma once
// What the dexel experiment says: promises with what was measured, tables, the page.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "experiments/dexel.h"
#include "experiments/output.h"

namespace restroke::experiments {

/// Of dexels, by lines or ends; nothing for voxels.
[[nodiscard]] std::optional<double> bytesPerLine(const DexelMeasured& m);
[[nodiscard]] std::optional<double> bytesPerEnd(const DexelMeasured& m);

/// In order, each once.
[[nodiscard]] std::vector<std::string> sourcesOf(const DexelResults& results);

/// What the hypothesis and the paper promise.
[[nodiscard]] std::vector<Claim> claims(const DexelResults& results);

/// All rows as text, solid by solid, and the claims.
[[nodiscard]] std::string dexelTable(const DexelResults& results);

struct DexelImages {
  std::string figure1;                                       ///< SVG
  std::vector<std::pair<std::string, std::string>> figures;  ///< solid, SVG
  struct Picture {
    std::string source, caption, png;
  };
  std::vector<Picture> pictures;
};
[[nodiscard]] std::string dexelReport(const DexelResults& results, const DexelImages& images,
                                      const Setup& setup, const Provenance& origin);

}  // namespace restroke::experiments
