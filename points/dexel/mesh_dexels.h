#pragma once
// Tri-dexels of triangle meshes, by ray parity (SPEC D1, D2).

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "implicit/execution.h"
#include "implicit/geometry/mesh_faults.h"
#include "implicit/geometry/triangle_mesh.h"
#include "points/dexel/dexel_grid.h"
#include "points/dexel/tri_dexel.h"
#include "points/isosurface/winding_source.h"

namespace restroke::points {

/// Where the lines of a tri-dexel find that a mesh bounds no solid.
struct MeshLines {
  /// Of each kind so many are kept: by family, then by row, then by column.
  static constexpr std::size_t kListed = 10;
  /// Runs along `axis` through u and v on the two axes that follow it (x, y, z, x, ...), in model units.
  struct Line {
    int axis = 0;
    float u = 0, v = 0;
    bool operator==(const Line&) const = default;
  };
  struct List {
    std::array<std::size_t, 3> counts{};  ///< of all, by family, listed or not
    std::vector<Line> first;
    [[nodiscard]] std::size_t count() const { return counts[0] + counts[1] + counts[2]; }
    bool operator==(const List&) const = default;
  };
  /// They pass through the mesh an odd number of times: it has a hole there.
  List odd;
  /// Surfaces overlap or face different ways: somewhere on the line the winding number is neither 0 nor 1
  /// (nor 0 nor -1, of a mesh that is inside out). Parity takes what two shells share as outside.
  List overlapping;
  bool operator==(const MeshLines&) const = default;
};

/// What follows a colon: "3 of the lines along x, 1 along z, first along x at y = 0.5, z = 0.25".
[[nodiscard]] std::string describe(const MeshLines::List& list);

/// A mesh as lines see it.
struct SampledMesh {
  TriDexel model;
  MeshLines lines;
};

/// What is inside the mesh on each line of the grid, by the parity of its crossings (mesh_scan.h: lines in
/// faces and through edges and vertices are decided exactly, and consistently). Normals are those of the
/// triangles, outward whichever way the triangles face; ends belong to OperationId::Initial, with None
/// outside. A line with an odd number of crossings is left empty, and reported. What is beyond the grid is
/// cut off at its outermost lines. Same mesh and grid: same bits. Throws InputError when a triangle names a
/// vertex that is not there or a coordinate is not finite. O(lines + triangles + crossings).
[[nodiscard]] SampledMesh sampleMesh(const TriangleMesh& mesh, const DexelGrid& grid,
                                     const Execution& execution = {});

/// The same, of a solid: throws InputError when a line is odd, with how many and where (SPEC D1).
[[nodiscard]] TriDexel triDexelOf(const TriangleMesh& mesh, const DexelGrid& grid,
                                  const Execution& execution = {});

/// What to do with a mesh that bounds no solid.
enum class MeshRepair : std::uint8_t {
  None,    ///< take it as it is, if its lines can
  Winding  ///< repairByWinding (winding_source.h) first
};

struct MeshModelOptions {
  DexelGridOptions lines = {};  ///< about the box of the solid
  MeshRepair repair = MeshRepair::None;
};

struct MeshModel {
  TriangleMesh solid;  ///< what the model was built from: the mesh, or what was made of it
  Repaired::Way repaired = Repaired::Way::None;
  MeshFaults faults;  ///< why it was repaired; looked for only with MeshRepair::Winding
  TriDexel model;
  MeshLines lines;  ///< none of them odd
};

/// From a mesh as files have it to a tri-dexel. Throws InputError as dexelGridFor, repairByWinding and
/// triDexelOf do; the sentence about odd lines says that there is a repair.
[[nodiscard]] MeshModel meshModelOf(const TriangleMesh& mesh, const MeshModelOptions& options = {},
                                    const Execution& execution = {});

}  // namespace restroke::points
