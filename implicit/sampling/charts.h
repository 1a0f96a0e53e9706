#pragma once
// Near-uniform samples of a surface that is given in pieces over the unit square.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "implicit/sampling/sample_table.h"

namespace restroke::implicit {

/// A piece of surface: (s, t) in the unit square to a point, with the area below any rectangle of the square.
class Chart {
 public:
  using Map = std::function<SurfaceSample(double s, double t)>;

  /// A map that takes equal areas to equal areas.
  static Chart uniform(double area, Map map);
  /// Any smooth map; areas are measured on a grid of so many rows (of equal s) and columns.
  static Chart measured(int rows, int columns, Map map);

  [[nodiscard]] double area() const { return rows_.back(); }
  /// The point below which, in s, lies `areaBelow` (0 to area()) of the piece, and in its row the fraction
  /// `along` (0 to 1) of the row's area.
  [[nodiscard]] SurfaceSample at(double areaBelow, double along) const;

 private:
  Map map_;
  std::vector<double> rows_;                  // area up to the end of each row
  std::vector<std::vector<double>> columns_;  // of each row: area up to the end of each column; none: even
};

/// A curve turned about the z axis: (radius, height) and the outward normal in that plane.
struct ProfilePoint {
  double radius = 0, height = 0;
  double normalRadius = 1, normalHeight = 0;
};
/// The part of a surface of revolution whose profile is s -> point, s from 0 to 1; `rows` as for measured.
[[nodiscard]] Chart revolved(int rows, std::function<ProfilePoint(double s)> profile);
/// The same where equal steps of s are equal areas.
[[nodiscard]] Chart revolvedUniformly(double area, std::function<ProfilePoint(double s)> profile);

/// A surface that every ray from the origin meets once, over the six faces of a cube of directions: direction
/// (of no particular length) -> point. `cells` a side of each face.
[[nodiscard]] std::vector<Chart> starShaped(int cells,
                                            const std::function<SurfaceSample(DVec3 direction)>& map);

[[nodiscard]] double areaOf(std::span<const Chart> charts);

/// `count` samples on all charts together: the k-th is where k + 1/2 of `count` equal parts of the area lie
/// below it, at the fraction k * golden ratio mod 1 along its row. Within a chart that is a lattice which
/// stays well spread however the chart is stretched along s or t, because the golden ratio is the number that
/// fractions approach worst; on a sphere it is the Fibonacci lattice, on a disc the sunflower (Vogel, "A
/// better way to construct the sunflower head", Mathematical Biosciences 44, 1979).
[[nodiscard]] std::vector<SurfaceSample> sampleCharts(std::span<const Chart> charts, std::uint32_t count);

}  // namespace restroke::implicit
