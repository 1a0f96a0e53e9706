#include "implicit/ray_cast.h"
#include "retarget/methods/exact.h"
#include "retarget/methods/followers.h"

namespace restroke::retarget {
namespace {

/// Affine maps keep lines: the camera's rays are mapped and cast.
class MappedRayCaster final : public Caster {
 public:
  MappedRayCaster(const CasterInput& input, const Affine& map)
      : list_(input.model.list()),
        camera_(input.camera),
        prefix_(input.prefix),
        map_(map),
        scale_(static_cast<float>(input.change.map->scaleAt(DVec3(0)))) {}

  std::optional<SurfaceHit> cast(const StrokePlace& place) override {
    const auto hit = implicit::castRay(list_, *readsAlong(place), prefix_);
    if (!hit) return std::nullopt;
    SurfaceHit found = rounded(*hit);
    found.scale = scale_;
    return found;
  }

  std::optional<Ray> readsAlong(const StrokePlace& place) const override {
    return map_.ray(rayThrough(camera_, place.screen));
  }

 private:
  const implicit::PrimitiveList& list_;
  Camera camera_;
  implicit::Prefix prefix_;
  Affine map_;
  float scale_;
};

class MappedTrailCaster final : public TrailCaster {
 public:
  MappedTrailCaster(const Trail& original, const SpaceMap& map) : TrailCaster(original), map_(map) {}
  std::optional<Ray> readsAlong(const StrokePlace&) const override { return Ray{.tMin = 0, .tMax = 0}; }

 protected:
  std::optional<SurfaceHit> carry(const TrailPoint& point) const override {
    const DVec3 p(point.hit->position);
    SurfaceHit found;
    found.position = Point(map_.point(p));
    found.normal = Vec3(normalized(map_.normal(p, DVec3(point.hit->normal))));
    found.scale = static_cast<float>(map_.scaleAt(p));
    return found;
  }

 private:
  const SpaceMap& map_;
};

}  // namespace

std::unique_ptr<Caster> makeMappedCaster(const CasterInput& input) {
  const SpaceMap* map = input.change.map;
  if (!input.change.original || !map) return makeExactCaster(input);
  if (const Affine* affine = map->affine()) return std::make_unique<MappedRayCaster>(input, *affine);
  return std::make_unique<MappedTrailCaster>(*input.change.original, *map);
}

}  // namespace restroke::retarget
