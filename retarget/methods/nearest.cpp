#include "retarget/methods/exact.h"
#include "retarget/methods/followers.h"
#include "retarget/methods/nearest_surfels.h"

namespace restroke::retarget {
namespace {

class NearestCaster final : public TrailCaster {
 public:
  explicit NearestCaster(const CasterInput& input)
      : TrailCaster(*input.change.original),
        list_(input.model.list()),
        surfels_(input.model.surfels(input.prefix, input.execution)) {}

 protected:
  std::optional<SurfaceHit> carry(const TrailPoint& point) const override {
    return nearestHit(surfels_, list_, point.hit->position);
  }

 private:
  const implicit::PrimitiveList& list_;
  NearestSurfels surfels_;
};

}  // namespace

std::unique_ptr<Caster> makeNearestCaster(const CasterInput& input) {
  if (!input.change.original) return makeExactCaster(input);
  return std::make_unique<NearestCaster>(input);
}

}  // namespace restroke::retarget
