#pragma once
// The rivals' measurements, and the proof that they do the same work.

#include <string>
#include <vector>

#include "tests/bench/cgal_corefinement.h"
#include "tests/bench/openvdb_csg.h"
#include "tests/bench/restroke_runs.h"

namespace restroke::bench {

/// Adds one repetition to the column, at the SIMD level in use where the rival has one: a leaf brush without
/// a level in its column has plain loops. `round` chooses which strokes are undone, where one undo takes so
/// long that only a few fit into a round.
void measureLeafBrush(const Task& task, std::size_t round, Column& column);
void measurePlainList(const Task& task, std::size_t round, Column& column);
[[nodiscard]] OpenVdbResult measureOpenVdbCsg(const Task& task, Column& column);
[[nodiscard]] CorefinementResult measureCorefinement(const Task& task, double seconds, Column& column);
/// Build and rays; `exactRays` is Restroke's rate (M/s), for the break-even.
void measureEmbree(const Task& task, double exactRays, Column& column);
/// Build, rays, and bringing the scene up to date after each of several strokes that are appended, and after
/// each that is undone in the middle of the list; `round` chooses them. The model's own work is not counted.
void measureUpdatedEmbree(const Task& task, std::size_t round, Column& column);

/// A sentence on what was compared, and whether it held.
struct Check {
  bool holds = false;
  std::string sentence;
};
[[nodiscard]] std::vector<Check> checkRivals(const Task& task, const RivalsTable& table,
                                             const OpenVdbResult& csg, const CorefinementResult& corefined);

}  // namespace restroke::bench
