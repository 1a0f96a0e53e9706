#pragma once
// The nearest of many surfels: a k-d tree of FLANN proposes, arithmetic of our own decides.

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "implicit/primitive_list.h"
#include "points/surfel.h"
#include "retarget/method.h"

namespace restroke::retarget {

/// A tree of surfels.
class NearestSurfels {
 public:
  /// O(n log n). None is fine.
  explicit NearestSurfels(std::vector<points::Surfel> surfels);
  ~NearestSurfels();
  NearestSurfels(const NearestSurfels&) = delete;
  NearestSurfels& operator=(const NearestSurfels&) = delete;

  [[nodiscard]] const std::vector<points::Surfel>& surfels() const { return surfels_; }

  /// Index of the surfel whose position is nearest to p, by |position - p|^2 in double (x, y, z summed in
  /// that order); of equally near ones the lowest. Nothing when there are no surfels. The same bits
  /// everywhere, whatever order the tree is walked in. About O(log n) where p is near the surface.
  [[nodiscard]] std::optional<std::uint32_t> nearest(Point p) const;

 private:
  struct Tree;
  std::vector<points::Surfel> surfels_;
  std::unique_ptr<const Tree> tree_;
};

/// The point of the surfel's disc that is nearest to p. Same bits everywhere.
[[nodiscard]] DVec3 nearestOnDisc(const points::Surfel& surfel, DVec3 p);

/// Where `nearest` puts a place: the nearest point of the nearest surfel's disc, with the surfel's normal and
/// primitive. Nothing when there are no surfels. `list` is the one whose surfels they are.
[[nodiscard]] std::optional<SurfaceHit> nearestHit(const NearestSurfels& surfels,
                                                   const implicit::PrimitiveList& list, Point p);

}  // namespace restroke::retarget
