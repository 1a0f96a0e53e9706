#pragma once
// Which triangles of a closed mesh meet where they should not.

#include <array>
#include <cstdint>
#include <vector>

#include "implicit/geometry/triangle_mesh.h"

namespace restroke::points {

/// All pairs of triangles that have a point in common other than a shared vertex or edge, at least one of the
/// two being among the chosen (one flag for each triangle): lower number first, ascending. A degenerate
/// triangle meets every triangle that it shares a vertex with. Exact, whatever the coordinates. Works in
/// parallel within the caller's arena. O(n log n) where few boxes of triangles overlap.
[[nodiscard]] std::vector<std::array<std::uint32_t, 2>> meetingPairs(const TriangleMesh& mesh,
                                                                     const std::vector<bool>& chosen);

}  // namespace restroke::points
