#pragma once
// The rivals' table as text, JSON and CSV.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "experiments/provenance.h"
#include "tests/bench/rivals_runs.h"

namespace restroke::bench {

/// What the table is about, and on what it was made.
struct Heading {
  experiments::Provenance origin;
  std::string list;
  std::size_t primitives = 0, strokes = 0, surfels = 0, activeVoxels = 0, rays = 0, rounds = 0;
  std::size_t shortened = 0;  ///< stamps of the shortened list that CGAL got through
  float density = 0;
  double voxel = 0;
};

[[nodiscard]] std::string textOf(const Heading& heading, const RivalsTable& table);
[[nodiscard]] std::string textOfTargets(const RivalsTable& table);
[[nodiscard]] nlohmann::ordered_json jsonOf(const Heading& heading, const RivalsTable& table,
                                            const std::vector<Check>& checks);
/// One line for each figure: row, unit, column, simd, value, ratio, repetitions.
[[nodiscard]] std::string csvOf(const RivalsTable& table);

}  // namespace restroke::bench
