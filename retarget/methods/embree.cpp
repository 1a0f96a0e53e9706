// Rays against surfels: S. Rusinkiewicz and M. Levoy, QSplat, 2000, and G. Schaufler and H. W. Jensen, Ray
// tracing point sampled geometry, 2000, let discs stand for the surface. We use them only to know that there
// is a surface, and about where; place and normal come from the list.

#include "retarget/methods/embree.h"

#include <cmath>
#include <limits>
#include <utility>

#include "retarget/methods/disc_scene.h"
#include "retarget/methods/exact.h"
#include "retarget/methods/kept_discs.h"

namespace restroke::retarget {
namespace {

class EmbreeCaster final : public Caster {
 public:
  explicit EmbreeCaster(const CasterInput& input)
      : list_(input.model.list()), camera_(input.camera), prefix_(input.prefix), kept_(input.discs) {
    if (kept_) scene_ = kept_->take();
    if (!scene_) scene_ = std::make_unique<DiscScene>();
    scene_->update(input.model, input.prefix, input.execution);
  }
  ~EmbreeCaster() override {
    if (kept_) kept_->giveBack(std::move(scene_));
  }
  EmbreeCaster(const EmbreeCaster&) = delete;
  EmbreeCaster& operator=(const EmbreeCaster&) = delete;

  std::optional<SurfaceHit> cast(const StrokePlace& place) override {
    const Ray ray = rayThrough(camera_, place.screen);
    const double directionLength = length(ray.direction);
    auto from = static_cast<float>(ray.tMin);
    while (const auto disc = scene_->nearest(ray, from)) {
      const double reach = kDiscReach * static_cast<double>(disc->radius) / directionLength;
      Ray bounded = ray;
      bounded.tMax = std::fmin(ray.tMax, static_cast<double>(disc->t) + reach);
      if (const auto hit = implicit::castRay(list_, bounded, prefix_)) return rounded(*hit);
      from = std::nextafter(disc->t, std::numeric_limits<float>::infinity());
    }
    return std::nullopt;
  }

 private:
  const implicit::PrimitiveList& list_;
  Camera camera_;
  implicit::Prefix prefix_;
  KeptDiscs* kept_;
  std::unique_ptr<DiscScene> scene_;
};

}  // namespace

std::unique_ptr<Caster> makeEmbreeCaster(const CasterInput& input) {
  return std::make_unique<EmbreeCaster>(input);
}

}  // namespace restroke::retarget
