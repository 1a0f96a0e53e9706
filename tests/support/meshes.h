#pragma once
// Small meshes for tests.

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "implicit/geometry/triangle_mesh.h"

namespace restroke::testing {

/// A box with 12 triangles that face out.
inline TriangleMesh boxMesh(Point low, Point high) {
  TriangleMesh mesh;
  for (const float z : {low.z, high.z})
    for (const float y : {low.y, high.y})
      for (const float x : {low.x, high.x}) mesh.vertices.push_back({x, y, z});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

/// Both in one mesh.
inline TriangleMesh together(TriangleMesh a, const TriangleMesh& b) {
  const auto base = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) a.triangles.push_back({base + t[0], base + t[1], base + t[2]});
  return a;
}

/// With every triangle turned around.
inline TriangleMesh insideOut(TriangleMesh mesh) {
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

/// An octahedron whose triangles are halved `levels` times along each side and pushed out onto the unit
/// sphere: 8 * 4^levels triangles.
inline TriangleMesh ballMesh(int levels) {
  TriangleMesh mesh;
  mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, isNew] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
      if (isNew) {
        const Vec3 sum = mesh.vertices[a] + mesh.vertices[b];
        mesh.vertices.push_back(sum / length(sum));
      }
      return entry->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    for (const auto& [a, b, c] : mesh.triangles) {
      const std::uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      for (const auto& t :
           {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c}, std::array{ab, bc, ca}})
        finer.push_back(t);
    }
    mesh.triangles = std::move(finer);
  }
  return mesh;
}

}  // namespace restroke::testing
