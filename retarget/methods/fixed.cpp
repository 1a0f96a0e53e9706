#include "retarget/methods/exact.h"
#include "retarget/methods/followers.h"

namespace restroke::retarget {
namespace {

class FixedCaster final : public TrailCaster {
 public:
  using TrailCaster::TrailCaster;
  // An empty ray: nothing of the shape is read.
  std::optional<Ray> readsAlong(const StrokePlace&) const override { return Ray{.tMin = 0, .tMax = 0}; }

 protected:
  std::optional<SurfaceHit> carry(const TrailPoint& point) const override {
    // The id is one of the list as it was.
    return SurfaceHit{point.hit->position, point.hit->normal};
  }
};

}  // namespace

std::unique_ptr<Caster> makeFixedCaster(const CasterInput& input) {
  if (!input.change.original) return makeExactCaster(input);
  return std::make_unique<FixedCaster>(*input.change.original);
}

}  // namespace restroke::retarget
