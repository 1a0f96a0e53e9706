#pragma once
// Triangles that share vertices, as mesh files hold them.

#include <array>
#include <cstdint>
#include <vector>

#include "implicit/geometry/box.h"

namespace restroke {

/// Indexed triangles. A triangle's vertices run counter-clockwise as seen from outside. Nothing else is
/// promised: the mesh may be open, meet itself or be empty (implicit/geometry/mesh_faults.h looks for that).
struct TriangleMesh {
  std::vector<Point> vertices;  ///< model units
  std::vector<std::array<std::uint32_t, 3>> triangles;
  bool operator==(const TriangleMesh&) const = default;
};

/// Box of the vertices that triangles use. O(triangles).
[[nodiscard]] inline Box boundsOf(const TriangleMesh& mesh) {
  Box box;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) box.add({mesh.vertices[v], mesh.vertices[v]});
  return box;
}

/// Enclosed volume, in cubic model units: the signed sum over the triangles, negative when they face inwards.
/// Of a mesh that is not closed it means nothing. O(triangles).
[[nodiscard]] inline double volumeOf(const TriangleMesh& mesh) {
  // About a vertex of the mesh, so that a mesh far from the origin keeps its digits.
  if (mesh.triangles.empty()) return 0;
  const DVec3 origin(mesh.vertices[mesh.triangles.front()[0]]);
  double six = 0;
  for (const auto& t : mesh.triangles) {
    const DVec3 a = DVec3(mesh.vertices[t[0]]) - origin, b = DVec3(mesh.vertices[t[1]]) - origin,
                c = DVec3(mesh.vertices[t[2]]) - origin;
    six += dot(a, cross(b, c));
  }
  return six / 6;
}

}  // namespace restroke
