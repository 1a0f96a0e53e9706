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

std::optional<SurfaceHit> TrailRecorder::cast(const StrokePlace& place) {
  const std::optional<SurfaceHit> hit = caster_.cast(place);
  trail_.points.push_back({place, hit});
  return hit;
}

Trail TrailRecorder::take() {
  const auto along = [](const TrailPoint& p) { return p.place.along; };
  std::stable_sort(trail_.points.begin(), trail_.points.end(),
                   [&](const TrailPoint& a, const TrailPoint& b) { return along(a) < along(b); });
  trail_.points.erase(
      std::unique(trail_.points.begin(), trail_.points.end(),
                  [&](const TrailPoint& a, const TrailPoint& b) { return along(a) == along(b); }),
      trail_.points.end());
  return std::exchange(trail_, {});
}

std::optional<SurfaceHit> TrailCaster::cast(const StrokePlace& place) {
  const std::optional<TrailPoint> point = original_.at(place.along);
  if (!point || !point->hit) return std::nullopt;
  return carry(*point);
}

}  // namespace restroke::retarget
