#pragma once
// The dual of a grid of sides: a vertex for each patch of surface in a cell, a quad for each crossed edge.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "implicit/geometry/triangle_mesh.h"
#include "points/isosurface/cell_patches.h"
#include "points/isosurface/qef.h"
#include "points/isosurface/side_grid.h"

namespace restroke::points {

/// Where a patch's vertex is put, from the most faithful to the safest.
enum class VertexPlace : std::uint8_t {
  NextCell,  ///< where the patch's planes meet, in a neighbouring cell that no surface was seen in
  InCell,    ///< where they meet best within the cell
  Cone,      ///< the same; and what surrounds the vertex stays in the cell
  MeanCone,  ///< the mean of the crossings; and what surrounds the vertex stays in the cell
};

/// A mesh that is closed, manifold and faces outwards whatever the sides are, and whose vertices can be moved
/// from one VertexPlace to a safer one.
///
/// An ambiguous face is read as the source reads its centre. Where the two cells that share it both have a
/// double face there (cell_patches.h), the two edges of the dual that cross the face would join the same two
/// vertices; each gets a vertex of its own on the face.
///
/// If all vertices are at MeanCone, no two triangles meet (but in shared vertices and edges). Every patch is
/// then a cone over the loop that it draws on its cell's boundary, within the convex hull of its crossings,
/// and the hulls of a cell's patches lie on different sides of a plane; to have this of all cells, the faces
/// of checkerboards are not asked about but separated. At Cone the same holds for cells with one patch.
class DualMesh {
 public:
  /// Every vertex and every triangle (up to 8 a quad) has a 32-bit number.
  static constexpr std::size_t kMaxQuads = std::size_t{1} << 28;

  /// Works in parallel within the caller's arena. The grid must outlive this, and have at most kMaxQuads
  /// crossed edges.
  DualMesh(const SideGrid& grid, const ContourSource& source);

  /// Triangles, and for each the quad that it is part of.
  struct Triangles {
    TriangleMesh mesh;
    std::vector<std::uint32_t> quad;
  };
  [[nodiscard]] Triangles triangles() const;

  /// Quads whose triangles may meet others where they should not: all those of which it is not sure that they
  /// stay among the cells around their edges as these triangles should (dual_mesh.cpp has the argument). No
  /// two triangles of other quads meet but in shared vertices and edges.
  [[nodiscard]] std::vector<bool> doubtfulQuads() const;

  /// Makes the mesh safer where pairs of its triangles meet: for each pair the first that applies of:
  /// vertices leave NextCell; quads become fans about their crossings; vertices become Cone; vertices become
  /// MeanCone. Returns, for each quad, whether it has changed or is in one of the pairs.
  using TrianglePair = std::array<std::uint32_t, 2>;
  std::vector<bool> makeSafer(const Triangles& triangles, std::span<const TrianglePair> pairs);

  /// Vertices at a place.
  [[nodiscard]] std::size_t count(VertexPlace place) const;
  /// Quads that are fans.
  [[nodiscard]] std::size_t fans() const;

 private:
  using Quad = std::array<std::uint32_t, 4>;  // patches, counter-clockwise from outside
  enum class Split : std::uint8_t { Diagonal02, Diagonal13, Fan };

  struct EdgeCrossing {
    Point safe;  // moved away from the ends of the edge
    double along;
    Vec3 normal;
  };
  struct Patch {
    GridIndex cell{};
    VertexPlace place = VertexPlace::InCell;
    std::uint8_t rank = 0;      // of the planes' minimum
    bool isOnly = false;        // in its cell
    std::array<Point, 3> at{};  // of NextCell, of InCell and Cone, of MeanCone
    Qef qef;
  };
  struct CutCell {
    std::uint32_t firstPatch;
    std::uint8_t corners, joinedFaces;
    std::uint8_t doubleFaces;
  };
  // What a patch knows about a cell: that planes meet there.
  struct Claim {
    GridIndex target;
    int rank;
    double distance;
    std::uint32_t patch;
    DVec3 place;
  };

  void findCrossings(const ContourSource& source);
  void findPatches(const ContourSource& source);
  void placePatches();
  [[nodiscard]] Point within(GridIndex cell, Point p) const;
  void placePatch(std::uint32_t patch, const Qef::Minimum& best, DVec3 safeSum);
  void placeSharp(const ContourSource& source);
  [[nodiscard]] std::optional<Claim> claimOf(std::uint32_t patch, const ContourSource& source) const;
  void findQuads();
  void chooseSplits(const std::vector<bool>& quads);
  [[nodiscard]] Split chooseDiagonal(const Quad& quad) const;

  [[nodiscard]] bool isCut(GridIndex cell) const;
  [[nodiscard]] CutCell readCell(GridIndex cell, const ContourSource& source) const;
  [[nodiscard]] Point positionOf(std::uint32_t patch) const;
  [[nodiscard]] bool isFan(std::uint32_t quad) const;
  [[nodiscard]] bool isInOrder(std::uint32_t quad, const GridEdge& edge) const;
  [[nodiscard]] bool isCone(std::uint32_t patch) const { return patches_[patch].place >= VertexPlace::Cone; }
  [[nodiscard]] DVec3 centerOf(GridIndex cell) const;
  [[nodiscard]] DVec3 positionOf(const GridEdge& edge, const EdgeCrossing& crossing) const;
  [[nodiscard]] std::uint32_t partnerAcross(const GridEdge& edge, int side) const;

  const SideGrid& grid_;
  std::vector<EdgeCrossing> crossings_;  // by edge number, as are quads_ and splits_
  std::vector<CutCell> cells_;           // by cell number
  std::vector<Patch> patches_;
  std::vector<Quad> quads_;
  std::vector<Split> splits_;
  std::vector<std::uint8_t>
      doubleSides_;  // of each quad: bit i, its side from vertex i is on a doubly double face
};

}  // namespace restroke::points
