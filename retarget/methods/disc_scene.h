#pragma once
// The surfels of a shape as an Embree scene that follows the shape, cluster by cluster (SPEC S14).

#include <cstddef>
#include <memory>
#include <optional>

#include "implicit/geometry/ray.h"
#include "points/surfel_model.h"

namespace restroke::retarget {

/// Never changes which discs there are, only speed and memory.
struct DiscSceneOptions {
  /// Side of a cell in radii of the shape's bounding sphere, finite and > 0. Smaller: less to build again
  /// after a stroke, but more groups, each of which costs a ray that enters it. 0.1 to 0.2 is flat for
  /// updates, 0.1 to 0.4 for rays (README.md).
  double cell = 0.2;
};

/// All surfels of a prefix as oriented discs, in groups that are each a scene of its own under one small
/// tree. A group is a cell of space: it has the surfels of the primitives whose centre lies in it. Primitives
/// with a radius of more than half a cell, such as most bases, are cut: each patch of 16 neighbouring samples
/// goes to the cell of its first one.
///
/// `update` compares every primitive with a copy of how it was at the last update, and builds anew those
/// groups in which a primitive came, went or shows other samples. So it may be given any model in any state;
/// what is alike is kept. Whatever the updates were, the discs are those of a scene built from nothing, if in
/// cells of another size, and a ray meets the same nearest disc. (Of two that it meets at the same float32
/// distance, which one is not promised.) How Embree rounds depends on the instruction set that it chooses.
class DiscScene {
 public:
  /// Empty. Throws InputError when Embree cannot be started or has no memory.
  explicit DiscScene(DiscSceneOptions options = {});
  ~DiscScene();
  DiscScene(const DiscScene&) = delete;
  DiscScene& operator=(const DiscScene&) = delete;

  /// Makes the scene that of the first primitives of the model. O(samples / 8) bytes are compared; then
  /// O(n log n) for the n surfels of the groups that changed, and O(groups). A prefix that is less than the
  /// list also costs what SurfelModel::visibleSamples does. Everything is built anew when the shape has
  /// become less than half or more than twice as large as when it last was. Throws InputError when Embree has
  /// no memory; the scene is then empty.
  void update(const points::SurfelModel& model, implicit::Prefix prefix = {},
              const Execution& execution = {});

  struct Hit {
    float t = 0;       ///< ray parameter
    float radius = 0;  ///< of the disc, model units
  };
  /// The nearest disc that faces the ray's origin, at a ray parameter of `from` to ray.tMax. May be called
  /// from several threads at once.
  [[nodiscard]] std::optional<Hit> nearest(const Ray& ray, float from) const;

  [[nodiscard]] std::size_t discCount() const;
  [[nodiscard]] std::size_t groupCount() const;
  /// How many groups the last update built.
  [[nodiscard]] std::size_t rebuiltGroups() const;

 private:
  class Groups;
  std::unique_ptr<Groups> groups_;
};

}  // namespace restroke::retarget
