#pragma once
// What keeps a triangle mesh from being the boundary of a solid.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "implicit/execution.h"
#include "implicit/geometry/triangle_mesh.h"

namespace restroke {

/// Everything that is wrong with a mesh. A mesh without faults is closed, consistently wound with its
/// triangles facing out, and meets itself in shared vertices and edges only. Several shells are fine when
/// they do not meet, and so is a shell that faces inwards inside one that faces outwards (a cavity). Vertices
/// are the same when their numbers are: weld equal positions first (readMesh does).
struct MeshFaults {
  /// Of each kind of fault the first ones are kept, in ascending order of vertices or triangles.
  static constexpr std::size_t kListed = 10;
  template <class Fault>
  struct List {
    std::size_t count = 0;  ///< of all, listed or not
    std::vector<Fault> first;
  };

  struct Vertex {
    std::uint32_t index;
    Point position;
    bool operator==(const Vertex&) const = default;
  };
  struct Edge {
    /// A border edge runs as in its triangle; others from the lower to the higher vertex.
    std::array<Vertex, 2> ends;
    std::size_t triangles;  ///< how many share it
    bool operator==(const Edge&) const = default;
  };
  struct Face {
    std::uint32_t triangle;
    std::array<Vertex, 3> corners;
    bool operator==(const Face&) const = default;
  };
  using FacePair = std::array<Face, 2>;
  /// A shell on whose two sides the winding number is not 0 and 1.
  struct Shell {
    Face face;            ///< one of its triangles
    std::int64_t behind;  ///< winding number behind that triangle
    std::int64_t before;  ///< winding number before it, where its normal points to
    bool operator==(const Shell&) const = default;
  };

  bool empty = false;  ///< no triangles at all
  /// Edges of one triangle only. Triangles that name a vertex twice have no say in edges and vertices.
  List<Edge> borders;
  List<Edge> crowded;       ///< edges of three triangles or more
  List<Edge> inconsistent;  ///< edges that both of their triangles run through in the same direction
  List<Face> degenerate;    ///< triangles without area (exactly), repeated vertices included
  /// Vertices whose triangles are not one fan: surfaces that touch in a point.
  List<Vertex> pinched;
  /// Pairs of triangles that meet other than in a shared vertex or edge. Degenerate triangles are left out:
  /// they are faults already, and lie in the edges of others.
  List<FacePair> crossings;
  /// Shells that face inwards without a shell around them, or outwards inside another. Looked for only when
  /// all of the above is in order, and left empty when `inwards` says it all.
  List<Shell> shells;
  /// Inside out: the mesh would be without faults if every triangle were turned around. Looked for when
  /// `shells` is.
  bool inwards = false;

  std::size_t shellCount = 0;  ///< pieces that hang together through edges
  double volume = 0;           ///< volumeOf(mesh); without meaning when there are borders

  /// No edge that is not shared by exactly two triangles, one in each direction, and no degenerate triangle.
  [[nodiscard]] bool closed() const {
    return borders.count + crowded.count + inconsistent.count + degenerate.count == 0 && !empty;
  }
  /// Is the mesh the boundary of a solid?
  [[nodiscard]] bool none() const {
    return closed() && pinched.count + crossings.count + shells.count == 0 && !inwards;
  }
};

/// Looks for all of them. Predicates are exact, so that a mesh has the same faults on every machine. The
/// sides of shells are computed with doubles: they are whole numbers, since shells do not meet when they are
/// asked for. O(n log n) for meshes whose triangles have few others near them; time grows with the number of
/// pairs whose boxes touch, which can be n^2. Throws InputError when a triangle names a vertex that is not
/// there, or a coordinate is not finite.
[[nodiscard]] MeshFaults faultsOf(const TriangleMesh& mesh, const Execution& execution = {});

/// Throws InputError when a triangle names a vertex that is not there, a coordinate is not finite, or there
/// are more than 2^30 triangles. O(triangles).
void checkMesh(const TriangleMesh& mesh);

/// The edges that an odd number of triangles share, in ascending order: without any, every line that avoids
/// vertices and edges passes through the mesh an even number of times. Vertices are the same when their
/// numbers are. Throws InputError as faultsOf. O(n log n).
[[nodiscard]] MeshFaults::List<MeshFaults::Edge> oddEdgesOf(const TriangleMesh& mesh,
                                                            const Execution& execution = {});

/// What is wrong, in words that follow a colon ("9 edges belong to one triangle only: 3-7 from (0, 0, 1) to
/// (0, 1, 1), ..."), each kind with its count and its first members. Without faults: "nothing is wrong".
[[nodiscard]] std::string describe(const MeshFaults& faults);

}  // namespace restroke
