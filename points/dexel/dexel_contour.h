#pragma once
// From a tri-dexel to a triangle mesh (SPEC D8).

#include <cstdint>
#include <optional>
#include <span>

#include "implicit/execution.h"
#include "points/dexel/tri_dexel.h"
#include "points/isosurface/contour_source.h"
#include "points/isosurface/isosurface.h"

namespace restroke::points {

/// A tri-dexel, on its own grid and one layer of outside points around it. The model must stay as it is while
/// this is used.
///
/// A grid point's side is what most of its three lines say, so that whatever the lines hold the sides are
/// those of a closed surface. The crossing of a grid's edge is the end of the line that runs along it.
/// Where that line was outvoted it is its nearest end of the right direction, half a cell away at most; or
/// else where the plane of the nearest end of any family passes. What is off the lines is on the side of the
/// nearest end's plane.
class TriDexelSource final : public GridSource {
 public:
  explicit TriDexelSource(const TriDexel& model);

  /// Of the grid with the layer around it; empty for a grid of no points.
  [[nodiscard]] Box bounds() const override;
  [[nodiscard]] Grid grid() const override;
  void fillSides(std::size_t words, std::span<std::uint64_t> bits) const override;
  void sides(std::span<const Point> points, std::span<implicit::Side> sides) const override;
  [[nodiscard]] Crossing crossing(Point inside, Point outside) const override;

 private:
  struct Range {
    int begin, end;  // of grid points, the layer around counted
  };
  [[nodiscard]] Range pointsWithin(int axis, float enter, float exit) const;
  [[nodiscard]] std::optional<Crossing> nearestEnd(DVec3 p) const;

  const TriDexel& model_;
  DexelGrid around_;
};

/// The boundary of the solid as a mesh that is closed, manifold and faces outwards (where lines contradict
/// each other a piece may face inwards), on the grid of the lines: see isosurface.h. Its edges and corners
/// stay sharp, by the normals of the ends. What lies between the lines is not seen, and of what is thinner
/// than a cell only what holds grid points. A vertex is within a cell of the solid's surface, but for a few
/// on ridges thinner than a cell, which are within a cell's diagonal. An empty model gives an empty mesh.
/// Throws InputError when the grid would have more than kMaxGridPoints points or the surface cross more than
/// 2^28 of its edges. Same model, same bits, whatever the execution. O(grid points / 64 + ends).
[[nodiscard]] Isosurface isosurfaceOf(const TriDexel& model, const Execution& execution = {});

}  // namespace restroke::points
