#pragma once
// Where parallel lines pass through the triangles of a mesh. Internal to points/dexel.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "implicit/geometry/vec.h"
#include "points/dexel/span_end.h"

namespace restroke::points {

/// Parallel lines, in a frame of their own: line (i, j) runs through (columns[i], rows[j]) along the third
/// axis, and depths grow along it. The frame is right-handed.
struct LineLattice {
  /// Strictly ascending and finite; no further apart in one place than in another but for rounding, or
  /// looking them up takes longer.
  std::span<const double> columns, rows;
};

/// Triangles in the frame of the lines: vertices are (column, row, depth), and within what float32 can hold.
struct LatticeMesh {
  std::span<const DVec3> vertices;
  std::span<const std::array<std::uint32_t, 3>> triangles;  ///< at most 2^30, indices in range
};

/// A line passes through a triangle.
struct LineCrossing {
  float depth;
  std::uint32_t triangle;
  bool leaves;  ///< the triangle's normal points along the line
};

/// The crossings of the lines in some rows.
struct RowCrossings {
  int firstRow = 0, rows = 0, width = 0;
  std::vector<std::uint32_t> begin;  ///< of each line in `all`, row by row; and the end of the last
  std::vector<LineCrossing> all;     ///< of each line in ascending order of depth, then triangle

  /// row: of the lattice, one of these.
  [[nodiscard]] std::span<const LineCrossing> of(int column, int row) const {
    const std::size_t line = static_cast<std::size_t>(row - firstRow) * static_cast<std::size_t>(width) +
                             static_cast<std::size_t>(column);
    return std::span(all).subspan(begin[line], begin[line + 1] - begin[line]);
  }

 private:
  friend class MeshScan;
  struct Found {
    std::uint32_t line;
    LineCrossing crossing;
  };
  std::vector<Found> found_;
};

/// Scan-converts triangles onto a lattice of lines, seen along the lines.
///
/// Which lines pass through a triangle is decided without rounding (implicit/geometry/exact_predicates.h). A
/// line through an edge or a vertex is decided as if it were moved by a distance smaller than any number
/// along the columns' axis, and by one smaller still along the rows'; triangles seen edge-on are passed
/// through by none. So every line passes through a mesh an even number of times if at each of its edges an
/// even number of triangles meets; edges are the same when they are in the same place, whatever the numbers
/// of their vertices.
///
/// Depths are computed in double, never beyond those of the triangle's corners, and rounded once to float32.
///
/// O(vertices + triangles) to prepare, then O(triangles of the rows + crossings) a band.
class MeshScan {
 public:
  /// Rows that are scanned together.
  static constexpr int kBandRows = 8;

  /// Refers to what it is given.
  MeshScan(const LatticeMesh& mesh, const LineLattice& lattice);

  [[nodiscard]] int bandCount() const { return static_cast<int>(bandBegin_.size()) - 1; }
  /// Bands may be scanned at the same time, each into crossings of its own. What these held is lost, their
  /// memory is used again.
  void scan(int band, RowCrossings& crossings) const;

 private:
  /// A vertex among the lines: the first column and row at its coordinates or after them.
  struct Place {
    int column, row;
  };
  /// Where an edge meets a row.
  struct EdgeAt {
    int firstColumn;  ///< the first that is at the edge or beyond it
    double column, depth;
  };
  [[nodiscard]] EdgeAt edgeAt(std::uint32_t low, std::uint32_t high, int row) const;
  [[nodiscard]] bool isBefore(int column, int row, std::uint32_t low, std::uint32_t high) const;
  void scanRow(std::uint32_t triangle, int row, RowCrossings& crossings) const;

  LatticeMesh mesh_;
  LineLattice lattice_;
  std::vector<Place> places_;
  std::vector<std::size_t> bandBegin_;    // of each band in triangles_, and the end of the last
  std::vector<std::uint32_t> triangles_;  // that meet lines of the band, ascending
};

/// Outward normals of triangles, for the ends of spans.
class FaceNormals {
 public:
  /// Vertices in model space. O(triangles).
  FaceNormals(std::span<const DVec3> vertices, std::span<const std::array<std::uint32_t, 3>> triangles);

  /// Of the triangle, turned so that it fits its part: against the line (`along`) where that enters a solid,
  /// along it where it leaves. Of a triangle that is too thin to have a normal in double precision, the
  /// line's direction.
  [[nodiscard]] PackedNormal of(const LineCrossing& crossing, bool leaves, PackedNormal along) const;

 private:
  std::vector<PackedNormal> normals_;
};

/// What is inside by the parity of a line's crossings.
struct ParitySpans {
  std::vector<ToolSpan> spans;  ///< ascending, apart from each other, none without length
  bool isOdd = false;           ///< an odd number of crossings; there are no spans then
  /// Surfaces overlap, or face different ways: the winding numbers along the line are not all 0 or 1, nor all
  /// 0 or -1. Parity takes what an even number of layers cover as outside.
  bool overlaps = false;
};
/// Crossings at the same depth cancel out in pairs: solids that touch become one, sheets without thickness
/// vanish. Of an odd number at one depth, one is the end. O(crossings).
void findSpans(std::span<const LineCrossing> crossings, const FaceNormals& normals, PackedNormal along,
               ParitySpans& out);

}  // namespace restroke::points
