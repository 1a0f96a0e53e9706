#pragma once
// restroke dexel apply --toolpath: cutters, and nozzles that add, along a path.

#include <nlohmann/json_fwd.hpp>

#include "points/dexel/dexel_document.h"
#include "sculpt/cli/commands.h"

namespace restroke::cli {

/// Throws InputError when options are given that have no sense with a tool path, or without one.
void checkToolpathOptions(const DexelApplyOptions& options);

/// Applies each element of the path as an operation of its own, and returns what is to be reported. Throws
/// InputError; the document is then of no use.
[[nodiscard]] nlohmann::ordered_json applyToolpath(const DexelApplyOptions& options,
                                                   points::TriDexelDocument& document);

}  // namespace restroke::cli
