#pragma once
// A history tree for people and programs: text for a terminal, JSON, and a drawing after the paper's figure 9
// (SPEC S8).

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "sculpt/history.h"

namespace restroke::cli {

/// One line a node: cursor (>), a mark (+ adds, - carves, b another base, t a transform of it; x when
/// cancelled), number, what it is. What follows stands below; only where the tree branches is there a step to
/// the right.
[[nodiscard]] std::string treeText(const sculpt::History& history);

/// {"cursor": N, "nodes": [{"node", "parent", "kind", "cancelled", ...}]}, by number.
[[nodiscard]] nlohmann::ordered_json treeJson(const sculpt::History& history);

/// The tree from left to right, a branch a row, long rows folded: the root white, what adds red, what carves
/// blue, other bases green, the cursor in a yellow frame, cancelled nodes translucent; the path to the cursor
/// drawn heavier, and a legend.
[[nodiscard]] std::string treeSvg(const sculpt::History& history);

}  // namespace restroke::cli
