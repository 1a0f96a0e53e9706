#pragma once
// From a solid to a triangle mesh (SPEC S13, D8).

#include <cstddef>
#include <optional>

#include "implicit/execution.h"
#include "implicit/geometry/triangle_mesh.h"
#include "implicit/primitive_list.h"
#include "points/isosurface/contour_source.h"

namespace restroke::points {

/// How fine the grid is: at most one of the two. With neither, kDefaultResolution.
struct IsosurfaceOptions {
  /// Cells along the longest side of the source's bounds, 1 to kMaxResolution.
  std::optional<int> resolution = std::nullopt;
  /// Side of a cell in model units, finite and > 0.
  std::optional<double> cell = std::nullopt;
};

/// The volume is then within 0.01 % for a ball, and within 0.1 % for 400 random balls of 0.2 to 120 % of the
/// model's half size added and carved; at 32, within 0.1 % and 0.2 %. What is thinner than a cell has no such
/// bound.
inline constexpr int kDefaultResolution = 128;
inline constexpr int kMaxResolution = 4096;
/// More grid points than this are refused: the grid would take more than 1 GiB.
inline constexpr double kMaxGridPoints = 0x1p33;

struct Isosurface {
  TriangleMesh mesh;
  double cell = 0;           ///< side of a cell, in model units
  double resolution = 0;     ///< cells along the longest side of the bounds
  std::size_t cutCells = 0;  ///< cells with corners on both sides
  /// Pairs of triangles that meet other than in a shared vertex or edge. Always 0 as far as we know (the
  /// sources have the argument, the tests some thousand random solids); counted all the same.
  std::size_t selfIntersections = 0;
  std::size_t pairsParted = 0;    ///< pairs that would have met without what the next two count
  std::size_t fans = 0;           ///< quads that were cut into 4 to 8 triangles
  std::size_t movedVertices = 0;  ///< vertices that were moved away from where the tangent planes meet
};

/// The boundary of a solid as a mesh that is closed, manifold and faces outwards, for any answers that the
/// source gives, and in which no two triangles meet but in shared vertices and edges.
///
/// Dual contouring with a vertex for each patch of surface in a cell (see the sources). Vertices are
/// where tangent planes meet, so that edges and corners stay sharp; where that would make
/// triangles meet, and only there, vertices move towards the mean of their crossings and quads get up to 8
/// triangles. What fits between grid points is not seen: nothing smaller than a cell is promised to appear,
/// and an edge sharper than a right angle may be cut back. Shells and cavities come out as separate pieces.
/// An empty solid, or one that lies between the grid points, gives an empty mesh.
///
/// Throws InputError when both options are given or one is out of range, the grid would have more than
/// kMaxGridPoints points or the surface cross more than 2^28 of its edges, or float32 has fewer than 64
/// numbers across a cell; InternalError when the source says that a point beyond its bounds is inside. Same
/// source, same options: same bits, whatever the execution. O(grid points) side tests and 1/8 byte each; the
/// rest grows with the surface, about 1 kB for each cut cell.
[[nodiscard]] Isosurface isosurfaceOf(const ContourSource& source, const IsosurfaceOptions& options = {},
                                      const Execution& execution = {});

/// The same on the grid that the source brings. Throws InputError when that has more than kMaxGridPoints
/// points or the surface crosses too many of its edges, InternalError when a point on its border is inside.
[[nodiscard]] Isosurface isosurfaceOf(const GridSource& source, const Execution& execution = {});

}  // namespace restroke::points
