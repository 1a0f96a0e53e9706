#pragma once
// Meshes as images of shapes under maps that no kind of volume is closed under: fine enough that flat
// triangles stand for the curved image, and measured how far they are from it.

#include <cstddef>
#include <functional>

#include "implicit/geometry/space_map.h"
#include "implicit/shape.h"

namespace restroke::experiments {

/// Where a point close to a shape's surface lies on it.
using ToSurface = std::function<DVec3(DVec3)>;

/// A closed mesh of a shape's surface. Of a mesh it is that mesh with long edges halved, and every point of
/// it lies on the mesh; of any other shape, which must be star-shaped about the centre of its ball, its
/// vertices do.
struct SurfaceMesh {
  TriangleMesh mesh;
  ToSurface toSurface;
};

/// No edge is longer than `edge` (model units) unless that takes more than `mostTriangles`; then the longest
/// ones are halved first, as far as the number goes. A mesh keeps all its vertices, whatever the number.
struct FineMeshOptions {
  double edge = 0.05;
  std::size_t mostTriangles = 60'000;
};
[[nodiscard]] SurfaceMesh fineMeshOf(const implicit::Shape& shape, const FineMeshOptions& options);

/// A shape's image under a map.
struct MappedMesh {
  TriangleMesh mesh;
  /// How far the image of the surface's points is from the triangles that stand for them, model units: 4/3 of
  /// the largest distance at the middles of edges. For a map and a surface that are quadratic over a
  /// triangle, which fine ones are but for third-order terms, nowhere is it more: the deviation is then 4 (uv
  /// d1 + vw d2 + wu d3) in barycentric coordinates u, v, w, with the deviations d at the middles, and uv +
  /// vw + wu is at most 1/3.
  double chordError = 0;
};
[[nodiscard]] MappedMesh mapped(const SurfaceMesh& surface, const SpaceMap& map);

/// A volume made of the mesh. Throws InputError when it is no boundary of a solid: the map has folded it.
[[nodiscard]] implicit::Shape shapeOf(TriangleMesh mesh);

}  // namespace restroke::experiments
