#include "retarget/methods/exact.h"

namespace restroke::retarget {
namespace {

class ExactCaster final : public Caster {
 public:
  explicit ExactCaster(const CasterInput& input)
      : list_(input.model.list()), camera_(input.camera), prefix_(input.prefix) {}

  std::optional<SurfaceHit> cast(ScreenPoint p) override {
    const auto hit = implicit::castRay(list_, rayThrough(camera_, p), prefix_);
    if (!hit) return std::nullopt;
    return rounded(*hit);
  }

 private:
  const implicit::PrimitiveList& list_;
  Camera camera_;
  implicit::Prefix prefix_;
};

}  // namespace

std::unique_ptr<Caster> makeExactCaster(const CasterInput& input) {
  return std::make_unique<ExactCaster>(input);
}

SurfaceHit rounded(const implicit::RayHit& hit) {
  return {Point(hit.position), Vec3(hit.normal)};
}

}  // namespace restroke::retarget
