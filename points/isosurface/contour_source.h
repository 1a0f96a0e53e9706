#pragma once
// What a solid must be able to answer to be turned into a mesh.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "implicit/geometry/box.h"
#include "implicit/geometry/vec.h"
#include "implicit/primitive_list.h"
#include "implicit/side.h"

namespace restroke::points {

/// Where a segment leaves a solid.
struct Crossing {
  DVec3 position{0};
  DVec3 normal{0, 0, 1};  ///< unit, out of the solid; at a sharp edge, of the face that the segment crosses
};

/// A solid that is known by side tests. All members are called by several threads at once, and must give the
/// same answer to the same question every time.
class ContourSource {
 public:
  virtual ~ContourSource() = default;

  /// Box that holds the solid, in model units; empty for an empty solid. It need not be tight, but
  /// resolutions count along its longest side.
  [[nodiscard]] virtual Box bounds() const = 0;
  /// sides[i] becomes the side of points[i]; the spans have equal size. Up to 4,096 points, neighbours in the
  /// array being neighbours in space.
  virtual void sides(std::span<const Point> points, std::span<implicit::Side> sides) const = 0;
  /// The crossing on the segment from a grid point that `sides` called inside to one that it called outside;
  /// of several the one nearest the inside end. It must answer in every case, however rounding came out.
  [[nodiscard]] virtual Crossing crossing(Point inside, Point outside) const = 0;

 protected:
  ContourSource() = default;
  ContourSource(const ContourSource&) = default;
  ContourSource& operator=(const ContourSource&) = default;
};

/// A solid that is known best at the points of a grid of its own: its mesh is made on that grid.
class GridSource : public ContourSource {
 public:
  struct Grid {
    double cell = 0;  ///< from point to point, model units
    /// Of the points along each axis: ascending, `cell` apart but for rounding, at least 2.
    std::array<std::vector<float>, 3> coordinates;
  };
  /// All points on the grid's border must be outside.
  [[nodiscard]] virtual Grid grid() const = 0;
  /// The sides of all its points, a bit each, set for the inside: rows along x of `words` words, row y of
  /// layer z being number z * (points along y) + y. All bits are clear at the call, which is one for the
  /// whole grid; it may work in parallel within the caller's arena.
  virtual void fillSides(std::size_t words, std::span<std::uint64_t> bits) const = 0;
};

/// A prefix of a list of signed primitives. The list must stay as it is while this is used.
///
/// Crossings come from rays in double precision. Where float32 side tests and rays disagree (coincident
/// boundaries, grazed surfaces) the side tests are bisected, and the normal is that of the primitive which
/// decides there.
class ListSource final : public ContourSource {
 public:
  explicit ListSource(const implicit::PrimitiveList& list, implicit::Prefix prefix = {})
      : list_(list), prefix_(prefix) {}

  [[nodiscard]] Box bounds() const override { return list_.bounds(prefix_); }
  void sides(std::span<const Point> points, std::span<implicit::Side> sides) const override;
  [[nodiscard]] Crossing crossing(Point inside, Point outside) const override;

 private:
  [[nodiscard]] Crossing bisect(Point inside, Point outside) const;

  const implicit::PrimitiveList& list_;
  implicit::Prefix prefix_;
};

}  // namespace restroke::points
