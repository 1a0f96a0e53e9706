#pragma once
// Which lines of a family may meet something. Internal to points/dexel.

#include "implicit/geometry/box.h"
#include "implicit/shapes/sphere.h"
#include "points/dexel/line_family.h"

namespace restroke::points {

/// Columns and rows, each from begin to before end; nothing where either is empty.
struct LineRectangle {
  int firstColumn = 0, endColumn = 0, firstRow = 0, endRow = 0;
  [[nodiscard]] bool empty() const { return firstColumn >= endColumn || firstRow >= endRow; }
};

/// A family of parallel lines, or of rays from one point, as a raster: every line that meets a ball or a box
/// is in its rectangle, and few others. O(1) each.
class FamilyRaster {
 public:
  explicit FamilyRaster(const LineFamily& family);
  [[nodiscard]] LineRectangle whole() const { return {0, width_, 0, height_}; }
  [[nodiscard]] LineRectangle of(const implicit::Sphere& ball) const;
  [[nodiscard]] LineRectangle of(const Box& box) const;

 private:
  struct Range {
    double low, high;
  };
  [[nodiscard]] LineRectangle rectangle(Range columns, Range rows) const;
  [[nodiscard]] Range seen(DVec3 numerator, DVec3 x, double radius) const;

  int width_, height_;
  bool rays_;
  DVec3 origin_;
  // The place of a point p is column dot(column_, p - origin_), row dot(row_, p - origin_); of rays both
  // divided by dot(depth_, p - origin_).
  DVec3 column_{0}, row_{0}, depth_{0};
};

}  // namespace restroke::points
