#pragma once
// Where a line in any direction passes through the triangles of a mesh.

#include <cstdint>
#include <vector>

#include "implicit/geometry/ray.h"
#include "implicit/geometry/triangle_mesh.h"
#include "implicit/geometry/triangle_tree.h"

namespace restroke {

struct RayCrossing {
  double t = 0;                ///< parameter along the line
  std::uint32_t triangle = 0;  ///< of the mesh
};

/// A mesh that lines are to be cast against.
struct MeshUnderLines {
  const TriangleMesh& mesh;
  const TriangleTree& tree;  ///< of the mesh
  double radius;             ///< about the size of the mesh: half its diagonal, or more
};

/// `crossings` becomes those of the whole line through the ray with the mesh, ascending (equal ones by
/// triangle).
///
/// Which triangles the line passes through is decided by the signs of edges seen along it, in double and the
/// same for both triangles of an edge (S. Woop, C. Benthin, I. Wald, "Watertight ray/triangle intersection",
/// Journal of Computer Graphics Techniques 2, 2013), ties as if the line were moved aside by less than any
/// number. Where rounding leaves an odd number of crossings, a line beside it is taken, by 2^-44 of the
/// radius: a mesh at each of whose edges an even number of triangles meets has an even number of crossings
/// but for a fault of odds beyond counting. Parameters are exact to a few units in the last place of the
/// coordinates. The same bits everywhere. O(log triangles + crossings), if the mesh is not all edge-on.
void findCrossings(const MeshUnderLines& mesh, const Ray& ray, std::vector<RayCrossing>& crossings);

}  // namespace restroke
