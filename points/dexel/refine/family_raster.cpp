#include "points/dexel/refine/family_raster.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace restroke::points {

FamilyRaster::FamilyRaster(const LineFamily& family)
    : width_(family.width),
      height_(family.height),
      rays_(family.directionStep != DVec3(0) || family.directionRowStep != DVec3(0)),
      origin_(family.origin) {
  // The dual basis: of what the columns, the rows and the lines themselves run along.
  const DVec3 u = rays_ ? family.directionStep : family.originStep,
              v = rays_ ? family.directionRowStep : family.originRowStep, w = family.direction;
  // With one line in a row or column it does not matter where the next one would be.
  const DVec3 a = cross(v, w), b = cross(w, u), c = cross(u, v);
  const double determinant = dot(u, a);
  if (determinant == 0) return;
  column_ = a / determinant;
  row_ = b / determinant;
  depth_ = c / determinant;
}

LineRectangle FamilyRaster::rectangle(Range columns, Range rows) const {
  // Rounding of what was computed in double, and of the lines themselves.
  constexpr double kRoom = 1e-3;
  const auto cut = [&](double x, int most) {
    return static_cast<int>(std::clamp(x, 0.0, static_cast<double>(most)));
  };
  return {cut(std::ceil(columns.low - kRoom), width_), cut(std::floor(columns.high + kRoom) + 1, width_),
          cut(std::ceil(rows.low - kRoom), height_), cut(std::floor(rows.high + kRoom) + 1, height_)};
}

// Of a ball that is in front of the rays' origin: the columns k for which the plane of points with
// dot(numerator - k depth_, x) = 0 meets it.
FamilyRaster::Range FamilyRaster::seen(DVec3 numerator, DVec3 x, double radius) const {
  const double n = dot(numerator, x), d = dot(depth_, x), square = radius * radius;
  const double a = d * d - square * dot(depth_, depth_), b = n * d - square * dot(numerator, depth_),
               c = n * n - square * dot(numerator, numerator);
  const double root = std::sqrt(std::max(0.0, b * b - a * c));
  return {(b - root) / a, (b + root) / a};
}

LineRectangle FamilyRaster::of(const implicit::Sphere& ball) const {
  if (column_ == DVec3(0)) return whole();
  const DVec3 x = DVec3(ball.center) - origin_;
  // By more than rounding moves the tests of a line and a ball.
  const double size = std::max({std::fabs(x.x), std::fabs(x.y), std::fabs(x.z)});
  const double radius = static_cast<double>(ball.radius) * (1 + 0x1p-20) + size * 0x1p-40;
  if (!rays_) {
    const double c = dot(column_, x), r = dot(row_, x), dc = radius * length(column_),
                 dr = radius * length(row_);
    return rectangle({c - dc, c + dc}, {r - dr, r + dr});
  }
  const double depth = dot(depth_, x), reach = radius * length(depth_);
  if (depth + reach <= 0) return {};
  if (depth - reach <= reach * 0x1p-20) return whole();
  return rectangle(seen(column_, x, radius), seen(row_, x, radius));
}

LineRectangle FamilyRaster::of(const Box& box) const {
  if (box.empty()) return {};
  if (column_ == DVec3(0)) return whole();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Range columns{kInfinity, -kInfinity}, rows = columns;
  int near = 0, behind = 0;  // of rays: corners that have no place, and those of them behind the origin
  for (int i = 0; i < 8; ++i) {
    const DVec3 corner((i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                       (i & 4) != 0 ? box.max.z : box.min.z);
    const DVec3 x = corner - origin_;
    double c = dot(column_, x), r = dot(row_, x);
    if (rays_) {
      const double depth = dot(depth_, x);
      if (!(depth > 1e-9 * (std::fabs(c) + std::fabs(r)))) {
        ++near;
        if (depth <= 0) ++behind;
        continue;
      }
      c /= depth;
      r /= depth;
    }
    columns = {std::min(columns.low, c), std::max(columns.high, c)};
    rows = {std::min(rows.low, r), std::max(rows.high, r)};
  }
  if (behind == 8) return {};
  if (near > 0) return whole();
  return rectangle(columns, rows);
}

}  // namespace restroke::points
