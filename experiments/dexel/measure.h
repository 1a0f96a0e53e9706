#pragma once
// One solid as voxels, as one family of dexels and as three: what each takes, and how far it is from the
// truth.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "implicit/execution.h"
#include "implicit/primitive_list.h"
#include "implicit/side.h"
#include "points/dexel/dexel_grid.h"
#include "points/surfel.h"
#include "retarget/methods/nearest_surfels.h"

namespace restroke::experiments {

/// Whatever the representation, its places are the points of one grid (points/dexel/dexel_grid.h).
enum class Representation : std::uint8_t {
  Voxels,        ///< a bit a grid point: its side, for the cube of one cell around it
  OneFamily,     ///< dexels along z
  ThreeFamilies  ///< a tri-dexel
};
inline constexpr Representation kRepresentations[] = {Representation::Voxels, Representation::OneFamily,
                                                      Representation::ThreeFamilies};
/// The axis of OneFamily.
inline constexpr int kOneFamily = 2;

struct TruthOptions {
  std::size_t points = 1'000'000;  ///< whose sides are asked for, > 0
  std::uint64_t seed = 1;          ///< of those points
  float density = 0;               ///< of the surface samples, a square model unit, > 0
};

/// What a solid really is: its list, the sides of random points in the bounds, samples of its surface.
class Truth {
 public:
  /// Throws InputError when the list's bounds are empty, no random point is inside, no sample is visible, or
  /// the sampling is refused (implicit::sampleCount).
  Truth(std::vector<implicit::Primitive> primitives, const TruthOptions& options, const Execution& execution);

  [[nodiscard]] const implicit::PrimitiveList& list() const { return list_; }
  [[nodiscard]] const std::vector<implicit::Primitive>& primitives() const { return primitives_; }
  [[nodiscard]] const Box& bounds() const { return bounds_; }
  [[nodiscard]] const std::vector<Point>& points() const { return points_; }
  [[nodiscard]] const std::vector<implicit::Side>& sides() const { return sides_; }
  [[nodiscard]] std::size_t pointsInside() const { return inside_; }
  [[nodiscard]] const retarget::NearestSurfels& surface() const { return *surface_; }
  /// Least distance from p to places that are known to be on the surface: the nearest sample, and where the
  /// lines through p along that sample's normal and along `normal` (unit) first enter the solid, no farther
  /// than `reach` (model units, > 0). Never less than the true distance; on smooth surfaces the same but for
  /// rounding.
  [[nodiscard]] double distanceFromSurface(Point p, Vec3 normal, double reach) const;

 private:
  std::vector<implicit::Primitive> primitives_;
  implicit::PrimitiveList list_;
  Box bounds_;
  std::vector<Point> points_;
  std::vector<implicit::Side> sides_;
  std::size_t inside_ = 0;
  std::unique_ptr<const retarget::NearestSurfels> surface_;
};

/// Of many distances, model units.
struct Distances {
  double mean = 0, high = 0, most = 0;  ///< `high`: the 99th percentile
};

struct DexelMeasured {
  Representation representation = Representation::Voxels;
  points::GridCounts counts{};  ///< grid points along each axis
  double cell = 0;              ///< from point to point, model units
  std::size_t lines = 0;        ///< of dexels; 0 for voxels
  /// Surface elements: ends of spans; of voxels the middles of the faces between a cell inside and one
  /// outside or beyond the grid.
  std::size_t elements = 0;
  std::size_t bytes = 0;                              ///< from the containers' capacity
  std::optional<std::size_t> bytesWithoutOperations;  ///< of dexels that keep no operations
  /// Random points on whose side the representation is wrong, by the points inside: a part of the volume. A
  /// voxel answers for its cube, one family by the line nearest to the point, three families by the majority
  /// of the three nearest lines.
  std::size_t wrongPoints = 0;
  double wrongVolume = 0;
  Distances coverage;  ///< from the surface samples to the nearest element
  Distances accuracy;  ///< from the elements to the surface (Truth::distanceFromSurface)
};

/// All three, on a grid of `resolution` points along the longest side of the bounds. The same figures for any
/// number of threads. Throws InputError as points::dexelGridFor does. `elements`, where it is not null, gets
/// the elements of each representation with outward normals, as discs that cover a cell.
[[nodiscard]] std::vector<DexelMeasured> measureAt(
    const Truth& truth, int resolution, const Execution& execution,
    std::vector<std::vector<points::Surfel>>* elements = nullptr);

}  // namespace restroke::experiments
