#include "retarget/surface_distance.h"

#include <cmath>

#include "implicit/ray_cast.h"

namespace restroke::retarget {
namespace {

// Descent steps. Of the parts of the way to the foot on the tangent plane that are tried, one fits the
// surface's curvature and takes at least two thirds off the foot's error; the distance's error is its square.
constexpr int kMostSteps = 16;
constexpr double kParts[] = {1, 0.5, 0.25, 0.125, 2, 4};
// Gains below this part of the distance end the descent.
constexpr double kLeastGain = 0x1p-40;
// No more crossings than this are looked at on one line. They lie within the distance known.
constexpr int kMostCrossings = 64;

}  // namespace

/// The nearest point of the surface so far.
struct SurfaceDistance::Foot {
  double distance = 0;
  double reach = 0;  // how far to look: the first distance, and a little more
  DVec3 position{0}, normal{0, 0, 1};
};

SurfaceDistance::SurfaceDistance(const points::SurfelModel& model, implicit::Prefix prefix,
                                 const Execution& execution)
    : list_(model.list()), prefix_(prefix), surfels_(model.surfels(prefix, execution)) {}

void SurfaceDistance::improve(Foot& foot, DVec3 p, DVec3 direction) const {
  if (!(dot(direction, direction) > 0)) return;
  // Rays find where they enter. The ray back finds where the ray forth leaves.
  for (const double sense : {1.0, -1.0}) {
    const DVec3 along = sense * normalized(direction);
    Ray ray{.origin = p, .direction = along, .tMin = -foot.reach, .tMax = foot.reach};
    for (int i = 0; i < kMostCrossings; ++i) {
      const auto hit = implicit::castRay(list_, ray, prefix_);
      if (!hit) break;
      if (std::fabs(hit->t) < foot.distance) {
        foot.distance = std::fabs(hit->t);
        foot.position = hit->position;
        foot.normal = hit->normal;
      }
      if (hit->t >= 0) break;  // those after it are farther
      ray.tMin = hit->t;
    }
  }
}

std::optional<double> SurfaceDistance::from(const SurfaceHit& place) const {
  const auto index = surfels_.nearest(place.position);
  if (!index) return std::nullopt;
  const points::Surfel& surfel = surfels_.surfels()[*index];
  const DVec3 p(place.position), towards = DVec3(surfel.position) - p;
  Foot foot{.distance = length(towards), .position = DVec3(surfel.position), .normal = DVec3(surfel.normal)};
  foot.reach = foot.distance + 2 * static_cast<double>(surfel.radius);
  for (const DVec3 direction : {DVec3(place.normal), DVec3(surfel.normal), towards})
    improve(foot, p, direction);
  for (int step = 0; step < kMostSteps; ++step) {
    const double before = foot.distance;
    const DVec3 away = p - foot.position, sideways = away - dot(away, foot.normal) * foot.normal;
    for (const double part : kParts) improve(foot, p, part * sideways - away);
    if (foot.distance >= before * (1 - kLeastGain)) break;
  }
  return foot.distance;
}

}  // namespace restroke::retarget
