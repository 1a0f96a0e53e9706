#include "retarget/methods/exact.h"

namespace restroke::retarget {
namespace {

class ExactCaster final : public Caster {
 public:
  explicit ExactCaster(const CasterInput& input)
      : list_(input.model.list()), camera_(input.camera), prefix_(input.prefix), scale_(input.change.scale) {}

  std::optional<SurfaceHit> cast(const StrokePlace& place) override {
    const ScreenPoint p = place.screen;
    const auto hit = implicit::castRay(list_, rayThrough(camera_, p), prefix_);
    if (!hit) return std::nullopt;
    SurfaceHit found = rounded(*hit);
    found.scale = scale_;
    return found;
  }

  std::optional<Ray> readsAlong(const StrokePlace& place) const override {
    return rayThrough(camera_, place.screen);
  }

 private:
  const implicit::PrimitiveList& list_;
  Camera camera_;
  implicit::Prefix prefix_;
  float scale_;
};

}  // namespace

std::unique_ptr<Caster> makeExactCaster(const CasterInput& input) {
  return std::make_unique<ExactCaster>(input);
}

SurfaceHit rounded(const implicit::RayHit& hit) {
  return {Point(hit.position), Vec3(hit.normal), hit.primitive};
}

}  // namespace restroke::retarget
