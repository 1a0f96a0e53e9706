#pragma once
// Lines at whole numbers, and what passes through a mesh by the exact predicate.

#include <vector>

#include "implicit/geometry/exact_predicates.h"
#include "implicit/geometry/triangle_mesh.h"
#include "points/dexel/dexel_grid.h"

namespace restroke::points::testing {

/// Points at whole numbers, from `first` to `last` on every axis.
inline DexelGrid wholeNumbers(int first, int last) {
  const float low = static_cast<float>(first) - 0.5f, high = static_cast<float>(last) + 0.5f;
  return DexelGrid({Point(low), Point(high)}, 1);
}

/// The definition: the exact predicate of a ray along +x, with the axes moved around. +1 for each triangle
/// through which the line leaves, -1 for each through which it enters.
inline std::vector<int> crossingsByDefinition(const TriangleMesh& mesh, int axis, float u, float v) {
  const auto seen = [&](Point p) { return Point(p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]); };
  std::vector<int> sides;
  for (const auto& t : mesh.triangles)
    sides.push_back(
        crossingOf({seen(mesh.vertices[t[0]]), seen(mesh.vertices[t[1]]), seen(mesh.vertices[t[2]])},
                   {-1e30, static_cast<double>(u), static_cast<double>(v)}));
  return sides;
}

}  // namespace restroke::points::testing
