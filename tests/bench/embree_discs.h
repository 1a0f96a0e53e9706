#pragma once
// A rival for rays: Embree with all surfels as oriented discs, built from nothing.

#include <memory>
#include <optional>
#include <span>

#include "implicit/geometry/ray.h"
#include "points/surfel.h"

namespace restroke::bench {

/// The nearest disc that a ray meets, seen from either side: no filter, as that costs Embree time and a
/// camera outside the shape does not need one. Builds and casts on one thread.
class EmbreeDiscs {
 public:
  /// O(surfels log surfels). Throws InputError when Embree cannot be started or has no memory.
  explicit EmbreeDiscs(std::span<const points::Surfel> surfels);
  ~EmbreeDiscs();
  EmbreeDiscs(const EmbreeDiscs&) = delete;
  EmbreeDiscs& operator=(const EmbreeDiscs&) = delete;

  [[nodiscard]] std::optional<double> castRay(const Ray& ray) const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace restroke::bench
