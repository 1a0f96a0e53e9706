#pragma once
// What is known of a volume without asking it: bounds of its clearance, one byte a cell.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "implicit/geometry/vec.h"

namespace restroke::implicit {

class Volume;

/// A grid over the box of a volume, in the volume's frame, and a layer of cells around it.
struct GridGeometry {
  DVec3 low{0};  ///< its corner
  double cell = 1;
  std::array<int, 3> size{1, 1, 1};

  explicit GridGeometry(const Volume& volume);
  [[nodiscard]] std::size_t cells() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
           static_cast<std::size_t>(size[2]);
  }
};

/// What rounding to float32 and a dilation may come to together, in cells, for a grid to be asked.
inline constexpr double kGridMargin = 0.03;
/// Cells that a grid has at most.
inline constexpr std::size_t kMostGridCells = std::size_t{35} * 35 * 35;

/// Of each cell, x first: > 0 when all of its points, moved by kGridMargin cells at most, are outside, < 0
/// when all are inside, 0 when neither is known. Asks for the clearance in the middle of each cell, once.
/// Points beyond the grid may be looked up in the cell nearest to them: where that is outside, so are they.
[[nodiscard]] std::vector<std::int8_t> sidesOfCells(const Volume& volume);

}  // namespace restroke::implicit
