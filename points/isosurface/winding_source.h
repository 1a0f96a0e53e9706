#pragma once
// A solid from triangles that bound none: the points that they go around.

#include <cstdint>
#include <optional>
#include <span>

#include "implicit/execution.h"
#include "implicit/geometry/mesh_faults.h"
#include "implicit/geometry/triangle_mesh.h"
#include "implicit/geometry/triangle_tree.h"
#include "implicit/geometry/winding_number.h"
#include "points/isosurface/contour_source.h"

namespace restroke::points {

/// The points whose generalised winding number is more than 1/2 (WindingNumber::isInside). Its boundary lies
/// on triangles where the number jumps over 1/2, and spans holes where it passes 1/2 smoothly.
///
/// Crossings on triangles are exact to rounding and face as the triangle's plane does. Those in holes come
/// from the fast winding number: they are as far off as its error (kFastError at most) over its slope.
class WindingSource final : public ContourSource {
 public:
  /// Coordinates must be finite and indices in range. Keeps a copy of the mesh. O(n log n).
  explicit WindingSource(TriangleMesh mesh);

  /// The mesh's box, widened until the winding number stays below 1/2 on it: beyond, where no triangle is, it
  /// is harmonic and vanishes far away, so that it is nowhere more. Looked for at points of the box's faces;
  /// what might have been missed is cut off. Empty for a mesh without extent.
  [[nodiscard]] Box bounds() const override { return bounds_; }
  void sides(std::span<const Point> points, std::span<implicit::Side> sides) const override;
  [[nodiscard]] Crossing crossing(Point inside, Point outside) const override;

 private:
  [[nodiscard]] double mostOn(const Box& box) const;
  /// Of the chosen points, which are reordered.
  void sidesAmong(std::span<const Point> points, std::span<std::uint32_t> chosen,
                  std::span<implicit::Side> sides) const;
  /// The side of all points of a box that is clear of triangles all around, if there is no doubt about it.
  [[nodiscard]] std::optional<implicit::Side> sideOfAll(const Box& box, double clear) const;
  [[nodiscard]] Crossing bisect(DVec3 inside, DVec3 outside, double step) const;

  WindingNumber winding_;
  TriangleTree tree_;
  Box bounds_;
};

/// Cells along the longest side for repairs. Logs with a repaired mesh name the file, not its repair: another
/// number here is another solid for them.
inline constexpr int kRepairResolution = 96;

struct RepairOptions {
  int resolution = kRepairResolution;  ///< cells along the longest side, 1 to kMaxResolution
};

/// A mesh that bounds a solid, and how it was come by.
struct Repaired {
  enum class Way : std::uint8_t {
    None,          ///< nothing was wrong: the mesh as it was
    TurnedAround,  ///< it was inside out: the same triangles, each turned around
    Remeshed       ///< the isosurface of its winding number; vertices and triangles are new
  };
  TriangleMesh mesh;
  Way way = Way::None;
  MeshFaults faults;  ///< what was wrong
};

/// Makes the boundary of a solid of any mesh (SPEC S13). What is thinner than a cell may be lost. Same mesh
/// and options: same bits. Throws InputError when no solid comes of it: nothing has a winding number of 1/2
/// (an open sheet, or surfaces that face inwards), or isosurfaceOf refuses. Time: faultsOf and isosurfaceOf
/// with a winding number for each grid point.
[[nodiscard]] Repaired repairByWinding(const TriangleMesh& mesh, const RepairOptions& options = {},
                                       const Execution& execution = {});

}  // namespace restroke::points
