#pragma once
// A plane through a model of dexels, for drawing (figure 1 of the paper).

#include <string>

namespace restroke::experiments {

/// The plane through the middle of the ball's grid (of `resolution` points along an axis), across z, as a
/// table: kind, x0, y0, x1, y1.
///   cell    a voxel inside: its corners
///   column  a span of the family along y: its ends; row: the same along x
///   end     one end: where it is, and its normal as it is kept (each column and row has two)
///   disc    the truth: middle, and radius as x1
///   cells   size of a cell as x0, and points along x and y as x1, y1
[[nodiscard]] std::string sliceTable(int resolution);

}  // namespace restroke::experiments
