#include "retarget/trail.h"

#include <algorithm>
#include <utility>

namespace restroke::retarget {

std::optional<TrailPoint> Trail::at(double along) const {
  const auto after = std::lower_bound(points.begin(), points.end(), along,
                                      [](const TrailPoint& p, double a) { return p.place.along < a; });
  if (after != points.end() && after->place.along == along) return *after;
  if (after == points.begin() || after == points.end()) return std::nullopt;
  const TrailPoint &a = after[-1], &b = *after;
  if (!a.hit || !b.hit) return std::nullopt;
  const double s = (along - a.place.along) / (b.place.along - a.place.along);
  const TrailPoint& nearer = s <= 0.5 ? a : b;
  const auto mean = [s](double x, double y) { return x + s * (y - x); };
  SurfaceHit hit = *nearer.hit;
  const DVec3 p(a.hit->position), q(b.hit->position), m(a.hit->normal), n(b.hit->normal);
  hit.position = Point(p + s * (q - p));
  const DVec3 normal = m + s * (n - m);
  if (dot(normal, normal) > 0) hit.normal = Vec3(normalized(normal));
  const ScreenPoint screen{static_cast<std::int32_t>(mean(a.place.screen.x, b.place.screen.x)),
                           static_cast<std::int32_t>(mean(a.place.screen.y, b.place.screen.y))};
  return TrailPoint{.place = {screen, along}, .hit = hit, .anchor = nearer.anchor};
}

Trail mapped(const Trail& trail, const SpaceMap& map) {
  Trail image = trail;
  for (TrailPoint& point : image.points) {
    if (!point.hit) continue;
    const DVec3 was(point.hit->position);
    point.hit->position = Point(map.point(was));
    point.hit->normal = Vec3(normalized(map.normal(was, DVec3(point.hit->normal))));
  }
  return image;
}

std::optional<SurfaceHit> TrailRecorder::cast(const StrokePlace& place) {
  const std::optional<SurfaceHit> hit = caster_.cast(place);
  points_.try_emplace(place.along, TrailPoint{place, hit});
  return hit;
}

Trail TrailRecorder::take() {
  Trail trail;
  trail.points.reserve(points_.size());
  for (auto& [along, point] : points_) trail.points.push_back(std::move(point));
  points_.clear();
  return trail;
}

std::optional<SurfaceHit> TrailCaster::cast(const StrokePlace& place) {
  const std::optional<TrailPoint> point = original_.at(place.along);
  if (!point || !point->hit) return std::nullopt;
  return carry(*point);
}

}  // namespace restroke::retarget
