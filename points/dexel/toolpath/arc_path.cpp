#include "points/dexel/toolpath/arc_path.h"

#include <cmath>
#include <utility>

namespace restroke::points {

namespace {

using lines::Flat2;

Flat2 unit(Flat2 a) {
  const double size = std::sqrt(lines::dot(a, a));
  return {a.x / size, a.y / size};
}

}  // namespace

DVec3 ArcPath::nearest(DVec3 p) const {
  const DVec3 q = p - center;
  const Flat2 flat{dot(q, u), dot(q, v)};
  const double size = std::sqrt(lines::dot(flat, flat));
  if (size > 0 && isBeside(flat)) return at({flat.x / size, flat.y / size}, heightBegin);
  return at(lines::dot(flat, begin) >= lines::dot(flat, end) ? begin : end, heightBegin);
}

Flat2 middleOf(Flat2 a, Flat2 b, bool isLong) {
  // Half way, the direction is along the sum, and at right angles to the difference: that of the two which
  // has more digits is used.
  if (lines::dot(a, b) >= 0) {
    const Flat2 sum = unit({a.x + b.x, a.y + b.y});
    return isLong ? Flat2{-sum.x, -sum.y} : sum;
  }
  const Flat2 difference = unit({b.x - a.x, b.y - a.y});
  return {difference.y, -difference.x};
}

std::optional<ArcPath> arcPathOf(const PathElement& element, const std::array<DVec3, 3>& axes) {
  if (element.kind != PathElement::Kind::Arc) return std::nullopt;
  const int w = element.axis, u = (w + 1) % 3, v = (w + 2) % 3;
  const Flat2 from{element.from[u] - element.center[u], element.from[v] - element.center[v]};
  const Flat2 to{element.to[u] - element.center[u], element.to[v] - element.center[v]};
  const double radius = std::sqrt(lines::dot(from, from));
  if (!(radius > 0)) return std::nullopt;
  ArcPath arc;
  // The frame's coordinates of a model axis are the axes' components along it.
  const auto inFrame = [&](int axis) { return DVec3(axes[0][axis], axes[1][axis], axes[2][axis]); };
  arc.u = inFrame(u);
  arc.v = inFrame(v);
  arc.w = inFrame(w);
  arc.radius = radius;
  arc.center = -from.x * arc.u - from.y * arc.v;
  arc.begin = unit(from);
  arc.heightEnd = element.to[w] - element.from[w];
  arc.isWhole = element.from[u] == element.to[u] && element.from[v] == element.to[v];
  // An end at the centre has no direction: the arc stays where it begins.
  arc.end = arc.isWhole || !(lines::dot(to, to) > 0) ? arc.begin : unit(to);
  double turn = lines::cross(from, to);
  if (element.clockwise) {
    std::swap(arc.begin, arc.end);
    std::swap(arc.heightBegin, arc.heightEnd);
    turn = -turn;
  }
  arc.isLong = !arc.isWhole && turn < 0;
  return arc;
}

}  // namespace restroke::points
