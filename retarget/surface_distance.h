#pragma once
// How far a place is from the surface that a list describes.

#include <optional>

#include "retarget/method.h"
#include "retarget/methods/nearest_surfels.h"

namespace restroke::retarget {

/// Distances to the whole shape's surface, for one prefix of a model.
class SurfaceDistance {
 public:
  /// Builds a tree of the prefix's surfels. The model must outlive this unchanged.
  explicit SurfaceDistance(const points::SurfelModel& model, implicit::Prefix prefix = {},
                           const Execution& execution = {});

  /// Distance from the place to the surface, in model units; nothing when the shape has no surfels.
  ///
  /// Of the nearest surfel, and of the list's crossings (exact, as castRay finds them, into the shape and out
  /// of it) on lines through the place along its normal, along the surfel's and towards the surfel, the
  /// nearest is taken; from there a descent along the surface looks for a nearer one. Each is a point of the
  /// surface, so but for rounding the answer is never less than the distance. It is the distance where the
  /// nearest surfel is on the part of the surface that is nearest.
  [[nodiscard]] std::optional<double> from(const SurfaceHit& place) const;

 private:
  struct Foot;
  void improve(Foot& foot, DVec3 p, DVec3 direction) const;

  const implicit::PrimitiveList& list_;
  implicit::Prefix prefix_;
  NearestSurfels surfels_;
};

}  // namespace restroke::retarget
