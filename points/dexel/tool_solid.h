#pragma once
// A solid as lines in any direction see it: what an operation fills or clears.

#include <vector>

#include "implicit/geometry/box.h"
#include "implicit/geometry/ray.h"

namespace restroke::points {

/// A stretch of a line inside a solid, with the solid's outward unit normals at its ends.
struct SolidSpan {
  double enter = 0, exit = 0;
  Vec3 enterNormal{0}, exitNormal{0};
};

/// Immutable, and may be asked from several threads. Whatever decides a result is computed in double, from
/// + - * / and sqrt in a fixed order: the same bits everywhere.
class ToolSolid {
 public:
  virtual ~ToolSolid() = default;
  ToolSolid(const ToolSolid&) = delete;
  ToolSolid& operator=(const ToolSolid&) = delete;

  /// Holds the solid; rounded outwards by more than `intersect` may be off. A line that misses it has no
  /// span.
  [[nodiscard]] const Box& bounds() const { return bounds_; }
  /// Appends where the whole line (origin + t direction, the direction of length 1) is inside, ascending and
  /// apart from each other, none without length. A line that only touches the solid may yield nothing.
  virtual void intersect(const Ray& line, std::vector<SolidSpan>& spans) const = 0;

 protected:
  ToolSolid() = default;
  /// To be called in the constructor.
  void setBounds(const Box& bounds) { bounds_ = bounds; }

 private:
  Box bounds_;
};

}  // namespace restroke::points
