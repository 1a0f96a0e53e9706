#include "sculpt/stroke_reads.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace restroke::sculpt {

namespace {

/// Ends are kept in float32, and rays meet balls in double: both are off by less than this part of their
/// coordinates.
constexpr double kRounding = 0x1p-20;

double largest(DVec3 p) {
  return std::max({std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
}

/// Whether a ray that begins at `apex` comes near the ball before it ends.
bool meets(DVec3 apex, DVec3 end, DVec3 center, double radius) {
  const DVec3 along = end - apex, to = center - apex;
  const double square = dot(along, along);
  const double t = square > 0 ? std::clamp(dot(to, along) / square, 0.0, 1.0) : 0;
  const DVec3 away = to - t * along;
  return dot(away, away) <= radius * radius;
}

}  // namespace

void ChangedPlaces::add(const implicit::Sphere& ball) {
  const DVec3 to = DVec3(ball.center) - DVec3(around_.center);
  const double distance = length(to), own = static_cast<double>(around_.radius),
               other = static_cast<double>(ball.radius);
  if (balls_.empty() || distance + own <= other) {
    around_ = ball;
  } else if (distance + other > own) {
    // The ball about both, rounded up.
    const double radius = (distance + own + other) / 2;
    around_.center = Point(DVec3(around_.center) + to * ((radius - own) / distance));
    around_.radius =
        static_cast<float>((radius + largest(DVec3(around_.center)) * kRounding) * (1 + kRounding));
  }
  balls_.push_back(ball);
}

bool ChangedPlaces::mayMeet(const Box& box) const {
  if (balls_.empty()) return false;
  // Distance from the box to the centre, axis by axis. Infinite bounds give 0.
  double square = 0;
  for (int i = 0; i < 3; ++i) {
    const auto c = static_cast<double>(around_.center[i]);
    const double out =
        std::max({0.0, static_cast<double>(box.min[i]) - c, c - static_cast<double>(box.max[i])});
    square += out * out;
  }
  const double radius =
      static_cast<double>(around_.radius) * (1 + kRounding) + largest(DVec3(around_.center)) * kRounding;
  return square <= radius * radius;
}

StrokeReads StrokeReads::ofEverything() {
  StrokeReads reads;
  reads.everything_ = true;
  constexpr float kEverywhere = std::numeric_limits<float>::infinity();
  reads.bounds_ = {Point(-kEverywhere), Point(kEverywhere)};
  return reads;
}

void StrokeReads::finish() {
  for (const ReadCast& cast : casts_) bounds_.add({cast.end, cast.end});
  if (!casts_.empty()) {
    bounds_.add({Point(apex_), Point(apex_)});
    const DVec3 corner(std::max(largest(DVec3(bounds_.min)), largest(DVec3(bounds_.max))));
    const Point slack(corner * kRounding);
    bounds_.min -= slack;
    bounds_.max += slack;
  }
  std::sort(casts_.begin(), casts_.end(),
            [](const ReadCast& a, const ReadCast& b) { return a.place.along < b.place.along; });
  casts_.shrink_to_fit();
  DVec3 sum(0);
  for (const ReadCast& cast : casts_) {
    const DVec3 to = DVec3(cast.end) - apex_;
    const double far = length(to);
    if (far > 0) sum += to / far;
    reach_ = std::max(reach_, far);
  }
  // Rays that go all ways have no cone that is worth asking.
  cosine_ = -1;
  sine_ = 0;
  if (!(dot(sum, sum) > 0)) return;
  axis_ = normalized(sum);
  double cosine = 1;
  for (const ReadCast& cast : casts_) {
    const DVec3 to = DVec3(cast.end) - apex_;
    const double far = length(to);
    if (far > 0) cosine = std::min(cosine, dot(to, axis_) / far);
  }
  cosine -= 1e-6;
  if (cosine <= 0) return;
  cosine_ = cosine;
  sine_ = std::sqrt(std::max(0.0, 1 - cosine * cosine));
}

bool StrokeReads::touchedBy(std::span<const ChangedPlaces> changes) {
  bool touched = false;
  const double slack = (largest(apex_) + reach_) * kRounding;
  const auto isNear = [&](const implicit::Sphere& ball) {
    const DVec3 to = DVec3(ball.center) - apex_;
    const double radius =
        static_cast<double>(ball.radius) * (1 + kRounding) + slack + largest(DVec3(ball.center)) * kRounding;
    const double square = dot(to, to), far = reach_ + radius;
    if (square > far * far) return false;
    if (cosine_ < 0 || square <= radius * radius) return true;
    const double along = dot(to, axis_), aside = std::sqrt(std::max(0.0, square - along * along));
    // Distance from the cone's side; behind the apex it is more than this.
    return aside * cosine_ - along * sine_ <= radius;
  };
  for (const ChangedPlaces& change : changes) {
    if (change.empty() || !isNear(change.around())) continue;
    for (const implicit::Sphere& ball : change.balls()) {
      if (!isNear(ball)) continue;
      const DVec3 center(ball.center);
      const double radius =
          static_cast<double>(ball.radius) * (1 + kRounding) + slack + largest(center) * kRounding;
      for (ReadCast& cast : casts_) {
        if (!cast.holds || !meets(apex_, DVec3(cast.end), center, radius)) continue;
        cast.holds = false;
        touched = true;
      }
    }
  }
  return touched;
}

std::optional<retarget::SurfaceHit> ReadingCaster::cast(const retarget::StrokePlace& place) {
  if (former_) {
    const auto& casts = former_->casts_;
    const auto found =
        std::lower_bound(casts.begin(), casts.end(), place.along,
                         [](const ReadCast& c, double along) { return c.place.along < along; });
    if (found != casts.end() && found->holds && found->place == place) {
      reads_.apex_ = former_->apex_;
      reads_.casts_.push_back(*found);
      if (!found->hit) return std::nullopt;
      return retarget::SurfaceHit{.position = found->end, .normal = found->normal, .scale = found->scale};
    }
  }
  ++castAnew_;
  const std::optional<retarget::SurfaceHit> hit = caster_.cast(place);
  const std::optional<Ray> ray = caster_.readsAlong(place);
  if (!ray) {
    reads_.everything_ = true;
  } else if (ray->tMax > ray->tMin) {
    ReadCast read{.place = place, .hit = hit.has_value()};
    reads_.apex_ = ray->origin;
    if (hit) {
      read.end = hit->position;
      read.normal = hit->normal;
      read.scale = hit->scale;
    } else {
      read.end = Point(ray->at(ray->tMax));
    }
    reads_.casts_.push_back(read);
  }
  return hit;
}

StrokeReads ReadingCaster::take() {
  if (reads_.everything_) return std::exchange(reads_, {}), StrokeReads::ofEverything();
  reads_.finish();
  return std::exchange(reads_, {});
}

}  // namespace restroke::sculpt
