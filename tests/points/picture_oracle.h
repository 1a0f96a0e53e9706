#pragma once
// The CPU pictures' formulas, one disc and one pixel at a time: what points/images/simd computes for many at
// once, and must equal bit for bit.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "implicit/geometry/camera.h"
#include "points/images/scene.h"
#include "points/images/screen_disc.h"
#include "points/images/shading.h"

namespace restroke::points::testing {

struct Interval {
  double min, max;
};

/// Where the disc's silhouette lies along one screen axis, as tangent (coordinate / depth).
inline Interval tangents(double c, double n, double cz, double nz, double r2) {
  const double a = cz * cz - r2 * (1.0 - nz * nz);
  const double b = c * cz + r2 * n * nz;
  const double e = c * c - r2 * (1.0 - n * n);
  const double root = std::sqrt(std::max(b * b - a * e, 0.0));
  return {(b - root) / a, (b + root) / a};
}

/// The disc on the screen, or nothing where it is not seen.
inline std::optional<ScreenDisc> projected(const ScreenSetup& setup, const Surfel& surfel) {
  const CameraFrame& frame = setup.frame();
  const double width = setup.projection().width, height = setup.projection().height;
  const double firstX = -frame.halfWidth, stepX = 2.0 * frame.halfWidth / width;
  const double firstY = frame.halfHeight, stepY = -2.0 * frame.halfHeight / height;
  const DVec3 d = DVec3(surfel.position) - frame.position;
  const DVec3 normal(surfel.normal);
  const DVec3 c(dot(d, frame.right), dot(d, frame.up), dot(d, frame.forward));
  const DVec3 n(dot(normal, frame.right), dot(normal, frame.up), dot(normal, frame.forward));
  const auto r = static_cast<double>(surfel.radius);
  const double h = dot(n, c);  // distance of the plane; negative when the disc faces the camera
  if (!(h < 0.0) || !(h * h > kEdgeOnCosine * kEdgeOnCosine * dot(c, c)) || !(r > 0.0)) return {};
  const double reach = r * std::sqrt(std::max(1.0 - n.z * n.z, 0.0));
  if (!(c.z + reach >= setup.projection().near) || !(c.z - reach <= setup.projection().far)) return {};

  double minX = 0, maxX = width, minY = 0, maxY = height;
  if (c.z - reach > 1e-6 * std::fabs(c.z)) {
    const Interval x = tangents(c.x, n.x, c.z, n.z, r * r), y = tangents(c.y, n.y, c.z, n.z, r * r);
    minX = std::max(minX, (x.min - firstX) / stepX - 1e-3);
    maxX = std::min(maxX, (x.max - firstX) / stepX + 1e-3);
    minY = std::max(minY, (y.max - firstY) / stepY - 1e-3);
    maxY = std::min(maxY, (y.min - firstY) / stepY + 1e-3);
    if (!(minX < maxX && minY < maxY)) return {};
  }

  double refX = 0.5 * width, refY = 0.5 * height;
  if (c.z > 0.0) {
    const double x = (c.x / c.z - firstX) / stepX, y = (c.y / c.z - firstY) / stepY;
    if (x > -width && x < 2.0 * width && y > -height && y < 2.0 * height) refX = x, refY = y;
  }
  const double floorX = std::floor(refX), floorY = std::floor(refY);
  const double dx = firstX + stepX * refX, dy = firstY + stepY * refY;
  const double w0 = (n.x * dx + n.y * dy + n.z) / h, wX = n.x * stepX / h, wY = n.y * stepY / h;
  DVec3 axis(1, 0, 0);
  const double ax = std::fabs(n.x), ay = std::fabs(n.y), az = std::fabs(n.z);
  if (ay <= ax && ay <= az) axis = DVec3(0, 1, 0);
  if (az <= ax && az < ay) axis = DVec3(0, 0, 1);
  const DVec3 u = normalized(cross(n, axis)) / r;
  const DVec3 v = cross(n, u);
  const double uc = dot(u, c), vc = dot(v, c);

  ScreenDisc disc = {};
  disc.pixelX = static_cast<std::int32_t>(floorX);
  disc.pixelY = static_cast<std::int32_t>(floorY);
  disc.fractionX = static_cast<float>(refX - floorX);
  disc.fractionY = static_cast<float>(refY - floorY);
  disc.w0 = static_cast<float>(w0);
  disc.wX = static_cast<float>(wX);
  disc.wY = static_cast<float>(wY);
  disc.u0 = static_cast<float>(u.x * dx + u.y * dy + u.z - w0 * uc);
  disc.uX = static_cast<float>(u.x * stepX - wX * uc);
  disc.uY = static_cast<float>(u.y * stepY - wY * uc);
  disc.v0 = static_cast<float>(v.x * dx + v.y * dy + v.z - w0 * vc);
  disc.vX = static_cast<float>(v.x * stepX - wX * vc);
  disc.vY = static_cast<float>(v.y * stepY - wY * vc);
  disc.firstX = static_cast<int>(static_cast<float>(minX) + 0.5f);
  disc.lastX = static_cast<int>(static_cast<float>(maxX) + 0.5f) - 1;
  disc.firstY = static_cast<int>(static_cast<float>(minY) + 0.5f);
  disc.lastY = static_cast<int>(static_cast<float>(maxY) + 0.5f) - 1;
  disc.window = static_cast<float>(2.0 * r * w0 * w0);
  disc.normalX = static_cast<float>(n.x);
  disc.normalY = static_cast<float>(n.y);
  disc.normalZ = static_cast<float>(-n.z);
  return disc;
}

/// What a disc says at a pixel's centre; w is no number outside of its box.
struct DiscSample {
  float w = std::numeric_limits<float>::quiet_NaN(), s = 0;  // s = U^2 + V^2
};
inline DiscSample sampleAt(const ScreenDisc& disc, int x, int y) {
  if (x < disc.firstX || x > disc.lastX || y < disc.firstY || y > disc.lastY) return {};
  const float dx = static_cast<float>(x - disc.pixelX) + (0.5f - disc.fractionX);
  const float dy = static_cast<float>(y - disc.pixelY) + (0.5f - disc.fractionY);
  const float w = (disc.w0 + disc.wY * dy) + disc.wX * dx;
  const float u = (disc.u0 + disc.uY * dy) + disc.uX * dx;
  const float v = (disc.v0 + disc.vY * dy) + disc.vX * dx;
  return {w, u * u + v * v};
}

/// A single-sample picture without occlusion: depth and colour.
struct OraclePicture {
  std::vector<float> depth, rgba;
};
inline OraclePicture oraclePicture(const Scene& scene, const Camera& camera, const Palette& palette = {}) {
  const ScreenSetup setup(camera);
  std::vector<ScreenDisc> discs;
  for (const Surfel& surfel : scene.surfels)
    if (std::optional<ScreenDisc> disc = projected(setup, surfel)) {
      disc->kind = kindOf(scene, surfel.primitive, surfel.sign);
      discs.push_back(*disc);
    }
  OraclePicture picture;
  for (int y = 0; y < static_cast<int>(camera.height); ++y)
    for (int x = 0; x < static_cast<int>(camera.width); ++x) {
      float best = setup.farW();
      for (const ScreenDisc& disc : discs) {
        const DiscSample at = sampleAt(disc, x, y);
        if (at.s <= at.w * at.w && at.w > best && at.w <= setup.nearW()) best = at.w;
      }
      const bool covered = best > setup.farW();
      picture.depth.push_back(covered ? 1.0f / best : std::numeric_limits<float>::infinity());
      Vec3 normal(0);
      float weights = 0, added = 0, carved = 0;
      for (const ScreenDisc& disc : discs) {
        const DiscSample at = sampleAt(disc, x, y);
        if (!(at.s <= at.w * at.w && at.w <= best && at.w + disc.window >= best)) continue;
        const float inside = 1.0f - at.s / (at.w * at.w), weight = inside * inside + 1e-4f;
        normal += Vec3(weight * disc.normalX, weight * disc.normalY, weight * disc.normalZ);
        weights += weight;
        if (disc.kind == SurfaceKind::Added) added += weight;
        if (disc.kind == SurfaceKind::Carved) carved += weight;
      }
      Vec3 color(0);
      if (covered) {
        const float size = length(normal), scale = 1.0f / weights;
        const Vec3 d(setup.directionX(static_cast<float>(x) + 0.5f),
                     setup.directionY(static_cast<float>(y) + 0.5f), -1.0f);
        color = shade({}, size > 0 ? normal / size : Vec3(0, 0, 1), d * (-1.0f / length(d)),
                      albedoOf(palette, added * scale, carved * scale));
      }
      picture.rgba.insert(picture.rgba.end(), {color.x, color.y, color.z, covered ? 1.0f : 0.0f});
    }
  return picture;
}

}  // namespace restroke::points::testing
