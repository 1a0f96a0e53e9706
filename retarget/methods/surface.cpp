// R. Schmidt and K. Singh, "Sketch-based procedural surface modeling and compositing using surface trees",
// SMI 2008: a stroke is kept in coordinates of the surface that it was drawn on, and evaluated there again.
// They parametrise the whole surface around a stroke; we keep each place on the primitive that owns it.

#include <map>
#include <utility>

#include "retarget/anchors.h"
#include "retarget/methods/exact.h"
#include "retarget/methods/followers.h"
#include "retarget/methods/nearest_surfels.h"

namespace restroke::retarget {
namespace {

class SurfaceCaster final : public TrailCaster {
 public:
  explicit SurfaceCaster(const CasterInput& input)
      : TrailCaster(*input.change.original), input_(input), owners_(input.change.owners) {}

 protected:
  std::optional<SurfaceHit> carry(const TrailPoint& point) const override {
    if (point.anchor && owners_)
      if (const SurfaceCoordinates* coordinates = coordinatesOf(*point.anchor))
        if (const auto hit = coordinates->carry(*point.hit)) return hit;
    // Drawn up at the first place that needs it: most strokes never do.
    if (!surfels_) surfels_.emplace(input_.model.surfels(input_.prefix, input_.execution));
    return nearestHit(*surfels_, input_.model.list(), point.hit->position);
  }

 private:
  // Made once an owner. All anchors of a trail were made on one list, so the owner tells its former shape.
  [[nodiscard]] const SurfaceCoordinates* coordinatesOf(const Anchor& anchor) const {
    const auto [entry, isNew] = known_.try_emplace({anchor.owner.node, anchor.owner.index});
    if (isNew)
      if (const auto owner = owners_->find(anchor.owner))
        entry->second = SurfaceCoordinates::between(anchor.shape, owner->shape);
    return entry->second.get();
  }

  CasterInput input_;
  const Owners* owners_;
  mutable std::map<std::pair<std::uint32_t, std::uint32_t>, std::unique_ptr<const SurfaceCoordinates>> known_;
  mutable std::optional<NearestSurfels> surfels_;
};

}  // namespace

std::unique_ptr<Caster> makeSurfaceCaster(const CasterInput& input) {
  if (!input.change.original) return makeExactCaster(input);
  return std::make_unique<SurfaceCaster>(input);
}

}  // namespace restroke::retarget
