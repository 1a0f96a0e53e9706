#pragma once
// How often a triangle mesh goes around a point, also when it has holes.

#include <array>
#include <cstdint>
#include <vector>

#include "implicit/geometry/triangle_mesh.h"
#include "implicit/geometry/triangle_tree.h"

namespace restroke {

/// Generalised winding number of any set of triangles: A. Jacobson, L. Kavan and O. Sorkine-Hornung, Robust
/// Inside-Outside Segmentation using Generalized Winding Numbers, 2013; evaluated by the hierarchy of G.
/// Barill, N. Dickson, R. Schmidt, D. Levin and A. Jacobson, Fast Winding Numbers for Soups and Clouds, 2018.
///
/// For a closed mesh that faces out it is 1 inside and 0 outside (-1 inside one that faces inwards, 2 where
/// two shells overlap); a mesh with holes gives values in between that change smoothly across the holes.
/// Double precision, only + - * / and sqrt in a fixed order: the same bits on every machine. Degenerate
/// triangles count nothing.
class WindingNumber {
 public:
  /// Largest difference between at() and exactAt(). It is what tests measure on scans, parts and soups with a
  /// margin of two or more, not a proven bound.
  static constexpr double kFastError = 0.02;

  /// Coordinates must be finite and indices in range. Keeps a copy of the mesh. O(n log n) time, O(n) memory.
  explicit WindingNumber(TriangleMesh mesh);

  /// The winding number at `p` (model units), within kFastError. A mesh without triangles gives 0.
  /// O(log n) where p is not close to many triangles.
  [[nodiscard]] double at(DVec3 p) const;

  /// The sum over all triangles, exact but for the rounding of doubles. A triangle in whose plane p lies
  /// counts 0: on a flat part of a closed surface the value is halfway between the two sides. O(n).
  [[nodiscard]] double exactAt(DVec3 p) const;

  /// Is exactAt(p) above 1/2? The fast value decides where it is sure, the exact one where it is not.
  [[nodiscard]] bool isInside(DVec3 p) const;

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }

 private:
  /// The triangles below a node of the tree, seen from far away: moments of their area about a centre.
  struct Cluster {
    DVec3 center{0};    ///< weighted by area
    double radius = 0;  ///< of a ball about it that holds the triangles
    DVec3 area{0};      ///< integral of the normal n
    /// Integrals of n_i d_j, d the way from the centre.
    std::array<std::array<double, 3>, 3> first{};
    /// Integrals of n_i d_j d_k / 2 for jk = xx, yy, zz, xy, xz, yz (the last three doubled: jk and kj).
    std::array<std::array<double, 6>, 3> second{};
  };

  [[nodiscard]] Cluster clusterOf(const TriangleTree::Node& node) const;
  [[nodiscard]] static double farWinding(const Cluster& cluster, DVec3 away);
  [[nodiscard]] double windingOf(std::uint32_t triangle, DVec3 p) const;

  TriangleMesh mesh_;
  TriangleTree tree_;
  std::vector<Cluster> clusters_;  ///< one for each node
};

}  // namespace restroke
