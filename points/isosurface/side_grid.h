#pragma once
// A uniform grid of points with the side of each, and the crossed edges and cut cells that follow from it.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "points/isosurface/contour_source.h"

namespace restroke::points {

/// A grid point, or the cell whose lowest corner it is.
using GridIndex = std::array<int, 3>;

/// An edge of the grid: from a point one step along an axis.
struct GridEdge {
  int axis = 0;
  GridIndex low{};
};

/// Points of a uniform grid around a solid, one bit each. All points on the grid's border are outside, so
/// that whatever separates inside from outside is closed.
///
/// Crossed edges (one end inside, one outside) and cut cells (not all corners on one side) are never listed:
/// both are bits that follow from the rows of sides, and an edge's or cell's number is the count of bits
/// before it. Edges are numbered by axis, then z, y, x; cells by z, y, x. Memory: points / 8 bytes and 16
/// bytes a row.
class SideGrid {
 public:
  /// Asks the source about every point of a grid of cubes with sides of `cell` around its bounds. The
  /// outermost faces of the bounds are in the middle of cells along the longest side; there is at least half
  /// a cell more all around. Bounds must not be empty, the cell positive; the caller has checked the number
  /// of points. Throws InternalError when the source says that a point on the border is inside.
  SideGrid(const ContourSource& source, const Box& bounds, double cell);
  /// The source's own grid with the sides that it fills in. Errors as above.
  explicit SideGrid(const GridSource& source);

  /// Points along each axis for those bounds and that cell; as doubles, for checks before anything is held.
  [[nodiscard]] static std::array<double, 3> pointsFor(const Box& bounds, double cell);

  [[nodiscard]] double cell() const { return cell_; }
  [[nodiscard]] const std::array<int, 3>& points() const { return points_; }
  [[nodiscard]] std::size_t rows() const {
    return rowCount_;
  }  ///< rows of points along x: row = z * points()[1] + y
  [[nodiscard]] Point at(GridIndex i) const;

  [[nodiscard]] bool inside(GridIndex i) const { return (wordAt(rowOf(i), i[0] / 64) >> i[0] % 64 & 1) != 0; }
  /// Bit c: corner c of the cell is inside (cell_patches.h). False bits for what stands beyond the grid.
  [[nodiscard]] std::uint8_t cornersOf(GridIndex cell) const;

  [[nodiscard]] std::size_t edgeCount() const { return edgesBefore_.back(); }
  [[nodiscard]] std::size_t cellCount() const { return cellsBefore_.back(); }
  /// Numbers of a crossed edge and of a cut cell.
  [[nodiscard]] std::size_t numberOf(const GridEdge& edge) const;
  [[nodiscard]] std::size_t numberOf(GridIndex cell) const;

  /// Calls f(number, edge) for the crossed edges of an axis that start in a row.
  template <class F>
  void forEdgesOf(int axis, std::size_t row, const F& f) const {
    std::size_t number = edgesBefore_[static_cast<std::size_t>(axis) * rowCount_ + row];
    forBits([&](int w) { return edgeWord(axis, row, w); }, row,
            [&](GridIndex low) { f(number++, GridEdge{axis, low}); });
  }
  /// Calls f(number, cell) for the cut cells whose lowest corners are in a row.
  template <class F>
  void forCellsOf(std::size_t row, const F& f) const {
    std::size_t number = cellsBefore_[row];
    forBits([&](int w) { return cellWord(row, w); }, row, [&](GridIndex cell) { f(number++, cell); });
  }

 private:
  [[nodiscard]] std::size_t rowOf(GridIndex i) const {
    return static_cast<std::size_t>(i[2]) * static_cast<std::size_t>(points_[1]) +
           static_cast<std::size_t>(i[1]);
  }
  [[nodiscard]] std::uint64_t wordAt(std::size_t row, int w) const {
    return bits_[row * words_ + static_cast<std::size_t>(w)];
  }
  // Bits of crossed edges and of cut cells; none in the last row or layer, where they would reach beyond.
  [[nodiscard]] std::uint64_t edgeWord(int axis, std::size_t row, int w) const;
  [[nodiscard]] std::uint64_t cellWord(std::size_t row, int w) const;
  void measure();
  void ask(const ContourSource& source);
  void askBlock(const ContourSource& source, GridIndex first);
  void refuseInsideBorder() const;
  void number();

  template <class Word, class F>
  void forBits(const Word& word, std::size_t row, const F& f) const {
    const int y = static_cast<int>(row % static_cast<std::size_t>(points_[1]));
    const int z = static_cast<int>(row / static_cast<std::size_t>(points_[1]));
    for (int w = 0; w < static_cast<int>(words_); ++w)
      for (std::uint64_t bits = word(w); bits != 0; bits &= bits - 1)
        f(GridIndex{w * 64 + std::countr_zero(bits), y, z});
  }

  double cell_;
  std::array<int, 3> points_{};
  std::array<std::vector<float>, 3> coordinates_;
  std::size_t words_ = 0, rowCount_ = 0;
  std::vector<std::uint64_t> bits_;
  std::vector<std::size_t> edgesBefore_, cellsBefore_;  // running counts; the last is the total
};

}  // namespace restroke::points
