#include "points/dexel/refine/refined_surfels.h"

#include <algorithm>
#include <cmath>

#include "points/dexel/end_maker.h"

namespace restroke::points {

namespace {

constexpr float kOverlap = 1.02f, kLargest = 1.25f;

// From a line to the next one of its row or column, at a depth.
double spacingAt(const LineFamily& family, double depth) {
  const auto larger = [](DVec3 a, DVec3 b) { return std::max(length(a), length(b)); };
  return larger(family.originStep, family.originRowStep) +
         depth * larger(family.directionStep, family.directionRowStep) / length(family.direction);
}

}  // namespace

std::vector<Surfel> surfelsOf(const RefinedModel& refined) {
  std::vector<Surfel> out;
  LineEnds ends;
  for (const RefinedFamily& of : refined.families) {
    const LineFamily& family = of.lines.family;
    for (int row = 0; row < family.height; ++row)
      for (int column = 0; column < family.width; ++column) {
        of.dexels.read(of.dexels.lineAt(column, row), ends);
        if (ends.empty()) continue;
        const Ray line = family.line(column, row);
        for (const SpanEnd& end : ends) {
          Surfel surfel;
          const auto depth = static_cast<double>(end.depth);
          surfel.position = Point(line.at(depth));
          surfel.normal = unpackNormal(end.normal);
          // On a plane through the end the lines stand in a lattice that is stretched by the slope.
          const float along = std::max(std::fabs(dot(surfel.normal, Vec3(line.direction))), 1e-6f);
          surfel.radius = std::min(kOverlap * std::sqrt(0.5f) / along, kLargest) *
                          static_cast<float>(spacingAt(family, depth));
          const EndMaker maker = makerOf(end, of.dexels.keepsOperations());
          surfel.primitive = maker.operation;
          surfel.sign = maker.sign;
          out.push_back(surfel);
        }
      }
  }
  return out;
}

}  // namespace restroke::points
