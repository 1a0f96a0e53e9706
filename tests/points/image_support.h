#pragma once
// Surfels and cameras for the tests of images and files, and the pictures' oracle: every disc against every
// ray.

#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "implicit/geometry/camera.h"
#include "points/surfel.h"
#include "tests/support/brute_force.h"

namespace restroke::points::testing {

struct Ball {
  Point center{0};
  float radius = 1;
};

/// Discs all over a sphere, spaced by the golden angle, overlapping as the model's do.
inline std::vector<Surfel> ballSurfels(const Ball& ball, int count, std::uint32_t primitive = 0,
                                       implicit::Sign sign = implicit::Sign::Positive) {
  std::vector<Surfel> surfels;
  const float radius = 0.95f * ball.radius * std::sqrt(4 * 3.14159265f / static_cast<float>(count));
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * i + 1) / count, s = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
    const Vec3 d(DVec3(s * std::cos(a), s * std::sin(a), z));
    surfels.push_back(
        {ball.center + ball.radius * d, sign == implicit::Sign::Positive ? d : -d, radius, primitive, sign});
  }
  return surfels;
}

/// Looks along -z at the origin.
inline Camera cameraAt(float distance, std::uint32_t width, std::uint32_t height) {
  Camera camera;
  camera.position = {0, 0, distance};
  camera.width = width;
  camera.height = height;
  return camera;
}

inline Ray rayOfPixel(const Camera& camera, std::size_t pixel) {
  const auto x = static_cast<std::int32_t>(pixel % camera.width),
             y = static_cast<std::int32_t>(pixel / camera.width);
  return rayThrough(camera, {x * kSubPixels + kSubPixels / 2, y * kSubPixels + kSubPixels / 2});
}

struct DiscHit {
  double depth = std::numeric_limits<double>::infinity();
  double cosine = 1;       // between normal and line of sight
  double rimDistance = 1;  // nearest disc or near miss: | distance from the centre / radius - 1 |
  std::size_t surfel = 0;
};

/// The definition, in double: the nearest front-facing disc whose plane the ray meets within its radius.
/// rimDistance is the least of all discs that the ray passes at a depth no greater than the hit's.
inline DiscHit nearestDisc(const std::vector<Surfel>& surfels, const Ray& ray) {
  DiscHit best;
  std::vector<std::pair<double, double>> rims;  // depth, distance
  for (std::size_t i = 0; i < surfels.size(); ++i) {
    const DVec3 n(surfels[i].normal), c(surfels[i].position);
    const double down = dot(n, ray.direction);
    if (!(down < 0)) continue;
    const double t = dot(n, c - ray.origin) / down;
    if (!(t >= ray.tMin && t <= ray.tMax)) continue;
    const double part = length(ray.at(t) - c) / static_cast<double>(surfels[i].radius);
    rims.emplace_back(t, std::fabs(part - 1));
    if (part <= 1 && t < best.depth) {
      best.depth = t;
      best.cosine = -down / length(ray.direction);
      best.surfel = i;
    }
  }
  for (const auto& [t, distance] : rims)
    if (t <= best.depth * (1 + 1e-6)) best.rimDistance = std::fmin(best.rimDistance, distance);
  return best;
}

/// Discs of all sizes in all directions, some of them around, behind and through the camera.
inline std::vector<Surfel> randomSurfels(restroke::testing::Random& random, std::size_t count, float extent) {
  std::vector<Surfel> surfels;
  while (surfels.size() < count) {
    const Vec3 n = random.inCube(1);
    const float size = length(n);
    if (size < 0.1f) continue;
    const float radius = random.below(8) == 0 ? random.between(0.3f, 1.5f) : random.between(0.01f, 0.3f);
    surfels.push_back({random.inCube(extent), n / size, radius, static_cast<std::uint32_t>(surfels.size()),
                       random.below(2) == 0 ? implicit::Sign::Positive : implicit::Sign::Negative});
  }
  return surfels;
}

}  // namespace restroke::points::testing
