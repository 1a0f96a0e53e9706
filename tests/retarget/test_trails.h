#pragma once
// Trails and changes for the tests of methods that follow a change.

#include <map>
#include <utility>

#include "retarget/trail.h"

namespace restroke::retarget {

/// What `exact` finds on the model along a line on the screen, at the places 0 to count - 1.
[[nodiscard]] Trail trailAlong(const points::SurfelModel& model, const Camera& camera, int count);

/// Owners named by hand: of node 0, by index.
class NamedOwners final : public Owners {
 public:
  explicit NamedOwners(std::map<std::uint32_t, implicit::Primitive> primitives)
      : primitives_(std::move(primitives)) {}
  [[nodiscard]] std::optional<implicit::Primitive> find(OwnerKey owner) const override {
    const auto entry = primitives_.find(owner.index);
    return owner.node == 0 && entry != primitives_.end() ? std::optional(entry->second) : std::nullopt;
  }

 private:
  std::map<std::uint32_t, implicit::Primitive> primitives_;
};

}  // namespace restroke::retarget
