#include "points/dexel/line_family.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "implicit/errors.h"
#include "implicit/parallel.h"

namespace restroke::points {

namespace {

using implicit::PrimitiveList;
using implicit::Sphere;

// Can the line, of unit direction, meet the ball? Rounding makes it say yes rather than no.
bool mayMeet(const Ray& line, const Sphere& ball) {
  const DVec3 to = DVec3(ball.center) - line.origin;
  const double along = dot(to, line.direction), r = static_cast<double>(ball.radius);
  return dot(to, to) - along * along <= r * r * (1 + 0x1p-20) + 0x1p-40 * dot(to, to);
}

// One line under the primitives of a list.
class LineOfList {
 public:
  LineOfList(const PrimitiveList& list, std::size_t count) : list_(list), count_(count) {}

  const LineEnds& through(const Ray& line, double from) {
    ends_.clear();
    for (std::size_t i = 0; i < count_; ++i) {
      const std::uint32_t slot = PrimitiveList::slotOf(list_.idAt(i));
      if (mayMeet(line, list_.balls()[slot])) apply(line, from, i);
    }
    return ends_;
  }

 private:
  void apply(const Ray& line, double from, std::size_t position) {
    const implicit::Primitive primitive = list_.at(position);
    const bool fills = primitive.sign == implicit::Sign::Positive;
    intervals_.clear();
    intersect(primitive.shape, line, intervals_);
    for (const RayInterval& in : intervals_) {
      if (!(in.exit > from)) continue;
      const auto normalAt = [&](double t) {
        const DVec3 n = t < from ? -line.direction : outwardNormal(primitive.shape, line.at(t));
        return packNormal(Vec3(fills ? n : -n));
      };
      changeLine(ends_,
                 {static_cast<float>(std::max(in.enter, from)), static_cast<float>(in.exit),
                  normalAt(in.enter), normalAt(in.exit)},
                 fills, static_cast<OperationId>(position));
    }
  }

  const PrimitiveList& list_;
  std::size_t count_;
  LineEnds ends_;
  std::vector<RayInterval> intervals_;
};

// Two unit vectors at right angles to a unit vector and to each other: along the axes where it is along one.
std::array<DVec3, 2> across(DVec3 n) {
  int least = 0;
  for (int a = 1; a < 3; ++a)
    if (std::fabs(n[a]) < std::fabs(n[least])) least = a;
  DVec3 axis{0};
  axis[least] = 1;
  const DVec3 u = normalized(cross(axis, n));
  return {u, cross(n, u)};
}

}  // namespace

Ray LineFamily::line(int column, int row) const {
  const double c = column, r = row;
  return {origin + c * originStep + r * originRowStep,
          normalized(direction + c * directionStep + r * directionRowStep)};
}

LineFamily latticeAlong(DVec3 direction, const Box& bounds, double cell) {
  const double size = length(direction);
  if (!std::isfinite(size) || !(size > 0))
    throw InputError("lines: the direction must be finite and have a length greater than 0");
  if (bounds.empty()) throw InputError("lines: the bounds are empty; there is nothing to lay lines through");
  if (!(std::isfinite(cell) && cell > 0))
    throw InputError(fmt::format("lines: {} apart were asked for; it must be greater than 0", cell));
  LineFamily out;
  out.direction = direction / size;
  const auto [u, v] = across(out.direction);
  const DVec3 half = (DVec3(bounds.max) - DVec3(bounds.min)) / 2.0;
  const DVec3 middle = (DVec3(bounds.max) + DVec3(bounds.min)) / 2.0;
  int counts[2];
  const DVec3* const axes[2] = {&u, &v};
  for (int i = 0; i < 2; ++i) {
    const DVec3& a = *axes[i];
    const double extent = 2 * (std::fabs(a.x) * half.x + std::fabs(a.y) * half.y + std::fabs(a.z) * half.z);
    const double lines = std::max(1.0, std::ceil(extent / cell - 1e-9));
    constexpr double kMostInARow = 8192;
    if (lines > kMostInARow)
      throw InputError(fmt::format("lines: {:.6g} apart there would be {} in a row; at most {} are allowed",
                                   cell, lines, kMostInARow));
    counts[i] = static_cast<int>(lines);
  }
  out.width = counts[0];
  out.height = counts[1];
  out.originStep = cell * u;
  out.originRowStep = cell * v;
  out.origin = middle - (out.width - 1) / 2.0 * out.originStep - (out.height - 1) / 2.0 * out.originRowStep;
  return out;
}

LineFamily raysOf(const Camera& camera) {
  validate(camera, "lines of a camera");
  const CameraFrame frame = frameOf(camera);
  LineFamily out;
  out.width = static_cast<int>(camera.width);
  out.height = static_cast<int>(camera.height);
  out.origin = frame.position;
  out.directionStep = 2 * frame.halfWidth / out.width * frame.right;
  out.directionRowStep = -2 * frame.halfHeight / out.height * frame.up;
  out.direction = frame.forward - (out.width - 1) / 2.0 * out.directionStep -
                  (out.height - 1) / 2.0 * out.directionRowStep;
  out.from = 0;
  return out;
}

Dexels dexelsOf(const PrimitiveList& list, const LineFamily& family, implicit::Prefix prefix,
                const Execution& execution) {
  Dexels out(family.width, family.height, {.operations = true});
  inArena(execution, [&] {
    tbb::parallel_for(0, family.height, [&](int row) {
      LineOfList line(list, std::min(prefix.count, list.size()));
      for (int column = 0; column < family.width; ++column)
        out.write(out.lineAt(column, row), line.through(family.line(column, row), family.from));
    });
  });
  return out;
}

}  // namespace restroke::points
